//! What a finished walk adds to the tally, for engines on the host.

use super::plan::{ROULETTE_BELOW, WalkPlan, WalkRecord};
use super::rng::{Purpose, draw};
use super::uniform;
use crate::goniometer::{Counts, Goniometer, Outcome, Tally, WEIGHT};
use crate::scene::MAX_KINDS;
use crate::tables::Kind;

/// A finished walk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Walked {
    /// How it went.
    pub record: WalkRecord,
    /// Path length inside each kind of fiber, in mm.
    pub lengths: [f64; MAX_KINDS],
    /// Logarithm of the factor by which roulette has raised its weight.
    pub log_gain: f64,
    /// Hits whose light left through a base.
    pub base_exits: u32,
}

impl Walked {
    /// Share of its light that a walk still carries in a channel, exp(−Σ σ ℓ) times the gain, at most 1.
    pub fn weight(&self, kinds: &[Kind], channel: usize) -> f64 {
        let depth = |(kind, length): (&Kind, &f64)| kind.absorption[channel] * length;
        let depth: f64 = kinds.iter().zip(&self.lengths).map(depth).sum();
        (self.log_gain - depth).exp().min(1.0)
    }

    /// Optical depth of its way inside fibers, in the channel that absorbs least.
    fn clearest_depth(&self, kinds: &[Kind]) -> f64 {
        kinds.iter().zip(&self.lengths).map(|(kind, length)| kind.clearest() * length).sum()
    }

    /// Share of its light that it may have kept in its brightest channel.
    pub fn kept(&self, kinds: &[Kind]) -> f64 {
        (self.log_gain - self.clearest_depth(kinds)).exp()
    }

    /// Play Russian roulette with a number uniform in (0, 1), if it may have kept little: it goes on with the probability of
    /// what it kept, and then carries all of it. Whether it goes on.
    pub fn survives(&mut self, kinds: &[Kind], number: f64) -> bool {
        let kept = self.kept(kinds);
        if kept >= ROULETTE_BELOW {
            return true;
        }
        self.log_gain = self.clearest_depth(kinds);
        number < kept
    }
}

/// What one walk adds to the tally.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    record: WalkRecord,
    base_exits: u32,
    /// Fixed-point weights by channel; empty when fibers do not absorb or the walk met none.
    weights: Vec<u16>,
}

impl Score {
    /// Round the weights of walk number `i` of a start, q = ⌊w·2ˢ + u⌋, without bias.
    pub fn new(walked: &Walked, kinds: &[Kind], goniometer: &Goniometer, seed: u64, start: usize, i: u64) -> Score {
        let layout = goniometer.layout();
        let bin = walked.record.bin as usize;
        let ended = bin == layout.outcome(Outcome::Ended);
        let touched = bin < 2 * layout.exit_cells || ended;
        let channels = Kind::channels(kinds).filter(|_| touched).unwrap_or_default();
        let id = WalkPlan::walk_id(goniometer.starts(), i, start);
        let u = if channels > 0 { uniform(draw(seed, id, 0, Purpose::Exit)[0]) } else { 0.0 };
        let weight = |channel| if ended { 0 } else { (walked.weight(kinds, channel) * WEIGHT as f64 + u) as u16 };
        Score { record: walked.record, base_exits: walked.base_exits, weights: (0..channels).map(weight).collect() }
    }

    /// The bin in which the walk is counted.
    pub fn bin(&self) -> usize {
        self.record.bin as usize
    }

    /// Count the walk at its start.
    pub fn add_to(&self, tally: &mut Tally, start: usize) {
        let layout = tally.layout;
        let bin = self.record.bin as usize;
        tally.bins[start * layout.stride() + bin] += 1;
        tally.counts += Counts {
            launched: 1,
            finished: 1,
            tentative_events: u64::from(self.record.events),
            collisions: u64::from(self.record.hits),
            base_exits: u64::from(self.base_exits),
        };
        let Some(weights) = &mut tally.weights else { return };
        let bins = 2 * layout.exit_cells + 1;
        for (channel, &q) in self.weights.iter().enumerate() {
            let q = u64::from(q);
            let mut add =
                |bin: usize, q: u64| weights.moments[(start * bins + bin) * weights.channels + channel].add(q);
            if bin < 2 * layout.exit_cells {
                add(bin, q);
            }
            add(2 * layout.exit_cells, WEIGHT - q);
        }
    }
}
