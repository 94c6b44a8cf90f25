//! Reflectance, transmittance and direct light of an incident cell, and their means over the hemisphere.

use super::estimate::{Estimate, direct, share};
use crate::goniometer::{Goniometer, Moments, Tally};
use serde::Serialize;
use std::f64::consts::PI;

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
    let basis = goniometer.incident_basis()?;
    let cells = basis.cells();
    let parts: Vec<(f64, Totals)> = (0..cells)
        .map(|cell| (basis.projected_solid_angle(cell) / PI, totals(tally, side * cells + cell, channel)))
        .collect();
    let largest = parts.iter().map(|(weight, _)| *weight).fold(0.0, f64::max);
    let walks = tally.walks_per_incident() as f64;
    let mean = |of: fn(&Totals) -> Estimate| {
        let one = |value: f64| parts.iter().all(|(_, part)| of(part).value == value);
        if let Some(value) = [0.0, 1.0].into_iter().find(|value| one(*value)) {
            // Nothing or everything of all walks: the error of one of them, of the largest cell.
            return Estimate { value, stderr: largest / walks };
        }
        let value = parts.iter().map(|(weight, part)| weight * of(part).value).sum::<f64>();
        // Variances add; a cell that saw nothing or everything has none of its own.
        let own = |part: &Totals| match of(part) {
            Estimate { value: 0.0 | 1.0, .. } => 0.0,
            Estimate { stderr, .. } => stderr * stderr,
        };
        let variance = parts.iter().map(|(weight, part)| weight * weight * own(part)).sum::<f64>();
        Estimate { value, stderr: variance.sqrt() }
    };
    let mut direct = mean(|part| part.direct);
    if tally.straight.is_some() {
        // All starts have their straight rays through the same realizations: take their errors to go together.
        direct.stderr = parts.iter().map(|(weight, part)| weight * part.direct.stderr).sum::<f64>();
    }
    Some(Totals {
        reflectance: mean(|part| part.reflectance),
        transmittance: mean(|part| part.transmittance),
        direct,
        absorptance: if tally.weights.is_some() { mean(|part| part.absorptance) } else { Estimate::default() },
        lost: parts.iter().map(|(weight, part)| weight * part.lost).sum::<f64>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::goniometer::{Basis, BinLayout, Coverage, Incidence, Origin};
    use crate::scene::{BasisChoice, Side};

    #[test]
    fn the_shares_add_up_to_one() {
        let origin = Origin { engine: "cpu".into(), adapter: String::new(), seed: 0 };
        let mut tally = Tally::new(origin, BinLayout { exit_cells: 1 }, 4, None);
        tally.coverage = Coverage::new(tally.origin().clone(), 0..100);
        for cell in 0..4 {
            tally.bins[5 * cell..5 * cell + 5].copy_from_slice(&[50, 30, 18, 2, 0]);
        }
        let disc = |n| Basis::new(BasisChoice::Disc(n));
        let goniometer = Goniometer { incidence: Incidence::Cells(disc(2)), exit: disc(1), sides: vec![Side::Front] };
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

    #[test]
    fn cells_count_by_their_projected_solid_angle() {
        let origin = Origin { engine: "cpu".into(), adapter: String::new(), seed: 0 };
        let choice = BasisChoice::Polar { rings: 2, sectors: 1 };
        let mut tally = Tally::new(origin, BinLayout { exit_cells: 2 }, 2, None);
        tally.coverage = Coverage::new(tally.origin().clone(), 0..100);
        // All of the light of the inner ring comes back, none of that of the outer; both have sin² = ½.
        tally.bins = vec![60, 40, 0, 0, 0, 0, 0, 0, 0, 20, 0, 80, 0, 0];
        let even = |goniometer: &Goniometer| hemispherical(&tally, goniometer, 0, 0).expect("cells have a mean");
        let rings = |rings| Goniometer {
            incidence: Incidence::Cells(Basis::new(BasisChoice::Polar { rings, sectors: 1 })),
            exit: Basis::new(choice),
            sides: vec![Side::Front],
        };
        assert!((even(&rings(2)).reflectance.value - 0.5).abs() < 1e-12);
        // Of three rings the first two have sin² θ of ¼ and ½ more.
        tally.bins.extend([100, 0, 0, 0, 0, 0, 0]);
        let even = hemispherical(&tally, &rings(3), 0, 0).expect("cells have a mean");
        assert!((even.reflectance.value - 0.5).abs() < 1e-12, "{}", even.reflectance.value);
        assert!((even.transmittance.value - 0.2 * 0.5).abs() < 1e-12);
        assert!((even.direct.value - 0.8 * 0.5).abs() < 1e-12);
    }
}
