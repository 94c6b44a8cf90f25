//! What can be said of a cloth in a few numbers.

use super::woven::{Cloth, System, Thread};
use std::f64::consts::PI;

/// Figures of one repeat of a cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Length of the axes of the warp and of the weft over their straight length, less 1.
    pub crimp: [f64; 2],
    /// Steepest slope of an axis of the warp and of the weft in radians.
    pub steepest: [f64; 2],
    /// Deepest that two yarns run into each other in mm; 0 up to rounding.
    pub penetration: f64,
    /// Share of the area that the warp and the weft cover, seen along z.
    pub cover: [f64; 2],
    /// Share of the area that any yarn covers, seen along z.
    pub cover_factor: f64,
    /// The rest.
    pub openness: f64,
    /// Mass of an area in g/m², if all densities are stated; with crimp and the take-up of the twist.
    pub areal_mass: Option<f64>,
    /// Share of the volume that is fiber.
    pub volume_fraction: f64,
    /// Largest share of the section of a yarn's plies that is fiber, where it climbs most steeply; real fibers reach 0.9.
    pub densest: f64,
    /// Fibers of the repeat.
    pub fibers: usize,
    /// Straight pieces of the realization that these figures are taken from.
    pub pieces: usize,
}

impl Cloth {
    /// The figures of the cloth; lengths of fibers are those of one realization.
    pub fn statistics(&self) -> Statistics {
        let systems = [System::Warp, System::Weft];
        let of = |system: System| self.threads().iter().filter(move |thread| thread.system == system);
        let crimp = systems.map(|system| {
            let length: f64 = of(system).map(|thread| self.path(thread).length()).sum();
            let straight: f64 = of(system).map(|thread| self.path(thread).period).sum();
            length / straight - 1.0
        });
        let slope = |thread: &Thread| self.path(thread).steepest;
        let steepest = systems.map(|system| of(system).map(slope).fold(0.0, f64::max).atan());
        let cover = systems.map(|system| {
            let period = if system == System::Warp { self.period().x } else { self.period().y };
            of(system).map(|thread| self.yarn(thread).width).sum::<f64>() / period
        });
        let densest =
            self.threads().iter().map(|thread| self.yarn(thread).packing(self.kinds()) * slope(thread).hypot(1.0));
        // Both systems are straight seen from above, so what one leaves open the other covers in proportion.
        let openness = (1.0 - cover[0]) * (1.0 - cover[1]);
        let (lengths, pieces) = self.fiber_lengths();
        let area = self.period().x * self.period().y;
        let volumes = lengths.iter().zip(self.kinds()).map(|(length, fiber)| PI * fiber.radius.powi(2) * length);
        // mm³/mm² × g/cm³ = 10³ g/m².
        let mass = volumes.clone().zip(self.kinds()).filter(|(volume, _)| *volume > 0.0);
        let mass = mass.map(|(volume, fiber)| Some(volume * fiber.density? * 1e3 / area)).sum();
        Statistics {
            crimp,
            steepest,
            penetration: self.largest_penetration(),
            cover,
            cover_factor: 1.0 - openness,
            openness,
            areal_mass: mass,
            volume_fraction: volumes.sum::<f64>() / (area * self.thickness()),
            densest: densest.fold(0.0, f64::max),
            fibers: self.weave().fibers(),
            pieces,
        }
    }

    /// Length of each kind of fiber of the scene in one realization in mm, and its number of pieces.
    fn fiber_lengths(&self) -> (Vec<f64>, usize) {
        let mut lengths = vec![0.0; self.kinds().len()];
        let mut pieces = 0;
        for thread in 0..self.threads().len() {
            self.realize_thread(0, 0, thread, &mut |piece| {
                lengths[piece.kind] += piece.length;
                pieces += 1;
            });
        }
        (lengths, pieces)
    }
}
