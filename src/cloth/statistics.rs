//! What can be said of a cloth in a few numbers.

use super::repeat::{Axis, Cloth, System, Thread};
use std::f64::consts::PI;

/// Figures of one repeat of a cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// The figures that weaves and knits have of their own.
    pub shape: Shape,
    /// Deepest that two yarns run into each other in mm; 0 up to rounding.
    pub penetration: f64,
    /// Share of the area that any yarn covers, seen along z.
    pub cover_factor: f64,
    /// The rest.
    pub openness: f64,
    /// Mass of an area in g/m², if all densities are stated; with crimp and the take-up of the twist.
    pub areal_mass: Option<f64>,
    /// Share of the volume that is fiber.
    pub volume_fraction: f64,
    /// Largest share of the section of a yarn's plies that is fiber: where it climbs most steeply in a weave, on the inside of
    /// the tightest bend of a knit. Real fibers reach 0.9.
    pub densest: f64,
    /// Fibers of the repeat.
    pub fibers: usize,
    /// Straight pieces of the realization that these figures are taken from.
    pub pieces: usize,
}

/// How the threads run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Of a weave; warp, then weft.
    Woven {
        /// Length of the axes over their straight length, less 1.
        crimp: [f64; 2],
        /// Steepest slope of an axis in radians.
        steepest: [f64; 2],
        /// Share of the area that the system covers, seen along z.
        cover: [f64; 2],
    },
    /// Of a knit.
    Knitted {
        /// Length of the axis in a loop in mm.
        loop_length: f64,
        /// Loops in a mm².
        stitch_density: f64,
        /// Steepest slope of the axis in radians.
        steepest: f64,
        /// Least radius of curvature of the axis in mm.
        tightest: f64,
    },
}

impl Cloth {
    /// The figures of the cloth; lengths of fibers are those of one realization.
    pub fn statistics(&self) -> Statistics {
        let steepest = |thread: &Thread| self.axis(thread).steepest();
        let packing = |thread: &Thread| self.yarn(thread).packing(self.kinds());
        let (shape, openness, densest) = match (self.knit(), self.axis(&self.threads()[0])) {
            (Some(knit), Axis::Loops(course)) => {
                let tightest = 1.0 / course.tightest();
                let shape = Shape::Knitted {
                    loop_length: course.length / knit.wales() as f64,
                    stitch_density: 1.0 / (knit.wale_spacing * knit.course_spacing),
                    steepest: course.steepest().atan(),
                    tightest,
                };
                // A section keeps its middle; its inside is as much shorter as the bend is tight.
                let inside = 1.0 - knit.diameter() / 2.0 / tightest;
                (shape, 1.0 - course.cover(&knit.yarn, self.period()), packing(&self.threads()[0]) / inside)
            }
            _ => {
                let systems = [System::Warp, System::Weft];
                let of = |system: System| self.threads().iter().filter(move |thread| thread.system == system);
                let crimp = systems.map(|system| {
                    let length: f64 = of(system).map(|thread| self.axis(thread).length()).sum();
                    let straight: f64 = of(system).map(|thread| self.axis(thread).period()).sum();
                    length / straight - 1.0
                });
                let cover = systems.map(|system| {
                    let period = if system == System::Warp { self.period().x } else { self.period().y };
                    of(system).map(|thread| self.yarn(thread).width).sum::<f64>() / period
                });
                let steep = systems.map(|system| of(system).map(steepest).fold(0.0, f64::max).atan());
                let filled = self.threads().iter().map(|thread| packing(thread) * steepest(thread).hypot(1.0));
                // Both systems are straight seen from above, so what one leaves open the other covers in proportion.
                let openness = (1.0 - cover[0]) * (1.0 - cover[1]);
                (Shape::Woven { crimp, steepest: steep, cover }, openness, filled.fold(0.0, f64::max))
            }
        };
        let (lengths, pieces) = self.fiber_lengths();
        let area = self.period().x * self.period().y;
        let volumes = lengths.iter().zip(self.kinds()).map(|(length, fiber)| PI * fiber.radius.powi(2) * length);
        // mm³/mm² × g/cm³ = 10³ g/m².
        let mass = volumes.clone().zip(self.kinds()).filter(|(volume, _)| *volume > 0.0);
        let mass = mass.map(|(volume, fiber)| Some(volume * fiber.density? * 1e3 / area)).sum();
        Statistics {
            shape,
            penetration: self.largest_penetration(),
            cover_factor: 1.0 - openness,
            openness,
            areal_mass: mass,
            volume_fraction: volumes.sum::<f64>() / (area * self.thickness()),
            densest,
            fibers: self.threads().iter().map(|thread| self.yarn(thread).fibers()).sum(),
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
