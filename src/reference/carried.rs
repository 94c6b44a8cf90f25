//! Flights that start where light leaves a fiber: a hit belongs to the cell that holds the fiber's axis.

use super::cells::Station;
use super::flight::{Event, Flight};
use super::medium::free_path;
use super::walk::Witness;
use crate::distribution::CellGrid;
use crate::tables::{Carry, CellEntry, Cells, SamplingTables};
use crate::walk::EventDraws;
use glam::DVec3;
use std::f64::consts::FRAC_PI_4;

/// A fiber that a ray would touch, and where.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// Direction of the ray.
    pub m: DVec3,
    /// Direction of the fiber.
    pub p: DVec3,
    /// Offset α of the ray from the axis, in radii.
    pub offset: f64,
    /// Radius of the fiber in mm.
    pub radius: f64,
}

impl Touch {
    /// From the axis to the hit, R n (paper §4); nothing where the ray runs along the fiber.
    pub(super) fn normal(&self) -> Option<DVec3> {
        let Touch { m, p, offset, radius } = *self;
        let across = m.cross(p);
        let length = across.length();
        let facing = p * m.dot(p) - m;
        (length > 0.0).then(|| radius / length * ((1.0 - offset * offset).sqrt() * facing + offset * across))
    }
}

impl Flight {
    /// Null collisions on the surfaces of fibers: come into the slab, fly at the rate of the majorant, take the list about
    /// where the axis would be.
    pub(super) fn tentative_carried(
        &mut self,
        tables: &SamplingTables,
        carry: &Carry,
        grid: &CellGrid,
        m: DVec3,
        draws: &EventDraws,
        witness: &mut impl Witness,
    ) -> Event {
        let slab = [-tables.thickness - carry.radius, carry.radius];
        let shift = m * (FRAC_PI_4 * carry.radius);
        let (begin, station) = (self.station, &mut self.station);
        let mut path = 0.0;
        if let Some(cells) = tables.cells.as_ref().filter(|_| !self.left_fiber) {
            path += station.skip_clear(cells, carry.radius, m, shift, witness);
        }
        self.left_fiber = false;
        path += station.enter(slab, m, witness);
        let free = free_path(tables, draws);
        station.fly(grid, m, free);
        if let Some(memory) = &mut self.memory {
            let (path, known) = memory.fly(path + free, station.blur, witness);
            if let Some(known) = known {
                *station = begin;
                station.fly(grid, m, path);
                witness.magnify(|| known.growth);
                return Event::Known(known);
            }
        }
        let z = station.place.z;
        witness.decide(|| (z - slab[0]).abs().min((z - slab[1]).abs()) / tables.thickness);
        if z < slab[0] || z > slab[1] {
            return Event::Left;
        }
        let Some(cells) = &tables.cells else { return Event::Fiber { share: 1.0, list: 0 } };
        let share = if carry.factors {
            witness.decide(|| station.face_distance(grid));
            station.entry_at(cells, DVec3::ZERO).placement
        } else {
            1.0
        };
        let about = Station { place: station.place + shift, ..*station };
        witness.decide(|| about.face_distance(grid));
        Event::Fiber { share, list: station.entry_at(cells, shift).list }
    }

    /// The share of the majorant's events that the cell of a fiber's axis takes, if the ray touches the fiber here.
    pub(super) fn share_of_axis(
        &self,
        tables: &SamplingTables,
        grid: &CellGrid,
        touch: &Touch,
        witness: &mut impl Witness,
    ) -> f64 {
        let Some(normal) = touch.normal() else { return 0.0 };
        let axis = Station { place: self.station.place - normal, ..self.station };
        let z = axis.place.z;
        witness.decide(|| z.abs().min((z + tables.thickness).abs()) / tables.thickness);
        // Beyond the faces there is no fiber.
        if z > 0.0 || z < -tables.thickness {
            return 0.0;
        }
        let Some(cells) = &tables.cells else { return 1.0 };
        witness.decide(|| axis.face_distance(grid));
        let (cell, wrapped) = self.station.unfolded(grid, -normal);
        let CellEntry { share, cut, .. } = cells.entries[grid.index(wrapped)];
        let within = (axis.place + DVec3::Z * grid.thickness) / grid.edges() - cell;
        witness.decide(|| cut.distance(within) * grid.edges().min_element() / axis.blur);
        if cut.holds(within) { share } else { 0.0 }
    }

