//! The distribution calculator: f(p, x) of a cloth of yarns from its explicit fibers (paper §5).

use super::cells::{Cell, CellGrid};
use super::count::{Count, Gathered, Grids, Key, SURFACE_UNIT, count};
use super::directions::DirectionGrid;
use super::lists::{Lists, make_lists};
use super::sheet::SpecificLength;
use crate::cloth::Cloth;
use crate::error::{Error, Result};
use crate::scene::Model;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::f64::consts::PI;

/// Edge of a cell in radii of the thinnest fiber where the file does not say.
const EDGE: f64 = 4.0;
/// Most cells along an axis, and in all.
const MOST_ALONG: u32 = 256;
const MOST_CELLS: usize = 1 << 21;
/// The effort of a run.
const USUAL: Effort = Effort::Precision(0.05);
/// Fewest and most realizations.
const FEWEST: u64 = 32;
const MOST: u64 = 4096;
/// Realizations that are counted side by side.
const CHUNK: u64 = 16;
/// The fibers of a cloth do not depend on the seed of the walks.
const SEED: u64 = 0;
/// Fibers cannot fill more of a cell than this.
const MAX_VOLUME_FRACTION: f64 = 0.9;
/// Standard errors by which a cell must be too full to be refused: once in 3·10⁶ cells by chance.
const SURELY: f64 = 5.0;

/// How many realizations to count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effort {
    /// So many, at least 2.
    Realizations(u64),
    /// As many, from 32 to 4096, as bring the standard error of the densities of cells below this share of their root mean
    /// square.
    Precision(f64),
}

impl Default for Effort {
    fn default() -> Effort {
        USUAL
    }
}

/// How the specific length of a cloth was gathered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gathering {
    /// Realizations that it is the mean of.
    pub realizations: u64,
    /// Standard error of the densities of cells, relative to their root mean square.
    pub error: f64,
    /// Mean share of the volume that is fiber.
    pub volume_fraction: f64,
    /// The largest of any cell.
    pub largest_fraction: f64,
    /// Cells that hold any fiber.
    pub filled: usize,
    /// Grid of the direction lists.
    pub list_counts: [u32; 3],
}

impl SpecificLength {
    /// Count the fibers of a woven or knitted cloth: the mean over realizations. `progress` is told the share that is done.
    ///
    /// # Errors
    /// [`Error::Input`] when the fibers fill more than 0.9 of a cell; it names the cell and a grid that cures it.
    pub fn of_cloth(
        cloth: &Cloth,
        model: &Model,
        effort: Effort,
        mut progress: impl FnMut(f64),
    ) -> Result<(SpecificLength, Gathering)> {
        let grids = grids(cloth, model);
        let mut sums = Sums::new(&grids);
        let mut wanted = match effort {
            Effort::Realizations(count) => count.max(2),
            Effort::Precision(_) => FEWEST,
        };
        loop {
            for first in (sums.realizations..wanted).step_by(CHUNK as usize) {
                let numbers = first..(first + CHUNK).min(wanted);
                let counts: Vec<Count> =
                    numbers.into_par_iter().map(|number| count(&cloth.realize(SEED, number), &grids)).collect();
                counts.iter().for_each(|count| sums.add(count));
                progress(sums.realizations as f64 / wanted as f64);
            }
            let Effort::Precision(precision) = effort else { break };
            let error = sums.error();
            if error <= precision || wanted >= MOST {
                break;
            }
            // The error falls with the root of the realizations.
            let needed = (sums.realizations as f64 * (error / precision).powi(2)).ceil() as u64;
            wanted = needed.clamp(wanted + CHUNK, MOST);
        }
        sums.finish(cloth, model, &grids)
    }
}

/// The grids on which a cloth is counted.
fn grids(cloth: &Cloth, model: &Model) -> Grids {
    let size = cloth.size();
    let cells = CellGrid {
        counts: model.cells.unwrap_or_else(|| default_counts(cloth)),
        period: cloth.period(),
        thickness: cloth.thickness(),
    };
    let spacing = cloth.spacing();
    let edges = cells.edges();
    // A list is never wider than a quarter of the distance of two yarns or loops, nor than four cells.
    let quarter = [spacing.x / 4.0, spacing.y / 4.0, size.z / 4.0];
    let block = [0, 1, 2].map(|axis| ((quarter[axis] / edges[axis]) as u32).clamp(1, 4));
    // Count directions four times as finely as they are tabulated.
    let n = (4 * model.directions.isqrt()).clamp(128, 1024);
    Grids { cells, block, raw: DirectionGrid { n } }
}

/// Cells of edge 4R, fewer where that would be too many.
fn default_counts(cloth: &Cloth) -> [u32; 3] {
    let kinds = cloth.used_kinds();
    let radius = kinds.iter().map(|&kind| cloth.kinds()[kind].radius).fold(f64::INFINITY, f64::min);
    let mut edge = EDGE * radius;
    loop {
        let counts = cloth.size().to_array().map(|size| ((size / edge).ceil() as u32).clamp(1, MOST_ALONG));
        if counts.iter().map(|count| *count as usize).product::<usize>() <= MOST_CELLS {
            return counts;
        }
        edge *= 1.1;
    }
}

