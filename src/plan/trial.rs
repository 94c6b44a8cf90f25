//! A configuration, ready to be walked through.

use super::configuration::{Configuration, Extent};
use super::stretches::{KeptBanks, OF_BLOCK, stretches, walk};
use crate::cloth::{DrawnFor, Realizer};
use crate::error::Result;
use crate::explicit::{Explicit, StraightRays};
use crate::goniometer::{Goniometer, Tally};
use crate::measure::{Prepared, prepare_from};
use crate::scene::{Medium, Scene};
use crate::walk::{Engine, FirstHitBanks, Implicit, Walker};
use rayon::prelude::*;
use std::time::Instant;

/// Blocks of walks that a trial is judged by.
pub const BLOCKS: u64 = 8;

/// Walks of one block.
#[derive(Clone, Debug)]
pub struct Block {
    /// Their counts, whose account has been checked. Of a medium, `counts.tentative_events` are tentative events, of the
    /// fibers themselves the pieces that rays were tested against.
    pub tally: Tally,
    /// How long they took; of blocks that were walked side by side, an equal share.
    pub seconds: f64,
}

/// What light goes through.
enum Body {
    Medium(Box<Prepared>, Option<KeptBanks>),
    Fibers(Box<Explicit>),
}

/// A configuration, ready to be walked through.
pub struct Trial {
    configuration: Configuration,
    goniometer: Goniometer,
    body: Body,
    seconds: f64,
    drawing: f64,
}

impl Trial {
    /// Make the tables of a medium, or draw a first realization of the fibers.
    ///
    /// Realizations of the fibers themselves are others than those that media are counted from, so that both are independent.
    ///
    /// # Errors
    /// Those of [`prepare_from`] and [`Explicit::drawn`]; among them that a configuration is refused for this cloth.
    pub fn prepare(scene: &Scene, extent: &Extent, configuration: Configuration) -> Result<Trial> {
        let scene = configuration.apply(scene, extent);
        let goniometer = Goniometer::new(&scene.measure);
        let started = Instant::now();
        let mut drawing = 0.0;
        let body = match configuration.model.medium {
            Medium::Implicit => {
                let prepared = prepare_from(&scene, extent.realizer(), |_| {})?;
                let banks = prepared.first_hits.clone().map(KeptBanks::new);
                Body::Medium(Box::new(prepared), banks)
            }
            Medium::Explicit => {
                let laid = extent.realizer().map(|realizer| realizer.for_user(DrawnFor::Trial));
                let new = || Realizer::new(&scene, scene.model.packing, DrawnFor::Trial);
                let realizer = laid.map_or_else(new, Ok)?;
                let through = configuration.each.map(|each| each as usize * goniometer.starts());
                let laid_out = started.elapsed().as_secs_f64();
                let explicit = Explicit::drawn(&scene, through, move |number| realizer.draw(number))?;
                drawing = started.elapsed().as_secs_f64() - laid_out;
                Body::Fibers(Box::new(if configuration.anew { explicit.anew() } else { explicit }))
            }
        };
        Ok(Trial { configuration, goniometer, body, seconds: started.elapsed().as_secs_f64(), drawing })
    }

    /// What is tried.
    pub fn configuration(&self) -> &Configuration {
        &self.configuration
    }

    /// The instrument.
    pub fn goniometer(&self) -> &Goniometer {
        &self.goniometer
    }

    /// The medium; none where light goes through the fibers themselves.
    pub fn medium(&self) -> Option<&Prepared> {
        match &self.body {
            Body::Medium(prepared, _) => Some(prepared),
            Body::Fibers(_) => None,
        }
    }

    /// Seconds that it took to prepare; of the fibers themselves they are those of one realization.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Seconds that a realization of the fibers takes one thread to draw; none of a medium.
    pub fn drawing(&self) -> f64 {
        self.drawing
    }