    /// The light goes on along `out` from where it has left a fiber, this far from where it hit it.
    pub(super) fn carry(
        &mut self,
        touch: &Touch,
        kind: usize,
        displacement: DVec3,
        out: DVec3,
        witness: &mut impl Witness,
    ) {
        self.station.place += displacement;
        self.left_fiber = true;
        let z = self.station.place.z;
        if let Some(memory) = &mut self.memory {
            memory.hit(touch, kind, displacement, (z, out), witness);
        }
    }
}

impl Station {
    /// The cell that lies this far from here; beyond the faces the nearest.
    fn entry_at<'a>(&self, cells: &'a Cells, shift: DVec3) -> &'a CellEntry {
        &cells.entries[cells.grid.index(self.unfolded(&cells.grid, shift).1)]
    }

    /// Numbers of the cell that lies this far from here, before and after they come back into the repeat.
    fn unfolded(&self, grid: &CellGrid, shift: DVec3) -> (DVec3, [u32; 3]) {
        let from = self.place + shift + DVec3::Z * grid.thickness;
        let mut cell = (from / grid.edges()).floor();
        cell.z = cell.z.clamp(0.0, f64::from(grid.counts[2] - 1));
        let wrapped = [0, 1, 2].map(|axis| {
            let count = f64::from(grid.counts[axis]);
            if axis == 2 { cell.z as u32 } else { cell[axis].rem_euclid(count) as u32 }
        });
        (cell, wrapped)
    }

    /// A ray that comes back to the cloth flies straight to where fibers can be hit: how far.
    fn enter(&mut self, slab: [f64; 2], m: DVec3, witness: &mut impl Witness) -> f64 {
        let z = self.place.z;
        let face = if z > slab[1] { slab[1] } else { slab[0] };
        if z <= slab[1] && z >= slab[0] {
            return 0.0;
        }
        witness.decide(|| m.z);
        if (face - z) * m.z <= 0.0 {
            return 0.0;
        }
        let path = (face - z) / m.z;
        self.place += m * path;
        self.place.z = face;
        self.blur = self.blur.max(path / m.z.abs());
        path
    }

    /// Jump to where the ray comes within a radius of the end of the block of empty cells about here, if the place is
    /// farther inside than that: how far.
    fn skip_clear(&mut self, cells: &Cells, radius: f64, m: DVec3, shift: DVec3, witness: &mut impl Witness) -> f64 {
        let grid = &cells.grid;
        let (cell, wrapped) = self.unfolded(grid, shift);
        let reach = cells.entries[grid.index(wrapped)].reach;
        if reach.across == 0 {
            return 0.0;
        }
        let block = DVec3::from([reach.across, reach.across, reach.along].map(f64::from));
        let edges = grid.edges();
        let back = DVec3::Z * grid.thickness;
        let mut low = (cell + 1.0 - block) * edges - back + radius;
        let mut high = (cell + block) * edges - back - radius;
        let mut inside = (self.place - low).min(high - self.place);
        // Beyond the faces all is empty, and no flight sets out from beyond the slab.
        let below = cell.z + 1.0 - block.z <= 0.0;
        let above = cell.z + block.z >= f64::from(grid.counts[2]);
        if below {
            low.z = -grid.thickness - radius;
            inside.z = high.z - self.place.z;
        }
        if above {
            inside.z = if below { f64::INFINITY } else { self.place.z - low.z };
            high.z = radius;
        }
        witness.decide(|| inside.abs().min_element() / self.blur);
        if inside.min_element() < 0.0 {
            return 0.0;
        }
        let face = DVec3::select(m.cmpgt(DVec3::ZERO), high, low);
        let path = |axis: usize| if m[axis] == 0.0 { f64::INFINITY } else { (face[axis] - self.place[axis]) / m[axis] };
        let first = (0..3).min_by(|a, b| path(*a).total_cmp(&path(*b))).unwrap_or_default();
        let path = path(first);
        self.place += m * path;
        self.place[first] = face[first];
        self.blur = self.blur.max(path / m[first].abs());
        path
    }
}
