//! Fibers that do not run into each other.
//!
//! Computes: from fibers that were laid independently, fibers that are nowhere nearer than touching, near their old places.
//!
//! Inputs: a [`Realization`]; lengths in mm.
//!
//! Method: position-based dynamics (Müller, Heidelberger, Hennix, Ratcliff, "Position based dynamics", 2007) on the corners
//! of the fibers, cut to pieces of at most 6 radii. In a sweep each two pieces that are nearer than the sum of their radii
//! and 2 % ask their corners to move apart by half of what is missing each, along the line of their nearest points, weighted
//! by how near these are to a corner. A corner takes the mean of what it is asked for one and a half times, spread over
//! its neighbours along the fiber by (1, 2, 1)/4 so that fibers do not kink, and half of its last step besides. Axes stay
//! in the slab, and inside by their radius where all were; ends on a face stay on it. Sweeps end when the deepest overlap is
//! below 2 % of the sum of the radii: then fibers cover about 0.999 of their volume in all presets
//! (`cargo bench --bench packing`).
//!
//! The result is a function of the fibers alone: each corner adds up what it is asked for in a fixed order.
//!
//! Where two fibers are caught in each other, though there is room for all, they are laid anew ([`Realizer`](super::Realizer)).
//!
//! Differs from position-based dynamics:
//! - All contacts are looked at in one step and averaged, where the paper goes from one to the next: so the work can be
//!   shared out, and no order is preferred.
//! - Nothing holds the length of a piece or the bend at a corner: fibers move across themselves, and little. Yarns of
//!   voile spread by 5 % and their fibers get 0.8 % longer (`tests/cloth/packing.rs`).
//! - Lists of neighbours are made anew after six sweeps at the earliest. A contact may be missed meanwhile, but the end is
//!   decided on fresh lists with exact distances.
//! - Ends that face each other, as where a thread is cut, do not touch within two radii. Neither do pieces of one fiber that
//!   are nearer than four radii along it.

mod chains;
mod contact;
mod covered;
mod neighbours;
mod relax;

use super::realization::Realization;
use crate::error::Error;
use chains::Chains;
use covered::covered;
use glam::DVec3;
use neighbours::Neighbours;
use relax::relax;

/// Deepest overlap that is left, over the sum of the radii.
pub const TOLERANCE: f64 = 0.02;
/// Least share of the volume of fibers that they cover.
pub const COVERED: f64 = 0.995;
/// Most sweeps.
const SWEEPS: u32 = 400;

/// How separate the fibers of a realization are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Separation {
    /// Deepest that two fibers run into each other, over the sum of their radii; 0 when none do.
    pub penetration: f64,
    /// Volume that fibers cover over the sum of their volumes, Σ π R² ℓ; from points inside of them, to about 10⁻⁴.
    pub covered: f64,
    /// Sweeps over all contacts that it took.
    pub sweeps: u32,
}

impl Separation {
    /// Whether fibers are as separate as they are to be.
    pub fn reached(&self) -> bool {
        self.penetration <= TOLERANCE && self.fills()
    }

    /// Whether fibers have found room, but for a few that may be caught in each other.
    pub(super) fn fills(&self) -> bool {
        self.covered >= COVERED
    }
}

impl Realization {
    /// Push fibers apart until none runs deeper into another than 2 % of the sum of their radii, and together they cover
    /// 0.995 of their volume or more. They get more corners, and stay as they were when that takes more than 400 sweeps.
    pub(super) fn push_apart(&mut self) -> Separation {
        if self.fibers.is_empty() {
            return Separation { penetration: 0.0, covered: 1.0, sweeps: 0 };
        }
        let fibers = self.fibers.iter().map(|fiber| (fiber.points.as_slice(), fiber.radius));
        let mut chains = Chains::new(fibers, self.period, self.thickness);
        let (sweeps, penetration) = relax(&mut chains, TOLERANCE, SWEEPS);
        let covered = covered(&chains, &Neighbours::new(&chains));
        let separation = Separation { penetration, covered, sweeps };
        if separation.reached() {
            for (index, fiber) in self.fibers.iter_mut().enumerate() {
                fiber.points = chains.of(index).to_vec();
            }
        }
        separation
    }

    /// Why its fibers are refused.
    pub(super) fn refusal(&self, left: &Separation) -> Error {
        Error::Input(format!(
            "the fibers fill {:.2} of the cloth and cannot be laid apart: after {} sweeps two of them still run {:.0} % of a \
             diameter into each other, and all together cover {:.4} of their volume; allowed: {:.0} %, {COVERED}. Give the yarns \
             more room or take fewer fibers, or packing = \"random\"",
            self.volume_fraction(),
            left.sweeps,
            100.0 * left.penetration,
            left.covered,
            100.0 * TOLERANCE,
        ))
    }

    /// Σ π R² ℓ over the volume of the element: the share of it that is fiber, if none overlap.
    pub fn volume_fraction(&self) -> f64 {
        let length = |points: &[DVec3]| points.windows(2).map(|ends| ends[0].distance(ends[1])).sum::<f64>();
        let volume = |radius: f64, points: &[DVec3]| std::f64::consts::PI * radius.powi(2) * length(points);
        let volume: f64 = self.fibers.iter().map(|fiber| volume(fiber.radius, &fiber.points)).sum();
        volume / (self.period.x * self.period.y * self.thickness)
    }
}
