//! The fibers of a sheet: a periodic element of straight fibers laid at random.
//!
//! Computes: a Poisson process of straight fibers with the stated length density and directions at every depth. Axes fill
//! 0 ≥ z ≥ −thickness and end at its faces; surfaces may stick out by a radius.
//!
//! Inputs: a checked [`Sheet`] and the kinds of fiber; lengths in mm.
//!
//! A fiber of the direction p is as long as its projection on the plane is one period, so it never lies over its own
//! image. Its middle lies anywhere in a layer that is higher than the sheet by its own height, and there are as many
//! middles in a volume as make the stated length: then every depth has its share of every direction, steep or flat. What
//! sticks out of the sheet is cut off. Fibers that are not steep enough to cross the sheet end inside: on a mm of fiber at
//! the angle θ to the normal there are 2 sin θ / period ends at most, one in 125 radii of flat fibers. Fibers along x or y
//! end where they begin.
//!
//! The period is 250 radii of the thickest fiber, or more where the element would have few pieces. A ray of a general
//! direction that has met a fiber hardly meets an image of it: straight light comes through as through fibers that are all
//! independent, at 60° through a sheet 1.2 periods thick as well (`tests/cloth/webs.rs`). Steep fibers of exactly one
//! direction, seen along the plane of it and x or y, are an exception: their images stand behind each other.
//!
//! Differs from the paper: it has no sheets.

use super::curves::{Curve, generator};
use super::realization::Realization;
use crate::error::{Error, Result};
use crate::scene::{Fiber, Orientation, Sheet, SheetFibers};
use glam::{DVec2, DVec3};
use rand::{Rng, RngExt};
use std::f64::consts::TAU;

/// Least period in radii of the thickest fiber.
const LEAST: f64 = 250.0;
/// Largest period in these radii.
const MOST: f64 = 5000.0;
/// Pieces that an element should have, if the period is not too long.
const WANTED_PIECES: f64 = 2000.0;
/// Most pieces of an element.
const MOST_PIECES: f64 = 2e7;
/// Pieces of a fiber that is one period long.
const PARTS: f64 = 4.0;
/// Projections shorter than this share of a fiber are none.
const UPRIGHT: f64 = 1e-9;

/// A periodic element of a sheet.
#[derive(Clone, Debug)]
pub struct Web {
    sheet: Sheet,
    radii: Vec<f64>,
    period: f64,
    expected_pieces: usize,
}

impl Web {
    /// Choose the element of a sheet.
    ///
    /// # Errors
    /// [`Error::Input`] when it would have too many pieces.
    pub fn new(sheet: &Sheet, fibers: &[Fiber]) -> Result<Web> {
        let radii: Vec<f64> = fibers.iter().map(|fiber| fiber.radius).collect();
        let thickest = sheet.kinds().iter().map(|&kind| radii[kind]).fold(0.0, f64::max);
        // Fibers, of which there are L P² cos θ and a few that end inside, and their cuts: L P (P cos θ + 5 t) pieces.
        let density: f64 = sheet.fibers.iter().map(|part| part.length_density).sum();
        let steep: f64 = sheet.fibers.iter().map(|part| part.length_density * steepness(&part.orientation)).sum();
        let cuts = (PARTS + 1.0) * density * sheet.thickness;
        let wanted = 2.0 * WANTED_PIECES / (cuts + (cuts * cuts + 4.0 * steep * WANTED_PIECES).sqrt());
        let period = wanted.clamp(LEAST * thickest, MOST * thickest);
        let pieces = (steep * period + cuts) * period;
        if pieces > MOST_PIECES {
            return Err(Error::Input(format!(
                "an element of the sheet {period:.3} mm wide, {LEAST} radii of its fibers, has more than {MOST_PIECES:e} \
                 straight pieces of fiber; make the sheet thinner, or its fibers fewer or less different in radius"
            )));
        }
        Ok(Web { sheet: sheet.clone(), radii, period, expected_pieces: pieces as usize })
    }

    /// Pieces that a realization has, about.
    pub fn expected_pieces(&self) -> usize {
        self.expected_pieces
    }

    /// Pieces that a realization has, about, where none is longer than so many radii.
    pub fn pieces_no_longer_than(&self, radii: f64) -> usize {
        let of = |part: &SheetFibers| part.length_density / (radii * self.radii[part.fiber]);
        let density: f64 = self.sheet.fibers.iter().map(of).sum();
        (density * self.period * self.period * self.sheet.thickness) as usize
    }

