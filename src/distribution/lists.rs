//! Lists of directions: counted directions, spread by the cone, as patches of the grid; shared where they are alike.

use super::count::{Gathered, Key, SURFACE_UNIT};
use super::directions::{DirectionGrid, direction_of, square_of};
use super::sheet::{Bundle, EXACT};
use super::spread::{cone_points, visible_area_error};
use crate::concentric::Patch;
use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// Fewest and most points that stand for the cone around a direction, and how many for each cell of the grid in it.
const CONE_POINTS: [f64; 2] = [256.0, 4096.0];
const POINTS_A_CELL: f64 = 4.0;
/// Lists whose error of H is looked at: those with the most fiber.
const LOOKED_AT: usize = 16;

/// Counted directions of one list cell, in the order of their keys.
type Raw<'a> = [(&'a Key, &'a Gathered)];

/// The lists of all list cells.
#[derive(Clone, Debug)]
pub struct Lists {
    /// Bundles; length densities are relative.
    pub lists: Vec<Vec<Bundle>>,
    /// The list of each list cell that holds fiber.
    pub of_cell: FxHashMap<u32, u32>,
    /// Largest |H(tabulated) − H(counted)| found of any list over rays, relative to its largest H.
    pub spread_error: f64,
}

/// A list in the making: its share of R·length by kind and patch, and the number of parts it rests on.
#[derive(Clone, Debug)]
struct Shape {
    shares: BTreeMap<(u32, Place), f64>,
    surface: f64,
    parts: f64,
}

/// Where a bundle lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Place {
    /// A cell of the grid of directions.
    Cell(u32),
    /// The one direction of a list, kept exactly.
    Exact(u32),
}

/// Make the lists. Directions are spread uniformly over the cone |p × p'| ≤ sin ω around the counted ones (paper §5), unless
/// all fibers of a kind in the cell share one direction, which stays exact; `radius` gives R of a kind of fiber in mm.
///
/// # Errors
/// The share of the list cells that `most` entries do for, each list padded to a power of two, where they do not for all.
pub fn make_lists(
    counted: &FxHashMap<Key, Gathered>,
    raw_grid: DirectionGrid,
    grid: DirectionGrid,
    cone: f64,
    radius: impl Fn(usize) -> f64,
    most: usize,
) -> Result<Lists, f64> {
    let mut sorted: Vec<(&Key, &Gathered)> = counted.iter().filter(|(_, gathered)| gathered.surface > 0).collect();
    sorted.sort_unstable_by_key(|(key, _)| *key);
    let raw: Vec<&Raw> = sorted.chunk_by(|(a, _), (b, _)| a.list == b.list).collect();
    let all = raw.len();
    let mut maker = Maker { grid, raw: raw_grid, cone, spread: FxHashMap::default(), exact: Vec::new() };
    let mut shapes: Vec<Shape> = Vec::new();
    let mut of_cell = FxHashMap::default();
    // Lists can only be alike when their largest bundles are the same.
    let mut alike: FxHashMap<(u32, Place), Vec<usize>> = FxHashMap::default();
    let mut entries = 0;
    for (done, raw) in raw.iter().enumerate() {
        let shape = maker.shape(raw);
        let largest = shape.shares.iter().max_by(|a, b| a.1.total_cmp(b.1)).map(|(place, _)| *place);
        let Some(largest) = largest else { continue };
        let candidates = alike.entry(largest).or_default();
        let known = candidates.iter().copied().find(|&known| shapes[known].is_like(&shape));
        let index = known.unwrap_or(shapes.len());
        match known {
            Some(known) => {
                entries -= shapes[known].entries();
                shapes[known].add(&shape);
            }
            None => {
                candidates.push(index);
                shapes.push(shape);
            }
        }
        entries += shapes[index].entries();
        if entries > most {
            return Err(done as f64 / all as f64);
        }
        of_cell.insert(raw[0].0.list, index as u32);
    }
    let spread_error = maker.largest_error(&raw, &of_cell, &shapes);
    let bundles = |shape: &Shape| -> Vec<Bundle> {
        let bundle = |(&(kind, place), share): (&(u32, Place), &f64)| {
            let kind = kind as usize;
            // The share is of R·length.
            Bundle { kind, patch: maker.patch(place), length_density: share / radius(kind) }
        };
        shape.shares.iter().map(bundle).collect()
    };
    Ok(Lists { lists: shapes.iter().map(bundles).collect(), of_cell, spread_error })
}

impl Shape {
    /// Entries of a table.
    fn entries(&self) -> usize {
        self.shares.len().next_power_of_two()
    }

    /// Whether the shares differ by no more than their sampling errors: χ² at most its degrees of freedom.
    fn is_like(&self, other: &Shape) -> bool {
        let places = self.shares.keys().chain(other.shares.keys().filter(|place| !self.shares.contains_key(place)));
        let (mut chi_square, mut freedom) = (0.0, 0.0);
        for place in places {
            let [a, b] =
                [self, other].map(|shape| shape.shares.get(place).copied().unwrap_or_default() / shape.surface);
            chi_square += (a - b).powi(2) / (a / self.parts + b / other.parts);
            freedom += 1.0;
        }
        chi_square <= freedom
    }