    /// What more rays to first hits cost once those that were ready with the medium have served: walks of each start that are
    /// served by these, walks of each start that a further bank of rays serves, and the seconds that it takes. None where
    /// there is no such bank, or none was made yet.
    pub fn rays(&self) -> Option<(u64, u64, f64)> {
        let Body::Medium(_, Some(banks)) = &self.body else { return None };
        Some((banks.ready().saturating_mul(banks.span()), banks.span(), banks.seconds()?))
    }

    /// Memory in bytes of what light goes through: the tables of a medium and the rays that find first hits, or one realization of the fibers, of which each
    /// thread has one.
    pub fn bytes(&self) -> usize {
        match &self.body {
            Body::Medium(prepared, _) => {
                let rays = prepared.first_hits.as_ref().map_or(0, |_| StraightRays::bytes(self.goniometer.starts()));
                prepared.tables.bytes() + rays
            }
            Body::Fibers(explicit) => explicit.bytes().iter().sum(),
        }
    }

    /// Walks of each start through one realization; 1 of a medium, where every number of walks is as good.
    pub fn step(&self) -> u64 {
        match &self.body {
            Body::Medium(..) => 1,
            Body::Fibers(explicit) => explicit.walks_of_start(self.goniometer.starts()),
        }
    }

    /// Make `walks` walks of each start in block `number`, after the `made` that it has; of a medium on `engine`, of the fibers
    /// themselves on the processor. Blocks have walks and realizations of their own, so they are independent, and what they
    /// count is a function of the arguments.
    ///
    /// # Errors
    /// Those of [`Walker::run`].
    pub fn block(&self, engine: &dyn Engine, seed: u64, number: u64, made: u64, walks: u64) -> Result<Block> {
        match &self.body {
            Body::Medium(prepared, banks) => {
                let span = banks.as_ref().map_or(u64::MAX, KeptBanks::span);
                let stretches = stretches(span, number, made, walks);
                // What a run makes once for many walks is no time of these few.
                banks.iter().try_for_each(|banks| banks.make(&stretches))?;
                let first_hits = banks.as_ref().map(|banks| banks as &dyn FirstHitBanks);
                self.through(&Implicit { first_hits, ..prepared.with(engine) }, seed, &stretches)
            }
            Body::Fibers(explicit) => self.through(&**explicit, seed, &self.realizations(number, made, walks)),
        }
    }

    /// Make `walks` walks of each start in each of the [`BLOCKS`] blocks, after the `made` that they have.
    ///
    /// # Errors
    /// Those of [`Trial::block`].
    pub fn blocks(&self, engine: &dyn Engine, seed: u64, made: u64, walks: u64) -> Result<Vec<Block>> {
        match &self.body {
            Body::Medium(..) => (0..BLOCKS).map(|number| self.block(engine, seed, number, made, walks)).collect(),
            // A block may have a single realization, which keeps one thread busy.
            Body::Fibers(explicit) => {
                let started = Instant::now();
                let one = |number| self.through(&**explicit, seed, &self.realizations(number, made, walks));
                let mut blocks: Vec<Block> = (0..BLOCKS).into_par_iter().map(one).collect::<Result<_>>()?;
                let share = started.elapsed().as_secs_f64() / BLOCKS as f64;
                blocks.iter_mut().for_each(|block| block.seconds = share);
                Ok(blocks)
            }
        }
    }

    /// Walks of a block through the fibers themselves: realizations begin where blocks do.
    fn realizations(&self, number: u64, made: u64, walks: u64) -> [(u64, u64); 1] {
        let step = self.step();
        [(number * (OF_BLOCK / step * step) + made, walks)]
    }

    fn through(&self, walker: &dyn Walker, seed: u64, stretches: &[(u64, u64)]) -> Result<Block> {
        let started = Instant::now();
        let tally = walk(walker, &self.goniometer, seed, stretches)?;
        let seconds = started.elapsed().as_secs_f64();
        Ok(Block { tally, seconds })
    }
}
