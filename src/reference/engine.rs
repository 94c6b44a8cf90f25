//! All walks of a plan, on all cores.

use super::walk::{Blind, walk};
use crate::error::Result;
use crate::goniometer::{Counts, Coverage, Goniometer, Origin, Outcome, Tally, WEIGHT};
use crate::tables::SamplingTables;
use crate::walk::{Engine, Purpose, WalkPlan, WalkRecord, draw, uniform};
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
                    let score = |i| score(tables, goniometer, plan, start, plan.first + i);
                    (start, (first..end).map(score).collect())
                })
                .collect();
            for (start, scores) in &scores {
                scores.iter().for_each(|score| count(&mut tally, *start, score));
            }
            progress(&tally);
        }
        tally.coverage = Coverage::new(origin, plan.walks());
        tally.check(plan.walks_per_incident)?;
        Ok(tally)
    }
}

/// What one walk adds to the tally.
struct Score {
    record: WalkRecord,
    base_exits: u32,
    /// Fixed-point weights by channel; empty when fibers do not absorb or the walk met none.
    weights: Vec<u16>,
}

/// Make one walk and round its weights, q = ⌊w·2ˢ + u⌋, without bias.
fn score(tables: &SamplingTables, goniometer: &Goniometer, plan: &WalkPlan, start: usize, i: u64) -> Score {
    let walked = walk(tables, goniometer, plan, start, i, &mut Blind);
    let layout = goniometer.layout();
    let bin = walked.record.bin as usize;
    let ended = bin == layout.outcome(Outcome::Ended);
    let mut weights = Vec::new();
    if tables.absorbing() && (bin < 2 * layout.exit_cells || ended) {
        let id = WalkPlan::walk_id(goniometer.starts(), i, start);
        let u = uniform(draw(plan.seed, id, 0, Purpose::Exit)[0]);
        let weight = |channel| if ended { 0.0 } else { walked.weight(tables, channel) };
        weights = (0..tables.channels()).map(|channel| (weight(channel) * WEIGHT as f64 + u) as u16).collect();
        if ended {
            weights.fill(0);
        }
    }
    Score { record: walked.record, base_exits: walked.base_exits, weights }
}

fn count(tally: &mut Tally, start: usize, score: &Score) {
    let layout = tally.layout;
    let bin = score.record.bin as usize;
    tally.bins[start * layout.stride() + bin] += 1;
    tally.counts += Counts {
        launched: 1,
        finished: 1,
        tentative_events: u64::from(score.record.events),
        collisions: u64::from(score.record.hits),
        base_exits: u64::from(score.base_exits),
    };
    let Some(weights) = &mut tally.weights else { return };
    let bins = 2 * layout.exit_cells + 1;
    for (channel, &q) in score.weights.iter().enumerate() {
        let q = u64::from(q);
        let mut add = |bin: usize, q: u64| weights.moments[(start * bins + bin) * weights.channels + channel].add(q);
        if bin < 2 * layout.exit_cells {
            add(bin, q);
        }
        add(2 * layout.exit_cells, WEIGHT - q);
    }
}
