//! Pilot runs: walks through the fibers themselves and through media, on the same few realizations, in rounds that grow.

use super::trial::BLOCKS;
use crate::bsdf::{Verdict, block_noise};
use crate::cloth::{DrawnFor, FiberGrid, Realizer};
use crate::error::Result;
use crate::explicit::{Explicit, StraightRays};
use crate::goniometer::{Goniometer, Tally};
use crate::scene::{self, BasisChoice, Incident, Scene};
use crate::tables::SamplingTables;
use crate::walk::{Engine, FirstHit, FirstHits, WalkPlan, Walker};
use rayon::prelude::*;
use std::sync::Arc;

/// Directions of light (θ, φ) in degrees of a pilot in place of a basis: in the middle of quarters of the hemisphere by projected
/// solid angle, and in no plane in which yarns lie.
const DIRECTIONS: &str = "[[21, 35], [38, 168], [52, 235], [69, 282]]";
/// Longest list of directions that a pilot takes as it is.
const MOST_DIRECTIONS: usize = 8;
/// Cells along an edge of its exit disc, as many as it takes for E to be that of finer ones; a run that has fewer exit cells has those
/// of its own.
const EXIT: u32 = 12;
/// Walks through a medium for each one through the fibers, which takes longer; they set out along the same ray.
pub(super) const BESIDE: u64 = 2;
/// Walks of each direction and block of the first, short look, and the fewest of a round.
const FIRST: u64 = 64;
/// Most of them in a round.
const MOST: u64 = 1 << 15;
/// Most walks of all directions: a first hit of each is kept.
const MOST_IN_ALL: f64 = (1 << 21) as f64;
/// Numbers of walks that a block has for its own.
const OF_BLOCK: u64 = 1 << 32;

/// Walks of every block through realizations of its own.
struct Round {
    /// Number of the first walk in its block, and walks of each direction.
    first: u64,
    walks: u64,
    /// By block, where the medium's walks first meet the fibers; none where the medium says that.
    first_hits: Vec<Arc<FirstHits>>,
}

/// Walks through the fibers, in rounds that each draw realizations for every block.
pub struct Pilot {
    scene: Scene,
    goniometer: Goniometer,
    realizer: Realizer,
    seed: u64,
    rounds: Vec<Round>,
    /// Realizations that were drawn.
    realizations: u64,
    /// By block.
    fibers: Vec<Tally>,
    /// Pieces that a walk through the fibers is tested against.
    pub tests_a_walk: f64,
    /// Pieces of a realization.
    pub pieces: usize,
    /// Walks, all starts together, that a run makes through one realization.
    pub walks_a_realization: f64,
    /// Relative noise of the scattered light of one walk of each direction: noise falls with the root of the walks.
    pub noise_of_one: f64,
}

/// Walks through a medium, beside those of a pilot; none so far by default.
#[derive(Default)]
pub struct Beside {
    blocks: Vec<Tally>,
    rounds: usize,
}

impl Beside {
    /// Tentative events of a walk.
    pub fn events(&self) -> f64 {
        let sum = |of: fn(&Tally) -> u64| self.blocks.iter().map(of).sum::<u64>() as f64;
        sum(|block| block.counts.tentative_events) / sum(|block| block.counts.launched)
    }
}

impl Pilot {
    /// Draw a realization for each block, and make as many walks through them as `walks` says of the tests that a walk takes and of
    /// the pieces that are drawn, all directions and blocks together. What is found does not depend on the clock.
    ///
    /// # Errors
    /// Those of [`Realizer::draw`] and [`FiberGrid::of`].
    pub fn new(scene: &Scene, laid: Option<&Realizer>, seed: u64, walks: impl Fn(f64, f64) -> f64) -> Result<Pilot> {
        let starts = Goniometer::new(&scene.measure).starts();
        let mut scene = scene.clone();
        let listed = matches!(&scene.measure.incident, Incident::List(list) if list.len() <= MOST_DIRECTIONS);
        if !listed {
            scene.measure.set_from_flag("incident", DIRECTIONS)?;
        }
        if scene.measure.exit.cells() > (EXIT * EXIT) as usize {
            scene.measure.exit = BasisChoice::Disc(EXIT);
        }
        let goniometer = Goniometer::new(&scene.measure);
        let new = || Realizer::new(&scene, scene.model.packing, DrawnFor::Pilot);
        let realizer = laid.map_or_else(new, |laid| Ok(laid.for_user(DrawnFor::Pilot)))?;
        // What a walk costs, a few through the first realization tell.
        let first = Arc::new(FiberGrid::of(&realizer.draw(0)?)?);
        let explicit = Explicit::of_one(&scene, first.clone());
        let few = explicit.run(&goniometer, &WalkPlan::new(!seed, FIRST), &mut |_| {})?;
        let mut pilot = Pilot {
            goniometer,
            realizer,
            seed,
            rounds: Vec::new(),
            realizations: 0,
            fibers: Vec::new(),
            tests_a_walk: few.counts.tentative_events as f64 / few.counts.launched as f64,
            pieces: first.tubes().len(),
            walks_a_realization: (Explicit::usual_walks(&first, starts) * starts as u64) as f64,
            noise_of_one: f64::INFINITY,
            scene,
        };
        let all = walks(pilot.tests_a_walk, pilot.pieces as f64 * BLOCKS as f64);
        pilot.add(all, Some(first))?;
        Ok(pilot)
    }

