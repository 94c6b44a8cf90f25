//! All walks of a plan, on all cores.

use super::walk::{Blind, walk};
use crate::error::Result;
use crate::goniometer::{Counts, Goniometer, Origin, Tally};
use crate::tables::SamplingTables;
use crate::walk::{Engine, WalkPlan, WalkRecord};
use rayon::prelude::*;

/// Walks of one incident cell made by one task.
const TASK: u64 = 4096;
/// Tasks between two looks at the progress, for each thread.
const TASKS_PER_ROUND: u64 = 16;

/// The f64 engine.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reference;

impl Reference {
    /// Who counts: the number of threads stands for the adapter.
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
        let origin = Origin { engine: "cpu", adapter: self.adapter(), seed: plan.seed };
        let cells = goniometer.incident_cells();
        let mut tally = Tally::new(origin, goniometer.layout(), cells);
        // A task is a block of walks of one cell; cells go round fastest.
        let tasks = plan.walks_per_incident.div_ceil(TASK) * cells as u64;
        let round = TASKS_PER_ROUND * rayon::current_num_threads() as u64;
        for first in (0..tasks).step_by(round as usize) {
            let records: Vec<(usize, Vec<WalkRecord>)> = (first..(first + round).min(tasks))
                .into_par_iter()
                .map(|task| {
                    let (start, cell) = (task / cells as u64 * TASK, (task % cells as u64) as usize);
                    let end = (start + TASK).min(plan.walks_per_incident);
                    let walk = |i| walk(tables, goniometer, plan, cell, plan.first + i, &mut Blind);
                    (cell, (start..end).map(walk).collect())
                })
                .collect();
            for (cell, records) in &records {
                count(&mut tally, *cell, records);
            }
            progress(&tally);
        }
        tally.walks_per_incident = plan.walks_per_incident;
        tally.check(plan.walks_per_incident)?;
        Ok(tally)
    }
}

fn count(tally: &mut Tally, cell: usize, records: &[WalkRecord]) {
    let start = cell * tally.layout.stride();
    for record in records {
        tally.bins[start + record.bin as usize] += 1;
        tally.counts += Counts {
            launched: 1,
            finished: 1,
            tentative_events: u64::from(record.events),
            collisions: u64::from(record.hits),
        };
    }
}
