//! Drawing fibers from the medium (paper §4).

use crate::distribution::direction_of;
use crate::tables::SamplingTables;
use crate::walk::EventDraws;
use glam::{DVec2, DVec3};

/// Distance along the ray to the next tentative event, in mm: exponential at the rate of the majorant (paper §4).
pub fn free_path(tables: &SamplingTables, draws: &EventDraws) -> f64 {
    draws.free_path / tables.majorant
}

/// The direction p and the kind of the fiber at a tentative event in a cell with this list, drawn together with weight
/// R f.
pub fn draw_fiber(tables: &SamplingTables, list: u32, draws: &EventDraws, jitter: bool) -> (DVec3, usize) {
    let entry = tables.draw_entry(list, draws.entry);
    let place = if jitter { draws.jitter } else { DVec2::splat(0.5) };
    (direction_of(tables.patches[entry].at(place)), usize::from(tables.entry_kinds[entry]))
}
