//! All walks of a plan on a device: batches of starts, segments of walks, dispatches.

use super::adapter::Kind;
use super::buffers::{InTexture, Packed};
use super::device::OpenDevice;
use super::layout::{BLOCK, Counters, FirstHit, UNIFORM_ENTRIES};
use super::pack::{
    absorption_table, cell_table, direction_entries, direction_table, first_hit_table, incidence, incident_table,
    ring_table,
};
use super::params::{counts, params, placement, start_words};
use super::session::{Session, Shape};
use super::settings::{Report, Settings};
use super::tuning::{Choice, TELLING, Tuning, flush_every, longest_budget};
use crate::error::{Error, Result};
use crate::goniometer::{Basis, Coverage, Goniometer, Origin, Tally};
use crate::tables::SamplingTables;
use crate::walk::{Engine, FirstHits, ROULETTE_EVERY, WalkPlan, WalkRecord};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Time between two looks at the bins.
const DRAIN: Duration = Duration::from_millis(500);
/// Blocks of one segment: their numbers are exact in f32.
/// So a segment has at most 2²⁸ walks, and a bin cannot pass once around 2³² unseen.
const MAX_BLOCKS: u64 = 1 << 24;
/// Largest optical depth through cells: a step of f32 at the front is then 10⁻³ of a flight, and no more of the light that comes
/// back is missing.
const MAX_DEPTH: f64 = 8192.0;

/// The WGSL engine on one device.
pub struct Gpu {
    pub(super) device: OpenDevice,
    pub(super) skipped: Vec<String>,
    pub(super) most_passes: Option<u32>,
    pub(super) pipelines: Mutex<HashMap<Shape, wgpu::ComputePipeline>>,
    /// What warm-ups have chosen.
    pub(super) tuned: Mutex<HashMap<Shape, Choice>>,
}

impl Gpu {
    /// Make the walks of a plan, with settings of its own, and report how it went.
    ///
    /// # Errors
    /// Those of [`Engine::run`].
    pub fn run_with(
        &self,
        settings: Settings,
        tables: &SamplingTables,
        goniometer: &Goniometer,
        plan: &WalkPlan,
        progress: &mut dyn FnMut(&Tally),
    ) -> Result<(Tally, Report)> {
        let (tally, report, _) = Run::new(self, settings, tables, goniometer, plan, false)?.make(progress)?;
        Ok((tally, report))
    }

    /// Make the walks of a plan and record each: walk i of start c at i·C + c, C starts.
    ///
    /// # Errors
    /// Those of [`Engine::run`]; the records must fit into one buffer.
    pub fn trace(
        &self,
        settings: Settings,
        tables: &SamplingTables,
        goniometer: &Goniometer,
        plan: &WalkPlan,
    ) -> Result<(Tally, Vec<WalkRecord>)> {
        let (tally, _, records) = Run::new(self, settings, tables, goniometer, plan, true)?.make(&mut |_| {})?;
        Ok((tally, records))
    }

    /// What an earlier warm-up has chosen for a kernel.
    fn tuned(&self, shape: Shape) -> Option<Choice> {
        let known = self.tuned.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        known.get(&untuned(shape)).copied()
    }

    /// The compiled kernel of a shape; lanes do not matter to it.
    fn pipeline(&self, shape: Shape) -> Result<wgpu::ComputePipeline> {
        let key = Shape { lanes: 0, ..shape };
        let mut known = self.pipelines.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some(pipeline) = known.get(&key) {
            return Ok(pipeline.clone());
        }
        let pipeline = Session::compile(&self.device, &shape)?;
        known.insert(key, pipeline.clone());
        Ok(pipeline)
    }
}

/// Refuse cells of which light would feel that places are rounded; in a sheet they are finest at the lit face.
fn check_depth(tables: &SamplingTables) -> Result<()> {
    let depth = tables.majorant * tables.thickness;
    if tables.cells.is_none() || depth <= MAX_DEPTH {
        return Ok(());
    }
    Err(Error::Device {
        needed: format!("cells of an optical depth of {depth:.0} through the cloth need finer places than f32 has"),
        found: format!("the gpu engine has no others (at most {MAX_DEPTH}); take the cpu engine"),
    })
}

