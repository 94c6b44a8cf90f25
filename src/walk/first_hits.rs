//! Where the light of each start first meets a fiber, found by straight rays and not by flights through a medium.

use crate::error::Result;
use glam::DVec3;
use std::sync::Arc;

/// A straight ray of a start, and the fiber that it meets first. Numbers are of single precision, as a device has them, so
/// that all engines set out alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// Direction of propagation.
    pub m: [f32; 3],
    /// What it meets; none where it goes straight through.
    pub fiber: Option<MetFiber>,
}

/// A fiber as a ray meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetFiber {
    /// Where, in mm; x and y inside the repeat.
    pub place: [f32; 3],
    /// Direction p of the fiber.
    pub p: [f32; 3],
    /// Offset α of the ray from the fiber's axis in radii, by the sign convention of [`EventDraws`](super::EventDraws).
    pub offset: f32,
    /// Kind of fiber, an index of the kinds of the tables.
    pub kind: u32,
}

/// Rays of all starts, equally many of each.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstHits {
    /// Rays of one start.
    pub of_start: usize,
    /// Start by start.
    pub rays: Vec<FirstHit>,
}

impl FirstHits {
    /// The ray that walk number `i` of a start takes: over and over in their order.
    pub fn of_walk(&self, start: usize, i: u64) -> &FirstHit {
        &self.rays[start * self.of_start + (i % self.of_start as u64) as usize]
    }

    /// `each` rays of every start through each of some realizations, by turns: the first few come from many of them.
    pub fn by_turns(each: usize, realizations: &[Vec<FirstHit>]) -> FirstHits {
        let starts = realizations.first().map_or(0, |own| own.len() / each.max(1));
        let of = |start: usize, ray: usize| realizations.iter().map(move |own| own[start * each + ray]);
        let rays = (0..starts).flat_map(|start| (0..each).flat_map(move |ray| of(start, ray))).collect();
        FirstHits { of_start: each * realizations.len(), rays }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.rays.len() * size_of::<FirstHit>()
    }
}

/// Rays without end, in banks: walk i of each start belongs to bank ⌊i / span⌋.
pub trait FirstHitBanks: Sync {
    /// Walks of each start that one bank serves.
    fn span(&self) -> u64;

    /// The rays of a bank, the same whenever they are asked for.
    ///
    /// # Errors
    /// Those of drawing the fibers.
    fn bank(&self, number: u64) -> Result<Arc<FirstHits>>;
}

/// Three numbers in double precision.
pub fn widen(numbers: [f32; 3]) -> DVec3 {
    DVec3::from(numbers.map(f64::from))
}
