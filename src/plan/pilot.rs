//! Pilot runs: a few walks through the fibers themselves and through a medium, on the same few realizations.

use super::trial::BLOCKS;
use crate::bsdf::{Distance, block_noise, distance};
use crate::cloth::{Realization, Realizer};
use crate::error::Result;
use crate::explicit::{Explicit, StraightRays};
use crate::goniometer::{Goniometer, Tally};
use crate::scene::{FirstHit, Incident, Scene};
use crate::tables::SamplingTables;
use crate::walk::{Engine, WalkPlan, Walker};
use rayon::prelude::*;
use std::sync::Arc;

/// Directions of light (θ, φ) in degrees of a pilot in place of a basis, none in a plane in which yarns lie.
const DIRECTIONS: &str = "[[3, 35], [30, 20], [60, 12], [60, 55]]";
/// Longest list of directions that a pilot takes as it is.
const MOST_DIRECTIONS: usize = 8;
/// Cells along an edge of its exit disc.
const EXIT: &str = "8";
/// Walks of each direction and block of the first, short round.
const FIRST: u64 = 64;
/// Most of them in all.
const MOST: u64 = 1 << 15;
/// Numbers of walks that a block has for its own.
const OF_BLOCK: u64 = 1 << 32;
/// Realizations that no medium is counted from.
const OF_PILOTS: u64 = 1 << 41;

/// Walks through the fibers of one realization a block.
pub struct Pilot {
    scene: Scene,
    goniometer: Goniometer,
    realizations: Arc<Vec<Realization>>,
    fibers: Vec<Tally>,
    /// Pieces that a walk through the fibers is tested against.
    pub tests_a_walk: f64,
    /// Pieces of a realization.
    pub pieces: usize,
    /// Relative noise of the scattered light of one walk of each direction: noise falls with the root of the walks.
    pub noise_of_one: f64,
}

impl Pilot {
    /// Draw a realization for each block, and make as many walks through them as `walks` says that a walk of so many tests
    /// allows, all directions and blocks together. What is found does not depend on the clock.
    ///
    /// # Errors
    /// Those of [`Realizer::draw`] and [`Explicit::drawn`].
    pub fn new(scene: &Scene, seed: u64, walks: impl Fn(f64) -> f64) -> Result<Pilot> {
        let mut scene = scene.clone();
        let listed = matches!(&scene.measure.incident, Incident::List(list) if list.len() <= MOST_DIRECTIONS);
        if !listed {
            scene.measure.set_from_flag("incident", DIRECTIONS)?;
        }
        scene.measure.set_from_flag("exit", EXIT)?;
        let goniometer = Goniometer::new(&scene.measure);
        let realizer = Realizer::new(&scene, scene.model.packing)?;
        let draw = |number| realizer.draw(OF_PILOTS + number);
        let realizations: Arc<Vec<Realization>> =
            Arc::new((0..BLOCKS).into_par_iter().map(draw).collect::<Result<_>>()?);
        let pieces = realizations.iter().map(|drawn| drawn.pieces().len()).max().unwrap_or_default();
        let mut pilot = Pilot {
            scene,
            goniometer,
            realizations,
            fibers: Vec::new(),
            tests_a_walk: 0.0,
            pieces,
            noise_of_one: f64::INFINITY,
        };
        let first = pilot.walk_fibers(seed, 0, FIRST)?;
        let more = (walks(pilot.tests_a_walk) / (BLOCKS as f64 * pilot.goniometer.starts() as f64)) as u64;
        pilot.fibers = match more.min(MOST) {
            0..FIRST => first,
            more => pilot.walk_fibers(seed, FIRST, more)?,
        };
        let walks = pilot.fibers[0].walks_per_incident() * BLOCKS;
        pilot.noise_of_one = block_noise(&pilot.fibers)?.value * (walks as f64).sqrt();
        Ok(pilot)
    }

    /// Walks of each direction in all blocks.
    pub fn walks(&self) -> u64 {
        self.fibers.iter().map(|block| block.walks_per_incident()).sum()
    }

    /// Walk through the fibers, realization by realization.
    fn walk_fibers(&mut self, seed: u64, first: u64, walks: u64) -> Result<Vec<Tally>> {
        let block = |number: u64| {
            let own = self.realizations.clone();
            let draw = move |_| Ok(own[number as usize].clone());
            let explicit = Explicit::drawn(&self.scene, Some(usize::MAX >> 1), draw)?;
            let plan = WalkPlan { first: number * OF_BLOCK + first, ..WalkPlan::new(!seed, walks) };
            explicit.run(&self.goniometer, &plan, &mut |_| {})
        };
        let blocks: Vec<Tally> = (0..BLOCKS).into_par_iter().map(block).collect::<Result<_>>()?;
        let made = BLOCKS * walks * self.goniometer.starts() as u64;
        let tests: u64 = blocks.iter().map(|block| block.counts.tentative_events).sum();
        self.tests_a_walk = tests as f64 / made as f64;
        Ok(blocks)
    }

    /// Walk through a medium as often as through the fibers: its distance from them, and the tentative events of a walk.
    ///
    /// # Errors
    /// Those of [`Engine::run`].
    pub fn try_medium(&self, tables: &SamplingTables, engine: &dyn Engine, seed: u64) -> Result<(Distance, f64)> {
        let rays = StraightRays::new(&self.scene, &self.goniometer);
        let on_fibers = self.scene.model.first_hit == FirstHit::Fibers;
        let walks = self.fibers[0].walks_per_incident();
        let mut blocks = Vec::new();
        for (number, realization) in (0..).zip(self.realizations.iter()) {
            let first_hits =
                if on_fibers { Some(Arc::new(rays.of_one(number, realization, walks as usize)?)) } else { None };
            let plan = WalkPlan { first: number * OF_BLOCK, first_hits, ..WalkPlan::new(seed, walks) };
            blocks.push(engine.run(tables, &self.goniometer, &plan, &mut |_| {})?);
        }
        let made = blocks.iter().map(|block| block.counts.launched).sum::<u64>() as f64;
        let events = blocks.iter().map(|block| block.counts.tentative_events).sum::<u64>() as f64;
        Ok((distance(&blocks, &self.fibers)?, events / made))
    }
}
