//! What flights need to know that start where light leaves a fiber: a hit lies on the surface of a fiber whose axis may be
//! in another cell.

use super::cut::{self, Cut};
use crate::distribution::{Cell, CellGrid, SpecificLength};
use crate::scene::{Memory, Model, Placement};
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// How hits and axes belong together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carry {
    /// Largest radius of a fiber in mm: no hit lies farther from its axis.
    pub radius: f64,
    /// Whether the cell of the hit has a factor of its own in the rate.
    pub factors: bool,
    /// Whether walks remember their last flight and the fiber that it set out from.
    pub memory: bool,
}

/// The rates of the cells of a placement.
pub struct Rates {
    /// Tentative events in 1/mm.
    pub majorant: f64,
    /// By cell, the share of them when all factors are 1.
    pub shares: Vec<f64>,
    /// By cell, the factor of the hits there.
    pub factors: Vec<f64>,
    /// By cell, the list to draw from.
    pub lists: Vec<u32>,
    /// By cell, the part of it where its fibers are.
    pub cuts: Vec<Cut>,
    /// None when flights start at hits.
    pub carry: Option<Carry>,
}

/// The rates of a placement; `radius` is the largest of any fiber.
pub fn rates(specific_length: &SpecificLength, model: &Model, radius: f64) -> Rates {
    let placement = model.placement;
    let SpecificLength { cells: grid, values, .. } = specific_length;
    // A factor of the axis's cell, or one that is the same everywhere, is a part of the density.
    let inside = match placement {
        Placement::AtHit | Placement::Carried => false,
        Placement::CarriedDense => true,
        Placement::CarriedVoid => values.len() == 1,
    };
    let factors = placement == Placement::CarriedVoid && !inside;
    let density = |cell: &Cell| if inside { cell.surface * cell.placement } else { cell.surface };
    let mut densities: Vec<f64> = values.iter().map(density).collect();
    let mut cuts = vec![Cut::NONE; values.len()];
    if placement == Placement::Carried && values.len() > 1 {
        cuts = cut::cuts(values, &densities, &largest_within(grid, &densities, cut::to_neighbours(grid)));
        densities.iter_mut().zip(&cuts).for_each(|(density, cut)| *density /= cut.fill());
    }
    let factor = |cell: &Cell| if factors { cell.placement } else { 1.0 };
    let factors_of: Vec<f64> = values.iter().map(factor).collect();
    let around = if factors { largest_within(grid, &densities, radius) } else { densities.clone() };
    let most = around.iter().zip(&factors_of).map(|(density, factor)| density * factor).fold(0.0, f64::max);
    let majorant = 2.0 * most;
    let carried = placement != Placement::AtHit;
    let own = |cell: &Cell| if cell.surface > 0.0 { cell.list } else { 0 };
    Rates {
        majorant,
        shares: densities.iter().map(|density| 2.0 * density / majorant).collect(),
        factors: factors_of,
        cuts,
        lists: if carried { nearest_lists(grid, values) } else { values.iter().map(own).collect() },
        carry: carried.then_some(Carry { radius, factors, memory: model.memory == Memory::Flight }),
    }
}

/// The largest value of any cell that a cell's points may come nearer to than a distance.
fn largest_within(grid: &CellGrid, values: &[f64], distance: f64) -> Vec<f64> {
    let mut values = values.to_vec();
    for axis in 0..3 {
        let count = i64::from(grid.counts[axis]);
        let reach = ((distance / grid.edges()[axis]).ceil() as i64).min(count);
        let before = values.clone();
        for (index, place) in grid.places().enumerate() {
            for step in -reach..=reach {
                let at = i64::from(place[axis]) + step;
                let at = if axis < 2 { at.rem_euclid(count) } else { at.clamp(0, count - 1) };
                let mut neighbour = place;
                neighbour[axis] = at as u32;
                values[index] = values[index].max(before[grid.index(neighbour)]);
            }
        }
    }
    values
}

