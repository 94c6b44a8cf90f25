//! Probabilities and BSDF values with their standard errors.

use crate::goniometer::{Goniometer, Moments, Straight, Tally};
use serde::Serialize;

/// A value and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Estimate {
    /// The mean.
    pub value: f64,
    /// Its standard deviation.
    pub stderr: f64,
}

/// One of the components that a lit side has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    /// Light that leaves on the lit side.
    Reflection,
    /// Light that touched a fiber and leaves on the other side.
    Transmission,
}

/// The share of `walks` that a count is.
///
/// The variance of the mean is P(1 − P)/(walks − 1), unbiased. A count of none or of all gets the error of one walk.
pub fn probability(count: u64, walks: u64) -> Estimate {
    let total = walks as f64;
    let value = count as f64 / total;
    let stderr = if count == 0 || count == walks || walks < 2 {
        1.0 / total
    } else {
        (value * (1.0 - value) / (total - 1.0)).sqrt()
    };
    Estimate { value, stderr }
}

/// The mean weight of `walks` walks of which `moments` are the sums, in units of one walk's light.
///
/// The variance of the mean is (⟨w²⟩ − ⟨w⟩²)/(walks − 1), unbiased. Where nothing was seen it is that of one walk of
/// full weight; a sum of full weights only, likewise.
pub fn mean_weight(moments: Moments, walks: u64, unit: u64) -> Estimate {
    // Weights are at most the unit, so this holds when each is all or nothing.
    if moments.square == moments.sum * unit {
        return probability(moments.sum / unit, walks);
    }
    let (n, unit) = (walks as f64, unit as f64);
    let value = moments.sum as f64 / n / unit;
    let square = moments.square as f64 / n / (unit * unit);
    Estimate { value, stderr: ((square - value * value).max(0.0) / (n - 1.0).max(1.0)).sqrt() }
}

/// The share of all light of a start with so many walks that `light` is, a sum over them.
///
/// Where straight rays say how much touches no fiber, the walks say how the rest is shared out.
pub fn share(tally: &Tally, start: usize, walks: u64, light: Moments) -> Estimate {
    let Source { walks, share } = Source::new(tally, start, walks);
    let Estimate { value, stderr } = mean_weight(light, walks, tally.unit());
    Estimate { value: share.value * value, stderr: (share.value * stderr).hypot(value * share.stderr) }
}

/// The walks of a start that say where light goes, and the share of all light that they stand for.
pub(super) struct Source {
    pub walks: u64,
    pub share: Estimate,
}

impl Source {
    /// All walks for all light; those that met a fiber for the rest where straight rays say how much touches none.
    pub fn new(tally: &Tally, start: usize, walks: u64) -> Source {
        match straight(tally, start, walks) {
            None => Source { walks, share: Estimate { value: 1.0, stderr: 0.0 } },
            Some(Straight { value, stderr, .. }) => {
                Source { walks: walks - tally.direct(start), share: Estimate { value: 1.0 - value, stderr } }
            }
        }
    }
}

/// What straight rays say of a start; where no walk met a fiber, none says where the rest goes, and the walks say all.
pub(super) fn straight(tally: &Tally, start: usize, walks: u64) -> Option<Straight> {
    let straight = tally.straight.as_ref().map(|straight| straight[start]);
    straight.filter(|_| tally.direct(start) < walks)
}

/// The share of the light of a start that touches no fiber.
pub fn direct(tally: &Tally, start: usize) -> Estimate {
    let walks = tally.walks_per_incident();
    match straight(tally, start, walks) {
        None => probability(tally.direct(start), walks),
        Some(Straight { value, stderr, .. }) => Estimate { value, stderr },
    }
}

/// f of one start by exit cell in a channel, in sr⁻¹: P(exit cell | start) over its projected solid angle.
pub fn values(
    tally: &Tally,
    goniometer: &Goniometer,
    component: Component,
    start: usize,
    channel: usize,
) -> Vec<Estimate> {
    let cells = tally.layout.exit_cells;
    let first = if component == Component::Reflection { 0 } else { cells };
    let value = |bin| {
        let solid_angle = goniometer.exit.projected_solid_angle(bin - first);
        let Estimate { value, stderr } =
            share(tally, start, tally.walks_per_incident(), tally.light(start, bin, channel));
        Estimate { value: value / solid_angle, stderr: stderr / solid_angle }
    };
    (first..first + cells).map(value).collect()
}