    /// Size of the element along x and y in mm.
    pub fn period(&self) -> DVec2 {
        DVec2::splat(self.period)
    }

    /// Thickness of the sheet in mm.
    pub fn thickness(&self) -> f64 {
        self.sheet.thickness
    }

    /// Draw the fibers: a function of the seed and the number of the draw.
    pub fn draw(&self, seed: u64, number: u64) -> Realization {
        let mut fibers = Vec::new();
        for (index, part) in self.sheet.fibers.iter().enumerate() {
            let mut rng = generator(seed, number, index as u64);
            self.draw_part(part, index, &mut rng, &mut fibers);
        }
        Realization { fibers, period: self.period(), thickness: self.sheet.thickness }
    }

    /// Draw the fibers of a population.
    fn draw_part(&self, part: &SheetFibers, thread: usize, rng: &mut impl Rng, fibers: &mut Vec<Curve>) {
        let (period, thickness) = (self.period, self.sheet.thickness);
        // On a mm² there are L (t sin θ / P + cos θ) fibers: L sin θ / P middles in a volume, in a layer t + P cot θ high.
        let most = thickness / period + 1.0;
        let mean = part.length_density * period * period * most;
        let mut passed = exponential(rng);
        while passed < mean {
            passed += exponential(rng);
            let p = draw_direction(&part.orientation, rng);
            let flat = p.truncate().length();
            let kept = rng.random::<f64>() * most < flat * thickness / period + p.z.abs();
            let [x, y, depth] = [0; 3].map(|_| rng.random::<f64>());
            if kept {
                let points = self.lay(p, [x, y, depth]);
                fibers.push(Curve { points, radius: self.radii[part.fiber], kind: part.fiber, thread, hair: false });
            }
        }
    }

    /// The corners of the fiber of direction p at three uniform numbers.
    fn lay(&self, p: DVec3, [x, y, depth]: [f64; 3]) -> Vec<DVec3> {
        let (period, thickness) = (self.period, self.sheet.thickness);
        let middle = DVec2::new(x, y) * period;
        let flat = p.truncate().length();
        if flat < UPRIGHT {
            return self.cut(middle.extend(0.0), middle.extend(-thickness));
        }
        let (along, slope) = (p.truncate() / flat, p.z / flat);
        let height = period * slope.abs();
        let centre = height / 2.0 - depth * (thickness + height);
        // Cut it off at the faces, and let it end there exactly.
        let end = |side: f64| {
            let z = centre + side * slope;
            let inside = z.clamp(-thickness, 0.0);
            let far = if z == inside { side } else { (inside - centre) / slope };
            (middle + along * far).extend(inside)
        };
        self.cut(end(-period / 2.0), end(period / 2.0))
    }

    /// Corners from one end to the other, at most a quarter of a period apart.
    fn cut(&self, from: DVec3, to: DVec3) -> Vec<DVec3> {
        // A fiber of one period has so many pieces, however its length was rounded.
        let parts = (PARTS * from.distance(to) / self.period * (1.0 - 1e-12)).ceil().max(1.0) as u32;
        let inner = (1..parts).map(|part| from.lerp(to, f64::from(part) / f64::from(parts)));
        std::iter::once(from).chain(inner).chain([to]).collect()
    }
}

/// About ⟨|cos θ|⟩ to the normal.
fn steepness(orientation: &Orientation) -> f64 {
    match orientation {
        Orientation::Isotropic => 0.5,
        Orientation::Planar => 0.0,
        Orientation::Aligned { axis, spread } => axis.z.abs().max(spread.sin() / 2.0),
    }
}

/// A number of the exponential distribution of mean 1.
fn exponential(rng: &mut impl Rng) -> f64 {
    -(1.0 - rng.random::<f64>()).ln()
}

/// A direction, up or down alike.
fn draw_direction(orientation: &Orientation, rng: &mut impl Rng) -> DVec3 {
    let turn = TAU * rng.random::<f64>();
    let (sin, cos) = turn.sin_cos();
    match *orientation {
        Orientation::Planar => DVec3::new(cos, sin, 0.0),
        Orientation::Isotropic => {
            let z = 1.0 - rng.random::<f64>();
            let flat = (1.0 - z * z).sqrt();
            DVec3::new(flat * cos, flat * sin, z)
        }
        Orientation::Aligned { axis, spread } => {
            let along = 1.0 - rng.random::<f64>() * (1.0 - spread.cos());
            let across = (1.0 - along * along).max(0.0).sqrt();
            let (side, up) = axis.any_orthonormal_pair();
            axis * along + (side * cos + up * sin) * across
        }
    }
}
