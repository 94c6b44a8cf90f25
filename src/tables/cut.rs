//! Cells that fibers fill in part: the half-space of a cell that holds its fibers.
//!
//! The rim of a yarn runs through cells. Where fibers are spread over the whole of such a cell they close gaps that are open and open
//! yarns that are closed. A plane that leaves the mean place of the fibers where it was counted puts them back (the moment-of-fluid
//! method of Dyadechko and Shashkov, 2005, for interfaces in fluids).

use crate::distribution::{Cell, CellGrid};
use glam::DVec3;
use rayon::prelude::*;

/// A mean place that is nearer to the middle of the cell is taken for the middle, in edges.
const LEAST: f64 = 0.02;
/// The largest component of a normal, in whole numbers.
const STEPS: f64 = 31.0;
/// Units of the offset.
const PARTS: f64 = 64.0;
/// Rounds that turn the normal, and halvings of the offset in each.
const TURNS: usize = 5;
const HALVINGS: usize = 16;
/// The least component of a normal beside the largest: others are rounded to it.
const FLAT: f64 = 1e-3;

/// A half-space of the unit cube: points u with normal·u ≤ offset/64.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Out of the half-space, whole numbers from −31 to 31; 0 where the whole cell is filled.
    pub normal: [i8; 3],
    /// From −8192 to 8191.
    pub offset: i16,
}

impl Cut {
    /// No cut at all.
    pub const NONE: Cut = Cut { normal: [0; 3], offset: 8191 };

    /// Whether a point of the cell, from 0 to 1 along each axis, lies on the side of the fibers.
    pub fn holds(&self, point: DVec3) -> bool {
        self.normal().dot(point) * PARTS <= f64::from(self.offset)
    }

    /// Distance of a point from the plane in edges; infinite without one.
    pub fn distance(&self, point: DVec3) -> f64 {
        let normal = self.normal();
        let length = normal.length();
        if length > 0.0 { (normal.dot(point) - f64::from(self.offset) / PARTS) / length } else { f64::INFINITY }
    }

    /// Share of the cell that it leaves.
    pub fn fill(&self) -> f64 {
        if *self == Cut::NONE { 1.0 } else { part(self.normal(), f64::from(self.offset) / PARTS).0 }
    }

    /// One word of a device: three normals of 6 bits, then the offset of 14 bits.
    pub fn word(&self) -> u32 {
        let [x, y, z] = self.normal.map(|component| component as u32 & 63);
        x | y << 6 | z << 12 | (self.offset as u32 & 0x3fff) << 18
    }

    fn normal(&self) -> DVec3 {
        DVec3::from(self.normal.map(f64::from))
    }

    /// The half-space whose middle comes nearest to `centroid`, and that fills at least the share `least` of the cube.
    fn about(centroid: DVec3, least: f64) -> Cut {
        let aim = centroid - 0.5;
        if aim.length() < LEAST || least >= 1.0 {
            return Cut::NONE;
        }
        let mut normal = -aim.normalize();
        let mut offset = 0.0;
        for _ in 0..TURNS {
            offset = solve(normal, |_, middle| (middle - 0.5).length() > aim.length());
            // Turn until the middle lies the right way.
            let middle = part(normal, offset).1 - 0.5;
            normal = (normal - (aim - middle) / aim.length().max(LEAST)).normalize_or(normal);
        }
        if part(normal, offset).0 < least {
            offset = solve(normal, |volume, _| volume < least);
        }
        let scale = STEPS / normal.abs().max_element();
        let whole = (normal * scale).round();
        let (volume, _) = part(normal, offset);
        let offset = solve(whole, |found, _| found < volume);
        let offset = (offset * PARTS).round().clamp(-8192.0, 8190.0) as i16;
        Cut { normal: [whole.x as i8, whole.y as i8, whole.z as i8], offset }
    }
}

/// The offset between that of the empty and that of the full cube above which `before` no longer holds, which is told of the
/// volume and the middle of the half-space.
fn solve(normal: DVec3, before: impl Fn(f64, DVec3) -> bool) -> f64 {
    let mut low = normal.min(DVec3::ZERO).element_sum();
    let mut high = normal.max(DVec3::ZERO).element_sum();
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let (volume, place) = part(normal, middle);
        if volume <= 0.0 || before(volume, place) { low = middle } else { high = middle }
    }
    high
}

