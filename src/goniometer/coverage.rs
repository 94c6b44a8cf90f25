//! Which walks a tally holds.

use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Which engine made the counts, from which random numbers.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Origin {
    /// Seed of the random numbers.
    pub seed: u64,
    /// `gpu` or `cpu`.
    pub engine: String,
    /// The adapter, or the arithmetic of the cpu engine.
    pub adapter: String,
}

/// Walks of one origin: the numbers i that every start has made.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Run {
    /// Who made them.
    #[serde(flatten)]
    pub origin: Origin,
    /// Ranges of walk numbers as pairs of first and end, ascending, none touching the next.
    pub walks: Vec<[u64; 2]>,
}

/// All walks of a tally by origin, ascending.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Coverage {
    runs: Vec<Run>,
}

impl Coverage {
    /// Walks `walks` of one origin.
    pub fn new(origin: Origin, walks: Range<u64>) -> Coverage {
        let walks = if walks.is_empty() { Vec::new() } else { vec![[walks.start, walks.end]] };
        Coverage { runs: vec![Run { origin, walks }] }
    }

    /// Whether this is what [`Coverage::join`] makes: at least one run, ascending, ranges merged, none made twice.
    pub fn is_sound(&self) -> bool {
        let merged = |run: &Run| {
            run.walks.iter().all(|[first, end]| first < end) && run.walks.windows(2).all(|w| w[0][1] < w[1][0])
        };
        let own = |run: &Run| Coverage { runs: vec![run.clone()] };
        let apart =
            |(i, run): (usize, &Run)| self.runs[..i].iter().all(|other| own(other).overlap(&own(run)).is_none());
        !self.runs.is_empty()
            && self.runs.iter().all(merged)
            && self.runs.windows(2).all(|pair| pair[0].origin < pair[1].origin)
            && self.runs.iter().enumerate().all(apart)
    }

    /// The runs, ascending by seed.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Walks of each start.
    pub fn walks_per_incident(&self) -> u64 {
        self.runs.iter().flat_map(|run| &run.walks).map(|[first, end]| end - first).sum()
    }

    /// A seed of which both hold walks.
    pub fn common_seed(&self, other: &Coverage) -> Option<u64> {
        let seeds = |coverage: &Coverage| -> Vec<u64> {
            coverage.runs.iter().filter(|run| !run.walks.is_empty()).map(|run| run.origin.seed).collect()
        };
        let others = seeds(other);
        seeds(self).into_iter().find(|seed| others.contains(seed))
    }

    /// Take in the walks of another tally.
    ///
    /// # Errors
    /// [`Error::Input`] when both hold the same walk of the same seed, whichever engine made it.
    pub fn join(&mut self, other: &Coverage) -> Result<()> {
        if let Some((seed, [first, end])) = self.overlap(other) {
            return Err(Error::Input(format!(
                "walks {first} to {} of seed {seed} would count twice: they are in both tallies",
                end - 1
            )));
        }
        for run in &other.runs {
            match self.runs.iter_mut().find(|known| known.origin == run.origin) {
                Some(known) => known.walks = merged(&[&known.walks[..], &run.walks[..]].concat()),
                None => self.runs.push(run.clone()),
            }
        }
        // Drop the runs that made no walk, as long as one is left to say who counts.
        if self.runs.iter().any(|run| !run.walks.is_empty()) {
            self.runs.retain(|run| !run.walks.is_empty());
        }
        self.runs.sort();
        Ok(())
    }

    /// The first walks that both hold.
    fn overlap(&self, other: &Coverage) -> Option<(u64, [u64; 2])> {
        let pairs = self.runs.iter().flat_map(|a| other.runs.iter().map(move |b| (a, b)));
        let same_seed = pairs.filter(|(a, b)| a.origin.seed == b.origin.seed);
        let common = same_seed.flat_map(|(a, b)| {
            let both = a.walks.iter().flat_map(|x| b.walks.iter().map(move |y| [x[0].max(y[0]), x[1].min(y[1])]));
            both.filter(|[first, end]| first < end).map(|range| (a.origin.seed, range))
        });
        common.min()
    }
}

/// Disjoint ranges, ascending, those that touch made one.
fn merged(ranges: &[[u64; 2]]) -> Vec<[u64; 2]> {
    let mut ranges = ranges.to_vec();
    ranges.sort_unstable();
    let mut result: Vec<[u64; 2]> = Vec::new();
    for range in ranges {
        match result.last_mut() {
            Some(last) if last[1] == range[0] => last[1] = range[1],
            _ => result.push(range),
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covered(seed: u64, engine: &str, walks: Range<u64>) -> Coverage {
        Coverage::new(Origin { seed, engine: engine.into(), adapter: String::new() }, walks)
    }

    #[test]
    fn ranges_that_touch_become_one_in_any_order() {
        let mut all = covered(1, "cpu", 20..30);
        all.join(&covered(1, "cpu", 0..10)).expect("they are disjoint");
        assert_eq!(all.runs()[0].walks, [[0, 10], [20, 30]]);
        all.join(&covered(1, "cpu", 10..20)).expect("they are disjoint");
        assert_eq!(all.runs()[0].walks, [[0, 30]]);
        assert_eq!(all.walks_per_incident(), 30);
        assert!(all.is_sound());
    }

    #[test]
    fn no_walk_counts_twice_whoever_made_it() {
        let mut all = covered(1, "cpu", 0..10);
        let error = all.join(&covered(1, "gpu", 9..12)).expect_err("walk 9 is in both").to_string();
        assert!(error.contains("walks 9 to 9 of seed 1"), "{error}");
        assert!(all.join(&covered(2, "gpu", 9..12)).is_ok());
        assert_eq!(all.walks_per_incident(), 13);
        assert_eq!(all.common_seed(&covered(2, "cpu", 50..60)), Some(2));
        assert_eq!(all.common_seed(&covered(3, "cpu", 0..10)), None);
    }

    #[test]
    fn what_join_would_not_make_is_not_sound() {
        let run = |seed, walks: &[[u64; 2]]| Run {
            origin: Origin { seed, engine: "cpu".into(), adapter: String::new() },
            walks: walks.to_vec(),
        };
        assert!(Coverage { runs: vec![run(1, &[[0, 4], [6, 7]]), run(2, &[[0, 4]])] }.is_sound());
        assert!(!Coverage { runs: vec![] }.is_sound());
        assert!(!Coverage { runs: vec![run(1, &[[0, 4], [4, 7]])] }.is_sound());
        assert!(!Coverage { runs: vec![run(1, &[[4, 4]])] }.is_sound());
        assert!(!Coverage { runs: vec![run(2, &[[0, 4]]), run(1, &[[0, 4]])] }.is_sound());
        let mut other = run(1, &[[2, 5]]);
        other.origin.engine = "gpu".into();
        assert!(!Coverage { runs: vec![run(1, &[[0, 4]]), other] }.is_sound());
    }
}
