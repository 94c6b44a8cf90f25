//! All walks of a plan, realization by realization, on all cores.

use super::clustering::{Clustering, Fates};
use super::walk::{Bodies, walk};
use crate::cloth::{DrawnFor, FiberGrid, Realization, Realizer};
use crate::error::Result;
use crate::goniometer::{Coverage, Goniometer, Origin, Tally};
use crate::scene::Scene;
use crate::tables::Kind;
use crate::walk::{Score, WalkPlan, Walker};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// Most walks of a start through one realization: so that some thousands of them see more than one cloth.
const MOST_OF_START: usize = 256;
/// Fewest walks through one realization, all starts together, as long as no start has more than that.
const FEWEST_WALKS: usize = 4096;
/// Bytes of a realization that are worth one more walk through it.
const BYTES_PER_WALK: usize = 256;

/// Realizations that walks go on through by turns, where each hit is followed by another realization.
const ANEW: u64 = 32;

/// The fibers of a realization from its number.
type Draw = Box<dyn Fn(u64) -> Result<Arc<FiberGrid>> + Send + Sync>;

/// The fibers of a cloth, as light meets them.
pub struct Explicit {
    draw: Draw,
    kinds: Vec<Kind>,
    places: Vec<usize>,
    half_length: f64,
    anew: bool,
    walks_per_realization: usize,
    most_of_start: usize,
    bytes: [usize; 2],
    pieces: usize,
    /// By number of the realization.
    fates: Mutex<BTreeMap<u64, Fates>>,
}

impl Explicit {
    /// The fibers of a scene.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) when the cloth cannot be laid out, its fibers cannot be separate though they are
    /// to be, or there are too many.
    pub fn new(scene: &Scene) -> Result<Explicit> {
        let realizer = Realizer::new(scene, scene.model.packing, DrawnFor::Fibers)?;
        Explicit::drawn(scene, None, move |number| realizer.draw(number))
    }

    /// Fibers of the kinds of a scene that `draw` draws from the number of a realization, each with so many walks, all starts
    /// together; if that is not said, with more the larger it is.
    ///
    /// # Errors
    /// Those of `draw`; [`Error::Input`](crate::Error::Input) when there are too many fibers.
    pub fn drawn(
        scene: &Scene,
        walks_per_realization: Option<usize>,
        draw: impl Fn(u64) -> Result<Realization> + Send + Sync + 'static,
    ) -> Result<Explicit> {
        let sorted = move |number| FiberGrid::of(&draw(number)?).map(Arc::new);
        let first = sorted(0)?;
        Ok(Explicit::found(scene, walks_per_realization, &first, Box::new(sorted)))
    }

    /// The fibers of one realization, for all walks.
    pub fn of_one(scene: &Scene, grid: Arc<FiberGrid>) -> Explicit {
        let first = grid.clone();
        Explicit::found(scene, Some(usize::MAX >> 1), &first, Box::new(move |_| Ok(grid.clone())))
    }

    /// Walks of each of so many starts through one realization like `first` where nothing is said of their number.
    pub fn usual_walks(first: &FiberGrid, starts: usize) -> u64 {
        (by_size(first) / starts).clamp(1, MOST_OF_START) as u64
    }

    fn found(scene: &Scene, walks_per_realization: Option<usize>, first: &FiberGrid, draw: Draw) -> Explicit {
        let used = scene.kinds();
        let place = |kind| used.iter().position(|&known| known == kind).unwrap_or_default();
        Explicit {
            draw,
            kinds: Kind::of_scene(scene),
            places: (0..scene.fibers.len()).map(place).collect(),
            half_length: scene.model.length_over_radius / 2.0,
            anew: false,
            walks_per_realization: walks_per_realization.unwrap_or_else(|| by_size(first)),
            most_of_start: if walks_per_realization.is_some() { usize::MAX } else { MOST_OF_START },
            bytes: first.bytes(),
            pieces: first.tubes().len(),
            fates: Mutex::new(BTreeMap::new()),
        }
    }

    /// The same, but the light forgets the fibers after each hit: it goes on from there through another realization. So it meets
    /// what a medium without cells and directions of finite size would have, and falls short of the fibers by what no medium
    /// knows.
    pub fn anew(self) -> Explicit {
        Explicit { anew: true, ..self }
    }

    /// Memory of one realization in bytes: its pieces of fibers, and the grid that finds them. There is one for each thread.
    pub fn bytes(&self) -> [usize; 2] {
        self.bytes
    }

