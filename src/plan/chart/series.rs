//! What is known of one configuration: its blocks of walks, and what they took.

use super::super::configuration::Configuration;
use super::super::trial::{BLOCKS, Block, Trial};
use super::engines::{Class, Engines};
use crate::error::Result;
use crate::goniometer::Tally;
use crate::scene::Medium;
use serde::{Deserialize, Serialize};

/// Walks of each start in each block that a medium is probed with, and of any visit to one at least and at most.
const PROBE: f64 = 32.0;
const LEAST_BLOCK: u64 = 16;
const MOST_BLOCK: u64 = 1 << 24;
/// A visit that took less than one part in so many of the seconds wanted is not timed, and the next has more walks, at most so
/// many times.
const ENOUGH: f64 = 2.0;
const STEP: f64 = 8.0;

/// Walks that were made in one go, in all blocks alike.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Visit {
    /// On which engine.
    pub class: Class,
    /// Walks, all starts and blocks together.
    pub walks: u64,
    /// Realizations that they went through; none of a medium.
    pub realizations: u64,
    /// Tentative events, or pieces of fibers tested.
    pub events: u64,
    /// Seconds that they took.
    pub seconds: f64,
}

/// What is known of one configuration.
#[derive(Clone, Debug)]
pub struct Series {
    /// The configuration.
    pub configuration: Configuration,
    /// Its blocks, the walks of all engine classes together; none before the first visit.
    pub blocks: Vec<Tally>,
    /// Walks of each start in each block.
    pub made: u64,
    /// The visits, in their order.
    pub visits: Vec<Visit>,
    /// Seconds of each preparation.
    pub preparing: Vec<f64>,
    /// Seconds that one thread needs for a realization; 0 of a medium.
    pub drawing: f64,
    /// What more rays to first hits cost, as [`Trial::rays`] has it.
    pub rays: Option<(u64, u64, f64)>,
    /// Memory in bytes of what light goes through.
    pub bytes: usize,
    /// Why the configuration cannot be had for this cloth.
    pub refused: Option<String>,
}

impl Series {
    /// Before the first visit.
    pub fn new(configuration: Configuration) -> Series {
        Series {
            configuration,
            blocks: Vec::new(),
            made: 0,
            visits: Vec::new(),
            preparing: Vec::new(),
            drawing: 0.0,
            rays: None,
            bytes: 0,
            refused: None,
        }
    }

    /// Whether its light goes through the fibers themselves.
    pub fn explicit(&self) -> bool {
        self.configuration.model.medium == Medium::Explicit
    }

    /// Note what a trial took to prepare and holds.
    pub fn note(&mut self, trial: &Trial) {
        self.preparing.push(trial.seconds());
        self.drawing = if self.drawing > 0.0 { self.drawing.min(trial.drawing()) } else { trial.drawing() };
        self.bytes = trial.bytes();
    }

    /// Median seconds of a preparation; none before the first.
    pub fn prepare_seconds(&self) -> Option<f64> {
        median(&self.preparing)
    }

    /// Seconds of a walk on an engine class, by its visits.
    pub fn rates(&self, class: Class) -> Vec<f64> {
        let of_class = self.visits.iter().filter(|visit| visit.class == class);
        of_class.map(|visit| visit.seconds / visit.walks as f64).collect()
    }

    /// Events of a walk, all visits together.
    pub fn events_per_walk(&self) -> f64 {
        let sum = |of: fn(&Visit) -> u64| self.visits.iter().map(of).sum::<u64>() as f64;
        sum(|visit| visit.events) / sum(|visit| visit.walks)
    }

    /// Make walks for about so many seconds on an engine class.
    ///
    /// # Errors
    /// Those of [`Trial::blocks`].
    pub fn visit(&mut self, trial: &Trial, engines: &Engines, class: Class, seed: u64, seconds: f64) -> Result<()> {
        let of_all = (BLOCKS * trial.goniometer().starts() as u64) as f64;
        let seed = self.configuration.seed(seed);
        if let Some(rate) = self.rates(class).last().copied() {
            let visit = self.walk(trial, engines, class, seed, seconds / rate / of_all)?;
            self.visits.push(visit);
            return Ok(());
        }
        // The first walks compile kernels and fill caches, and small numbers of them are slow: time none that are far from the
        // seconds that are wanted.
        let mut visit = self.walk(trial, engines, class, seed, PROBE)?;
        if !self.explicit() {
            let mut walks = PROBE;
            let mut factor = STEP;
            while factor > ENOUGH {
                walks *= factor.min(STEP);
                visit = self.walk(trial, engines, class, seed, walks)?;
                factor = seconds / visit.seconds;
            }
        }
        self.visits.push(visit);
        Ok(())
    }

    /// Make about so many walks of each start in each block.
    fn walk(&mut self, trial: &Trial, engines: &Engines, class: Class, seed: u64, wanted: f64) -> Result<Visit> {
        let step = trial.step();
        let least = if self.explicit() { step } else { LEAST_BLOCK };
        let walks = ((wanted / step as f64).round() as u64 * step).clamp(least, MOST_BLOCK.max(step));
        let blocks = trial.blocks(engines.of(class), seed, self.made, walks)?;
        self.add(&blocks, walks)?;
        self.rays = trial.rays().or(self.rays);
        Ok(Visit {
            class,
            walks: blocks.iter().map(|block| block.tally.counts.launched).sum(),
            realizations: if self.explicit() { BLOCKS * walks.div_ceil(step) } else { 0 },
            events: blocks.iter().map(|block| block.tally.counts.tentative_events).sum(),
            seconds: blocks.iter().map(|block| block.seconds).sum(),
        })
    }

    fn add(&mut self, blocks: &[Block], walks: u64) -> Result<()> {
        if self.blocks.is_empty() {
            self.blocks = blocks.iter().map(|block| block.tally.clone()).collect();
        } else {
            for (sum, block) in self.blocks.iter_mut().zip(blocks) {
                sum.merge(&block.tally)?;
            }
        }
        self.made += walks;
        Ok(())
    }
}

/// The middle of some numbers; none of none.
pub(super) fn median(numbers: &[f64]) -> Option<f64> {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => None,
        n if n % 2 == 1 => Some(sorted[n / 2]),
        n => Some((sorted[n / 2 - 1] + sorted[n / 2]) / 2.0),
    }
}
