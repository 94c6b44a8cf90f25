//! Reflectance, transmittance and direct light of an incident cell, and their means over the hemisphere.

use super::estimate::{Estimate, probability};
use crate::goniometer::{Goniometer, Incidence, Tally};
use serde::Serialize;

/// Where the light of an incident direction goes. The four shares and `lost` add up to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Totals {
    /// Share that leaves on the lit side.
    pub reflectance: Estimate,
    /// Share that touched a fiber and leaves on the other side.
    pub transmittance: Estimate,
    /// Share that touched no fiber.
    pub direct: Estimate,
    /// Share that stays in the fibers; 0 in a lossless cloth.
    pub absorptance: Estimate,
    /// Share that was given up.
    pub lost: f64,
}

/// The totals of one incident cell.
pub fn totals(tally: &Tally, cell: usize) -> Totals {
    let walks = tally.walks_per_incident;
    Totals {
        reflectance: probability(tally.reflection(cell).iter().sum(), walks),
        transmittance: probability(tally.transmission(cell).iter().sum(), walks),
        direct: probability(tally.direct(cell), walks),
        absorptance: Estimate::default(),
        lost: tally.lost(cell) as f64 / walks as f64,
    }
}

/// The mean over all incident cells by projected solid angle; none for listed directions.
pub fn hemispherical(tally: &Tally, goniometer: &Goniometer) -> Option<Totals> {
    let Incidence::Disc(disc) = &goniometer.incidence else { return None };
    let parts: Vec<Totals> = (0..disc.cells()).map(|cell| totals(tally, cell)).collect();
    let cells = parts.len() as f64;
    let walks = tally.walks_per_incident as f64;
    let mean = |of: fn(&Totals) -> Estimate| {
        let value = parts.iter().map(|part| of(part).value).sum::<f64>() / cells;
        if value == 0.0 || value == 1.0 {
            // Nothing or everything of all walks: the error of one of them.
            return Estimate { value, stderr: 1.0 / (walks * cells) };
        }
        // Variances add; a cell that saw nothing or everything has none of its own.
        let own = |share: f64| share * (1.0 - share) / (walks - 1.0).max(1.0);
        let variance = parts.iter().map(|part| own(of(part).value)).sum::<f64>() / (cells * cells);
        Estimate { value, stderr: variance.sqrt() }
    };
    Some(Totals {
        reflectance: mean(|part| part.reflectance),
        transmittance: mean(|part| part.transmittance),
        direct: mean(|part| part.direct),
        absorptance: Estimate::default(),
        lost: parts.iter().map(|part| part.lost).sum::<f64>() / cells,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::goniometer::{BinLayout, DiscBasis, Origin};

    #[test]
    fn the_shares_add_up_to_one() {
        let origin = Origin { engine: "cpu", adapter: String::new(), seed: 0 };
        let mut tally = Tally::new(origin, BinLayout { exit_cells: 1 }, 4);
        tally.walks_per_incident = 100;
        for cell in 0..4 {
            tally.bins[4 * cell..4 * cell + 4].copy_from_slice(&[50, 30, 18, 2]);
        }
        let incidence = Incidence::Disc(DiscBasis { n: 2 });
        let goniometer = Goniometer { incidence, exit: DiscBasis { n: 1 } };
        let mean = hemispherical(&tally, &goniometer).expect("a disc has a mean");
        let sum = mean.reflectance.value + mean.transmittance.value + mean.direct.value + mean.lost;
        assert!((sum - 1.0).abs() < 1e-12);
        let one = totals(&tally, 0).reflectance.stderr;
        assert!((mean.reflectance.stderr - one / 2.0).abs() < 1e-12);
        // Nothing in any cell: one walk of all, not of a cell.
        for cell in 0..4 {
            tally.bins[4 * cell + 2] = 0;
        }
        let mean = hemispherical(&tally, &goniometer).expect("a disc has a mean");
        assert_eq!(mean.direct, Estimate { value: 0.0, stderr: 1.0 / 400.0 });
    }
}
