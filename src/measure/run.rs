//! One measurement.

use super::engine::Grounds;
use super::fibers::AgainstFibers;
use super::promise::Promise;
use super::stop::Stop;
use crate::bsdf::noise;
use crate::cloth::{Cloth, DrawnFor, Realizer};
use crate::distribution::{DirectionGrid, Effort, Gathering, SpecificLength};
use crate::error::{Error, Result};
use crate::explicit::{Banks, Clustering, Explicit, StraightRays};
use crate::goniometer::{Goniometer, Moments, Straight, Tally};
use crate::scene::{Direct, FirstHit, Model, Packing, Scene, Structure};
use crate::tables::{Kind, SamplingTables};
use crate::walk::{Engine, FirstHitBanks, Implicit, WalkPlan, Walker};
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Memory that the results of a run may take, in bytes.
const MAX_BYTES: usize = 4 << 30;
/// Most walks of one run.
pub const MAX_WALKS: u64 = 1 << 48;
/// Time between two looks at the noise.
const LOOK: Duration = Duration::from_millis(200);

/// How far a run has come.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Walks made.
    pub walks: u64,
    /// Walks that the run will take, as far as can be told.
    pub planned: Option<u64>,
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
    /// How much walks through one realization of the fibers resemble each other; none for a medium.
    pub clustering: Option<Clustering>,
    /// The medium against the fibers, if that was tried.
    pub against: Option<AgainstFibers>,
    /// How the model was chosen, if a planner did.
    pub plan: Option<serde_json::Value>,
    /// Where the error of the model comes from, if that was measured.
    pub budget: Option<serde_json::Value>,
    /// Whether the tolerance was kept, where a planner was to keep one.
    pub promise: Option<Promise>,
    /// Why this engine, where there was a choice.
    pub grounds: Option<Grounds>,
}

/// The medium and the instrument of a scene.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// f(p, x) of the cloth.
    pub specific_length: SpecificLength,
    /// The explicit cloth; none for a sheet.
    pub cloth: Option<Cloth>,
    /// How f was gathered; none for a sheet, which states it.
    pub gathering: Option<Gathering>,
    /// What the engines read.
    pub tables: SamplingTables,
    /// The instrument.
    pub goniometer: Goniometer,
    /// The light by start that touches no fiber, by straight rays; none where walks say it.
    pub straight: Option<Vec<Straight>>,
    /// Where walks first meet a fiber; none where flights through the medium find it.
    pub first_hits: Option<Arc<Banks>>,
}

impl Prepared {
    /// Draws realizations of this scene for a user, without laying out its yarns again.
    ///
    /// # Errors
    /// Those of [`Realizer::new`].
    pub fn realizer(&self, scene: &Scene, packing: Packing, drawn_for: DrawnFor) -> Result<Realizer> {
        let model = Model { packing, ..scene.model };
        let of_yarns = |cloth: &Cloth| Ok(Realizer::of_yarns(cloth.clone(), &model, drawn_for));
        self.cloth.as_ref().map_or_else(|| Realizer::new(scene, packing, drawn_for), of_yarns)
    }

    /// The medium, for an engine to send walks through.
    pub fn with<'a>(&'a self, engine: &'a dyn Engine) -> Implicit<'a> {
        let first_hits = self.first_hits.as_deref().map(|banks| banks as &dyn FirstHitBanks);
        Implicit { engine, tables: &self.tables, straight: self.straight.as_deref(), first_hits }
    }

    /// Walks that set out along one ray through a draw of the fibers, of so many walks of each start; none where walks are
    /// independent.
    pub fn walks_a_ray(&self, walks: u64) -> Option<f64> {
        let banks = self.first_hits.as_ref()?;
        let packing = if banks.walks_a_ray().is_some() { Packing::Random } else { Packing::Separate };
        Some(StraightRays::walks_a_ray(packing, self.goniometer.starts(), walks))
    }
}

/// Tabulate a scene.
///
/// # Errors
/// [`Error::Input`] when the cloth cannot be laid out or tabulated, or the run would not fit into memory.
pub fn prepare(scene: &Scene) -> Result<Prepared> {
    prepare_with(scene, |_| {})
}

