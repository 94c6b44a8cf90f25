//! Flights to the next collision, by null collisions or by the table of H(m) (paper §4).

use super::cells::Station;
use super::medium::free_path;
use super::memory::{Known, Memory};
use super::walk::Witness;
use crate::distribution::CellGrid;
use crate::tables::{SamplingTables, VisibleArea};
use crate::walk::{EventDraws, MOST_REFUSALS};
use glam::DVec3;

/// A walk between two hits.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    /// Where it is.
    pub station: Station,
    /// Optical depth that is left until the collision; none before a flight sets out.
    depth: Option<f64>,
    /// Largest rate of collisions that this flight has met, in 1/mm.
    densest: f64,
    /// Fibers that were refused at the collision so far; none on the way to it.
    refused: u32,
    /// The flight starts on the surface of a fiber, where nothing is known of the cells about.
    pub(super) left_fiber: bool,
    /// What the walk remembers, if it does.
    pub(super) memory: Option<Memory>,
}

/// What one event brings.
#[derive(Clone, Copy, Debug)]
pub(super) enum Event {
    /// The light has left the cloth.
    Left,
    /// The ray has come to the face of a cell.
    Passed,
    /// A fiber of this list is to be drawn, and hit with probability `share` |m × p|; when light is carried through fibers,
    /// times the share of the axis's cell.
    Fiber { share: f64, list: u32 },
    /// The ray has come to a fiber that is known to be there.
    Known(Known),
}

impl Flight {
    /// A walk that sets out from a station.
    pub fn new(station: Station, memory: Option<Memory>) -> Flight {
        Flight { station, depth: None, densest: 0.0, refused: 0, left_fiber: false, memory }
    }

    /// Fly on through one event.
    pub(super) fn event(
        &mut self,
        tables: &SamplingTables,
        grid: &CellGrid,
        m: DVec3,
        draws: &EventDraws,
        witness: &mut impl Witness,
    ) -> Event {
        match (&tables.visible, &tables.carry) {
            (Some(visible), _) => self.march(tables, visible, grid, m, draws, witness),
            (None, None) => self.tentative(tables, grid, m, draws, witness),
            (None, Some(carry)) => self.tentative_carried(tables, carry, grid, m, draws, witness),
        }
    }

    /// A fiber was drawn at the collision: it was hit, or refused.
    pub fn drawn(&mut self, hit: bool) {
        self.refused += 1;
        // Where all fibers are nearly parallel to the ray, the table's H is its error: give the collision up.
        if hit || self.refused >= MOST_REFUSALS {
            (self.depth, self.densest, self.refused) = (None, 0.0, 0);
        }
    }

    /// Null collisions: fly at the rate of the majorant.
    fn tentative(
        &mut self,
        tables: &SamplingTables,
        grid: &CellGrid,
        m: DVec3,
        draws: &EventDraws,
        witness: &mut impl Witness,
    ) -> Event {
        let station = &mut self.station;
        if let Some(cells) = &tables.cells {
            station.skip_empty(cells, m);
        }
        station.fly(grid, m, free_path(tables, draws));
        let z = station.place.z;
        witness.decide(|| z.abs().min((z + tables.thickness).abs()) / tables.thickness);
        if z > 0.0 || z < -tables.thickness {
            return Event::Left;
        }
        match &tables.cells {
            None => Event::Fiber { share: 1.0, list: 0 },
            Some(cells) => {
                witness.decide(|| station.face_distance(grid));
                let cell = station.look_up(cells);
                Event::Fiber { share: cell.share, list: cell.list }
            }
        }
    }

    /// The paper: exponential optical depth, marched from cell to cell; a jump over empty cells is one step.
    fn march(
        &mut self,
        tables: &SamplingTables,
        visible: &VisibleArea,
        grid: &CellGrid,
        m: DVec3,
        draws: &EventDraws,
        witness: &mut impl Witness,
    ) -> Event {
        let cell = self.station.cell_ahead(grid, m);
        let (share, list, reach) = match &tables.cells {
            // A sheet has no faces across x and y.
            None => (1.0, 0, [i64::from(u32::MAX), i64::from(u32::MAX), 1]),
            Some(cells) => {
                let entry = &cells.entries[grid.index(cell)];
                let across = i64::from(entry.reach.across.max(1));
                (entry.share, entry.list, [across, across, i64::from(entry.reach.along.max(1))])
            }
        };
        if self.refused == 0 {
            if self.depth.is_none() && tables.cells.is_some() {
                witness.decide(|| self.station.face_distance(grid).min(self.station.distance_beside(grid, 2)));
            }
            let depth = *self.depth.get_or_insert(draws.free_path);
            let rate = tables.majorant * share * visible.look_up(list, m);
            self.densest = self.densest.max(rate);
            let face = self.station.face_ahead(grid, cell, reach, m);
            // There is no collision in an empty cell, even where no depth is left.
            let free = if rate > 0.0 { depth / rate } else { f64::INFINITY };
            if share > 0.0 {
                witness.decide(|| (free - face.path) * m[face.axis] / self.station.blur);
                witness.decide(|| depth - rate * face.path);
            }
            if free >= face.path {
                self.depth = Some((depth - rate * face.path).max(0.0));
                let out = self.station.pass(grid, m, &face);
                if tables.cells.is_some() {
                    witness.decide(|| self.station.distance_beside(grid, face.axis));
                }
                return if out { Event::Left } else { Event::Passed };
            }
            self.station.place += m * free;
            // An error of the place is one of the depth where fibers are dense, and a larger one of the place where they are
            // sparse.
            self.station.blur = (self.station.blur.max(free) * self.densest / rate).max(1.0 / rate);
        }
        Event::Fiber { share: 1.0, list }
    }
}
