//! Cells of the concentric map.

use crate::concentric::{Patch, disc_to_square, square_to_disc};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// `n` × `n` cells of the square that the concentric map gives from the projected unit disc.
///
/// Column ⌊n(a+1)/2⌋, row ⌊n(b+1)/2⌋, index row·n + column. Every cell has projected solid angle π/n².
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DiscBasis {
    /// Cells along an edge of the square.
    pub n: u32,
}

impl DiscBasis {
    /// Number of cells.
    pub fn cells(&self) -> usize {
        (self.n * self.n) as usize
    }

    /// Projected solid angle of one cell in sr.
    pub fn projected_solid_angle(&self) -> f64 {
        PI / self.cells() as f64
    }

    /// The place of the projection (x, y) on the square, in cells: the integer parts are column and row.
    pub fn place(&self, projection: DVec2) -> DVec2 {
        (disc_to_square(projection) + 1.0) * (f64::from(self.n) / 2.0)
    }

    /// The cell that holds a direction, by its projection (x, y).
    pub fn cell_of(&self, projection: DVec2) -> usize {
        let place = self.place(projection);
        let along = |t: f64| (t as u32).min(self.n - 1);
        (along(place.y) * self.n + along(place.x)) as usize
    }

    /// The part of the square that is one cell.
    pub fn patch(&self, cell: usize) -> Patch {
        let cell = cell as u32;
        Patch::cell(self.n, cell % self.n, cell / self.n)
    }

    /// The unit vector, z ≥ 0, at a place inside a cell; a place is in [0, 1]².
    pub fn direction(&self, cell: usize, place: DVec2) -> DVec3 {
        let disc = square_to_disc(self.patch(cell).at(place));
        disc.extend((1.0 - disc.length_squared()).max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_lies_in_the_cell_it_was_made_from() {
        let disc = DiscBasis { n: 7 };
        for cell in 0..disc.cells() {
            for place in [DVec2::new(0.01, 0.99), DVec2::splat(0.5), DVec2::new(0.7, 0.02)] {
                let direction = disc.direction(cell, place);
                assert!((direction.length() - 1.0).abs() < 1e-12);
                assert_eq!(disc.cell_of(direction.truncate()), cell);
            }
        }
    }

    #[test]
    fn cells_count_from_negative_x_and_y() {
        let disc = DiscBasis { n: 4 };
        assert_eq!(disc.cell_of(DVec2::new(-0.9, -0.3)), 4);
        assert_eq!(disc.cell_of(DVec2::new(0.9, -0.3)), 7);
        assert_eq!(disc.cell_of(DVec2::new(0.3, 0.9)), 14);
    }
}
