//! Tables as the shaders read them.

use super::layout::FirstHit;
use crate::concentric::Patch;
use crate::distribution::direction_of;
use crate::goniometer::{Basis, Goniometer, Incidence, MOST_RINGS};
use crate::scene::{MAX_KINDS, Side};
use crate::tables::{CellEntry, Kind, SamplingTables};
use crate::walk::{FirstHits, widen};
use glam::DVec3;
use std::ops::Range;

/// One vector an entry: the patch, or its middle direction when there is no jitter, with the kind of fiber; w = alias and
/// threshold. Behind the entries of each list, for tracking by tables, H(m) at the corners of each cell of rays.
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
    let mut table = Vec::with_capacity(direction_entries(tables));
    for (index, list) in tables.lists.iter().enumerate() {
        let first = list.first as usize;
        let range = first..first + list.alias.words().len();
        let entries = tables.patches[range.clone()].iter().zip(&tables.entry_kinds[range]).zip(list.alias.words());
        table.extend(entries.map(entry));
        if let Some(visible) = &tables.visible {
            let cells = (0..visible.n).flat_map(|row| (0..visible.n).map(move |column| (column, row)));
            let corners = |(x, y)| [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
            table.extend(cells.map(|cell| corners(cell).map(|(x, y)| visible.node(index as u32, x, y).to_bits())));
        }
    }
    table
}

/// Vectors of the direction table.
pub fn direction_entries(tables: &SamplingTables) -> usize {
    tables.patches.len() + tables.lists.len() * visible_cells(tables) as usize
}

/// Cells of rays behind each list.
fn visible_cells(tables: &SamplingTables) -> u32 {
    tables.visible.as_ref().map_or(0, |visible| visible.n * visible.n)
}

/// One vector a cell: share (f32), placement factor (f32) or cut, first entry and index bits of its list, reach across and along.
pub fn cell_table(tables: &SamplingTables) -> Vec<[u32; 4]> {
    let factors = tables.carry.is_some_and(|carry| carry.factors);
    let entry = |cell: &CellEntry| {
        let list = &tables.lists[cell.list as usize];
        let share = (cell.share as f32).to_bits();
        let second = if factors { (cell.placement as f32).to_bits() } else { cell.cut.word() };
        let reach = u32::from(cell.reach.across) | u32::from(cell.reach.along) << 16;
        let first = list.first + cell.list * visible_cells(tables);
        [share, second, first | list.alias.index_bits() << 24, reach]
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

/// One vector a start: the incident cell's corner on the square and the sign of z, or wi when directions are listed; of rings
/// the first eighth of a turn, the least sin²θ and the extents of both.
pub fn incident_table(goniometer: &Goniometer) -> Vec<[f32; 4]> {
    let entry = |start: usize| match &goniometer.incidence {
        Incidence::Listed(_) => goniometer.centre(start).extend(0.0).as_vec4().to_array(),
        Incidence::Cells(Basis::Rings(basis)) => {
            let cell = start % basis.cells();
            let ring = basis.ring(cell);
            let width = 8.0 / f64::from(ring.sectors);
            let first = width * (cell as f64 - f64::from(ring.first) - ring.shift);
            [first, ring.edges[0], width, ring.edges[1] - ring.edges[0]].map(|value| value as f32)
        }
        Incidence::Cells(Basis::Disc(disc)) => {
            let corner = disc.patch(start % disc.cells()).corner;
            let sign = if goniometer.side(start) == Side::Front { 1.0 } else { -1.0 };
            [corner.x as f32, corner.y as f32, sign, 0.0]
        }
    };
    (0..goniometer.starts()).map(entry).collect()
}

/// The rays of some starts, with places as lanes have them.
pub fn first_hit_table(
    tables: &SamplingTables,
    goniometer: &Goniometer,
    first_hits: &FirstHits,
    starts: Range<usize>,
) -> Vec<FirstHit> {
    let each = first_hits.of_start;
    let entry = |(ray, start): (&crate::walk::FirstHit, usize)| {
        let [mx, my, mz] = ray.m;
        let Some(fiber) = ray.fiber else {
            return FirstHit { ray: [mx, my, mz, 0.0], place: [0.0; 4], fiber: [1.0, 0.0, 0.0, -1.0] };
        };
        let place = widen(fiber.place);
        let place = match &tables.cells {
            Some(cells) => (place + DVec3::Z * tables.thickness) / cells.grid.edges(),
            None if goniometer.side(start) == Side::Front => place,
            None => place + DVec3::Z * tables.thickness,
        };
        let [px, py, pz] = fiber.p;
        FirstHit {
            ray: [mx, my, mz, fiber.offset],
            place: place.extend(0.0).as_vec4().to_array(),
            fiber: [px, py, pz, fiber.kind as f32],
        }
    };
    starts
        .flat_map(|start| first_hits.rays[start * each..(start + 1) * each].iter().map(move |ray| (ray, start)))
        .map(entry)
        .collect()
}

/// One vector an exit ring: sin²θ of its outer edge, its first cell, its cells, its shift; rings that are none lie beyond
/// every direction.
pub fn ring_table(goniometer: &Goniometer) -> Vec<[f32; 4]> {
    let mut table = vec![[2.0, 0.0, 1.0, 0.0]; MOST_RINGS];
    if let Basis::Rings(basis) = &goniometer.exit {
        for (place, ring) in table.iter_mut().zip(basis.rings()) {
            *place = [ring.edges[1], f64::from(ring.first), f64::from(ring.sectors), ring.shift].map(|v| v as f32);
        }
    }
    table
}

/// The number of the incidence in the shaders.
pub fn incidence(goniometer: &Goniometer) -> u32 {
    match &goniometer.incidence {
        Incidence::Cells(Basis::Disc(_)) => 0,
        Incidence::Listed(_) => 1,
        Incidence::Cells(Basis::Rings(_)) => 2,
    }
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
