//! One random draw of all fibers, as straight pieces.

use super::repeat::{Axis, Cloth, System, Thread};
use super::section::{Section, Strand};
use super::steps::Station;
use glam::DVec3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// A straight piece of a fiber; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primitive {
    /// Its middle: 0 ≤ x, y < period. Its ends may lie in the next repeat.
    pub centre: DVec3,
    /// Unit vector along it; it points to where its thread goes.
    pub direction: DVec3,
    /// Its length.
    pub length: f64,
    /// Radius of the fiber.
    pub radius: f64,
    /// Index of the kind of fiber in the scene.
    pub kind: usize,
    /// Index of the thread in [`Cloth::threads`].
    pub thread: usize,
}

impl Cloth {
    /// Draw the places of all fibers of the repeat: a function of the seed and the number of the draw.
    pub fn realize(&self, seed: u64, number: u64) -> Vec<Primitive> {
        let mut pieces = Vec::with_capacity(self.expected_pieces());
        for thread in 0..self.threads().len() {
            self.realize_thread(seed, number, thread, &mut |piece| pieces.push(piece));
        }
        pieces
    }

    /// Draw the fibers of one thread, the same as in [`Cloth::realize`]; pieces of a fiber follow each other.
    pub fn realize_thread(&self, seed: u64, number: u64, thread: usize, take: &mut dyn FnMut(Primitive)) {
        let place = &self.threads()[thread];
        let (section, steps) = (self.section(place), self.steps(place));
        let mut rng = generator(seed, number, thread);
        let strands = section.draw(&mut rng);
        // Cut the thread at one place, since its twist need not close over the period.
        let cut = rng.random::<f64>() * steps.pieces;
        for strand in &strands {
            let radius = section.radius(strand.kind);
            let corner = |pieces: f64| self.point(place, &steps.at(pieces), section, strand);
            // Shift the corners of each fiber, so that their pieces do not end side by side.
            let first = rng.random::<f64>();
            let inner = (0..).map(|step| first + f64::from(step)).take_while(|pieces| *pieces < steps.pieces);
            let mut last = corner(cut);
            for pieces in inner.chain([steps.pieces]) {
                let next = corner(cut + pieces);
                let (along, length) = (next - last, next.distance(last));
                if length > 0.0 {
                    let centre = self.wrap((last + next) / 2.0);
                    take(Primitive { centre, direction: along / length, length, radius, kind: strand.kind, thread });
                }
                last = next;
            }
        }
    }

    /// The point of a fiber at a station of its thread.
    fn point(&self, thread: &Thread, station: &Station, section: &Section, strand: &Strand) -> DVec3 {
        if let Axis::Loops(course) = self.axis(thread) {
            let frame = course.at(station.along);
            return frame.off(section.place(strand, station.length, frame.turn));
        }
        let place = section.place(strand, station.length, 0.0);
        let z = station.height + place.y;
        // Left is up × the thread's direction.
        match thread.system {
            System::Warp => DVec3::new(thread.at - place.x, station.along, z),
            System::Weft => DVec3::new(station.along, thread.at + place.x, z),
        }
    }

    /// The image of a point inside the repeat.
    fn wrap(&self, point: DVec3) -> DVec3 {
        let wrap = |x: f64, period: f64| {
            let x = x.rem_euclid(period);
            if x < period { x } else { 0.0 }
        };
        DVec3::new(wrap(point.x, self.period().x), wrap(point.y, self.period().y), point.z)
    }
}

/// Random numbers of one thread of one draw.
fn generator(seed: u64, number: u64, thread: usize) -> ChaCha8Rng {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&number.to_le_bytes());
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(thread as u64);
    rng
}
