//! Directions that are spread over a cone, and what a table makes of them.

use super::directions::direction_of;
use crate::concentric::Patch;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

const GOLDEN_RATIO: f64 = 1.618_033_988_749_895;

/// `points` points that fill the cone |p × axis| ≤ sin(spread) evenly by solid angle: a spherical Fibonacci lattice.
pub fn cone_points(axis: DVec3, spread: f64, points: u32) -> impl Iterator<Item = DVec3> {
    let (side, up) = axis.any_orthonormal_pair();
    (0..points).map(move |index| {
        let fraction = (f64::from(index) + 0.5) / f64::from(points);
        let along = 1.0 - fraction * (1.0 - spread.cos());
        let across = (1.0 - along * along).sqrt();
        let (sin, cos) = (TAU * (f64::from(index) / GOLDEN_RATIO).fract()).sin_cos();
        axis * along + (side * cos + up * sin) * across
    })
}

/// Largest error of ⟨|m × p|⟩ of tabulated patches against stated directions over rays m, relative to its largest value;
/// the shares of each add up to 1.
pub fn visible_area_error(parts: &[(Patch, f64)], stated: &[(DVec3, f64)], rays: impl Iterator<Item = DVec3>) -> f64 {
    let within = [0.125, 0.375, 0.625, 0.875];
    let tabulated: Vec<(DVec3, f64)> = parts
        .iter()
        .flat_map(|(patch, share)| {
            let points = within.into_iter().flat_map(move |a| within.into_iter().map(move |b| DVec2::new(a, b)));
            points.map(move |point| (direction_of(patch.at(point)), share / 16.0))
        })
        .collect();
    let (mut worst, mut largest): (f64, f64) = (0.0, 0.0);
    for m in rays {
        let mean = |parts: &[(DVec3, f64)]| parts.iter().map(|(p, share)| m.cross(*p).length() * share).sum::<f64>();
        let truth = mean(stated);
        worst = worst.max((truth - mean(&tabulated)).abs());
        largest = largest.max(truth);
    }
    worst / largest
}
