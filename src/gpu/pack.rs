//! Tables as the shaders read them.

use crate::concentric::Patch;
use crate::distribution::direction_of;
use crate::goniometer::{Goniometer, Incidence};
use crate::scene::{MAX_KINDS, Side};
use crate::tables::{CellEntry, Kind, SamplingTables};

/// One vector an entry: the patch, or its middle direction when there is no jitter, with the kind of fiber; w = alias and
/// threshold.
pub fn direction_table(tables: &SamplingTables, jitter: bool) -> Vec<[u32; 4]> {
    let entry = |((patch, kind), word): ((&Patch, &u8), &u32)| {
        let kind = u32::from(*kind);
        if jitter {
            let [x, y] = [patch.corner.x, patch.corner.y].map(|value| (value as f32).to_bits());
            [x, y, extents(patch, tables.patch_unit) | kind << 24, *word]
        } else {
            let [x, y, z] = direction_of(patch.centre()).to_array().map(|value| (value as f32).to_bits());
            [x, y, z & !3 | kind, *word]
        }
    };
    let words = tables.lists.iter().flat_map(|list| list.alias.words());
    tables.patches.iter().zip(&tables.entry_kinds).zip(words).map(entry).collect()
}

/// One vector a cell: share and placement factor (f32), first entry and index bits of its list, reach across and along.
pub fn cell_table(tables: &SamplingTables) -> Vec<[u32; 4]> {
    let entry = |cell: &CellEntry| {
        let list = &tables.lists[cell.list as usize];
        let [share, placement] = [cell.share, cell.placement].map(|value| (value as f32).to_bits());
        let reach = u32::from(cell.reach.across) | u32::from(cell.reach.along) << 16;
        [share, placement, list.first | list.alias.index_bits() << 24, reach]
    };
    tables.cells.iter().flat_map(|cells| &cells.entries).map(entry).collect()
}

/// Both extents in units, 12 bits each.
fn extents(patch: &Patch, unit: f64) -> u32 {
    let units = |extent: f64| {
        let units = (extent / unit).round();
        assert!((extent - units * unit).abs() < 1e-9 && units < 4096.0, "extent {extent} is not a multiple of {unit}");
        units as u32
    };
    units(patch.extent.x) | units(patch.extent.y) << 12
}

/// One vector a start: the incident cell's corner on the square and the sign of z, or wi when directions are listed.
pub fn incident_table(goniometer: &Goniometer) -> Vec<[f32; 4]> {
    let entry = |start: usize| match &goniometer.incidence {
        Incidence::Listed(_) => goniometer.centre(start).extend(0.0).as_vec4().to_array(),
        Incidence::Disc(disc) => {
            let corner = disc.patch(start % disc.cells()).corner;
            let sign = if goniometer.side(start) == Side::Front { 1.0 } else { -1.0 };
            [corner.x as f32, corner.y as f32, sign, 0.0]
        }
    };
    (0..goniometer.starts()).map(entry).collect()
}

/// Absorption by channel and kind, in 1/mm.
pub fn absorption_table(tables: &SamplingTables) -> Vec<[f32; 4]> {
    let channel = |channel: usize| by_kind(tables, |kind| kind.absorption[channel] as f32);
    (0..tables.channels()).map(channel).collect()
}

/// One number of each kind of fiber; kinds that are not there get 0.
pub fn by_kind(tables: &SamplingTables, number: impl Fn(&Kind) -> f32) -> [f32; 4] {
    let mut numbers = [0.0; MAX_KINDS];
    numbers.iter_mut().zip(&tables.kinds).for_each(|(place, kind)| *place = number(kind));
    numbers
}
