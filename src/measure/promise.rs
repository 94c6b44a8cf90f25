//! Whether a run kept the tolerance that it was planned for.

use super::stop::percent;
use crate::bsdf::{Kept, Verdict};
use serde::Serialize;

/// Rounding that is no breach.
const SLACK: f64 = 1e-9;

/// A tolerance, what was measured of it, and whether it was kept.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Promise {
    /// What √(noise² + model error²) was to be at most, as a share of the scattered light.
    pub tolerance: f64,
    /// What was measured.
    pub measured: Measured,
    /// Whether it was kept; none where neither a pilot nor the check at the end could tell.
    pub kept: Option<bool>,
}

/// What was measured of a promise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Noise of the scattered light; 0 where there is none.
    pub noise: f64,
    /// Ends of the interval of the model's error at the level of 95 %, by pilots on this cloth: 0 and 0 of the fibers themselves;
    /// none where no pilot was made.
    pub pilots: Option<[f64; 2]>,
    /// The same by the check against the fibers at the end, by parts of the hemispheres; none where none was made.
    pub check: Option<[f64; 2]>,
}

impl Promise {
    /// Of a run with this noise: through the fibers themselves (`pilots` are 0), or through a medium that pilots gave this interval of
    /// its error and that the check at the end gave this verdict.
    pub fn of(tolerance: f64, noise: f64, pilots: Option<[f64; 2]>, check: Option<&Verdict>) -> Promise {
        if noise.is_infinite() {
            // Nothing was scattered of which anything could be off.
            let measured = Measured { noise: 0.0, pilots, check: None };
            return Promise { tolerance, measured, kept: Some(true) };
        }
        let quiet = noise <= tolerance * (1.0 + SLACK);
        let checked = check.map(|verdict| verdict.kept(tolerance));
        let told = match (pilots, checked) {
            (_, Some(Kept::No)) => Some(false),
            (Some([_, high]), _) if high <= tolerance => Some(true),
            (_, Some(Kept::Yes)) => Some(true),
            (Some([low, _]), _) if low > tolerance => Some(false),
            _ => None,
        };
        let kept = if quiet { told } else { Some(false) };
        Promise { tolerance, measured: Measured { noise, pilots, check: check.map(Verdict::interval) }, kept }
    }

    /// What is to be said at the end; nothing where it was kept.
    pub fn line(&self) -> Option<String> {
        let of = |what: &str, ends: Option<[f64; 2]>| {
            ends.map(|[low, high]| format!("{what} {:.1} to {:.1} %", 100.0 * low, 100.0 * high))
        };
        let Measured { noise, pilots, check } = self.measured;
        let parts: Vec<String> =
            [of("by pilots", pilots), of("by the check at the end", check)].into_iter().flatten().collect();
        let model = if parts.is_empty() { "not measured".into() } else { parts.join(", ") };
        let found = format!("noise {:.2} %, error of the model {model}", 100.0 * noise);
        let word = match self.kept {
            Some(true) => return None,
            Some(false) => "was not kept",
            None => "may not have been kept",
        };
        Some(format!(
            "the tolerance of {} {word}: {found}; --model explicit has no error but noise",
            percent(self.tolerance)
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::Distance;

    fn check(square: f64, square_error: f64) -> Verdict {
        Verdict { light: Distance { square, square_error }, gaps: Vec::new() }
    }

    #[test]
    fn the_check_at_the_end_overrules_a_pilot_and_noise_overrules_both() {
        let (good, bad, blunt) = (check(1e-4, 1e-4), check(0.01, 1e-3), check(0.0, 0.1));
        let kept = |noise, pilots, check| Promise::of(0.05, noise, pilots, check).kept;
        assert_eq!(kept(0.03, Some([0.0, 0.04]), Some(&blunt)), Some(true));
        assert_eq!(kept(0.03, Some([0.0, 0.04]), Some(&bad)), Some(false));
        assert_eq!(kept(0.03, None, Some(&good)), Some(true));
        assert_eq!(kept(0.03, Some([0.06, 0.1]), Some(&blunt)), Some(false));
        assert_eq!((kept(0.03, Some([0.02, 0.06]), Some(&blunt)), kept(0.03, None, None)), (None, None));
        // Through the fibers themselves only noise counts.
        assert_eq!((kept(0.05, Some([0.0; 2]), None), kept(0.051, Some([0.0; 2]), None)), (Some(true), Some(false)));
        assert_eq!(kept(f64::INFINITY, None, None), Some(true));
        let line = Promise::of(0.05, 0.03, None, Some(&bad)).line().unwrap_or_default();
        assert!(line.starts_with("the tolerance of 5 % was not kept: noise 3.00 %"), "{line}");
        assert!(Promise::of(0.05, 0.03, None, Some(&good)).line().is_none());
    }
}
