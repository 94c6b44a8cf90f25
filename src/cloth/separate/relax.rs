//! Sweeps that push pieces apart.

use super::chains::Chains;
use super::contact::{closest, meet};
use super::neighbours::{Neighbour, Neighbours};
use glam::DVec3;
use rayon::prelude::*;

/// Distance that is aimed at, in sums of the radii.
const ROOM: f64 = 1.02;
/// Share of what is asked for that a corner goes in a step.
const STEP: f64 = 1.5;
/// Share of its last step that it goes besides.
const KEPT: f64 = 0.5;
/// Least weight of what a corner is asked for: what hardly concerns it moves it little.
const LEAST_WEIGHT: f64 = 0.5;
/// Sweeps with the same lists at least.
const SAME_LISTS: u32 = 6;
/// Where a thread is cut its fibers do not touch those of the next period so near to their ends, in radii.
pub const END: f64 = 2.0;
/// Axes nearly meet below this distance in sums of the radii.
const MEET: f64 = 0.1;
/// Axes cross when the sine of their angle is above this.
const CROSS: f64 = 0.1;
/// A piece lies on neither side of another below this distance in sums of the radii.
const ON_NEITHER: f64 = 1e-9;
/// Pieces that are worth a task of their own.
const TASK: usize = 256;

/// What all contacts of a piece ask of its two corners.
#[derive(Clone, Copy, Default)]
struct Push {
    way: [DVec3; 2],
    weight: [f64; 2],
    /// Deepest overlap over the sum of the radii.
    depth: f64,
}

/// Push pieces apart until none runs deeper into another than the tolerance, in sums of their radii, or the sweeps are used
/// up; how many were made and what is left.
pub fn relax(chains: &mut Chains, tolerance: f64, most: u32) -> (u32, f64) {
    let mut steps = vec![DVec3::ZERO; chains.len()];
    let mut neighbours = Neighbours::new(chains);
    let (mut moved, mut since) = (0.0, 0);
    for sweep in 0..most {
        if moved > neighbours.reach && since >= SAME_LISTS {
            chains.measure();
            neighbours = Neighbours::new(chains);
            (moved, since) = (0.0, 0);
        }
        let pushes: Vec<Push> = each(chains, |piece| push(chains, piece, neighbours.of(piece)));
        if pushes.iter().all(|push| push.depth <= tolerance) {
            chains.measure();
            neighbours = Neighbours::new(chains);
            (moved, since) = (0.0, 0);
            let depth = deepest(chains, &neighbours);
            if depth <= tolerance {
                return (sweep, depth);
            }
        }
        moved += step(chains, &pushes, &mut steps);
        since += 1;
    }
    chains.measure();
    (most, deepest(chains, &Neighbours::new(chains)))
}

/// Move all corners; the longest way of any.
fn step(chains: &mut Chains, pushes: &[Push], steps: &mut Vec<DVec3>) -> f64 {
    let asked: Vec<DVec3> = each(chains, |corner| {
        let (mut way, mut weight) = (DVec3::ZERO, 0.0);
        let [before, after] = chains.pieces_at(corner);
        for (piece, end) in [(after, 0), (before, 1)] {
            if let Some(piece) = piece {
                way += pushes[piece].way[end];
                weight += pushes[piece].weight[end];
            }
        }
        way * (STEP / weight.max(LEAST_WEIGHT))
    });
    let moves: Vec<[DVec3; 2]> = each(chains, |corner| {
        // Spread it along the fiber.
        let [before, after] = chains.pieces_at(corner);
        let before = before.map_or(asked[corner], |piece| asked[piece]);
        let after = after.map_or(asked[corner], |piece| asked[piece + 1]);
        let spread = (before + asked[corner] * 2.0 + after) / 4.0;
        let to = chains.moved(corner, steps[corner] * KEPT + spread);
        [to, to - chains.points[corner]]
    });
    chains.points = moves.iter().map(|[to, _]| *to).collect();
    *steps = moves.iter().map(|[_, way]| *way).collect();
    steps.iter().map(|way| way.length_squared()).fold(0.0, f64::max).sqrt()
}

/// Something for each corner, in their order.
fn each<T: Send>(chains: &Chains, of: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    (0..chains.len()).into_par_iter().with_min_len(TASK).map(of).collect()
}

fn push(chains: &Chains, piece: usize, neighbours: &[Neighbour]) -> Push {
    let mut push = Push::default();
    for neighbour in neighbours {
        let other = neighbour.piece as usize;
        let [own, ends] = [chains.ends(piece), neighbour.ends(chains)];
        let found = meet(own, ends);
        let touching = chains.radius_at(piece) + chains.radius_at(other);
        let wanted = touching * ROOM;
        let square = found.apart.length_squared();
        if square >= wanted * wanted || chains.cut_between(piece, neighbour, found.shares, END) {
            continue;
        }
        let distance = square.sqrt();
        push.depth = push.depth.max(1.0 - distance / touching);
        let order = if piece < other { 1.0 } else { -1.0 };
        let normal = side(own, ends, order, found.apart, touching);
        let way = normal * ((wanted - distance) / 2.0);
        for (end, share) in [1.0 - found.shares[0], found.shares[0]].into_iter().enumerate() {
            push.way[end] += way * share;
            push.weight[end] += share;
        }
    }
    push
}

/// The direction that the first of two pieces is pushed in: away from the second one, and of axes that nearly meet to the
/// side where it lies already. Where it lies on none, `order`, ±1, tells the pieces apart.
fn side(own: [DVec3; 2], ends: [DVec3; 2], order: f64, apart: DVec3, touching: f64) -> DVec3 {
    if apart.length_squared() > (MEET * touching).powi(2) {
        return apart.normalize();
    }
    let (along, across) = ((own[1] - own[0]).normalize(), (ends[1] - ends[0]).normalize());
    let normal = along.cross(across);
    if normal.length_squared() < CROSS * CROSS {
        return apart.try_normalize().unwrap_or(order * along.any_orthonormal_vector());
    }
    // The normal turns over when the pieces change places.
    let (normal, height) = (normal.normalize(), apart.dot(normal.normalize()));
    if height.abs() > ON_NEITHER * touching { normal * height.signum() } else { normal }
}

/// Deepest overlap of any two pieces over the sum of their radii.
fn deepest(chains: &Chains, neighbours: &Neighbours) -> f64 {
    let of = |piece: usize| {
        let depth = |neighbour: &Neighbour| {
            let other = neighbour.piece as usize;
            let found = closest(chains.ends(piece), neighbour.ends(chains));
            let touching = chains.radius_at(piece) + chains.radius_at(other);
            if chains.cut_between(piece, neighbour, found.shares, END) {
                0.0
            } else {
                1.0 - found.apart.length() / touching
            }
        };
        neighbours.of(piece).iter().map(depth).fold(0.0, f64::max)
    };
    each(chains, of).into_iter().fold(0.0, f64::max)
}