    fn add(&mut self, other: &Shape) {
        for (place, share) in &other.shares {
            *self.shares.entry(*place).or_default() += share;
        }
        self.surface += other.surface;
        self.parts += other.parts;
    }
}

/// Turns counted directions into patches.
struct Maker {
    grid: DirectionGrid,
    cone: f64,
    /// The grid of the counted directions.
    raw: DirectionGrid,
    /// Shares of the cells of the grid in the cone around a raw cell.
    spread: FxHashMap<u32, Vec<(u32, f64)>>,
    exact: Vec<DVec3>,
}

impl Maker {
    fn shape(&mut self, raw: &Raw) -> Shape {
        let mut shape = Shape { shares: BTreeMap::new(), surface: 0.0, parts: 0.0 };
        for bins in raw.chunk_by(|(a, _), (b, _)| a.kind == b.kind) {
            let kind = bins[0].0.kind;
            let only = bins.first().and_then(|(_, first)| first.only());
            let same =
                |p: &DVec3| bins.iter().all(|(_, bin)| bin.only().is_some_and(|q| q.cross(*p).length() <= EXACT));
            let only = only.filter(same);
            for (key, bin) in bins {
                let surface = bin.surface as f64 / SURFACE_UNIT;
                shape.surface += surface;
                shape.parts += f64::from(bin.parts);
                match only {
                    Some(p) => {
                        let place = self.exact(p);
                        *shape.shares.entry((kind, place)).or_default() += surface;
                    }
                    None => {
                        for (cell, share) in self.spread(key.bin) {
                            *shape.shares.entry((kind, Place::Cell(*cell))).or_default() += surface * share;
                        }
                    }
                }
            }
        }
        shape
    }

    /// The number of an exact direction.
    fn exact(&mut self, p: DVec3) -> Place {
        let known = self.exact.iter().position(|known| known.cross(p).length() <= EXACT);
        let index = known.unwrap_or_else(|| {
            self.exact.push(p);
            self.exact.len() - 1
        });
        Place::Exact(index as u32)
    }

    /// The cells of the grid that the cone around the middle of a raw cell covers, and their shares.
    fn spread(&mut self, raw: u32) -> &[(u32, f64)] {
        let (grid, n, cone) = (self.grid, self.raw.n, self.cone);
        self.spread.entry(raw).or_insert_with(|| {
            let p = direction_of(Patch::cell(n, raw % n, raw / n).centre());
            let cells = (1.0 - cone.cos()) * f64::from(grid.n * grid.n);
            let points = (POINTS_A_CELL * cells).clamp(CONE_POINTS[0], CONE_POINTS[1]) as u32;
            let mut shares: BTreeMap<u32, f64> = BTreeMap::new();
            for point in cone_points(p, cone, points) {
                *shares.entry(grid.cell_of(point) as u32).or_default() += 1.0 / f64::from(points);
            }
            shares.into_iter().collect()
        })
    }

    fn patch(&self, place: Place) -> Patch {
        match place {
            Place::Cell(cell) => Patch::cell(self.grid.n, cell % self.grid.n, cell / self.grid.n),
            Place::Exact(index) => Patch { corner: square_of(self.exact[index as usize]), extent: DVec2::ZERO },
        }
    }

    /// Hold the lists with the most fiber against what was counted in their cells.
    fn largest_error(&self, raw: &[&Raw], of_cell: &FxHashMap<u32, u32>, shapes: &[Shape]) -> f64 {
        let surface = |raw: &Raw| raw.iter().map(|(_, bin)| bin.surface).sum::<u64>();
        let mut cells: Vec<(u64, usize)> = raw.iter().enumerate().map(|(cell, raw)| (surface(raw), cell)).collect();
        cells.sort_unstable_by(|a, b| b.cmp(a));
        let error = |&(surface, cell): &(u64, usize)| {
            let raw = raw[cell];
            let shape = &shapes[of_cell[&raw[0].0.list] as usize];
            let tabulated: Vec<(Patch, f64)> =
                shape.shares.iter().map(|((_, place), share)| (self.patch(*place), share / shape.surface)).collect();
            let counted: Vec<(DVec3, f64)> =
                raw.iter().map(|(_, bin)| (bin.mean(), bin.surface as f64 / surface as f64)).collect();
            let rays: Vec<DVec3> = cone_points(DVec3::Z, std::f64::consts::FRAC_PI_2, 256)
                .chain(counted.iter().map(|(p, _)| *p).take(64))
                .chain(tabulated.iter().map(|(patch, _)| direction_of(patch.centre())).take(64))
                .collect();
            visible_area_error(&tabulated, &counted, rays.into_iter())
        };
        cells.iter().take(LOOKED_AT).map(error).fold(0.0, f64::max)
    }
}
