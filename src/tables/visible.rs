//! The specific visible area by direction of the ray (paper §3), for tracking by tables.

use super::sampling::{MOST, SamplingTables};
use crate::concentric::Patch;
use crate::distribution::direction_of;
use crate::error::{Error, Result};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Rays at which the error is looked at, for each of so many lists.
const RAYS: u32 = 512;
const LISTS: usize = 64;
/// Entries of a list that are integrated with several points each.
const MANY: usize = 4096;
/// Longest part of a patch's edge that two points integrate: the edge of a cell of 16 × 16.
const LARGEST_PART: f64 = 0.125;

/// H(m) of every list relative to its greatest possible value, ⟨|m × p|⟩, on a grid of the half-sphere of m.
///
/// m and −m see the same fibers. The half-sphere is laid on a square by the octahedral map: with s = |x| + |y| + |z| and z
/// made positive, (a, b) = ((x + y)/s, (x − y)/s) ∈ [−1, 1]². Values are at the corners of n × n cells and linear in
/// between (Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 3(2), 2014).
#[derive(Clone, Debug, PartialEq)]
pub struct VisibleArea {
    /// Cells along an edge of the square.
    pub n: u32,
    /// (n + 1)² values for each list, a row at a time.
    pub nodes: Vec<f32>,
    /// Largest |H(looked up) − H| found of any list over rays, relative to its largest H.
    pub error: f64,
}

impl VisibleArea {
    /// Tabulate the lists of a medium, whose directions fill their patches.
    ///
    /// # Errors
    /// [`Error::Input`] when engines cannot number so many entries.
    pub fn new(tables: &SamplingTables) -> Result<VisibleArea> {
        let count = tables.lists.len();
        let n: u32 = match count {
            0..=16 => 64,
            17..=4096 => 32,
            _ => 16,
        };
        if tables.patches.len() + count * (n * n) as usize > MOST {
            return Err(Error::Input(format!(
                "tables of H(m) for {count} lists of directions take more than {MOST} entries; take \
                 `tracking = \"null-collision\"`"
            )));
        }
        let edge = n + 1;
        let nodes = (0..count).into_par_iter().flat_map(|list| {
            let exact = Exact::new(tables, list);
            (0..edge * edge).into_par_iter().map(move |node| {
                let square = DVec2::new(f64::from(node % edge), f64::from(node / edge)) / f64::from(n);
                exact.at(from_square(square)) as f32
            })
        });
        let mut visible = VisibleArea { n, nodes: nodes.collect(), error: 0.0 };
        let step = count.div_ceil(LISTS);
        let errors = (0..count).into_par_iter().step_by(step);
        let errors = errors.map(|list| visible.error_of(list, &Exact::new(tables, list)));
        visible.error = errors.reduce(|| 0.0, f64::max);
        Ok(visible)
    }

    /// ⟨|m × p|⟩ of a list, looked up.
    pub fn look_up(&self, list: u32, m: DVec3) -> f64 {
        let place = to_square(m) * f64::from(self.n);
        let cell = place.floor().min(DVec2::splat(f64::from(self.n - 1)));
        let [u, v] = (place - cell).to_array();
        let [low, high] = [0, 1].map(|row| {
            let [a, b] = [0, 1].map(|column| f64::from(self.node(list, cell.x as u32 + column, cell.y as u32 + row)));
            a + (b - a) * u
        });
        low + (high - low) * v
    }

    /// The value at a corner.
    pub fn node(&self, list: u32, column: u32, row: u32) -> f32 {
        let edge = self.n as usize + 1;
        self.nodes[(list as usize * edge + row as usize) * edge + column as usize]
    }

    fn error_of(&self, list: usize, exact: &Exact) -> f64 {
        let (mut worst, mut largest): (f64, f64) = (0.0, 0.0);
        for ray in 0..RAYS {
            let [a, b] = [fraction(ray, 0.754_877_666), fraction(ray, 0.569_840_291)];
            // Half of the rays lie near the fibers or along them, where the table is worst.
            let m = match ray % 4 {
                0 | 2 => from_square(DVec2::new(a, b)),
                1 => exact.near(a, b, ray),
                _ => exact.near(0.5, 0.5, ray),
            };
            let truth = exact.at(m);
            worst = worst.max((self.look_up(list as u32, m) - truth).abs());
            largest = largest.max(truth);
        }
        worst / largest
    }
}

