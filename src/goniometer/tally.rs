//! The integer tally of a run and its accounts.

use super::coverage::{Coverage, Origin};
use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};
use std::iter::Sum;
use std::ops::AddAssign;

/// Fixed-point units of one walk's light when fibers absorb, 2ˢ with s = 12.
pub const WEIGHT: u64 = 1 << 12;

/// Order of the bins of one start: reflection cells, transmission cells, then the outcomes of [`Outcome`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BinLayout {
    /// Exit cells of one side.
    pub exit_cells: usize,
}

/// How a walk can end without an exit cell. The discriminant is its place behind the exit cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It touched no fiber.
    Direct = 0,
    /// It was given up.
    Lost = 1,
    /// Russian roulette ended it.
    Ended = 2,
}

/// Number of outcomes.
pub const OUTCOMES: usize = 3;

impl BinLayout {
    /// Bin of light that left on the lit side.
    pub fn reflection(&self, cell: usize) -> usize {
        cell
    }

    /// Bin of light that touched a fiber and left on the other side.
    pub fn transmission(&self, cell: usize) -> usize {
        self.exit_cells + cell
    }

    /// Bin of walks without an exit cell.
    pub fn outcome(&self, outcome: Outcome) -> usize {
        2 * self.exit_cells + outcome as usize
    }

    /// Bins of one start.
    pub fn stride(&self) -> usize {
        2 * self.exit_cells + OUTCOMES
    }
}

/// Sums over all finished walks, made by the engine independently of the bins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Walks started.
    pub launched: u64,
    /// Walks that came to an end.
    pub finished: u64,
    /// Tentative events, null collisions and the last step out of the sheet included.
    pub tentative_events: u64,
    /// Real hits.
    pub collisions: u64,
    /// Hits whose light left through a base of the fiber.
    pub base_exits: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.launched += other.launched;
        self.finished += other.finished;
        self.tentative_events += other.tentative_events;
        self.collisions += other.collisions;
        self.base_exits += other.base_exits;
    }
}

/// Sums of fixed-point weights in one bin and channel: Σq and Σq².
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Moments {
    /// Σq.
    pub sum: u64,
    /// Σq².
    pub square: u64,
}

impl Moments {
    /// Add one weight.
    pub fn add(&mut self, q: u64) {
        self.sum += q;
        self.square += q * q;
    }
}

/// Of walks that are in one of both; each leaves in one cell, so its square counts once.
impl AddAssign for Moments {
    fn add_assign(&mut self, other: Moments) {
        self.sum += other.sum;
        self.square += other.square;
    }
}

impl Sum for Moments {
    fn sum<I: Iterator<Item = Moments>>(all: I) -> Moments {
        let mut whole = Moments::default();
        all.for_each(|one| whole += one);
        whole
    }
}

/// Light that fibers took from: weights by start, bin and channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Weights {
    /// Colour channels.
    pub channels: usize,
    /// Moments by start, exit cell of both hemispheres and then the absorbed light, channel.
    pub moments: Vec<Moments>,
}

/// Light of one start that touches no fiber, as straight rays through the cloth say it: a share and its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Straight {
    /// The share.
    pub value: f64,
    /// Its standard deviation.
    pub stderr: f64,
    /// Covariance with the mean over all starts of its lit side, by [`Goniometer::weight`](super::Goniometer::weight): rays of all
    /// starts go through the same fibers.
    pub with_mean: f64,
}

/// Walks by start (side and incident cell) and exit.
#[derive(Clone, Debug, PartialEq)]
pub struct Tally {
    /// The walks that it holds; those of an engine at work are filled in at the end.
    pub coverage: Coverage,
    /// How the bins of one start are laid out.
    pub layout: BinLayout,
    /// Numbers of walks, `layout.stride()` for each start.
    pub bins: Vec<u64>,
    /// Their light by channel, when fibers absorb; otherwise every walk keeps all of it.
    pub weights: Option<Weights>,
    /// Sums over the run.
    pub counts: Counts,
    /// The light by start that touches no fiber, when it is known better than from the walks: then these say only where the
    /// rest goes.
    pub straight: Option<Vec<Straight>>,
}

