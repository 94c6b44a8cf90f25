//! Places in the periodic grid of cells, and flights over empty ones.

use crate::distribution::CellGrid;
use crate::tables::{CellEntry, Cells};
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
        self.come_back(grid);
    }

    /// Bring the place back into the repeat.
    fn come_back(&mut self, grid: &CellGrid) {
        self.place.x = self.place.x.rem_euclid(grid.period.x);
        self.place.y = self.place.y.rem_euclid(grid.period.y);
    }

    /// The cell here.
    fn cell(&self, grid: &CellGrid) -> [u32; 3] {
        [0, 1, 2].map(|axis| {
            let last = f64::from(grid.counts[axis] - 1);
            coordinate(grid, self.place, axis).floor().clamp(0.0, last) as u32
        })
    }

    /// What the cell here holds.
    pub fn look_up<'a>(&self, cells: &'a Cells) -> &'a CellEntry {
        &cells.entries[cells.grid.index(self.cell(&cells.grid))]
    }

    /// The cell that a ray from here goes through: on a face, the one ahead.
    pub fn cell_ahead(&mut self, grid: &CellGrid, m: DVec3) -> [u32; 3] {
        [0, 1, 2].map(|axis| {
            let coordinate = coordinate(grid, self.place, axis);
            // The coordinate of a face is a whole number up to rounding.
            let nearest = coordinate.round();
            let on_face = (coordinate - nearest).abs() <= 1e-12 * (1.0 + nearest.abs());
            let here = if !on_face {
                coordinate.floor()
            } else if m[axis] < 0.0 {
                nearest - 1.0
            } else {
                nearest
            };
            let count = f64::from(grid.counts[axis]);
            let cell = if axis == 2 { here.clamp(0.0, count - 1.0) } else { here.rem_euclid(count) };
            // Follow the cell into the repeat; a face stays a face.
            if axis < 2 && on_face {
                self.place[axis] = (cell + nearest - here) * grid.edges()[axis];
            } else if axis < 2 && cell != here {
                self.place[axis] += (cell - here) * grid.edges()[axis];
            }
            cell as u32
        })
    }

    /// The face through which a ray leaves the block of cells that lie less than `reach` from a cell, or the cloth.
    pub fn face_ahead(&self, grid: &CellGrid, cell: [u32; 3], reach: [i64; 3], m: DVec3) -> Face {
        let face = |axis: usize| {
            let beyond = i64::from(cell[axis]) + if m[axis] > 0.0 { reach[axis] } else { 1 - reach[axis] };
            // Beyond its faces there is no cloth.
            let beyond = if axis == 2 { beyond.clamp(0, i64::from(grid.counts[2])) } else { beyond };
            let at = beyond as f64 * grid.edges()[axis] - if axis == 2 { grid.thickness } else { 0.0 };
            Face { axis, at, path: ((at - self.place[axis]) / m[axis]).max(0.0) }
        };
        let ahead = [0, 1, 2].into_iter().filter(|axis| m[*axis] != 0.0).map(face);
        let none = Face { axis: 0, at: self.place.x, path: f64::INFINITY };
        ahead.min_by(|a, b| a.path.total_cmp(&b.path)).unwrap_or(none)
    }

    /// Distance to the nearest face that does not stand across an axis, on the scale of the place's error.
    pub fn distance_beside(&self, grid: &CellGrid, axis: usize) -> f64 {
        let distance = |other: usize| {
            let coordinate = coordinate(grid, self.place, other);
            (coordinate - coordinate.round()).abs() * grid.edges()[other]
        };
        let others = (0..3).filter(|other| *other != axis);
        others.map(distance).fold(f64::INFINITY, f64::min) / self.blur
    }

    /// Go to a face; whether it is that of the cloth.
    pub fn pass(&mut self, grid: &CellGrid, m: DVec3, face: &Face) -> bool {
        self.place += m * face.path;
        self.place[face.axis] = face.at;
        self.blur = self.blur.max(face.path / m[face.axis].abs());
        let half = 0.5 * grid.edges().z;
        face.axis == 2 && (face.at > -half && m.z > 0.0 || face.at < half - grid.thickness && m.z < 0.0)
    }

    /// Jump over the block of empty cells around the place, if there is one, on to its face.
    pub fn skip_empty(&mut self, cells: &Cells, m: DVec3) {
        let grid = &cells.grid;
        let cell = self.cell(grid);
        let reach = cells.entries[grid.index(cell)].reach;
        if reach.across == 0 {
            return;
        }
        // Find the face of the block through which the ray leaves.
        let face = |axis: usize| {
            let reach = i64::from([reach.across, reach.across, reach.along][axis]);
            let beyond = i64::from(cell[axis]) + if m[axis] > 0.0 { reach } else { 1 - reach };
            beyond as f64 * grid.edges()[axis] - if axis == 2 { grid.thickness } else { 0.0 }
        };
        let distance = |axis: usize| (face(axis) - self.place[axis]) / m[axis];
        let ahead = [0, 1, 2].into_iter().filter(|axis| m[*axis] != 0.0);
        let Some(first) = ahead.min_by(|a, b| distance(*a).total_cmp(&distance(*b))) else { return };
        let (path, at) = (distance(first), face(first));
        self.place += m * path;
        self.place[first] = at;
        // Where a ray meets a face at a flat angle, an error of its direction moves the place further.
        self.blur = self.blur.max(path / m[first].abs());
    }

    /// Distance to the nearest face between two cells, on the scale of the place's error.
    pub fn face_distance(&self, grid: &CellGrid) -> f64 {
        let distance = |axis: usize| {
            let coordinate = coordinate(grid, self.place, axis);
            let nearest = coordinate.round();
            let outer = axis == 2 && (nearest <= 0.0 || nearest >= f64::from(grid.counts[2]));
            let between = grid.counts[axis] > 1 && !outer;
            if between { (coordinate - nearest).abs() * grid.edges()[axis] } else { f64::INFINITY }
        };
        [0, 1, 2].map(distance).into_iter().fold(f64::INFINITY, f64::min) / self.blur
    }
}

/// A face between cells, ahead of a ray.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// The axis that it stands across.
    pub axis: usize,
    /// Where, in mm.
    pub at: f64,
    /// How far along the ray, in mm.
    pub path: f64,
}

/// A coordinate in cells from x = 0, y = 0, z = −thickness.
fn coordinate(grid: &CellGrid, place: DVec3, axis: usize) -> f64 {
    let from = if axis == 2 { place.z + grid.thickness } else { place[axis] };
    from / grid.edges()[axis]
}