/// A shape without what a warm-up chooses, and without what it leaves out.
fn untuned(shape: Shape) -> Shape {
    Shape { lanes: 0, budget: 0, trace: false, ..shape }
}

impl Engine for Gpu {
    fn run(
        &self,
        tables: &SamplingTables,
        goniometer: &Goniometer,
        plan: &WalkPlan,
        progress: &mut dyn FnMut(&Tally),
    ) -> Result<Tally> {
        self.run_with(Settings::default(), tables, goniometer, plan, progress).map(|(tally, _)| tally)
    }
}

/// One run under way.
struct Run<'a> {
    gpu: &'a Gpu,
    settings: Settings,
    tables: &'a SamplingTables,
    goniometer: &'a Goniometer,
    plan: &'a WalkPlan,
    shape: Shape,
    report: Report,
    tally: Tally,
    records: Vec<WalkRecord>,
}

impl<'a> Run<'a> {
    fn new(
        gpu: &'a Gpu,
        settings: Settings,
        tables: &'a SamplingTables,
        goniometer: &'a Goniometer,
        plan: &'a WalkPlan,
        trace: bool,
    ) -> Result<Run<'a>> {
        settings.check()?;
        plan.check(tables)?;
        check_depth(tables)?;
        let large = |entries: usize| entries > UNIFORM_ENTRIES as usize;
        let cells = tables.cells.as_ref().map_or(0, |cells| cells.entries.len());
        let hardware = gpu.kind() == Kind::Hardware;
        // The number of the next roulette is drawn at a flush.
        let most_passes = if tables.absorbing() { ROULETTE_EVERY - 1 } else { u32::MAX };
        let roulette = plan.roulette && tables.kinds.iter().any(|kind| kind.clearest() > 0.0);
        let channels = tables.channels() as u32;
        let flush_every = settings.flush_every.unwrap_or_else(|| flush_every(tables.depth())).min(most_passes);
        let tuning = Tuning::start(gpu.kind());
        let shape = Shape {
            workgroup: settings.workgroup.unwrap_or(64),
            lanes: settings.lanes.unwrap_or(tuning.lanes),
            budget: settings.budget.unwrap_or(tuning.budget.min(longest_budget(
                flush_every,
                channels,
                gpu.most_passes,
            ))),
            flush_every,
            // Divergent reads of a uniform buffer are slow on hardware; a texture is slower than that in software.
            in_texture: InTexture {
                directions: large(direction_entries(tables)) || settings.table_in_texture.unwrap_or(hardware),
                cells: large(cells) || settings.cells_in_texture.unwrap_or(hardware),
            },
            jitter: plan.jitter,
            incidence: incidence(goniometer),
            exit_rings: matches!(goniometer.exit, Basis::Rings(_)),
            trace,
            kinds: tables.kinds.len() as u32,
            channels,
            absorbing: tables.absorbing(),
            bases: tables.half_length.is_finite(),
            roulette,
            cells: cells > 0,
            visible_n: tables.visible.as_ref().map_or(0, |visible| visible.n),
            placement: placement(tables),
            memory: tables.carry.is_some_and(|carry| carry.memory),
            first_hits: plan.first_hits.is_some(),
        };
        let origin = Origin { engine: "gpu".into(), adapter: gpu.adapter(), seed: plan.seed };
        let channels = tables.absorbing().then(|| tables.channels());
        let tally = Tally::new(origin, goniometer.layout(), goniometer.starts(), channels);
        let records = if trace {
            let walks = plan.walks_per_incident as usize * goniometer.starts();
            vec![WalkRecord { bin: u32::MAX, events: 0, hits: 0 }; walks]
        } else {
            Vec::new()
        };
        Ok(Run { gpu, settings, tables, goniometer, plan, shape, report: Report::default(), tally, records })
    }

    fn make(mut self, progress: &mut dyn FnMut(&Tally)) -> Result<(Tally, Report, Vec<WalkRecord>)> {
        let directions = direction_table(self.tables, self.plan.jitter);
        let incident = incident_table(self.goniometer);
        let absorption = absorption_table(self.tables);
        let cells = cell_table(self.tables);
        let rings = ring_table(self.goniometer);
        let batch = self.starts_per_batch();
        for first in (0..incident.len()).step_by(batch) {
            let starts = first..(first + batch).min(incident.len());
            let incident = &incident[starts.clone()];
            let rays = |hits: &Arc<FirstHits>| first_hit_table(self.tables, self.goniometer, hits, starts.clone());
            let first_hits = &self.plan.first_hits.as_ref().map(rays).unwrap_or_default();
            let (directions, cells, absorption, rings) = (&directions, &cells, &absorption, &rings);
            let packed = Packed { directions, cells, incident, absorption, first_hits, rings };
            if first == 0 {
                self.tune(&packed)?;
            }
            self.run_batch(starts, &packed, progress)?;
        }
        let Shape { lanes, budget, flush_every, .. } = self.shape;
        self.report = Report { lanes, budget, flush_every, ..self.report };
        self.tally.coverage = Coverage::new(self.tally.origin().clone(), self.plan.walks());
        self.tally.check(self.plan.walks_per_incident)?;
        Ok((self.tally, self.report, self.records))
    }

    /// Starts whose bins and directions fit the device.
    fn starts_per_batch(&self) -> usize {
        let binding = self.gpu.device.device.limits().max_storage_buffer_binding_size;
        let rays = self.plan.first_hits.as_ref().map_or(0, |first_hits| first_hits.of_start * size_of::<FirstHit>());
        let fit = binding as usize / rays.max(start_words(self.tables, self.goniometer) * size_of::<u32>());
        let wanted = self.settings.starts_per_batch.unwrap_or(usize::MAX);
        fit.min(UNIFORM_ENTRIES as usize).min(wanted).max(1)
    }

    /// Walks of each start in one segment, of so many starts.
    fn segment(&self, starts: usize) -> u64 {
        let starts = starts as u64;
        let stride = self.goniometer.starts() as u64;
        let most = (MAX_BLOCKS / starts * u64::from(BLOCK)).min((1 << 32) / stride - 1);
        most.min(self.settings.walks_per_segment.unwrap_or(most)).min(self.plan.walks_per_incident).max(1)
    }

    /// Let a timed warm-up choose lanes and budget, unless they are set or the run is short.
    fn tune(&mut self, packed: &Packed) -> Result<()> {
        let walks = self.plan.walks_per_incident * self.goniometer.starts() as u64;
        let tuning = Tuning::start(self.gpu.kind());
        let fixed = self.settings.lanes.is_some() || self.settings.budget.is_some();
        if !fixed && tuning.pays(walks, self.tables.depth()) {
            let Choice { lanes, budget } = match self.gpu.tuned(self.shape) {
                Some(choice) => choice,
                None => self.warm_up(&tuning, packed)?,
            };
            self.shape = Shape { lanes, budget, ..self.shape };
        }
        if self.settings.lanes.is_none() {
            // No more lanes than blocks.
            let blocks = walks.div_ceil(u64::from(BLOCK)).next_power_of_two();
            let group = self.shape.workgroup;
            self.shape.lanes = self.shape.lanes.min(blocks.min(1 << 30) as u32).next_multiple_of(group);
        }
        Ok(())
    }

    /// Time dispatches of more and more lanes.
    fn warm_up(&self, tuning: &Tuning, packed: &Packed) -> Result<Choice> {
        let starts = packed.incident.len();
        let walks = self.plan.first..self.plan.first + self.segment(starts);
        let mut shape = Shape { lanes: tuning.warm_up_lanes, trace: false, ..self.shape };
        loop {
            let session = self.session(shape, packed)?;
            session.restart(&params(self.tables, self.goniometer, self.plan, 0..starts, walks.clone()), 0);
            // The first dispatch compiles, the second is timed.
            session.dispatch()?;
            let started = Instant::now();
            let counters = session.dispatch()?;
            let seconds = started.elapsed().as_secs_f64();
            // Lanes that ran out of walks would make the device look faster than it is.
            if u64::from(counters.launched) >= (walks.end - walks.start) * starts as u64 {
                return Ok(Choice { lanes: shape.lanes, budget: shape.budget });
            }
            if seconds >= TELLING || 4 * shape.lanes > tuning.most_lanes {
                let longest = longest_budget(shape.flush_every, shape.channels, self.gpu.most_passes);
                let choice = tuning.choose(seconds / (f64::from(shape.lanes) * f64::from(shape.budget)), longest);
                self.gpu.tuned.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).insert(untuned(shape), choice);
                return Ok(choice);
            }
            shape.lanes *= 4;
        }
    }

    fn session(&self, shape: Shape, packed: &Packed) -> Result<Session<'a>> {
        let starts = packed.incident.len();
        let bins = starts * start_words(self.tables, self.goniometer);
        let traces = if shape.trace { self.segment(starts) as usize * self.goniometer.starts() } else { 0 };
        let pipeline = self.gpu.pipeline(shape)?;
        Session::new(&self.gpu.device, pipeline, shape, packed, bins, traces, self.settings.bins_preset)
    }

    fn run_batch(&mut self, starts: Range<usize>, packed: &Packed, progress: &mut dyn FnMut(&Tally)) -> Result<()> {
        let mut session = self.session(self.shape, packed)?;
        let segment = self.segment(starts.len());
        let end = self.plan.first + self.plan.walks_per_incident;
        let mut walk = self.plan.first;
        while walk < end {
            let walks = segment.min(end - walk);
            let mut params = params(self.tables, self.goniometer, self.plan, starts.clone(), walk..walk + walks);
            params.blocks = params.blocks.saturating_sub(self.settings.withheld_blocks);
            session.restart(&params, self.settings.sums_preset);
            self.run_segment(&mut session, starts.start, walks * starts.len() as u64, progress)?;
            if self.shape.trace {
                self.keep_traces(&session, starts.start, walk, walks)?;
            }
            walk += walks;
        }
        Ok(())
    }

    /// Dispatch until all walks of the segment have come to an end.
    fn run_segment(
        &mut self,
        session: &mut Session,
        first: usize,
        walks: u64,
        progress: &mut dyn FnMut(&Tally),
    ) -> Result<()> {
        let before = self.tally.counts;
        let mut last = Counters::default();
        let mut drained = Instant::now();
        // A walk may take this many dispatches before it is given up.
        let patience = u64::from(self.plan.max_events.div_ceil(self.shape.budget)) + 16;
        let mut idle = 0;
        while u64::from(last.finished) < walks {
            let now = session.dispatch()?;
            self.report.dispatches += 1;
            idle = if now.finished == last.finished { idle + 1 } else { 0 };
            if idle > patience {
                let message = format!("{} of {walks} walks came to an end and then no more", now.finished);
                return Err(Error::Account { engine: "gpu".into(), message });
            }
            last = now;
            self.tally.counts = before;
            self.tally.counts += counts(&now, self.settings.sums_preset);
            if drained.elapsed() > DRAIN || u64::from(now.finished) >= walks {
                session.drain(&mut self.tally, first)?;
                drained = Instant::now();
                progress(&self.tally);
            }
        }
        self.report.resumed += u64::from(last.resumed);
        Ok(())
    }

    fn keep_traces(&mut self, session: &Session, start: usize, first: u64, walks: u64) -> Result<()> {
        let stride = self.goniometer.starts();
        let offset = (first - self.plan.first) as usize * stride + start;
        for (slot, trace) in session.traces(walks as usize * stride)?.iter().enumerate() {
            if trace.counted > 1 {
                let message = format!("walk {} was counted {} times", offset + slot, trace.counted);
                return Err(Error::Account { engine: "gpu".into(), message });
            }
            if trace.counted == 1 {
                self.records[offset + slot] = WalkRecord { bin: trace.bin, events: trace.events, hits: trace.hits };
            }
        }
        Ok(())
    }
}
