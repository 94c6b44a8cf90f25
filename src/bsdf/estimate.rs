//! Probabilities and BSDF values with their standard errors.

use crate::goniometer::{Goniometer, Tally};
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

/// f of one incident cell by exit cell, in sr⁻¹: P(exit cell | incident cell) over its projected solid angle.
pub fn values(tally: &Tally, goniometer: &Goniometer, component: Component, cell: usize) -> Vec<Estimate> {
    let counts = match component {
        Component::Reflection => tally.reflection(cell),
        Component::Transmission => tally.transmission(cell),
    };
    let solid_angle = goniometer.exit.projected_solid_angle();
    let value = |&count: &u64| {
        let Estimate { value, stderr } = probability(count, tally.walks_per_incident);
        Estimate { value: value / solid_angle, stderr: stderr / solid_angle }
    };
    counts.iter().map(value).collect()
}

/// Relative noise of the scattered light, √(Σσ²/ΣP²) over all incident and exit cells; also of an unfinished tally.
///
/// It is infinite while nothing has been scattered.
pub fn noise(tally: &Tally) -> f64 {
    let (mut variance, mut square) = (0.0, 0.0);
    for cell in 0..tally.incident_cells() {
        let walks: u64 = tally.of_incident(cell).iter().sum();
        if walks == 0 {
            continue;
        }
        for &count in tally.reflection(cell).iter().chain(tally.transmission(cell)) {
            let Estimate { value, stderr } = probability(count, walks);
            square += value * value;
            variance += if count == 0 { 0.0 } else { stderr * stderr };
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
        let origin = Origin { engine: "cpu", adapter: String::new(), seed: 0 };
        let mut tally = Tally::new(origin, BinLayout { exit_cells: 2 }, 1);
        assert_eq!(noise(&tally), f64::INFINITY);
        // Shares 0.3 and 0.1 of 100 walks; the rest is direct.
        tally.bins = vec![30, 0, 10, 0, 60, 0];
        let expected = ((0.3 * 0.7 + 0.1 * 0.9) / 99.0 / (0.09 + 0.01f64)).sqrt();
        assert!((noise(&tally) - expected).abs() < 1e-15, "{}", noise(&tally));
    }

    #[test]
    fn a_share_has_the_binomial_error() {
        let half = probability(500, 1000);
        assert_eq!(half.value, 0.5);
        assert!((half.stderr - (0.25f64 / 999.0).sqrt()).abs() < 1e-15);
    }
}
