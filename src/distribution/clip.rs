//! Straight pieces of fiber, cut at the faces of cells.

use super::cells::CellGrid;
use glam::DVec3;

/// Cuts pieces at the faces of a grid of cells; keeps its memory from piece to piece.
#[derive(Debug)]
pub struct Clipper {
    grid: CellGrid,
    cuts: Vec<f64>,
}

impl Clipper {
    /// Cut at the faces of this grid.
    pub fn new(grid: CellGrid) -> Clipper {
        Clipper { grid, cuts: Vec::new() }
    }

    /// Call `take` with the cell, the start and end of each part as shares of the piece from `from` to `to` (mm), in
    /// their order, and the middle of the part from 0 to 1 along each edge of the cell. The parts fill the piece; x and y are
    /// periodic, and what protrudes from a face belongs to the cells there.
    pub fn parts(&mut self, from: DVec3, to: DVec3, mut take: impl FnMut([u32; 3], f64, f64, DVec3)) {
        let edges = self.grid.edges();
        let up = DVec3::new(0.0, 0.0, self.grid.thickness);
        let (from, to) = ((from + up) / edges, (to + up) / edges);
        self.cuts.clear();
        for axis in 0..3 {
            let (a, b) = (from[axis], to[axis]);
            let (low, high) = (a.min(b), a.max(b));
            let mut face = low.floor() + 1.0;
            while face < high {
                self.cuts.push(((face - a) / (b - a)).clamp(0.0, 1.0));
                face += 1.0;
            }
        }
        self.cuts.sort_unstable_by(f64::total_cmp);
        self.cuts.push(1.0);
        let mut start = 0.0;
        for &end in &self.cuts {
            if end > start {
                // The middle of a part tells its cell.
                let place = from.lerp(to, (start + end) / 2.0);
                let middle = place.floor().as_i64vec3();
                let [nx, ny, nz] = self.grid.counts;
                let cell = [wrap(middle.x, nx), wrap(middle.y, ny), middle.z.clamp(0, i64::from(nz) - 1) as u32];
                let z = place.z - f64::from(cell[2]);
                let within = DVec3::new(place.x - place.x.floor(), place.y - place.y.floor(), z.clamp(0.0, 1.0));
                take(cell, start, end, within);
                start = end;
            }
        }
    }
}

/// The number inside one period.
fn wrap(number: i64, period: u32) -> u32 {
    let period = i64::from(period);
    // Most pieces lie inside, and a division takes its time.
    if (0..period).contains(&number) { number as u32 } else { number.rem_euclid(period) as u32 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn parts_fill_the_piece_and_lie_in_their_cells() {
        let grid = CellGrid { counts: [4, 3, 2], period: DVec2::new(2.0, 3.0), thickness: 1.0 };
        let mut clipper = Clipper::new(grid);
        let edges = grid.edges();
        for step in 0..500 {
            let turn = f64::from(step);
            let from = DVec3::new(1.9 * (turn * 0.7).sin(), 3.0 * (turn * 0.3).cos(), -0.5 - 0.5 * (turn * 1.3).sin());
            let to = from + DVec3::new((turn * 0.9).cos(), 2.0 * (turn * 1.7).sin(), 0.0);
            let mut last = 0.0;
            clipper.parts(from, to, |place, start, end, within| {
                assert!(within.cmpge(DVec3::ZERO).all() && within.cmple(DVec3::ONE).all());
                assert_eq!(start, last);
                last = end;
                // Every inner point of the part is in the cell, up to periods.
                for inner in [0.01, 0.5, 0.99] {
                    let point = from.lerp(to, start + inner * (end - start)) + DVec3::Z;
                    for axis in 0..2 {
                        let cell = (point[axis] / edges[axis]).floor().rem_euclid(f64::from(grid.counts[axis]));
                        assert_eq!(cell, f64::from(place[axis]), "axis {axis} of {point}");
                    }
                }
            });
            assert_eq!(last, 1.0);
        }
    }

    #[test]
    fn a_piece_along_a_face_or_of_no_length_has_one_cell_at_a_time() {
        let grid = CellGrid { counts: [4, 4, 1], period: DVec2::ONE, thickness: 1.0 };
        let mut parts = Vec::new();
        let mut clipper = Clipper::new(grid);
        clipper.parts(DVec3::new(0.5, 0.0, 0.0), DVec3::new(0.5, 0.5, 0.0), |place, _, _, _| parts.push(place));
        assert_eq!(parts, [[2, 0, 0], [2, 1, 0]]);
        parts.clear();
        let point = DVec3::new(-1e-18, 0.3, -0.2);
        clipper.parts(point, point, |place, _, _, _| parts.push(place));
        assert_eq!(parts.len(), 1);
        assert!(parts[0][0] < 4);
    }
}
