//! Reflectance, transmittance and direct light of an incident cell, and their means over the hemisphere.

use super::estimate::{Estimate, direct, share};
use crate::goniometer::{Goniometer, Incidence, Moments, Tally};
use serde::Serialize;

/// Where the light of a start goes. The four shares and `lost` add up to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Totals {
    /// Share that leaves on the lit side.
    pub reflectance: Estimate,
    /// Share that touched a fiber and leaves on the other side.
    pub transmittance: Estimate,
    /// Share that touched no fiber.
    pub direct: Estimate,
    /// Share that stays in the fibers; exactly 0 in a lossless cloth.
    pub absorptance: Estimate,
    /// Share that was given up.
    pub lost: f64,
}

/// The totals of one start in a channel.
pub fn totals(tally: &Tally, start: usize, channel: usize) -> Totals {
    let walks = tally.walks_per_incident();
    let cells = tally.layout.exit_cells;
    let sum = |bins: std::ops::Range<usize>| {
        let moments = bins.map(|bin| tally.light(start, bin, channel));
        // A walk leaves in one cell, so its square counts once.
        let sum = moments.fold(Moments::default(), |a, b| Moments { sum: a.sum + b.sum, square: a.square + b.square });
        share(tally, start, walks, sum)
    };
    let lost = share(tally, start, walks, Moments { sum: tally.lost(start) * tally.unit(), square: 0 });
    Totals {
        reflectance: sum(0..cells),
        transmittance: sum(cells..2 * cells),
        direct: direct(tally, start),
        absorptance: match &tally.weights {
            Some(_) => share(tally, start, walks, tally.absorbed(start, channel)),
            None => Estimate::default(),
        },
        lost: lost.value,
    }
}

/// The mean over all incident cells of a lit side (by its place in `sides`) by projected solid angle; none for listed
/// directions.
pub fn hemispherical(tally: &Tally, goniometer: &Goniometer, side: usize, channel: usize) -> Option<Totals> {
    let Incidence::Disc(disc) = &goniometer.incidence else { return None };
    let parts: Vec<Totals> = (0..disc.cells()).map(|cell| totals(tally, side * disc.cells() + cell, channel)).collect();
    let cells = parts.len() as f64;
    let walks = tally.walks_per_incident() as f64;
    let mean = |of: fn(&Totals) -> Estimate| {
        let value = parts.iter().map(|part| of(part).value).sum::<f64>() / cells;
        if value == 0.0 || value == 1.0 {
            // Nothing or everything of all walks: the error of one of them.
            return Estimate { value, stderr: 1.0 / (walks * cells) };
        }
        // Variances add; a cell that saw nothing or everything has none of its own.
        let own = |part: &Totals| match of(part) {
            Estimate { value: 0.0 | 1.0, .. } => 0.0,
            Estimate { stderr, .. } => stderr * stderr,
        };
        Estimate { value, stderr: parts.iter().map(own).sum::<f64>().sqrt() / cells }
    };
    let mut direct = mean(|part| part.direct);
    if tally.straight.is_some() {
        // All starts have their straight rays through the same realizations: take their errors to go together.
        direct.stderr = parts.iter().map(|part| part.direct.stderr).sum::<f64>() / cells;
    }
    Some(Totals {
        reflectance: mean(|part| part.reflectance),
        transmittance: mean(|part| part.transmittance),
        direct,
        absorptance: if tally.weights.is_some() { mean(|part| part.absorptance) } else { Estimate::default() },
        lost: parts.iter().map(|part| part.lost).sum::<f64>() / cells,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::goniometer::{BinLayout, Coverage, DiscBasis, Origin};
    use crate::scene::Side;

    #[test]
    fn the_shares_add_up_to_one() {
        let origin = Origin { engine: "cpu".into(), adapter: String::new(), seed: 0 };
        let mut tally = Tally::new(origin, BinLayout { exit_cells: 1 }, 4, None);
        tally.coverage = Coverage::new(tally.origin().clone(), 0..100);
        for cell in 0..4 {
            tally.bins[5 * cell..5 * cell + 5].copy_from_slice(&[50, 30, 18, 2, 0]);
        }
        let incidence = Incidence::Disc(DiscBasis { n: 2 });
        let goniometer = Goniometer { incidence, exit: DiscBasis { n: 1 }, sides: vec![Side::Front] };
        let mean = hemispherical(&tally, &goniometer, 0, 0).expect("a disc has a mean");
        let sum = mean.reflectance.value + mean.transmittance.value + mean.direct.value + mean.lost;
        assert!((sum - 1.0).abs() < 1e-12);
        let one = totals(&tally, 0, 0).reflectance.stderr;
        assert!((mean.reflectance.stderr - one / 2.0).abs() < 1e-12);
        // Nothing in any cell: one walk of all, not of a cell.
        for cell in 0..4 {
            tally.bins[5 * cell + 2] = 0;
        }
        let mean = hemispherical(&tally, &goniometer, 0, 0).expect("a disc has a mean");
        assert_eq!(mean.direct, Estimate { value: 0.0, stderr: 1.0 / 400.0 });
    }
}
