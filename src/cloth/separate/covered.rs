//! How much of the volume of fibers is covered once.

use super::chains::Chains;
use super::neighbours::Neighbours;
use super::relax::END;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Points in each piece, about, if pieces are few.
const POINTS: f64 = 2e5;

/// Volume that fibers cover over the sum of their volumes: the mean of 1/m over points inside of fibers, each in m of them.
pub fn covered(chains: &Chains, neighbours: &Neighbours) -> f64 {
    let each = (POINTS / chains.len() as f64).ceil().max(1.0) as usize;
    let of = |piece: usize| {
        if !chains.starts(piece) {
            return [0.0; 2];
        }
        let [a, b] = chains.ends(piece);
        let radius = chains.radius_at(piece);
        let volume = a.distance(b) * radius * radius;
        let (side, up) = (b - a).normalize_or(DVec3::X).any_orthonormal_pair();
        let share = |point: usize| {
            // A sequence that fills the cylinder evenly (Roberts 2018, R₃).
            let number = (piece * each + point) as f64;
            let [u, v, w] = [0.819_172_513_396_164_4, 0.671_043_606_703_789_3, 0.549_700_477_901_997]
                .map(|step| (0.5 + number * step).fract());
            let place = DVec2::from_angle(TAU * v) * (radius * w.sqrt());
            let point = a.lerp(b, u) + side * place.x + up * place.y;
            let inside = neighbours.of(piece).iter().filter(|neighbour| {
                let [start, end] = neighbour.ends(chains);
                let (from, along) = (point - start, end - start);
                let at = from.dot(along) / along.length_squared();
                let radius = chains.radius_at(neighbour.piece as usize);
                (0.0..1.0).contains(&at)
                    && (from - along * at).length_squared() < radius * radius
                    && !chains.cut_between(piece, neighbour, [u, at], END)
            });
            1.0 / (1 + inside.count()) as f64
        };
        let mean = (0..each).map(share).sum::<f64>() / each as f64;
        [volume * mean, volume]
    };
    let parts: Vec<[f64; 2]> = (0..chains.len()).into_par_iter().with_min_len(256).map(of).collect();
    let sum = |index: usize| parts.iter().map(|part| part[index]).sum::<f64>();
    sum(0) / sum(1)
}