impl Tally {
    /// An empty tally; `channels` is none for lossless fibers.
    pub fn new(origin: Origin, layout: BinLayout, starts: usize, channels: Option<usize>) -> Tally {
        let weights = channels.map(|channels| {
            let moments = vec![Moments::default(); starts * (2 * layout.exit_cells + 1) * channels];
            Weights { channels, moments }
        });
        let bins = vec![0; layout.stride() * starts];
        Tally {
            coverage: Coverage::new(origin, 0..0),
            layout,
            bins,
            weights,
            counts: Counts::default(),
            straight: None,
        }
    }

    /// Who counted; the first of several by seed.
    pub fn origin(&self) -> &Origin {
        &self.coverage.runs()[0].origin
    }

    /// Walks of each start.
    pub fn walks_per_incident(&self) -> u64 {
        self.coverage.walks_per_incident()
    }

    /// Number of starts: lit sides times incident cells.
    pub fn starts(&self) -> usize {
        self.bins.len() / self.layout.stride()
    }

    /// Channels that are told apart.
    pub fn channels(&self) -> usize {
        self.weights.as_ref().map_or(1, |weights| weights.channels)
    }

    /// Units of one walk's light.
    pub fn unit(&self) -> u64 {
        if self.weights.is_some() { WEIGHT } else { 1 }
    }

    /// Numbers of walks of one start, all bins.
    pub fn of_start(&self, start: usize) -> &[u64] {
        let stride = self.layout.stride();
        &self.bins[start * stride..(start + 1) * stride]
    }

    /// Walks by exit cell of the lit side.
    pub fn reflection(&self, start: usize) -> &[u64] {
        &self.of_start(start)[..self.layout.exit_cells]
    }

    /// Walks by exit cell of the far side, without those that touched no fiber.
    pub fn transmission(&self, start: usize) -> &[u64] {
        &self.of_start(start)[self.layout.exit_cells..2 * self.layout.exit_cells]
    }

    /// Walks that ended without an exit cell.
    pub fn outcome(&self, start: usize, outcome: Outcome) -> u64 {
        self.of_start(start)[self.layout.outcome(outcome)]
    }

    /// Walks that touched no fiber.
    pub fn direct(&self, start: usize) -> u64 {
        self.outcome(start, Outcome::Direct)
    }

    /// Walks that were given up.
    pub fn lost(&self, start: usize) -> u64 {
        self.outcome(start, Outcome::Lost)
    }

    /// Light of an exit bin (reflection cells, then transmission cells) in one channel, in units of [`Tally::unit`]; the
    /// same in all channels of a lossless cloth.
    pub fn light(&self, start: usize, bin: usize, channel: usize) -> Moments {
        match &self.weights {
            Some(_) => self.moments(start, bin, channel),
            // A count is its own second moment.
            None => {
                let count = self.of_start(start)[bin];
                Moments { sum: count, square: count }
            }
        }
    }

    /// Light that fibers kept of one start, walk by walk.
    pub fn absorbed(&self, start: usize, channel: usize) -> Moments {
        if self.weights.is_some() {
            self.moments(start, 2 * self.layout.exit_cells, channel)
        } else {
            Moments::default()
        }
    }

    fn moments(&self, start: usize, bin: usize, channel: usize) -> Moments {
        self.weights.as_ref().map_or(Moments::default(), |weights| {
            let bins = 2 * self.layout.exit_cells + 1;
            weights.moments[(start * bins + bin) * weights.channels + channel]
        })
    }

    /// Add the counts of other walks through the same cloth and instrument, exactly.
    ///
    /// # Errors
    /// [`Error::Input`] when the tallies differ in starts, exit cells, channels or straight light, or hold the same walk of
    /// the same seed.
    pub fn merge(&mut self, other: &Tally) -> Result<()> {
        let shape = |tally: &Tally| {
            (tally.layout.exit_cells, tally.starts(), tally.weights.as_ref().map(|weights| weights.channels))
        };
        if shape(self) != shape(other) {
            return Err(Error::Input("the tallies differ in incident cells, exit cells or channels".into()));
        }
        if self.straight != other.straight {
            return Err(Error::Input("the tallies differ in the light that touches no fiber".into()));
        }
        self.coverage.join(&other.coverage)?;
        self.add_counts(other);
        Ok(())
    }

