//! All walks of a plan, on all cores.

use super::walk::{Blind, walk};
use crate::error::Result;
use crate::goniometer::{Coverage, Goniometer, Origin, Tally};
use crate::tables::SamplingTables;
use crate::walk::{Engine, Score, WalkPlan};
use rayon::prelude::*;

/// Walks of one start made by one task.
const TASK: u64 = 4096;
/// Tasks between two looks at the progress, for each thread.
const TASKS_PER_ROUND: u64 = 16;

/// The f64 engine.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reference;

impl Reference {
    /// On what it runs.
    pub fn adapter(&self) -> String {
        format!("{} threads, f64", rayon::current_num_threads())
    }
}

impl Engine for Reference {
    fn run(
        &self,
        tables: &SamplingTables,
        goniometer: &Goniometer,
        plan: &WalkPlan,
        progress: &mut dyn FnMut(&Tally),
    ) -> Result<Tally> {
        plan.check(tables)?;
        let origin = Origin { engine: "cpu".into(), adapter: "f64".into(), seed: plan.seed };
        let starts = goniometer.starts();
        let channels = tables.absorbing().then(|| tables.channels());
        let mut tally = Tally::new(origin.clone(), goniometer.layout(), starts, channels);
        // A task is a block of walks of one start; starts go round fastest.
        let tasks = plan.walks_per_incident.div_ceil(TASK) * starts as u64;
        let round = TASKS_PER_ROUND * rayon::current_num_threads() as u64;
        for first in (0..tasks).step_by(round as usize) {
            let scores: Vec<(usize, Vec<Score>)> = (first..(first + round).min(tasks))
                .into_par_iter()
                .map(|task| {
                    let (first, start) = (task / starts as u64 * TASK, (task % starts as u64) as usize);
                    let end = (first + TASK).min(plan.walks_per_incident);
                    let score = |i| {
                        let walked = walk(tables, goniometer, plan, start, i, &mut Blind);
                        Score::new(&walked, &tables.kinds, goniometer, plan.seed, start, i)
                    };
                    (start, (plan.first + first..plan.first + end).map(score).collect())
                })
                .collect();
            for (start, scores) in &scores {
                scores.iter().for_each(|score| score.add_to(&mut tally, *start));
            }
            progress(&tally);
        }
        tally.coverage = Coverage::new(origin, plan.walks());
        tally.check(plan.walks_per_incident)?;
        Ok(tally)
    }
}