/// Numbers that fill the unit square evenly: Roberts' sequence.
fn fraction(index: u32, step: f64) -> f64 {
    (0.5 + f64::from(index) * step).fract()
}

/// Sines to the fibers of a list by quadrature, with the probabilities of the alias table.
struct Exact {
    points: Vec<(DVec3, f64)>,
}

impl Exact {
    fn new(tables: &SamplingTables, list: usize) -> Exact {
        let list = &tables.lists[list];
        let first = list.first as usize;
        // Many patches are small: their middles will do.
        let few = list.alias.words().len() <= MANY;
        let shares = list.alias.probabilities();
        let points = shares.into_iter().enumerate().filter(|(_, share)| *share > 0.0).flat_map(|(entry, share)| {
            let patch = tables.patches[first + entry];
            let points = if few { points_of(&patch) } else { vec![direction_of(patch.centre())] };
            let count = points.len() as f64;
            points.into_iter().map(move |p| (p, share / count))
        });
        Exact { points: points.collect() }
    }

    fn at(&self, m: DVec3) -> f64 {
        self.points.iter().map(|(p, share)| m.cross(*p).length() * share).sum()
    }

    /// A ray near one of the fibers.
    fn near(&self, a: f64, b: f64, ray: u32) -> DVec3 {
        let (p, _) = self.points[ray as usize * 7919 % self.points.len()];
        let (side, up) = p.any_orthonormal_pair();
        (p + 0.1 * ((a - 0.5) * side + (b - 0.5) * up)).normalize()
    }
}

/// Gauss points of a patch, 2 along each part of an edge that is not 0.
fn points_of(patch: &Patch) -> Vec<DVec3> {
    const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
    let along = |extent: f64| {
        // Large patches take several parts: over a hemisphere two points are 1 % off.
        let parts = (extent / LARGEST_PART - 1e-9).ceil() as u32;
        let points = move |part: u32| GAUSS.map(|at| (f64::from(part) + at) / f64::from(parts));
        if extent > 0.0 { (0..parts).flat_map(points).collect() } else { vec![0.5] }
    };
    let (a, b): (Vec<f64>, Vec<f64>) = (along(patch.extent.x), along(patch.extent.y));
    a.iter().flat_map(|&a| b.iter().map(move |&b| direction_of(patch.at(DVec2::new(a, b))))).collect()
}

/// The place of a ray on the square [0, 1]².
pub fn to_square(m: DVec3) -> DVec2 {
    let m = if m.z < 0.0 { -m } else { m };
    let scale = 0.5 / (m.x.abs() + m.y.abs() + m.z);
    (DVec2::new(m.x + m.y, m.x - m.y) * scale + 0.5).clamp(DVec2::ZERO, DVec2::ONE)
}

/// The ray, z ≥ 0, of a place.
fn from_square(square: DVec2) -> DVec3 {
    let DVec2 { x: a, y: b } = square * 2.0 - 1.0;
    let (x, y) = ((a + b) / 2.0, (a - b) / 2.0);
    DVec3::new(x, y, 1.0 - x.abs() - y.abs()).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_and_its_reverse_have_a_place_that_gives_them_back() {
        for (x, y, z) in [(0.0, 0.0, 1.0), (0.3, -0.4, 0.8), (-0.7, 0.1, -0.2), (1.0, 0.0, 0.0), (-0.3, 0.9, 1e-12)] {
            let m = DVec3::new(x, y, z).normalize();
            assert!(from_square(to_square(m)).cross(m).length() < 1e-12, "{m}");
            assert!(from_square(to_square(-m)).cross(m).length() < 1e-12, "{m}");
        }
    }
}