/// Relative noise that the walks leave in the scattered light, √(Σσ²/ΣP²) over all starts, exit cells and channels; also of an unfinished
/// tally.
///
/// It is infinite while nothing has been scattered.
pub fn noise(tally: &Tally) -> f64 {
    let (mut variance, mut square) = (0.0, 0.0);
    for start in 0..tally.starts() {
        let walks: u64 = tally.of_start(start).iter().sum();
        if walks == 0 {
            continue;
        }
        // More walks do not lessen the error of straight rays, which is left out.
        let Source { walks, share } = Source::new(tally, start, walks);
        for bin in 0..2 * tally.layout.exit_cells {
            for channel in 0..tally.channels() {
                let light = tally.light(start, bin, channel);
                if light.sum > 0 {
                    let Estimate { value, stderr } = mean_weight(light, walks, tally.unit());
                    square += (share.value * value).powi(2);
                    variance += (share.value * stderr).powi(2);
                }
            }
        }
    }
    if square > 0.0 { (variance / square).sqrt() } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::goniometer::{BinLayout, Origin};

    #[test]
    fn an_empty_cell_has_the_error_of_one_walk() {
        assert_eq!(probability(0, 1000), Estimate { value: 0.0, stderr: 1e-3 });
        assert_eq!(probability(1000, 1000), Estimate { value: 1.0, stderr: 1e-3 });
    }

    #[test]
    fn noise_is_the_error_of_the_scattered_light() {
        let origin = Origin { engine: "cpu".into(), adapter: String::new(), seed: 0 };
        let mut tally = Tally::new(origin, BinLayout { exit_cells: 2 }, 1, None);
        assert_eq!(noise(&tally), f64::INFINITY);
        // Shares 0.3 and 0.1 of 100 walks; the rest is direct.
        tally.bins = vec![30, 0, 10, 0, 60, 0, 0];
        let expected = ((0.3 * 0.7 + 0.1 * 0.9) / 99.0 / (0.09 + 0.01f64)).sqrt();
        assert!((noise(&tally) - expected).abs() < 1e-15, "{}", noise(&tally));
    }

    #[test]
    fn straight_light_scales_the_walks_and_leaves_their_noise() {
        let origin = Origin { engine: "cpu".into(), adapter: String::new(), seed: 0 };
        let mut tally = Tally::new(origin.clone(), BinLayout { exit_cells: 2 }, 1, None);
        tally.coverage = crate::goniometer::Coverage::new(origin, 0..100);
        tally.bins = vec![30, 0, 10, 0, 60, 0, 0];
        let plain = noise(&tally);
        tally.straight = Some(vec![Straight { value: 0.5, stderr: 0.1, with_mean: 0.01 }]);
        // 30 of 40 walks that met a fiber, of half of the light.
        let Estimate { value, stderr } = share(&tally, 0, 100, tally.light(0, 0, 0));
        let inside = (0.75f64 * 0.25 / 39.0).sqrt();
        assert!((value - 0.375).abs() < 1e-15 && (stderr - (0.5 * inside).hypot(0.075)).abs() < 1e-15);
        assert_eq!(direct(&tally, 0), Estimate { value: 0.5, stderr: 0.1 });
        // The error of the rays is no noise of the walks, which more of them could lessen.
        assert!(noise(&tally) < plain);
        let expected = (2.0 * 0.75 * 0.25 / 39.0 / (0.75f64.powi(2) + 0.25f64.powi(2))).sqrt();
        assert!((noise(&tally) - expected).abs() < 1e-12, "{}", noise(&tally));
        // Where no walk met a fiber, the walks say all.
        tally.bins = vec![0, 0, 0, 0, 100, 0, 0];
        assert_eq!(direct(&tally, 0).value, 1.0);
        assert_eq!(share(&tally, 0, 100, tally.light(0, 0, 0)).value, 0.0);
    }

    #[test]
    fn a_share_has_the_binomial_error() {
        let half = probability(500, 1000);
        assert_eq!(half.value, 0.5);
        assert!((half.stderr - (0.25f64 / 999.0).sqrt()).abs() < 1e-15);
    }
}