/// As [`prepare`]; `progress` is told the share of the fibers of a cloth of yarns that are counted.
///
/// # Errors
/// Those of [`prepare`].
pub fn prepare_with(scene: &Scene, progress: impl FnMut(f64)) -> Result<Prepared> {
    prepare_from(scene, None, progress)
}

/// As [`prepare_with`], from realizations of this realizer of the scene's yarns, if it is given.
///
/// # Errors
/// Those of [`prepare`].
pub fn prepare_from(scene: &Scene, realizer: Option<&Realizer>, progress: impl FnMut(f64)) -> Result<Prepared> {
    let goniometer = Goniometer::new(&scene.measure);
    let rays = StraightRays::new(scene, &goniometer);
    let Model { direct, first_hit, packing, .. } = scene.model;
    let wanted = scene.model.wants_rays();
    let (specific_length, yarns, gathering) = match &scene.structure {
        Structure::Sheet(sheet) => {
            let grid = DirectionGrid { n: scene.model.directions.isqrt() };
            let radius = |kind: usize| scene.fibers[kind].radius;
            let mut length = SpecificLength::of_sheet(sheet, grid, radius);
            length.place(scene.model.placement, radius)?;
            (length, None, None)
        }
        Structure::Weave(_) | Structure::Knit(_) => {
            let laid_out = realizer.and_then(Realizer::yarns).cloned();
            let cloth = laid_out.map_or_else(|| Cloth::new(scene), Ok)?;
            let realizer =
                realizer.cloned().unwrap_or_else(|| Realizer::of_yarns(cloth.clone(), &scene.model, DrawnFor::Medium));
            let draw = |number| {
                let realization = realizer.draw(number)?;
                if wanted {
                    rays.add(number, &realization)?;
                }
                Ok(realization)
            };
            let (length, gathering) =
                SpecificLength::of_draws(&cloth, &scene.model, Effort::default(), &draw, progress)?;
            (length, Some((cloth, realizer)), Some(gathering))
        }
    };
    let (cloth, realizer) = yarns.unzip();
    let tables = SamplingTables::new(scene, &specific_length)?;
    check_memory(memory(&scene.model, &tables, &goniometer), tables.channels(), &goniometer)?;
    let (mut straight, mut first_hits) = (None, None);
    if wanted {
        let realizer = realizer.map_or_else(|| Realizer::new(scene, packing, DrawnFor::Medium), Ok)?;
        if gathering.is_none() {
            StraightRays::wanted().into_par_iter().try_for_each(|number| rays.add(number, &realizer.draw(number)?))?;
        }
        if direct == Direct::Straight && packing == Packing::Random {
            rays.go_on(&realizer)?;
        }
        straight = rays.light().filter(|_| direct == Direct::Straight);
        // Separate fibers take too long to draw for fresh rays.
        let realizer = Some(realizer).filter(|_| packing == Packing::Random);
        first_hits = (first_hit == FirstHit::Fibers).then(|| Arc::new(rays.into_banks(realizer)));
    }
    Ok(Prepared { specific_length, cloth, gathering, tables, goniometer, straight, first_hits })
}

/// Find the fibers of a scene, and set up the instrument.
///
/// # Errors
/// Those of [`Explicit::new`]; [`Error::Input`] when the run would not fit into memory.
pub fn prepare_explicit(scene: &Scene) -> Result<(Explicit, Goniometer)> {
    let goniometer = check_results(scene)?;
    Ok((Explicit::new(scene)?, goniometer))
}

/// The instrument of a scene, whose results fit into memory whatever light goes through.
///
/// # Errors
/// [`Error::Input`] when they do not.
pub fn check_results(scene: &Scene) -> Result<Goniometer> {
    let goniometer = Goniometer::new(&scene.measure);
    let channels = Kind::channels(&Kind::of_scene(scene));
    check_memory(result_memory(channels, &goniometer), channels.unwrap_or(1), &goniometer)?;
    Ok(goniometer)
}