    /// Add what another tally of the same shape has counted, whatever walks it covers.
    pub fn add_counts(&mut self, other: &Tally) {
        self.bins.iter_mut().zip(&other.bins).for_each(|(sum, count)| *sum += count);
        if let (Some(weights), Some(others)) = (&mut self.weights, &other.weights) {
            for (sum, part) in weights.moments.iter_mut().zip(&others.moments) {
                sum.sum += part.sum;
                sum.square += part.square;
            }
        }
        self.counts += other.counts;
    }

    /// Hold the counts against the plan.
    ///
    /// 1. By start, in walks: planned = reflected + transmitted + direct + ended by roulette + lost.
    /// 2. By start and channel, in units of light: what entered fibers = out + absorbed, both summed walk by walk.
    /// 3. Over the run: walks launched and walks finished, counted apart from the bins.
    ///
    /// # Errors
    /// [`Error::Account`] names the first sum that does not close.
    pub fn check(&self, planned_per_incident: u64) -> Result<()> {
        let fail = |message: String| Err(Error::Account { engine: self.origin().engine.clone(), message });
        for start in 0..self.starts() {
            let counted: u64 = self.of_start(start).iter().sum();
            if counted != planned_per_incident {
                return fail(format!(
                    "incident cell {start} was to get {planned_per_incident} walks and counts {counted}"
                ));
            }
            for channel in 0..self.weights.as_ref().map_or(0, |weights| weights.channels) {
                let entered = (counted - self.direct(start) - self.lost(start)) * self.unit();
                let out: u64 = (0..2 * self.layout.exit_cells).map(|bin| self.light(start, bin, channel).sum).sum();
                let absorbed = self.absorbed(start, channel).sum;
                if entered != out + absorbed {
                    return fail(format!(
                        "in incident cell {start} and channel {channel} fibers got {entered} units of light, \
                         and {out} went out and {absorbed} were absorbed"
                    ));
                }
            }
        }
        let binned: u64 = self.bins.iter().sum();
        let Counts { launched, finished, .. } = self.counts;
        if launched != binned || finished != binned {
            return fail(format!("{launched} walks started and {finished} ended, but {binned} were binned"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn closed() -> Tally {
        let origin = Origin { engine: "cpu".into(), adapter: String::new(), seed: 0 };
        let mut tally = Tally::new(origin, BinLayout { exit_cells: 4 }, 3, Some(2));
        for start in 0..3 {
            tally.bins[start * 11 + start] = 7;
            tally.bins[start * 11 + 8] = 3;
            let weights = tally.weights.as_mut().expect("it has weights");
            for channel in 0..2 {
                for _ in 0..7 {
                    weights.moments[(start * 9 + start) * 2 + channel].add(1000);
                    weights.moments[(start * 9 + 8) * 2 + channel].add(WEIGHT - 1000);
                }
            }
        }
        tally.counts = Counts { launched: 30, finished: 30, ..Counts::default() };
        tally
    }

    #[test]
    fn a_closed_account_passes() {
        assert!(closed().check(10).is_ok());
    }

    #[test]
    fn each_broken_sum_is_named() {
        let broken = |change: fn(&mut Tally), message: &str| {
            let mut tally = closed();
            change(&mut tally);
            let error = tally.check(10).expect_err(message).to_string();
            assert!(error.contains(message), "{error}");
        };
        broken(|tally| tally.bins.swap(0, 11), "incident cell 0");
        broken(|tally| tally.counts.launched += 1, "31 walks started");
        broken(|tally| tally.counts.finished -= 1, "29 ended");
        broken(|tally| tally.weights.as_mut().expect("weights").moments[19].sum += 1, "incident cell 1 and channel 1");
    }
}
