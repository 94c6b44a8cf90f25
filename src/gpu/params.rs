//! Numbers that go to the device before a run of dispatches, and sums that come back.

use super::layout::{BLOCK, Counters, Params};
use crate::goniometer::{Counts, Goniometer, Incidence};
use crate::tables::SamplingTables;
use crate::walk::WalkPlan;
use std::ops::Range;

/// Parameters of walks `walks` of the incident cells `cells`.
pub fn params(
    tables: &SamplingTables,
    goniometer: &Goniometer,
    plan: &WalkPlan,
    cells: Range<usize>,
    walks: Range<u64>,
) -> Params {
    let halves = |value: u64| [value as u32, (value >> 32) as u32];
    let stride = goniometer.incident_cells();
    let incident_edge = match &goniometer.incidence {
        Incidence::Disc(disc) => 2.0 / f64::from(disc.n),
        Incidence::Listed(_) => 0.0,
    };
    let walk_count = (walks.end - walks.start) as u32;
    Params {
        seed: halves(plan.seed),
        base: halves(WalkPlan::walk_id(stride, walks.start, cells.start)),
        id_stride: stride as u32,
        cells: cells.len() as u32,
        walks: walk_count,
        blocks: cells.len() as u32 * walk_count.div_ceil(BLOCK),
        threshold_bits: 32 - tables.alias.index_bits(),
        max_events: plan.max_events,
        exit_n: goniometer.exit.n,
        exit_cells: goniometer.exit.cells() as u32,
        mean_free_path: (1.0 / tables.majorant) as f32,
        thickness: tables.thickness as f32,
        ior: tables.ior as f32,
        ior_reciprocal: (1.0 / tables.ior) as f32,
        ior_square_less_1: (tables.ior * tables.ior - 1.0) as f32,
        patch_unit: tables.patch_unit as f32,
        incident_edge: incident_edge as f32,
        cells_reciprocal: (1.0 / cells.len() as f64) as f32,
    }
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
    }
}
