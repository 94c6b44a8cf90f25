//! Places in the periodic grid of cells, and flights over empty ones.

use super::walk::Witness;
use crate::distribution::CellGrid;
use crate::tables::{CellEntry, Cells};
use crate::walk::JUMPS;
use glam::DVec3;

/// A ray on its way through the cells.
#[derive(Clone, Copy, Debug)]
pub struct Station {
    /// x and y inside the repeat, z from the front downwards, in mm.
    pub place: DVec3,
    /// On which scale errors of the place have grown so far, in mm.
    pub blur: f64,
}

impl Station {
    /// A place where a walk sets out.
    pub fn start(grid: &CellGrid, place: DVec3) -> Station {
        Station { place, blur: grid.period.max_element().max(grid.thickness) }
    }

    /// Fly straight on and come back into the repeat.
    pub fn fly(&mut self, grid: &CellGrid, m: DVec3, path: f64) {
        self.place += m * path;
        self.blur = self.blur.max(path);
        self.place.x = self.place.x.rem_euclid(grid.period.x);
        self.place.y = self.place.y.rem_euclid(grid.period.y);
    }

    /// The cell here.
    pub fn cell(&self, grid: &CellGrid, witness: &mut impl Witness) -> [u32; 3] {
        witness.decide(|| self.face_distance(grid, None));
        [0, 1, 2].map(|axis| clamped(coordinate(grid, self.place, axis).floor() as i64, grid, axis))
    }

    /// What the cell here holds.
    pub fn look_up<'a>(&self, cells: &'a Cells, witness: &mut impl Witness) -> &'a CellEntry {
        &cells.entries[cells.grid.index(self.cell(&cells.grid, witness))]
    }

    /// Jump over empty cells: from block to block, a fixed number of times.
    pub fn skip_empty(&mut self, cells: &Cells, m: DVec3, witness: &mut impl Witness) {
        let grid = &cells.grid;
        let edges = grid.edges();
        let mut cell = self.cell(grid, witness);
        for _ in 0..JUMPS {
            let reach = cells.entries[grid.index(cell)].reach;
            let outside = self.place.z > 0.0 || self.place.z < -grid.thickness;
            if reach.across == 0 || outside {
                return;
            }
            let reach = [reach.across, reach.across, reach.along].map(i64::from);
            // Find the face of the block through which the ray leaves.
            let mut nearest = (f64::INFINITY, 0, 0.0, 0);
            for axis in 0..3 {
                let next = i64::from(cell[axis]) + if m[axis] > 0.0 { reach[axis] } else { -reach[axis] };
                let lowest = if axis == 2 { -grid.thickness } else { 0.0 };
                let face = lowest + edges[axis] * (next + i64::from(m[axis] <= 0.0)) as f64;
                let distance = (face - self.place[axis]) / m[axis];
                if m[axis] != 0.0 && distance < nearest.0 {
                    nearest = (distance, axis, face, next);
                }
            }
            let (distance, axis, face, next) = nearest;
            self.place += m * distance;
            self.place[axis] = face;
            // A face that the ray meets at a flat angle blurs where it does.
            self.blur = self.blur.max(distance / m[axis].abs());
            witness.decide(|| self.face_distance(grid, Some(axis)));
            for other in 0..3 {
                let index = if other == axis { next } else { coordinate(grid, self.place, other).floor() as i64 };
                if other < 2 {
                    let count = i64::from(grid.counts[other]);
                    self.place[other] -= grid.period[other] * index.div_euclid(count) as f64;
                    cell[other] = index.rem_euclid(count) as u32;
                } else {
                    cell[other] = clamped(index, grid, other);
                }
            }
        }
    }

    /// Distance to the nearest face between two cells, on the scale of the place's error; a face that the ray stands on
    /// by construction does not count.
    fn face_distance(&self, grid: &CellGrid, stands_on: Option<usize>) -> f64 {
        let distance = |axis: usize| {
            let coordinate = coordinate(grid, self.place, axis);
            let nearest = coordinate.round();
            let outer = axis == 2 && (nearest <= 0.0 || nearest >= f64::from(grid.counts[2]));
            let between = grid.counts[axis] > 1 && !outer && stands_on != Some(axis);
            if between { (coordinate - nearest).abs() * grid.edges()[axis] } else { f64::INFINITY }
        };
        [0, 1, 2].map(distance).into_iter().fold(f64::INFINITY, f64::min) / self.blur
    }
}

/// A coordinate in cells from x = 0, y = 0, z = −thickness.
fn coordinate(grid: &CellGrid, place: DVec3, axis: usize) -> f64 {
    let from = if axis == 2 { place.z + grid.thickness } else { place[axis] };
    from / grid.edges()[axis]
}

fn clamped(index: i64, grid: &CellGrid, axis: usize) -> u32 {
    index.clamp(0, i64::from(grid.counts[axis]) - 1) as u32
}
