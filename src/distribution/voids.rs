//! What fibers leave free: how much of their surface lies in no other fiber, and how much of the volume they cover.

use super::cells::CellGrid;
use super::sheet::SpecificLength;
use crate::cloth::{FiberGrid, Realization};
use crate::error::Result;
use glam::DVec3;
use std::f64::consts::TAU;

/// Points on the surfaces of fibers, for an area of the smallest face of a cell.
const SURFACE_POINTS: f64 = 1.0;

/// The factors e/(1 − c) of a placement by voids.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Voids {
    /// e: share of the surface of all fibers that lies in no other fiber.
    pub free_surface: f64,
    /// c: share of the volume that fibers cover, over all cells.
    pub covered: f64,
    /// The largest factor of any cell.
    pub largest: f64,
    /// Standard error of the factors, relative to their root mean square, over cells with fibers.
    pub error: f64,
}

/// Points of one realization, by cell.
#[derive(Clone, Debug)]
pub struct VoidCount {
    /// Points on surfaces, and those of them in no other fiber.
    surface: Vec<u32>,
    free: Vec<u32>,
    /// Points anywhere, one a cell; whether it is in a fiber.
    covered: Vec<u32>,
}

impl VoidCount {
    /// Throw points at the surfaces of fibers and into cells; they depend on the number of the realization alone.
    ///
    /// # Errors
    /// Those of [`FiberGrid::new`].
    pub fn new(realization: &Realization, cells: &CellGrid, number: u64) -> Result<VoidCount> {
        let mut count =
            VoidCount { surface: vec![0; cells.len()], free: vec![0; cells.len()], covered: vec![0; cells.len()] };
        if realization.fibers.is_empty() {
            return Ok(count);
        }
        let mut random = Random(number);
        let grid = FiberGrid::of(realization)?;
        let edges = cells.edges();
        let area = (edges.x * edges.y).min(edges.y * edges.z).min(edges.z * edges.x);
        for tube in grid.tubes() {
            let (side, up) = tube.direction().any_orthonormal_pair();
            let points = SURFACE_POINTS * TAU * tube.radius() * tube.length() / area;
            for _ in 0..(points + random.uniform()) as u64 {
                let (sin, cos) = (TAU * random.uniform()).sin_cos();
                let along = tube.direction() * (tube.length() * random.uniform());
                let point = tube.start() + along + (side * cos + up * sin) * tube.radius();
                let Some(cell) = cells.at(point) else { continue };
                count.surface[cell] += 1;
                let other = |index: usize| grid.tubes()[index].fiber() != tube.fiber();
                count.free[cell] += u32::from(!grid.holding(point).any(other));
            }
        }
        for ([ix, iy, iz], covered) in cells.places().zip(&mut count.covered) {
            let corner = DVec3::new(f64::from(ix), f64::from(iy), f64::from(iz));
            let within = DVec3::new(random.uniform(), random.uniform(), random.uniform());
            let point = (corner + within) * edges - DVec3::Z * cells.thickness;
            *covered = u32::from(grid.holding(point).next().is_some());
        }
        Ok(count)
    }
}

/// Points of many realizations.
#[derive(Clone, Debug)]
pub struct VoidSums {
    cells: CellGrid,
    /// Even and odd realizations: their difference tells the error.
    halves: [Points; 2],
}

/// Points by cell.
#[derive(Clone, Debug)]
struct Points {
    surface: Vec<u64>,
    free: Vec<u64>,
    covered: Vec<u64>,
    volume: Vec<u64>,
}

impl Points {
    fn new(cells: usize) -> Points {
        let none = || vec![0; cells];
        Points { surface: none(), free: none(), covered: none(), volume: none() }
    }

    fn map(&self, one: impl Fn(&[u64]) -> Vec<u64>) -> Points {
        let Points { surface, free, covered, volume } = self;
        Points { surface: one(surface), free: one(free), covered: one(covered), volume: one(volume) }
    }

    fn plus(&self, other: &Points) -> Points {
        let sum = |a: &[u64], b: &[u64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
        Points {
            surface: sum(&self.surface, &other.surface),
            free: sum(&self.free, &other.free),
            covered: sum(&self.covered, &other.covered),
            volume: sum(&self.volume, &other.volume),
        }
    }

    /// e/(1 − c) by cell; a point is added to each count, so that no few points give 0 or no number.
    fn factors(&self) -> Vec<f64> {
        let factor = |cell: usize| {
            let free = (self.free[cell] + 1) as f64 / (self.surface[cell] + 1) as f64;
            let void = (self.volume[cell] - self.covered[cell] + 1) as f64 / (self.volume[cell] + 1) as f64;
            free / void
        };
        (0..self.surface.len()).map(factor).collect()
    }
}

impl VoidSums {
    /// No points.
    pub fn new(cells: &CellGrid) -> VoidSums {
        VoidSums { cells: *cells, halves: [Points::new(cells.len()), Points::new(cells.len())] }
    }

    /// Add a realization.
    pub fn add(&mut self, count: &VoidCount, number: u64) {
        let half = &mut self.halves[(number % 2) as usize];
        let add = |sums: &mut [u64], counts: &[u32]| {
            sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += u64::from(*count));
        };
        add(&mut half.surface, &count.surface);
        add(&mut half.free, &count.free);
        add(&mut half.covered, &count.covered);
        half.volume.iter_mut().for_each(|volume| *volume += 1);
    }

    /// Set the factors of all cells.
    pub fn place(&self, specific_length: &mut SpecificLength) -> Voids {
        let all = self.halves[0].plus(&self.halves[1]);
        // Pool neighbours with weights 1, 2, 1 along each axis.
        let pooled = |points: &Points| points.map(|counts| pool(&self.cells, counts)).factors();
        let (factors, [even, odd]) = (pooled(&all), [&self.halves[0], &self.halves[1]].map(pooled));
        let (mut square, mut spread) = (0.0, 0.0);
        for (i, cell) in specific_length.values.iter_mut().enumerate() {
            cell.placement = factors[i];
            if cell.surface > 0.0 {
                square += factors[i].powi(2);
                spread += (even[i] - odd[i]).powi(2) / 4.0;
            }
        }
        let share = |part: &[u64], whole: &[u64]| part.iter().sum::<u64>() as f64 / whole.iter().sum::<u64>() as f64;
        Voids {
            free_surface: share(&all.free, &all.surface),
            covered: share(&all.covered, &all.volume),
            largest: factors.iter().copied().fold(0.0, f64::max),
            error: f64::sqrt(spread / square),
        }
    }
}

/// Sums over each cell and its neighbours, with weights 1, 2, 1 along each axis; nothing lies beyond the faces.
fn pool(cells: &CellGrid, counts: &[u64]) -> Vec<u64> {
    let mut sums = counts.to_vec();
    for axis in 0..3 {
        let before = sums.clone();
        let count = cells.counts[axis];
        for (index, place) in cells.places().enumerate() {
            let at = |at: u32| {
                let mut neighbour = place;
                neighbour[axis] = at;
                before[cells.index(neighbour)]
            };
            let here = place[axis];
            let inner = axis < 2 || (here > 0 && here + 1 < count);
            let next = if inner || here + 1 < count { at((here + 1) % count) } else { 0 };
            let last = if inner || here > 0 { at((here + count - 1) % count) } else { 0 };
            sums[index] = 2 * before[index] + next + last;
        }
    }
    sums
}

/// SplitMix64.
struct Random(u64);

impl Random {
    /// Uniform in [0, 1).
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * 2f64.powi(-53)
    }
}