/// The list of every cell; one without fibers borrows that of the nearest with fibers.
fn nearest_lists(grid: &CellGrid, values: &[Cell]) -> Vec<u32> {
    let places: Vec<[u32; 3]> = grid.places().collect();
    let mut lists: Vec<Option<u32>> = vec![None; values.len()];
    // Order by whole numbers: the same on all machines.
    let unit = grid.edges().min_element() / 64.0;
    let mut next = BinaryHeap::new();
    for (index, cell) in values.iter().enumerate().filter(|(_, cell)| cell.surface > 0.0) {
        next.push(Reverse((0, index, cell.list, [0i32; 3])));
    }
    while let Some(Reverse((_, index, list, steps))) = next.pop() {
        if lists[index].is_some() {
            continue;
        }
        lists[index] = Some(list);
        for axis in 0..3 {
            for step in [-1, 1] {
                let (mut place, count) = (places[index], i64::from(grid.counts[axis]));
                let at = i64::from(place[axis]) + i64::from(step);
                if axis == 2 && !(0..count).contains(&at) {
                    continue;
                }
                place[axis] = at.rem_euclid(count) as u32;
                let neighbour = grid.index(place);
                if lists[neighbour].is_none() {
                    let mut steps = steps;
                    steps[axis] += step;
                    let way = DVec3::from(steps.map(f64::from)) * grid.edges() / unit;
                    next.push(Reverse((way.length_squared().round() as u64, neighbour, list, steps)));
                }
            }
        }
    }
    lists.into_iter().map(Option::unwrap_or_default).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn cells(counts: [u32; 3], filled: &[([u32; 3], f64, u32)]) -> (CellGrid, Vec<Cell>) {
        let grid = CellGrid { counts, period: DVec2::new(1.0, 0.5), thickness: 0.3 };
        let mut values = vec![Cell { surface: 0.0, placement: 1.0, list: 7, centroid: Cell::MIDDLE }; grid.len()];
        for (place, surface, list) in filled {
            values[grid.index(*place)] =
                Cell { surface: *surface, placement: 1.0, list: *list, centroid: Cell::MIDDLE };
        }
        (grid, values)
    }

    #[test]
    fn an_empty_cell_borrows_the_nearest_list() {
        // Edges are 0.1, 0.1 and 0.1 mm.
        let (grid, values) = cells([10, 5, 3], &[([1, 2, 0], 1.0, 3), ([7, 2, 2], 2.0, 4)]);
        let lists = nearest_lists(&grid, &values);
        let square = |a: [u32; 3], b: [u32; 3]| {
            let periodic = |a: u32, b: u32, n: u32| a.abs_diff(b).min(n - a.abs_diff(b)).pow(2);
            periodic(a[0], b[0], 10) + periodic(a[1], b[1], 5) + a[2].abs_diff(b[2]).pow(2)
        };
        for (place, list) in grid.places().zip(lists) {
            let (near, far) = (square(place, [1, 2, 0]), square(place, [7, 2, 2]));
            assert!(near == far || list == if near < far { 3 } else { 4 }, "{place:?}: {list}");
        }
    }

    #[test]
    fn the_majorant_is_that_of_a_hit_and_an_axis_within_reach() {
        let (grid, mut values) = cells([10, 5, 3], &[([1, 2, 1], 2.0, 0), ([6, 2, 1], 1.0, 0)]);
        values[grid.index([2, 2, 1])].placement = 1.5;
        values[grid.index([3, 2, 1])].placement = 4.0;
        let length = SpecificLength {
            grid: crate::distribution::DirectionGrid { n: 4 },
            cells: grid,
            values,
            lists: vec![Vec::new()],
            spread_error: 0.0,
        };
        let majorant = |placement, radius| rates(&length, &Model { placement, ..Model::default() }, radius).majorant;
        assert_eq!(majorant(Placement::AtHit, 0.05), 4.0);
        assert_eq!(majorant(Placement::Carried, 0.05), 4.0);
        assert_eq!(majorant(Placement::CarriedVoid, 0.05), 6.0);
        assert_eq!(majorant(Placement::CarriedVoid, 0.15), 16.0);
        assert_eq!(majorant(Placement::CarriedDense, 0.05), 4.0);
    }
}