    /// Make a further round of so many walks, all directions and blocks together, through further realizations.
    ///
    /// # Errors
    /// Those of [`Pilot::new`].
    pub fn grow(&mut self, walks: f64) -> Result<()> {
        self.add(walks, None)
    }

    /// Add a round in which no realization has more walks than in a run through the fibers: further ones through the same tell less.
    fn add(&mut self, walks: f64, drawn: Option<Arc<FiberGrid>>) -> Result<()> {
        let starts = self.goniometer.starts() as f64;
        let all = (walks / (BLOCKS as f64 * starts)).clamp(FIRST as f64, MOST as f64);
        let realizations = (all / (self.walks_a_realization / starts).max(FIRST as f64)).ceil();
        let (each, realizations) = ((all / realizations) as u64, realizations as u64);
        let first = self.rounds.last().map_or(FIRST, |round| round.first + round.walks);
        let before = self.realizations;
        let rays = (self.scene.model.first_hit == scene::FirstHit::Fibers)
            .then(|| StraightRays::new(&self.scene, &self.goniometer));
        let one = |number: u64, turn: u64| {
            let realization = before + number * realizations + turn;
            let grid = match &drawn {
                Some(grid) if realization == 0 => grid.clone(),
                _ => Arc::new(FiberGrid::of(&self.realizer.draw(realization)?)?),
            };
            let plan = WalkPlan { first: number * OF_BLOCK + first + turn * each, ..WalkPlan::new(!self.seed, each) };
            let tally = Explicit::of_one(&self.scene, grid.clone()).run(&self.goniometer, &plan, &mut |_| {})?;
            Ok((tally, rays.as_ref().map(|rays| rays.through(realization, &grid, each as usize))))
        };
        let block = |number: u64| {
            let parts: Vec<(Tally, Option<Vec<FirstHit>>)> =
                (0..realizations).map(|turn| one(number, turn)).collect::<Result<_>>()?;
            let (tallies, first_hits): (Vec<Tally>, Vec<Option<Vec<FirstHit>>>) = parts.into_iter().unzip();
            let mut whole = tallies[0].clone();
            tallies[1..].iter().try_for_each(|part| whole.merge(part))?;
            let first_hits: Vec<Vec<FirstHit>> = first_hits.into_iter().flatten().collect();
            Ok((whole, (!first_hits.is_empty()).then(|| Arc::new(FirstHits::by_turns(each as usize, &first_hits)))))
        };
        let blocks: Vec<(Tally, Option<Arc<FirstHits>>)> =
            (0..BLOCKS).into_par_iter().map(block).collect::<Result<_>>()?;
        let (tallies, first_hits): (Vec<Tally>, Vec<Option<Arc<FirstHits>>>) = blocks.into_iter().unzip();
        join(&mut self.fibers, tallies)?;
        let first_hits = first_hits.into_iter().flatten().collect();
        self.rounds.push(Round { first, walks: each * realizations, first_hits });
        self.realizations += BLOCKS * realizations;
        self.noise_of_one = block_noise(&self.fibers)?.value * (self.of_direction() as f64).sqrt();
        Ok(())
    }

    /// Exit cells of each side.
    pub fn exit_cells(&self) -> f64 {
        self.goniometer.exit.cells() as f64
    }

    /// Walks of each direction in all blocks.
    pub fn of_direction(&self) -> u64 {
        self.fibers.iter().map(Tally::walks_per_incident).sum()
    }

    /// Walks of all directions.
    pub fn walks(&self) -> f64 {
        (self.of_direction() * self.goniometer.starts() as u64) as f64
    }

    /// How many more walks, all directions together, it may have at most; without end where no first hits are kept.
    pub fn room(&self) -> f64 {
        match self.scene.model.first_hit {
            scene::FirstHit::Fibers => (MOST_IN_ALL - self.walks()).max(0.0),
            scene::FirstHit::Medium => f64::INFINITY,
        }
    }

    /// Realizations that were drawn.
    pub fn realizations(&self) -> f64 {
        self.realizations as f64
    }

    /// Walk through a medium as often as through the fibers, on from the walks that are there, and hold both against each other.
    ///
    /// # Errors
    /// Those of [`Engine::run`].
    pub fn hold(&self, beside: &mut Beside, tables: &SamplingTables, engine: &dyn Engine) -> Result<Verdict> {
        for Round { first, walks, first_hits } in &self.rounds[beside.rounds..] {
            let block = |number: u64| {
                let first_hits = first_hits.get(number as usize).cloned();
                let first = number * OF_BLOCK + BESIDE * first;
                let plan = WalkPlan { first, first_hits, ..WalkPlan::new(self.seed, BESIDE * walks) };
                engine.run(tables, &self.goniometer, &plan, &mut |_| {})
            };
            join(&mut beside.blocks, (0..BLOCKS).map(block).collect::<Result<_>>()?)?;
        }
        beside.rounds = self.rounds.len();
        Verdict::new(&beside.blocks, &self.fibers)
    }
}

/// Add the walks of further blocks to those that are there.
fn join(blocks: &mut Vec<Tally>, more: Vec<Tally>) -> Result<()> {
    if blocks.is_empty() {
        *blocks = more;
        return Ok(());
    }
    blocks.iter_mut().zip(&more).try_for_each(|(block, more)| block.merge(more))
}
