//! Pilot runs: a few walks through the fibers themselves and through a medium, on the same few realizations.

use super::trial::BLOCKS;
use crate::bsdf::{Distance, block_noise, distance};
use crate::cloth::{DrawnFor, FiberGrid, Realizer};
use crate::error::Result;
use crate::explicit::{Explicit, StraightRays};
use crate::goniometer::{Goniometer, Tally};
use crate::scene::{FirstHit, Incident, Scene};
use crate::tables::SamplingTables;
use crate::walk::{Engine, FirstHits, WalkPlan, Walker};
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

/// Walks through the fibers of one realization a block.
pub struct Pilot {
    scene: Scene,
    goniometer: Goniometer,
    /// Those of the blocks, where a medium's walks first meet them.
    realizations: Vec<Arc<FiberGrid>>,
    fibers: Vec<Tally>,
    /// Pieces that a walk through the fibers is tested against.
    pub tests_a_walk: f64,
    /// Pieces of a realization.
    pub pieces: usize,
    /// Relative noise of the scattered light of one walk of each direction: noise falls with the root of the walks.
    pub noise_of_one: f64,
}

impl Pilot {
    /// Exit cells of each side of a pilot.
    pub const EXIT_CELLS: f64 = 64.0;

    /// Draw a realization for each block, and make as many walks through them as `walks` says of the tests that a walk takes and of
    /// the pieces that are drawn, all directions and blocks together. What is found does not depend on the clock.
    ///
    /// # Errors
    /// Those of [`Realizer::draw`] and [`FiberGrid::of`].
    pub fn new(scene: &Scene, seed: u64, walks: impl Fn(f64, f64) -> f64) -> Result<Pilot> {
        let mut scene = scene.clone();
        let listed = matches!(&scene.measure.incident, Incident::List(list) if list.len() <= MOST_DIRECTIONS);
        if !listed {
            scene.measure.set_from_flag("incident", DIRECTIONS)?;
        }
        scene.measure.set_from_flag("exit", EXIT)?;
        let goniometer = Goniometer::new(&scene.measure);
        let realizer = Realizer::new(&scene, scene.model.packing, DrawnFor::Pilot)?;
        // What a walk costs, a few through the first realization tell.
        let drawn = |number: u64| FiberGrid::of(&realizer.draw(number)?).map(Arc::new);
        let first = drawn(0)?;
        let pieces = first.tubes().len();
        let few =
            Explicit::of_one(&scene, first.clone()).run(&goniometer, &WalkPlan::new(!seed, FIRST), &mut |_| {})?;
        let tests_a_walk = few.counts.tentative_events as f64 / few.counts.launched as f64;
        let all = walks(tests_a_walk, pieces as f64 * BLOCKS as f64);
        let of_block = ((all / (BLOCKS as f64 * goniometer.starts() as f64)) as u64).clamp(FIRST, MOST);
        let kept = scene.model.first_hit == FirstHit::Fibers;
        let block = |number: u64| {
            let grid = if number == 0 { first.clone() } else { drawn(number)? };
            let plan = WalkPlan { first: number * OF_BLOCK + FIRST, ..WalkPlan::new(!seed, of_block) };
            let tally = Explicit::of_one(&scene, grid.clone()).run(&goniometer, &plan, &mut |_| {})?;
            Ok((tally, kept.then_some(grid)))
        };
        let blocks: Vec<(Tally, Option<Arc<FiberGrid>>)> =
            (0..BLOCKS).into_par_iter().map(block).collect::<Result<_>>()?;
        let (fibers, own): (Vec<Tally>, Vec<Option<Arc<FiberGrid>>>) = blocks.into_iter().unzip();
        let noise_of_one = block_noise(&fibers)?.value * ((of_block * BLOCKS) as f64).sqrt();
        let realizations = own.into_iter().flatten().collect();
        Ok(Pilot { scene, goniometer, realizations, fibers, tests_a_walk, pieces, noise_of_one })
    }

    /// Walks of each direction in all blocks.
    pub fn walks(&self) -> u64 {
        self.fibers.iter().map(|block| block.walks_per_incident()).sum()
    }

    /// Walk through a medium as often as through the fibers: its distance from them, and the tentative events of a walk.
    ///
    /// # Errors
    /// Those of [`Engine::run`].
    pub fn try_medium(&self, tables: &SamplingTables, engine: &dyn Engine, seed: u64) -> Result<(Distance, f64)> {
        let rays = StraightRays::new(&self.scene, &self.goniometer);
        let walks = self.fibers[0].walks_per_incident();
        let of_one = |(number, grid): (usize, &Arc<FiberGrid>)| rays.of_one(number as u64, grid, walks as usize);
        let first_hits: Vec<Arc<FirstHits>> =
            self.realizations.par_iter().enumerate().map(of_one).map(Arc::new).collect();
        let mut blocks = Vec::new();
        for number in 0..BLOCKS {
            let first_hits = first_hits.get(number as usize).cloned();
            let plan = WalkPlan { first: number * OF_BLOCK, first_hits, ..WalkPlan::new(seed, walks) };
            blocks.push(engine.run(tables, &self.goniometer, &plan, &mut |_| {})?);
        }
        let made = blocks.iter().map(|block| block.counts.launched).sum::<u64>() as f64;
        let events = blocks.iter().map(|block| block.counts.tentative_events).sum::<u64>() as f64;
        Ok((distance(&blocks, &self.fibers)?, events / made))
    }
}
