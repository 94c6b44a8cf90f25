//! Reflectance, transmittance and direct light of an incident cell, and their means over the hemisphere.

use super::estimate::{Estimate, direct, share, straight};
use crate::goniometer::{Goniometer, Moments, Straight, Tally};
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
        share(tally, start, walks, bins.map(|bin| tally.light(start, bin, channel)).sum())
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
    goniometer.incident_basis()?;
    let cells = goniometer.incident_cells();
    let walks = tally.walks_per_incident();
    let part = |start| Part {
        weight: goniometer.weight(start),
        totals: totals(tally, start, channel),
        rays: straight(tally, start, walks),
    };
    let parts: Vec<Part> = (side * cells..(side + 1) * cells).map(part).collect();
    let mean = |of: fn(&Totals) -> Estimate| mean(&parts, walks, of);
    Some(Totals {
        reflectance: mean(|part| part.reflectance),
        transmittance: mean(|part| part.transmittance),
        direct: match tally.straight {
            None => mean(|part| part.direct),
            Some(_) => direct_mean(&parts),
        },
        absorptance: if tally.weights.is_some() { mean(|part| part.absorptance) } else { Estimate::default() },
        lost: parts.iter().map(|part| part.weight * part.totals.lost).sum::<f64>(),
    })
}

/// A start, as a part of the mean over its lit side.
struct Part {
    weight: f64,
    totals: Totals,
    /// What straight rays say of it.
    rays: Option<Straight>,
}

/// The mean of a share that walks tell. Variances of walks add up; what straight rays take from the direct light of all starts they
/// give to the share of each.
fn mean(parts: &[Part], walks: u64, of: fn(&Totals) -> Estimate) -> Estimate {
    let one = |value: f64| parts.iter().all(|part| of(&part.totals).value == value);
    if let Some(value) = [0.0, 1.0].into_iter().find(|value| one(*value)) {
        // Nothing or everything of all walks: the error of one of them, of the largest cell.
        let largest = parts.iter().map(|part| part.weight).fold(0.0, f64::max);
        return Estimate { value, stderr: largest / walks as f64 };
    }
    // Of the walks that met a fiber: the share of a start, and the mean of all.
    let met =
        |part: &Part| part.rays.map_or(0.0, |rays| of(&part.totals).value / (1.0 - rays.value).max(f64::MIN_POSITIVE));
    let all: f64 = parts.iter().map(|part| part.weight * met(part)).sum();
    let variance = |part: &Part| {
        let Estimate { value, stderr } = of(&part.totals);
        let of_rays = part.rays.map_or(0.0, |rays| met(part) * rays.stderr);
        // A cell that saw nothing or everything has no variance of its own.
        let own = if value == 0.0 || value == 1.0 { 0.0 } else { (stderr * stderr - of_rays * of_rays).max(0.0) };
        let shared = part.rays.map_or(0.0, |rays| met(part) * all * rays.with_mean);
        part.weight * (part.weight * own + shared)
    };
    let value = parts.iter().map(|part| part.weight * of(&part.totals).value).sum();
    Estimate { value, stderr: parts.iter().map(variance).sum::<f64>().max(0.0).sqrt() }
}

/// The mean of direct light that straight rays tell, with the variance of the mean over realizations; a start of which the walks
/// say all has its own.
fn direct_mean(parts: &[Part]) -> Estimate {
    let value = parts.iter().map(|part| part.weight * part.totals.direct.value).sum();
    let shared = |part: &Part| {
        let own = part.weight * part.totals.direct.stderr.powi(2);
        part.weight * part.rays.map_or(own, |rays| rays.with_mean)
    };
    Estimate { value, stderr: parts.iter().map(shared).sum::<f64>().max(0.0).sqrt() }
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

    #[test]
    fn what_rays_leave_open_of_direct_light_they_leave_open_of_what_is_absorbed() {
        let origin = Origin { engine: "cpu".into(), adapter: String::new(), seed: 0 };
        let disc = |n| Basis::new(BasisChoice::Disc(n));
        let goniometer = Goniometer { incidence: Incidence::Cells(disc(2)), exit: disc(1), sides: vec![Side::Front] };
        // All light that meets a fiber stays there; rays of the starts err together, or against each other.
        let errors = |with_mean: [f64; 4]| {
            let mut tally = Tally::new(origin.clone(), BinLayout { exit_cells: 1 }, 4, Some(1));
            tally.coverage = Coverage::new(origin.clone(), 0..10_000);
            for cell in 0..4 {
                tally.bins[5 * cell..5 * cell + 5].copy_from_slice(&[0, 0, 1000, 0, 9000]);
            }
            let (unit, weights) = (tally.unit(), tally.weights.as_mut().expect("it absorbs"));
            for cell in 0..4 {
                weights.moments[3 * cell + 2] = Moments { sum: 9000 * unit, square: 9000 * unit * unit };
            }
            tally.straight = Some(with_mean.map(|with_mean| Straight { value: 0.1, stderr: 0.02, with_mean }).to_vec());
            let mean = hemispherical(&tally, &goniometer, 0, 0).expect("a disc has a mean");
            assert!((mean.absorptance.value - 0.9).abs() < 1e-12 && (mean.direct.value - 0.1).abs() < 1e-12);
            [mean.direct.stderr, mean.absorptance.stderr, mean.reflectance.stderr]
        };
        let [direct, absorbed, reflected] = errors([4e-4; 4]);
        assert!((direct - 0.02).abs() < 1e-12 && (absorbed - 0.02).abs() < 1e-6 && reflected < 3e-5);
        let [direct, absorbed, _] = errors([0.0; 4]);
        assert!(direct < 1e-12 && absorbed < 1e-4, "{direct} {absorbed}");
        // Where no walk meets a fiber, walks say all, and none of the light is known without error.
        let mut tally = Tally::new(origin.clone(), BinLayout { exit_cells: 1 }, 4, Some(1));
        tally.coverage = Coverage::new(origin.clone(), 0..100);
        (0..4).for_each(|cell| tally.bins[5 * cell + 2] = 100);
        tally.straight = Some(vec![Straight { value: 1.0, stderr: 0.01, with_mean: 0.0 }; 4]);
        let mean = hemispherical(&tally, &goniometer, 0, 0).expect("a disc has a mean");
        assert_eq!(mean.direct, Estimate { value: 1.0, stderr: 0.005 });
    }
}
