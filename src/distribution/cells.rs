//! The periodic element of a cloth, cut into cells.

use glam::{DVec2, DVec3};

/// A grid of cells over one repeat, periodic in x and y, from the back (z = −thickness) to the front (z = 0).
///
/// Cell (ix, iy, iz) has the index (iz·ny + iy)·nx + ix; ix counts from x = 0, iz from the back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellGrid {
    /// Cells along x, y and z, each at least 1.
    pub counts: [u32; 3],
    /// Size of the repeat along x and y in mm.
    pub period: DVec2,
    /// Thickness of the cloth in mm.
    pub thickness: f64,
}

impl CellGrid {
    /// One cell, of a cloth that is the same everywhere; its repeat is as wide as it is thick.
    pub fn homogeneous(thickness: f64) -> CellGrid {
        CellGrid { counts: [1; 3], period: DVec2::splat(thickness), thickness }
    }

    /// Cells in all.
    pub fn len(&self) -> usize {
        self.counts.iter().map(|count| *count as usize).product()
    }

    /// Never: a grid has a cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Edges of a cell in mm.
    pub fn edges(&self) -> DVec3 {
        let [nx, ny, nz] = self.counts.map(f64::from);
        DVec3::new(self.period.x / nx, self.period.y / ny, self.thickness / nz)
    }

    /// The index of a cell.
    pub fn index(&self, [ix, iy, iz]: [u32; 3]) -> usize {
        let [nx, ny, _] = self.counts.map(|count| count as usize);
        (iz as usize * ny + iy as usize) * nx + ix as usize
    }

    /// The index of the cell that holds a point; none beyond the faces.
    pub fn at(&self, point: DVec3) -> Option<usize> {
        let from = (point + DVec3::Z * self.thickness) / self.edges();
        let [nx, ny, nz] = self.counts.map(i64::from);
        let [ix, iy, iz] = from.floor().as_i64vec3().to_array();
        let place = [ix.rem_euclid(nx), iy.rem_euclid(ny), iz].map(|at| at as u32);
        (0..nz).contains(&iz).then(|| self.index(place))
    }

    /// The places of the cells, in the order of their indices.
    pub fn places(&self) -> impl Iterator<Item = [u32; 3]> + use<> {
        let [nx, ny, nz] = self.counts;
        (0..nz).flat_map(move |iz| (0..ny).flat_map(move |iy| (0..nx).map(move |ix| [ix, iy, iz])))
    }
}

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Σ R F over the kinds of fiber, half the rate of tentative events, in 1/mm; 0 for an empty cell.
    pub surface: f64,
    /// Factor of the rate that depends on where a flight starts; 1 when it starts at the hit.
    pub placement: f64,
    /// Index of its list of bundles; of no meaning in an empty cell.
    pub list: u32,
    /// Mean place of its fibers, by R·length, from 0 to 1 along each axis.
    pub centroid: [f32; 3],
}

impl Cell {
    /// The mean place of fibers that lie all over a cell.
    pub const MIDDLE: [f32; 3] = [0.5; 3];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_come_in_the_order_of_their_indices() {
        let grid = CellGrid { counts: [3, 4, 2], period: DVec2::new(3.0, 2.0), thickness: 0.5 };
        assert_eq!(grid.len(), 24);
        assert!(grid.places().enumerate().all(|(i, place)| grid.index(place) == i));
        assert_eq!(grid.index([2, 1, 1]), 17);
        assert_eq!(grid.edges(), DVec3::new(1.0, 0.5, 0.25));
    }
}
