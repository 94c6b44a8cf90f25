//! Sums of what was counted in realizations, and the specific length that is their mean.

use super::calculator::{Element, Gathering};
use super::cells::Cell;
use super::count::{Count, EDGE_UNITS, Gathered, Grids, Key, SURFACE_UNIT};
use super::directions::DirectionGrid;
use super::lists::{Lists, make_lists};
use super::sheet::SpecificLength;
use super::voids::{VoidCount, VoidSums};
use crate::scene::Model;
use rustc_hash::FxHashMap;

/// Most entries of all lists together, each padded to a power of two: their numbers are exact in f32 and fit into 24 bits.
pub const MOST_ENTRIES: usize = 1 << 23;

/// Sums over realizations.
pub struct Sums {
    pub realizations: u64,
    /// Σ R·length in mm².
    pub total: f64,
    pub surface: Vec<u64>,
    moments: Vec<[u64; 3]>,
    /// Sums of the squares of one realization.
    square: Vec<f64>,
    directions: FxHashMap<Key, Gathered>,
    pub voids: Option<VoidSums>,
}

impl Sums {
    pub fn new(grids: &Grids) -> Sums {
        let cells = grids.cells.len();
        let (surface, square) = (vec![0; cells], vec![0.0; cells]);
        let moments = vec![[0; 3]; if grids.centroids { cells } else { 0 }];
        let voids = grids.voids.then(|| VoidSums::new(&grids.cells));
        Sums { realizations: 0, total: 0.0, surface, moments, square, directions: FxHashMap::default(), voids }
    }

    /// Add a realization; always in the order of their numbers.
    pub fn add(&mut self, count: &Count, voids: Option<&VoidCount>) {
        if let (Some(sums), Some(voids)) = (&mut self.voids, voids) {
            sums.add(voids, self.realizations);
        }
        self.realizations += 1;
        self.total += count.total;
        for ((sum, square), surface) in self.surface.iter_mut().zip(&mut self.square).zip(&count.surface) {
            *sum += surface;
            *square += (*surface as f64).powi(2);
        }
        for (sum, moment) in self.moments.iter_mut().zip(&count.moments) {
            sum.iter_mut().zip(moment).for_each(|(sum, moment)| *sum += moment);
        }
        for (key, gathered) in &count.directions {
            self.directions.entry(*key).and_modify(|known| known.add(gathered)).or_insert(*gathered);
        }
    }

    /// Mean of a cell and the variance of that mean.
    fn mean(&self, cell: usize) -> (f64, f64) {
        let n = self.realizations as f64;
        let (mean, square) = (self.surface[cell] as f64 / n, self.square[cell] / n);
        (mean, (square - mean * mean).max(0.0) / (n - 1.0))
    }

    /// Root of the summed variances of the means over the root of their summed squares.
    pub fn error(&self) -> f64 {
        let (mut variances, mut squares) = (0.0, 0.0);
        for cell in 0..self.surface.len() {
            let (mean, variance) = self.mean(cell);
            variances += variance;
            squares += mean * mean;
        }
        f64::sqrt(variances / squares)
    }

    /// Standard error of the density of a cell, relative to it.
    pub fn relative_error(&self, cell: usize) -> f64 {
        let (mean, variance) = self.mean(cell);
        if mean > 0.0 { variance.sqrt() / mean } else { 0.0 }
    }

    /// Lists of directions that have no more than [`MOST_ENTRIES`] together, made twice as wide as often as that takes.
    fn lists(&self, element: &Element, model: &Model, grids: &mut Grids) -> Lists {
        let grid = DirectionGrid { n: model.directions.isqrt() };
        let radius = |kind: usize| element.radii[kind];
        let make =
            |directions: &_, raw, most| make_lists(directions, raw, grid, model.cone.unwrap_or_default(), radius, most);
        let mut widened = None;
        loop {
            let directions = widened.as_ref().unwrap_or(&self.directions);
            // One list cannot be too long.
            let most = if grids.list_counts() == [1; 3] { usize::MAX } else { MOST_ENTRIES };
            let share = match make(directions, grids.raw, most) {
                Ok(lists) => return lists,
                Err(share) => share,
            };
            // Two lists in one have half the entries of both at least.
            for _ in 0..share.recip().log2().ceil().clamp(1.0, 30.0) as u32 {
                let narrow = widened.take().unwrap_or_else(|| self.directions.clone());
                widened = Some(grids.widen(grids.narrowest(element.list_width), narrow));
            }
        }
    }

    /// The means, how they were gathered, and the volume fractions of the cells.
    pub fn finish(&self, element: &Element, model: &Model, mut grids: Grids) -> (SpecificLength, Gathering, Vec<f64>) {
        let grid = DirectionGrid { n: model.directions.isqrt() };
        let radius = |kind: usize| element.radii[kind];
        let Lists { lists, of_cell, spread_error } = self.lists(element, model, &mut grids);
        let edges = grids.cells.edges();
        let scale = 1.0 / (SURFACE_UNIT * self.realizations as f64 * edges.x * edges.y * edges.z);
        let cell = |(surface, place): (&u64, [u32; 3])| {
            let list = of_cell.get(&grids.list_of(place)).copied().unwrap_or_default();
            let moment = self.moments.get(grids.cells.index(place)).filter(|_| *surface > 0);
            let centroid = moment.map_or(Cell::MIDDLE, |moment| {
                moment.map(|sum| ((sum as f64 / *surface as f64 + 0.5) / EDGE_UNITS) as f32)
            });
            Cell { surface: *surface as f64 * scale, placement: 1.0, list, centroid }
        };
        let values: Vec<Cell> = self.surface.iter().zip(grids.cells.places()).map(cell).collect();
        let specific_length = SpecificLength { grid, cells: grids.cells, values, lists, spread_error };
        let fractions = specific_length.volume_fractions(radius);
        let gathering = Gathering {
            realizations: self.realizations,
            error: self.error(),
            volume_fraction: fractions.iter().sum::<f64>() / fractions.len() as f64,
            largest_fraction: fractions.iter().copied().fold(0.0, f64::max),
            filled: specific_length.values.iter().filter(|cell| cell.surface > 0.0).count(),
            list_counts: grids.list_counts(),
            voids: None,
        };
        (specific_length, gathering, fractions)
    }
}
