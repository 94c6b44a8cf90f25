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
//! - Pieces that are nearer than four radii along a fiber do not touch. A fiber that ends where it started one period on goes
//!   on there: its ends move together, and lengths along it are counted past them.
//! - Where the twist of a thread does not close, its fibers are cut. Their ends stay in the plane of the cut, and do not touch
//!   the fibers of the next period, which start there, within two radii.

mod chains;
mod contact;
mod covered;
mod cut;
mod neighbours;
mod relax;

use super::realization::Realization;
use crate::error::Error;
pub(super) use chains::LONGEST;
use chains::{Chains, Laid};
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
    /// 0.995 of their volume or more. They get corners of their own, and stay as they were when that takes more than 400 sweeps.
    /// With `threads` those of one thread were cut in one place.
    pub(super) fn push_apart(&mut self, threads: bool) -> Separation {
        if self.fibers.is_empty() {
            return Separation { penetration: 0.0, covered: 1.0, sweeps: 0 };
        }
        let fibers = self.fibers.iter().map(|fiber| Laid {
            points: &fiber.points,
            radius: fiber.radius,
            thread: (threads && !fiber.hair).then_some(fiber.thread),
        });
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

    /// Why its fibers are refused after so many draws, of the threads of a cloth or of a sheet.
    pub(super) fn refusal(&self, left: &Separation, threads: bool, draws: u64) -> Error {
        let (fill, sweeps, cover) = (self.volume_fraction(), left.sweeps, left.covered);
        let [deep, allowed] = [left.penetration, TOLERANCE].map(|depth| 100.0 * depth);
        let cover = format!("all together cover {cover:.4} of their volume");
        let found = match (left.penetration > TOLERANCE, left.fills()) {
            (true, false) => format!(
                "the fibers fill {fill:.2} of the cloth and cannot be laid apart: after {sweeps} sweeps two of them still run \
                 {deep:.1} % of a diameter into each other, and {cover}; allowed: {allowed:.0} %, {COVERED}"
            ),
            (true, true) => format!(
                "the fibers fill {fill:.2} of the cloth and cannot all be laid apart: in each of {draws} draws a few still run into \
                 each other after {sweeps} sweeps, two of them by {deep:.1} % of a diameter; allowed: {allowed:.0} %"
            ),
            (false, _) => format!(
                "the fibers fill {fill:.2} of the cloth and are too close: no two run deeper than {deep:.1} % of a diameter into \
                 each other, but so many touch that {cover}; allowed: {COVERED}"
            ),
        };
        let cure = if threads { "Give the yarns more room" } else { "Make the sheet thicker" };
        Error::Input(format!("{found}. {cure} or take fewer fibers, or packing = \"random\""))
    }

    /// Σ π R² ℓ over the volume of the element: the share of it that is fiber, if none overlap.
    pub fn volume_fraction(&self) -> f64 {
        let length = |points: &[DVec3]| points.windows(2).map(|ends| ends[0].distance(ends[1])).sum::<f64>();
        let volume = |radius: f64, points: &[DVec3]| std::f64::consts::PI * radius.powi(2) * length(points);
        let volume: f64 = self.fibers.iter().map(|fiber| volume(fiber.radius, &fiber.points)).sum();
        volume / (self.period.x * self.period.y * self.thickness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn a_refusal_names_what_was_not_reached_and_who_needs_room() {
        let drawn = Realization { fibers: Vec::new(), period: DVec2::ONE, thickness: 1.0 };
        let said = |penetration: f64, covered: f64, threads: bool| {
            let left = Separation { penetration, covered, sweeps: 400 };
            assert!(!left.reached());
            drawn.refusal(&left, threads, 3).to_string()
        };
        let (deep, cover) = ("of a diameter", "of their volume");
        let dense = said(0.5, 0.9, false);
        assert!(dense.contains("50.0 % of a diameter") && dense.contains("cover 0.9000 of their volume"), "{dense}");
        assert!(dense.contains("Make the sheet thicker or take fewer fibers"), "{dense}");
        // What was reached is no cause.
        let few = said(0.074, 0.999, true);
        assert!(few.contains("3 draws") && few.contains("7.4 % of a diameter") && !few.contains(cover), "{few}");
        assert!(few.contains("Give the yarns more room or take fewer fibers"), "{few}");
        let close = said(0.01, 0.99, true);
        assert!(close.contains("cover 0.9900 of their volume; allowed: 0.995") && close.contains(deep), "{close}");
        assert!(!close.contains("cannot") && !close.contains("2 %"), "{close}");
    }
}
