//! How far around each empty cell there is nothing: what a ray may jump over.

use crate::distribution::CellGrid;

/// Largest reach of a block in any direction, in cells.
const MOST: u8 = 8;
/// Reach across a layer that holds no fiber at all, in cells: rays near the horizon come to its end in few jumps.
const ACROSS_LAYER: u16 = 4096;

/// The block of empty cells around a cell: all cells whose places differ by less than the reach. Both are 0 for a cell
/// that is not empty; cells outside of the faces of the cloth count as empty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reach {
    /// Along x and y, in cells.
    pub across: u16,
    /// Along z, in cells.
    pub along: u16,
}

/// The reach of every cell, from whether it is empty.
pub fn reaches(grid: &CellGrid, empty: &[bool]) -> Vec<Reach> {
    let mut radius: Vec<u8> = empty.iter().map(|empty| u8::from(*empty)).collect();
    // A cell has radius r + 1 where it and all its neighbours have radius r.
    for r in 1..MOST {
        let least = eroded(grid, &radius);
        for (radius, least) in radius.iter_mut().zip(least) {
            if *radius == r && least >= r {
                *radius = r + 1;
            }
        }
    }
    let mut reaches: Vec<Reach> =
        radius.into_iter().map(|r| Reach { across: u16::from(r), along: u16::from(r) }).collect();
    let layer = grid.counts[0] as usize * grid.counts[1] as usize;
    let layers: Vec<bool> = empty.chunks(layer).map(|cells| cells.iter().all(|empty| *empty)).collect();
    for (iz, cells) in reaches.chunks_mut(layer).enumerate() {
        let full = layers.iter().enumerate().filter(|(_, empty)| !**empty);
        let distance = full.map(|(other, _)| other.abs_diff(iz)).min().unwrap_or(layers.len());
        if layers[iz] {
            cells.fill(Reach { across: ACROSS_LAYER, along: distance.min(usize::from(u16::MAX)) as u16 });
        }
    }
    reaches
}

/// The least value around each cell, itself included; periodic in x and y, and nothing beyond the faces.
fn eroded(grid: &CellGrid, values: &[u8]) -> Vec<u8> {
    let mut values = values.to_vec();
    for axis in 0..3 {
        let count = grid.counts[axis];
        let before = values.clone();
        for (index, place) in grid.places().enumerate() {
            let mut take = |at: u32| {
                let mut neighbour = place;
                neighbour[axis] = at;
                values[index] = values[index].min(before[grid.index(neighbour)]);
            };
            let at = place[axis];
            if axis < 2 {
                take((at + 1) % count);
                take((at + count - 1) % count);
            } else {
                take((at + 1).min(count - 1));
                take(at.saturating_sub(1));
            }
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    /// Whether all cells nearer than the reach are empty, looked up one by one.
    fn is_free(grid: &CellGrid, empty: &[bool], [ix, iy, iz]: [u32; 3], across: i64, along: i64) -> bool {
        let [nx, ny, nz] = grid.counts.map(i64::from);
        let all = |reach: i64| (1 - reach)..reach;
        all(along).all(|dz| {
            let z = i64::from(iz) + dz;
            let row = |dx: i64, dy: i64| {
                let place = [(i64::from(ix) + dx).rem_euclid(nx), (i64::from(iy) + dy).rem_euclid(ny), z];
                empty[grid.index(place.map(|at| at as u32))]
            };
            !(0..nz).contains(&z) || all(across).all(|dx| all(across).all(|dy| row(dx, dy)))
        })
    }

    #[test]
    fn blocks_are_empty_and_as_large_as_they_can_be() {
        let grid = CellGrid { counts: [23, 19, 7], period: DVec2::ONE, thickness: 1.0 };
        // Few fibers, a layer with none, and one with a single cell.
        let full = |i: usize| match i / (23 * 19) {
            0 | 3 => false,
            1 => i == 23 * 19 + 200,
            _ => i % 97 == 5,
        };
        let empty: Vec<bool> = (0..grid.len()).map(|i| !full(i)).collect();
        let reaches = reaches(&grid, &empty);
        let mut seen = std::collections::BTreeSet::new();
        for (place, reach) in grid.places().zip(&reaches) {
            let (across, along) = (i64::from(reach.across), i64::from(reach.along));
            seen.insert(reach.across);
            if reach.across == ACROSS_LAYER {
                assert!(is_free(&grid, &empty, place, 23, along), "{place:?}: {reach:?}");
                assert!(!is_free(&grid, &empty, place, 23, along + 1), "{place:?}: {reach:?}");
            } else if reach.across > 0 {
                assert!(is_free(&grid, &empty, place, across, along), "{place:?}: {reach:?}");
                let larger = is_free(&grid, &empty, place, across + 1, along + 1);
                assert!(!larger || reach.across == 8, "{place:?}: {reach:?}");
            } else {
                assert!(!empty[grid.index(place)]);
            }
        }
        assert!(seen.len() > 5, "only {seen:?}");
    }

    #[test]
    fn one_cell_of_an_empty_layer_reaches_across() {
        let grid = CellGrid { counts: [1, 1, 5], period: DVec2::ONE, thickness: 1.0 };
        let along: Vec<u16> =
            reaches(&grid, &[true, true, false, true, false]).iter().map(|reach| reach.along).collect();
        assert_eq!(along, [2, 1, 0, 1, 0]);
    }
}