/// Volume and middle of the part of the unit cube where normal·u ≤ offset: the tetrahedra at its corners, added and taken away
/// by turns.
fn part(normal: DVec3, offset: f64) -> (f64, DVec3) {
    let least = FLAT * normal.abs().max_element();
    let a = normal.abs().max(DVec3::splat(least));
    // Turn the axes along which the normal points down.
    let flipped = normal.cmplt(DVec3::ZERO);
    let d = offset + DVec3::select(flipped, a, DVec3::ZERO).element_sum();
    let (mut volume, mut moment) = (0.0, DVec3::ZERO);
    for corner in 0..8 {
        let at = DVec3::new(f64::from(corner & 1), f64::from(corner >> 1 & 1), f64::from(corner >> 2));
        let rest = d - a.dot(at);
        if rest > 0.0 {
            let sign = if at.element_sum() as i32 % 2 == 0 { 1.0 } else { -1.0 };
            let of_corner = sign * rest.powi(3) / (6.0 * a.element_product());
            volume += of_corner;
            moment += of_corner * (at + rest / (4.0 * a));
        }
    }
    let middle = if volume > 0.0 { moment / volume } else { DVec3::splat(0.5) };
    (volume.clamp(0.0, 1.0), DVec3::select(flipped, 1.0 - middle, middle))
}

/// The cuts of cells whose densities are `densities`; nowhere do fibers lie denser behind one than in `around`, the densest
/// neighbour of a cell.
pub fn cuts(values: &[Cell], densities: &[f64], around: &[f64]) -> Vec<Cut> {
    let cut = |((cell, density), most): ((&Cell, &f64), &f64)| {
        if *density > 0.0 { Cut::about(DVec3::from(cell.centroid.map(f64::from)), density / most) } else { Cut::NONE }
    };
    values.par_iter().zip(densities).zip(around).map(cut).collect()
}

/// A length within which there are a cell's neighbours and no others.
pub fn to_neighbours(grid: &CellGrid) -> f64 {
    0.5 * grid.edges().min_element()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume and middle by a grid of points.
    fn counted(cut: &Cut) -> (f64, DVec3) {
        let n = 64;
        let points =
            (0..n * n * n).map(|i| (DVec3::from([i % n, i / n % n, i / n / n].map(f64::from)) + 0.5) / f64::from(n));
        let inside: Vec<DVec3> = points.filter(|point| cut.holds(*point)).collect();
        let sum: DVec3 = inside.iter().sum();
        (inside.len() as f64 / f64::from(n * n * n), sum / inside.len() as f64)
    }

    #[test]
    fn a_cut_leaves_the_middle_of_the_fibers_where_it_was() {
        // Half-spaces of all kinds of corners and edges, by their own middles.
        let normals = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.2], [0.5, 0.5, 0.5], [-0.9, 0.3, 0.6], [0.1, 0.7, -0.7]];
        for normal in normals.map(DVec3::from) {
            for share in [0.1, 0.3, 0.5, 0.8, 0.9] {
                let offset = solve(normal, |volume, _| volume < share);
                let (volume, middle) = part(normal, offset);
                assert!((volume - share).abs() < 1e-3, "{normal}: {volume} of {share}");
                let cut = Cut::about(middle, 0.0);
                let (found, centre) = counted(&cut);
                assert!((found - cut.fill()).abs() < 0.02, "{normal}, {share}: {found} of {}", cut.fill());
                // Thin slices can be told from their neighbours by little more than their thickness.
                assert!(centre.distance(middle) < 0.03, "{normal}, {share}: {centre} of {middle}");
                assert!((found - share).abs() < 0.05, "{normal}, {share}: {found}");
            }
        }
    }

    #[test]
    fn fibers_all_over_a_cell_are_not_cut_and_the_densest_neighbour_bounds_the_rest() {
        assert_eq!(Cut::about(DVec3::splat(0.51), 0.0), Cut::NONE);
        let cut = Cut::about(DVec3::new(0.1, 0.5, 0.5), 0.6);
        assert!((cut.fill() - 0.6).abs() < 0.01, "{}", cut.fill());
        assert!(cut.holds(DVec3::new(0.5, 0.1, 0.9)) && !cut.holds(DVec3::new(0.7, 0.1, 0.9)));
        assert_eq!((Cut::NONE.fill(), Cut::NONE.holds(DVec3::ONE)), (1.0, true));
    }

    #[test]
    fn a_word_has_every_bit() {
        let cut = Cut { normal: [-31, 5, -1], offset: -77 };
        let word = cut.word();
        let back = |low: u32, bits: u32| (word << (32 - low - bits)) as i32 >> (32 - bits);
        assert_eq!([back(0, 6), back(6, 6), back(12, 6), back(18, 14)], [-31, 5, -1, -77]);
    }
}
