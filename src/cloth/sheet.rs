//! The fibers of a homogeneous sheet, so that it can be drawn.

use super::curves::generator;
use super::realization::Primitive;
use crate::scene::{Fiber, Orientation, Sheet};
use glam::{DVec2, DVec3};
use rand::{Rng, RngExt};
use std::f64::consts::TAU;

/// Length of a fiber in sides of the square.
const LONG: f64 = 1.0;
/// Length of its pieces in sides of the square, at most.
const PIECE: f64 = 0.125;

/// Draw the fibers of a square of a sheet, which goes on periodically: straight, without order, and as much of them as the
/// sheet has on average; `side` is in mm. What sticks out of the faces is cut off. The draw is a function of the seed.
pub fn lay_sheet(sheet: &Sheet, fibers: &[Fiber], side: f64, seed: u64) -> Vec<Primitive> {
    let mut pieces = Vec::new();
    let (length, depth) = (LONG * side, sheet.thickness);
    for (stream, part) in sheet.fibers.iter().enumerate() {
        let mut rng = generator(seed, 0, stream as u64);
        // Let the middles lie as far outside as fibers reach.
        let expected = part.length_density * side * side * (depth + length) / length;
        for _ in 0..(expected + rng.random::<f64>()).floor() as usize {
            let p = direction(&part.orientation, &mut rng);
            let middle = DVec3::new(side * rng.random::<f64>(), side * rng.random::<f64>(), 0.0);
            let middle = middle.with_z(length / 2.0 - (depth + length) * rng.random::<f64>());
            let Some([from, to]) = inside(middle.z, p.z, length, depth) else { continue };
            let count = ((to - from) / (PIECE * side)).ceil();
            let step = (to - from) / count;
            for place in 0..count as u32 {
                let centre = middle + p * (from + step * (f64::from(place) + 0.5));
                let level = centre.truncate().rem_euclid(DVec2::splat(side));
                let radius = fibers[part.fiber].radius;
                let centre = level.extend(centre.z);
                pieces.push(Primitive { centre, direction: p, length: step, radius, kind: part.fiber, thread: 0 });
            }
        }
    }
    pieces
}

/// The stretch of a fiber that lies between the faces, from its middle.
fn inside(z: f64, climb: f64, length: f64, depth: f64) -> Option<[f64; 2]> {
    let half = length / 2.0;
    if climb == 0.0 {
        return (-depth..=0.0).contains(&z).then_some([-half, half]);
    }
    let [a, b] = [-z / climb, (-depth - z) / climb];
    let (from, to) = (a.min(b).max(-half), a.max(b).min(half));
    (from < to).then_some([from, to])
}

/// A direction of a population.
fn direction(orientation: &Orientation, rng: &mut impl Rng) -> DVec3 {
    let mut turned = |axis: DVec3, least: f64| {
        let cos = least + (1.0 - least) * rng.random::<f64>();
        let (across, other) = axis.any_orthonormal_pair();
        let round = DVec2::from_angle(TAU * rng.random::<f64>()) * (1.0 - cos * cos).max(0.0).sqrt();
        axis * cos + across * round.x + other * round.y
    };
    match orientation {
        Orientation::Isotropic => turned(DVec3::Z, 0.0),
        Orientation::Planar => DVec2::from_angle(TAU * rng.random::<f64>()).extend(0.0),
        Orientation::Aligned { axis, spread } => turned(*axis, spread.cos()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, Source};

    #[test]
    fn a_sheet_is_laid_with_its_length_and_its_directions() {
        for name in ["felt", "nonwoven"] {
            let scene = Scene::parse(&Source::find(name).expect("it is a preset")).expect("it is right");
            let sheet = scene.sheet().expect("it is a sheet");
            let side = 1.5;
            let pieces = lay_sheet(sheet, &scene.fibers, side, 1);
            let length: f64 = pieces.iter().map(|piece| piece.length).sum();
            let expected = sheet.fibers[0].length_density * side * side * sheet.thickness;
            // A thousand fibers, of which those at the faces are cut.
            assert!((length / expected - 1.0).abs() < 0.1, "{name}: {length} and {expected}");
            let upright: f64 =
                pieces.iter().map(|piece| piece.length * piece.direction.z.powi(2)).sum::<f64>() / length;
            let isotropic = if name == "felt" { 1.0 / 3.0 } else { 0.0 };
            assert!((upright - isotropic).abs() < 0.05, "{name}: {upright}");
            for piece in &pieces {
                let reach = piece.direction.z.abs() * piece.length / 2.0;
                assert!(piece.centre.z + reach < 1e-9 && piece.centre.z - reach > -sheet.thickness - 1e-9);
            }
        }
    }
}