    /// Pieces of fibers of a realization.
    pub fn pieces(&self) -> usize {
        self.pieces
    }

    /// On what it runs.
    pub fn adapter(&self) -> String {
        format!("{} threads, f64", rayon::current_num_threads())
    }

    /// Walks of each start through one realization: walk i goes through realization ⌊i / this⌋.
    pub fn walks_of_start(&self, starts: usize) -> u64 {
        (self.walks_per_realization / starts).clamp(1, self.most_of_start) as u64
    }

    /// How much the walks of one realization resemble each other, from all runs so far that `tally` holds.
    pub fn clustering(&self, tally: &Tally) -> Option<Clustering> {
        let fates = self.fates.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        Clustering::new(&fates.values().copied().collect::<Vec<_>>(), tally)
    }

    /// The walks of a plan that go through realizations, each with its start, realization by realization.
    fn walk_through(
        &self,
        goniometer: &Goniometer,
        plan: &WalkPlan,
        numbers: &[u64],
    ) -> Result<Vec<Vec<(usize, Score)>>> {
        let drawn = |number: &u64| (self.draw)(*number);
        if !self.anew {
            let one = |number: &u64| drawn(number).map(|grid| self.walk_in(goniometer, plan, *number, &grid, &[]));
            return numbers.par_iter().map(one).collect();
        }
        let grids: Vec<Arc<FiberGrid>> = numbers.par_iter().map(drawn).collect::<Result<_>>()?;
        let one = |(number, grid): (&u64, &Arc<FiberGrid>)| self.walk_in(goniometer, plan, *number, grid, &grids);
        Ok(numbers.par_iter().zip(&grids).map(one).collect())
    }

    /// The walks of a plan that set out through one realization, whose fibers are in `grid`.
    fn walk_in(
        &self,
        goniometer: &Goniometer,
        plan: &WalkPlan,
        number: u64,
        grid: &FiberGrid,
        anew: &[Arc<FiberGrid>],
    ) -> Vec<(usize, Score)> {
        let bodies = Bodies { grid, anew, kinds: &self.kinds, places: &self.places, half_length: self.half_length };
        let each = self.walks_of_start(goniometer.starts());
        let walks = plan.walks();
        let own = walks.start.max(number * each)..walks.end.min((number + 1) * each);
        let score = |start, i| {
            let walked = walk(&bodies, goniometer, plan, start, i);
            (start, Score::new(&walked, &self.kinds, goniometer, plan.seed, start, i))
        };
        (0..goniometer.starts())
            .flat_map(|start| own.clone().map(move |i| (start, i)))
            .map(|(start, i)| score(start, i))
            .collect()
    }
}

/// Walks through a realization, all starts together: the more the larger it is.
fn by_size(first: &FiberGrid) -> usize {
    FEWEST_WALKS.max(first.bytes().iter().sum::<usize>() / BYTES_PER_WALK)
}

impl Walker for Explicit {
    fn run(&self, goniometer: &Goniometer, plan: &WalkPlan, progress: &mut dyn FnMut(&Tally)) -> Result<Tally> {
        let origin = Origin { engine: "cpu".into(), adapter: "f64".into(), seed: plan.seed };
        let starts = goniometer.starts();
        let each = self.walks_of_start(starts);
        let walks = plan.walks();
        let realizations: Vec<u64> =
            if walks.is_empty() { vec![] } else { (walks.start / each..=(walks.end - 1) / each).collect() };
        let mut tally = Tally::new(origin.clone(), goniometer.layout(), starts, Kind::channels(&self.kinds));
        let threads = rayon::current_num_threads();
        for some in realizations.chunk_by(|a, b| if self.anew { a / ANEW == b / ANEW } else { b % threads as u64 != 0 })
        {
            let parts = self.walk_through(goniometer, plan, some)?;
            let mut fates = self.fates.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
            for (number, scores) in some.iter().zip(&parts) {
                scores.iter().for_each(|(start, score)| score.add_to(&mut tally, *start));
                let own = Fates::of(tally.layout, scores.iter().map(|(_, score)| score.bin()));
                fates.entry(*number).or_default().add(&own);
            }
            drop(fates);
            progress(&tally);
        }
        tally.coverage = Coverage::new(origin, walks);
        tally.check(plan.walks_per_incident)?;
        Ok(tally)
    }
}
