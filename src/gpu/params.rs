//! Numbers that go to the device before a run of dispatches, and sums that come back.

use super::layout::{BLOCK, Counters, Params};
use super::pack::by_kind;
use crate::goniometer::{Basis, Counts, Goniometer, Incidence};
use crate::scene::{MAX_KINDS, Side};
use crate::tables::SamplingTables;
use crate::walk::WalkPlan;
use glam::DVec3;
use std::ops::Range;

/// Parameters of walks `walks` of the starts `starts`.
pub fn params(
    tables: &SamplingTables,
    goniometer: &Goniometer,
    plan: &WalkPlan,
    starts: Range<usize>,
    walks: Range<u64>,
) -> Params {
    let halves = |value: u64| [value as u32, (value >> 32) as u32];
    let incident_edge = match &goniometer.incidence {
        Incidence::Cells(Basis::Disc(disc)) => 2.0 / f64::from(disc.n),
        Incidence::Cells(Basis::Rings(_)) | Incidence::Listed(_) => 0.0,
    };
    let exit_n = match &goniometer.exit {
        Basis::Disc(disc) => disc.n,
        Basis::Rings(basis) => basis.rings().len() as u32,
    };
    let (counts, per_edge) = tables.cells.as_ref().map_or((DVec3::ONE, DVec3::ONE), |cells| {
        (DVec3::from(cells.grid.counts.map(f64::from)), cells.grid.edges().recip())
    });
    let radius = tables.carry.map_or(0.0, |carry| carry.radius);
    let of_start = plan.first_hits.as_ref().map_or(0, |first_hits| first_hits.of_start as u64);
    let first_ray = if of_start > 0 { walks.start % of_start } else { 0 };
    let walk_count = (walks.end - walks.start) as u32;
    let mut kinds = [[0.0; 4]; MAX_KINDS];
    for (place, kind) in kinds.iter_mut().zip(&tables.kinds) {
        let ior = kind.ior;
        *place = [ior, 1.0 / ior, ior * ior - 1.0, kind.radius].map(|value| value as f32);
    }
    Params {
        seed: halves(plan.seed),
        base: halves(WalkPlan::walk_id(goniometer.starts(), walks.start, starts.start)),
        id_stride: goniometer.starts() as u32,
        starts: starts.len() as u32,
        front_starts: starts.clone().filter(|&start| goniometer.side(start) == Side::Front).count() as u32,
        walks: walk_count,
        blocks: starts.len() as u32 * walk_count.div_ceil(BLOCK),
        threshold_bits: 32 - tables.lists[0].alias.index_bits(),
        max_events: plan.max_events,
        exit_n,
        exit_cells: goniometer.exit.cells() as u32,
        start_words: start_words(tables, goniometer) as u32,
        mean_free_path: (1.0 / tables.majorant) as f32,
        thickness: tables.thickness as f32,
        patch_unit: tables.patch_unit as f32,
        incident_edge: incident_edge as f32,
        starts_reciprocal: (1.0 / starts.len() as f64) as f32,
        half_length: tables.half_length.min(1e9) as f32,
        kinds,
        clearest: by_kind(tables, |kind| kind.clearest() as f32),
        counts: counts.as_vec3().extend(0.0).to_array(),
        per_edge: per_edge.as_vec3().extend(0.0).to_array(),
        carry: (per_edge * radius).extend(radius).as_vec4().to_array(),
        first_hits: [of_start as u32, first_ray as u32, 0, 0],
    }
}

/// The number of the placement in the shaders.
pub fn placement(tables: &SamplingTables) -> u32 {
    tables.carry.map_or(0, |carry| 1 + u32::from(carry.factors))
}

/// Words that the device keeps for one start: numbers of walks by bin, then four words of moments by exit bin and
/// channel, the absorbed light last.
pub fn start_words(tables: &SamplingTables, goniometer: &Goniometer) -> usize {
    let layout = goniometer.layout();
    let moments = if tables.absorbing() { 4 * (2 * layout.exit_cells + 1) * tables.channels() } else { 0 };
    layout.stride() + moments
}

/// The sums of all lanes, joined from their words.
///
/// The low words started at `preset`.
pub fn counts(counters: &Counters, preset: u32) -> Counts {
    let join = |high: u32, low: u32| (u64::from(high) << 32 | u64::from(low)).wrapping_sub(u64::from(preset));
    Counts {
        launched: u64::from(counters.launched),
        finished: u64::from(counters.finished),
        tentative_events: join(counters.tentative_high, counters.tentative_low),
        collisions: join(counters.collisions_high, counters.collisions_low),
        base_exits: join(counters.base_exits_high, counters.base_exits_low),
    }
}