/// Refuse a run that takes too much memory.
fn check_memory(bytes: usize, channels: usize, goniometer: &Goniometer) -> Result<()> {
    if bytes <= MAX_BYTES {
        return Ok(());
    }
    let (cells, exits) = (goniometer.starts(), goniometer.exit.cells());
    // Grey and rgb leave nothing to choose.
    let (channels, fewer) = match channels {
        channels if channels > 3 => (format!(" and {channels} channels"), " or take fewer wavelengths"),
        _ => (String::new(), ""),
    };
    Err(Error::Input(format!(
        "{cells} incident cells with {exits} exit cells on each side{channels} take about {} MiB of memory, allowed: \
         {} MiB; lower `incident` or `exit`{fewer}",
        bytes.div_ceil(1 << 20),
        MAX_BYTES >> 20
    )))
}

/// Memory in bytes that the results of a run take at most: the tally and a part of it that is made, and the table as it is
/// written.
fn result_memory(channels: Option<usize>, goniometer: &Goniometer) -> usize {
    let bins = goniometer.layout().stride() * goniometer.starts();
    let tally = bins * size_of::<u64>() + moments(channels, goniometer) * size_of::<Moments>();
    2 * tally + 2 * bins * channels.unwrap_or(1) * size_of::<f32>()
}

/// Sums of weights of a tally.
fn moments(channels: Option<usize>, goniometer: &Goniometer) -> usize {
    (2 * goniometer.layout().exit_cells + 1) * channels.unwrap_or_default() * goniometer.starts()
}

/// Memory in bytes that a run takes at most: its results, what the gpu engine holds of one batch (on the device, as last
/// seen, and twice on the way), the tables, and the straight rays of the model.
pub fn memory(model: &Model, tables: &SamplingTables, goniometer: &Goniometer) -> usize {
    let channels = Kind::channels(&tables.kinds);
    let bins = goniometer.layout().stride() * goniometer.starts();
    let batch = (4 * (bins + 4 * moments(channels, goniometer))).min(128 << 20);
    // What the device reads of the tables is packed on the host first.
    let packed = 16 * (tables.patches.len() + tables.visible.as_ref().map_or(0, |visible| visible.nodes.len()));
    let cells = 16 * tables.cells.as_ref().map_or(0, |cells| cells.entries.len());
    let rays = if model.wants_rays() { StraightRays::bytes(goniometer.starts()) } else { 0 };
    result_memory(channels, goniometer) + 4 * batch + tables.bytes() + 2 * (packed + cells) + rays
}

/// Send walks through a medium or through fibers until `stop` says that it is enough; `started` is when the work on them
/// began.
///
/// # Errors
/// Those of [`Walker::run`].
pub fn run(
    walker: &dyn Walker,
    goniometer: &Goniometer,
    seed: u64,
    stop: Stop,
    started: Instant,
    mut progress: Option<&mut dyn FnMut(Progress)>,
) -> Result<Measurement> {
    let starts = goniometer.starts() as u64;
    let most = MAX_WALKS / starts;
    let begun = Instant::now();
    let mut next_look = begun + LOOK;
    let mut made = 0;
    let mut tally = walker.run(goniometer, &WalkPlan::new(seed, 0), &mut |_| {})?;
    while let Some(next) = stop.next(&tally, made, begun, most) {
        let plan = WalkPlan { first: made, ..WalkPlan::new(seed, next - made) };
        let part = walker.run(goniometer, &plan, &mut |part| {
            let Some(progress) = &mut progress else { return };
            let now = Instant::now();
            if now >= next_look {
                let walks = tally.counts.finished + part.counts.finished;
                // The noise of all walks, from that of the part that grows.
                let noise = noise(part) * (part.counts.finished as f64 / walks as f64).sqrt();
                let planned = stop.expected(noise, walks / starts, begun).map(|walks| walks * starts);
                progress(Progress { walks, planned, noise });
                // A look at a large table takes its time: spend a twentieth on it at most.
                next_look = Instant::now() + LOOK.max(20 * now.elapsed());
            }
        })?;
        tally.merge(&part)?;
        made = next;
    }
    tally.check(made)?;
    let seconds = Seconds {
        prepare: (begun - started).as_secs_f64(),
        walk: begun.elapsed().as_secs_f64(),
        total: started.elapsed().as_secs_f64(),
    };
    Ok(Measurement {
        goniometer: goniometer.clone(),
        tally,
        seconds,
        clustering: None,
        against: None,
        plan: None,
        budget: None,
        promise: None,
        grounds: None,
    })
}

/// Largest resident memory of this process so far in bytes, from Linux's /proc; none on other systems.
pub fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}
