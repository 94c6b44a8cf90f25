//! How much walks through one realization resemble each other.

use crate::goniometer::{BinLayout, Outcome, Tally};

/// Walks of one realization, by what became of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Fates {
    walks: f64,
    reflected: f64,
    transmitted: f64,
    direct: f64,
}

impl Fates {
    /// Take in further walks.
    pub fn add(&mut self, other: &Fates) {
        self.walks += other.walks;
        self.reflected += other.reflected;
        self.transmitted += other.transmitted;
        self.direct += other.direct;
    }

    /// Of walks that ended in these bins.
    pub fn of(layout: BinLayout, bins: impl Iterator<Item = usize>) -> Fates {
        let mut fates = Fates::default();
        for bin in bins {
            fates.walks += 1.0;
            if bin < layout.exit_cells {
                fates.reflected += 1.0;
            } else if bin < 2 * layout.exit_cells {
                fates.transmitted += 1.0;
            } else if bin == layout.outcome(Outcome::Direct) {
                fates.direct += 1.0;
            }
        }
        fates
    }
}

/// Variance of the mean over all starts of a share of the walks, over what it would be if all walks were independent. Walks
/// through one realization are not: they see the same fibers. Stated standard errors of single cells take walks as
/// independent, those of a mean over all incident cells are too small by the root of these factors. Each factor has a
/// relative error of √(2/(realizations − 1)).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Clustering {
    /// Realizations.
    pub realizations: usize,
    /// Of the walks reflected.
    pub reflectance: f64,
    /// Of the walks that touched a fiber and went through.
    pub transmittance: f64,
    /// Of those that touched none.
    pub direct: f64,
}

impl Clustering {
    /// From the walks of each realization; none of fewer than two of equal size.
    pub(super) fn new(fates: &[Fates], tally: &Tally) -> Option<Clustering> {
        let whole = fates.iter().map(|fates| fates.walks).fold(0.0, f64::max);
        let equal: Vec<&Fates> = fates.iter().filter(|fates| fates.walks == whole).collect();
        let n = equal.len() as f64;
        if equal.len() < 2 {
            return None;
        }
        let factor = |of: &dyn Fn(&Fates) -> f64, share: &dyn Fn(usize) -> f64| {
            let mean = equal.iter().map(|fates| of(fates)).sum::<f64>() / n;
            let variance = equal.iter().map(|fates| (of(fates) - mean).powi(2)).sum::<f64>() / (n - 1.0);
            // Starts have walks alike.
            let starts = tally.starts();
            let alone: f64 = (0..starts).map(|start| share(start) * (1.0 - share(start))).sum();
            let alone = alone * whole / starts as f64;
            if alone > 0.0 { variance / alone } else { 1.0 }
        };
        let all = |start: usize| tally.of_start(start).iter().sum::<u64>().max(1) as f64;
        let sum = |counts: &[u64]| counts.iter().sum::<u64>() as f64;
        Some(Clustering {
            realizations: fates.len(),
            reflectance: factor(&|fates| fates.reflected, &|start| sum(tally.reflection(start)) / all(start)),
            transmittance: factor(&|fates| fates.transmitted, &|start| sum(tally.transmission(start)) / all(start)),
            direct: factor(&|fates| fates.direct, &|start| tally.direct(start) as f64 / all(start)),
        })
    }
}
