//! One measurement.

use super::engine::ChosenEngine;
use crate::bsdf::noise;
use crate::distribution::{DirectionGrid, SpecificLength};
use crate::error::{Error, Result};
use crate::goniometer::{Goniometer, Tally};
use crate::scene::Scene;
use crate::tables::SamplingTables;
use crate::walk::{Engine, WalkPlan};
use serde::Serialize;
use std::time::{Duration, Instant};

/// Largest tally that is held in memory, in bytes.
const MAX_TALLY: usize = 1 << 30;
/// Time between two looks at the noise.
const LOOK: Duration = Duration::from_millis(200);

/// How far a run has come.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Walks made.
    pub walks: u64,
    /// Walks to be made.
    pub planned: u64,
    /// Relative noise of the scattered light so far.
    pub noise: f64,
}

/// Where the time went, in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Seconds {
    /// Tables and engine.
    pub prepare: f64,
    /// Walks, the engine's warm-up included.
    pub walk: f64,
    /// Both.
    pub total: f64,
}

/// What a run gives.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// The instrument.
    pub goniometer: Goniometer,
    /// The counts, whose account has been checked.
    pub tally: Tally,
    /// Where the time went.
    pub seconds: Seconds,
}

/// The medium and the instrument of a scene.
///
/// # Errors
/// [`Error::Input`] when the table of results would not fit into memory.
pub fn prepare(scene: &Scene) -> Result<(SpecificLength, SamplingTables, Goniometer)> {
    let goniometer = Goniometer::new(&scene.measure);
    let bytes = goniometer.layout().stride() * goniometer.incident_cells() * size_of::<u64>();
    if bytes > MAX_TALLY {
        let (cells, exits) = (goniometer.incident_cells(), goniometer.exit.cells());
        return Err(Error::Input(format!(
            "{cells} incident cells with {exits} exit cells on each side take {} MiB, allowed: {} MiB; \
             lower `incident` or `exit`",
            bytes.div_ceil(1 << 20),
            MAX_TALLY >> 20
        )));
    }
    let grid = DirectionGrid { n: scene.model.directions.isqrt() };
    let specific_length = SpecificLength::of_sheet(&scene.sheet, grid);
    let tables = SamplingTables::new(scene, &specific_length);
    Ok((specific_length, tables, goniometer))
}

/// Measure a scene with a chosen engine; `started` is when the work on it began.
///
/// # Errors
/// Those of [`prepare`] and of [`Engine::run`].
pub fn run(
    scene: &Scene,
    engine: &ChosenEngine,
    plan: &WalkPlan,
    started: Instant,
    progress: &mut dyn FnMut(Progress),
) -> Result<Measurement> {
    let (_, tables, goniometer) = prepare(scene)?;
    let prepared = Instant::now();
    let planned = plan.walks_per_incident * goniometer.incident_cells() as u64;
    let mut looked = prepared;
    let tally = engine.run(&tables, &goniometer, plan, &mut |tally| {
        if looked.elapsed() >= LOOK {
            looked = Instant::now();
            progress(Progress { walks: tally.counts.finished, planned, noise: noise(tally) });
        }
    })?;
    let seconds = Seconds {
        prepare: (prepared - started).as_secs_f64(),
        walk: prepared.elapsed().as_secs_f64(),
        total: started.elapsed().as_secs_f64(),
    };
    Ok(Measurement { goniometer, tally, seconds })
}

/// Largest resident memory of this process so far in bytes, from Linux's /proc; none on other systems.
pub fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}
