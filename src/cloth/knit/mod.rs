//! Loops of weft knits.
//!
//! A course is one yarn. Its loops bend as little as they can (the bending energy ∫κ² ds, as in Vassiliadis, Kallivretaki,
//! Provatidis, "Geometrical modelling of plain weft knitted fabrics", Indian J. Fibre Text. Res. 32, 2007) at the stated
//! stitch density and loop length, and axes keep the yarn's diameter apart, in their own course and to its neighbours.

mod course;
mod crossings;
mod energy;
mod minimise;
mod relax;
mod series;

pub use course::{Course, Frame};

use super::repeat::{Axis, Fabric, Laid, System, Thread};
use crate::error::{Error, Result};
use crate::scene::{Knit, THINNEST};
use energy::Room;
use glam::DVec2;
use rayon::prelude::*;
use relax::relax;

/// Loop lengths that are tried where the stated one is impossible: so many to a factor of two, over two such factors.
const TRIED: i32 = 16;

/// Lay the course of a repeat.
///
/// # Errors
/// [`Error::Input`] when the loops do not fit; it says what would.
pub(super) fn lay(knit: &Knit) -> Result<Laid> {
    let relaxed = relax(knit.stitch, &room(knit, knit.loop_length, knit.diameter())).map_err(|_| jammed(knit))?;
    let course = Course::new(knit, &relaxed);
    let spacing = DVec2::new(knit.wale_spacing, knit.course_spacing);
    Ok(Laid {
        yarns: vec![knit.yarn.clone()],
        spacing,
        period: spacing * DVec2::new(knit.wales() as f64, 1.0),
        thickness: course.thickness,
        threads: vec![Thread { system: System::Weft, index: 0, yarn: 0, at: 0.0, axis: 0 }],
        axes: vec![Axis::Loops(course)],
        fabric: Fabric::Knitted(knit.clone(), relaxed.clearance),
    })
}

/// The room of a loop of some length and a yarn of some diameter, in mm.
fn room(knit: &Knit, length: f64, diameter: f64) -> Room {
    Room { wale: knit.wale_spacing / length, course: knit.course_spacing / length, diameter: diameter / length }
}

/// What would fit in place of loops that do not.
fn jammed(knit: &Knit) -> Error {
    let fits = |length: f64, diameter: f64| relax(knit.stitch, &room(knit, length, diameter)).is_ok();
    // Shorten or lengthen the loops, as far as they reach the next course and the yarn is not too thin for them.
    let length = |step: i32| knit.loop_length * 2f64.powf(f64::from(step) / f64::from(TRIED));
    let sensible = |step: &i32| length(*step) > knit.least_length() && knit.diameter() >= THINNEST * length(*step);
    let lengths = || -> Vec<i32> {
        let steps: Vec<i32> = (-TRIED..=TRIED).filter(sensible).collect();
        steps.into_par_iter().filter(|step| fits(length(*step), knit.diameter())).collect()
    };
    // Take a thinner yarn.
    let thinner = || {
        let (mut low, mut high) = (0.0, knit.diameter());
        for _ in 0..6 {
            let middle = (low + high) / 2.0;
            if fits(knit.loop_length, middle) { low = middle } else { high = middle }
        }
        low
    };
    let (possible, low) = rayon::join(lengths, thinner);
    let lengths = match (possible.first(), possible.last()) {
        (Some(first), Some(last)) => {
            format!("; `loop_length_mm` can be from about {:.3} to {:.3}", length(*first), length(*last))
        }
        _ => String::new(),
    };
    let diameters = if low > 0.0 {
        format!("at most a yarn of {:.0} µm fits", (1e3 * low).floor())
    } else {
        "no yarn fits".into()
    };
    Error::Input(format!(
        "loops of {:.4} mm of a yarn that is {:.0} µm thick do not fit at these courses and wales: {diameters}{lengths}",
        knit.loop_length,
        1e3 * knit.diameter(),
    ))
}