/// Sums over realizations.
struct Sums {
    realizations: u64,
    surface: Vec<u64>,
    /// Squares of the surface of one realization, in units of 2¹⁶ of those of `surface`.
    square: Vec<u64>,
    directions: FxHashMap<Key, Gathered>,
}

impl Sums {
    fn new(grids: &Grids) -> Sums {
        let cells = grids.cells.len();
        Sums { realizations: 0, surface: vec![0; cells], square: vec![0; cells], directions: FxHashMap::default() }
    }

    fn add(&mut self, count: &Count) {
        self.realizations += 1;
        for ((sum, square), surface) in self.surface.iter_mut().zip(&mut self.square).zip(&count.surface) {
            *sum += surface;
            *square += (surface >> 16).pow(2);
        }
        for (key, gathered) in &count.directions {
            self.directions.entry(*key).and_modify(|known| known.add(gathered)).or_insert(*gathered);
        }
    }

    /// Root of the summed variances of the means over the root of their summed squares.
    fn error(&self) -> f64 {
        let n = self.realizations as f64;
        let (mut variance, mut square) = (0.0, 0.0);
        for (sum, squares) in self.surface.iter().zip(&self.square) {
            let mean = *sum as f64 / n;
            let mean_square = *squares as f64 * 2f64.powi(32) / n;
            variance += (mean_square - mean * mean).max(0.0) / (n - 1.0);
            square += mean * mean;
        }
        (variance / square).sqrt()
    }

    /// Standard error of the density of a cell, relative to it.
    fn relative_error(&self, cell: usize) -> f64 {
        let n = self.realizations as f64;
        let (mean, square) = (self.surface[cell] as f64 / n, self.square[cell] as f64 * 2f64.powi(32) / n);
        if mean > 0.0 { ((square / (mean * mean) - 1.0).max(0.0) / (n - 1.0)).sqrt() } else { 0.0 }
    }

    fn finish(&self, cloth: &Cloth, model: &Model, grids: &Grids) -> Result<(SpecificLength, Gathering)> {
        let grid = DirectionGrid { n: model.directions.isqrt() };
        let radius = |kind: usize| cloth.kinds()[kind].radius;
        let Lists { lists, of_cell, spread_error } =
            make_lists(&self.directions, grids.raw, grid, model.cone.unwrap_or_default(), radius);
        let edges = grids.cells.edges();
        let scale = 1.0 / (SURFACE_UNIT * self.realizations as f64 * edges.x * edges.y * edges.z);
        // v = π Σ R² F = π ⟨R²F⟩/⟨RF⟩ Σ R F.
        let thickness: Vec<f64> = lists
            .iter()
            .map(|list| {
                let mean = |power: i32| list.iter().map(|b| radius(b.kind).powi(power) * b.length_density).sum::<f64>();
                PI * mean(2) / mean(1)
            })
            .collect();
        let cell = |(surface, place): (&u64, [u32; 3])| {
            let list = of_cell.get(&grids.list_of(place)).copied().unwrap_or_default();
            Cell { surface: *surface as f64 * scale, placement: 1.0, list }
        };
        let values: Vec<Cell> = self.surface.iter().zip(grids.cells.places()).map(cell).collect();
        let fraction =
            |cell: &Cell| if cell.surface > 0.0 { cell.surface * thickness[cell.list as usize] } else { 0.0 };
        let fractions: Vec<f64> = values.iter().map(fraction).collect();
        let surely = |&i: &usize| fractions[i] * (1.0 - SURELY * self.relative_error(i));
        let fullest = (0..fractions.len()).max_by(|a, b| surely(a).total_cmp(&surely(b))).unwrap_or_default();
        if surely(&fullest) > MAX_VOLUME_FRACTION {
            return Err(too_full(grids, fullest, fractions[fullest]));
        }
        let gathering = Gathering {
            realizations: self.realizations,
            error: self.error(),
            volume_fraction: fractions.iter().sum::<f64>() / fractions.len() as f64,
            largest_fraction: fractions.iter().copied().fold(0.0, f64::max),
            filled: values.iter().filter(|cell| cell.surface > 0.0).count(),
            list_counts: grids.list_counts(),
        };
        Ok((SpecificLength { grid, cells: grids.cells, values, lists, spread_error }, gathering))
    }
}

/// Name the cell that is too full, and the grid of twice the edge.
fn too_full(grids: &Grids, cell: usize, fraction: f64) -> Error {
    let [nx, ny, nz] = grids.cells.counts;
    let cell = cell as u32;
    let (ix, iy, iz) = (cell % nx, cell / nx % ny, cell / nx / ny);
    let [cx, cy, cz] = grids.cells.counts.map(|count| count.div_ceil(2));
    Error::Input(format!(
        "fibers fill {fraction:.2} of cell ({ix}, {iy}, {iz}) of {nx} × {ny} × {nz}, but at most {MAX_VOLUME_FRACTION} is \
         possible: take fewer cells, such as cells = [{cx}, {cy}, {cz}], or make the yarns wider"
    ))
}
