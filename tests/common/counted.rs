//! Elements that are counted, and what a count says of them.

use super::SplitMix;
use super::stats::mean_error;
use fiberwalk::cloth::{Cloth, Curve, Primitive, Realization};
use fiberwalk::distribution::{CellGrid, Effort, Element, SpecificLength, surface};
use fiberwalk::scene::Model;
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;

/// A periodic element and how it is counted.
pub struct Counted<'a> {
    pub cells: CellGrid,
    pub list_width: DVec3,
    pub radii: Vec<f64>,
    pub directions: u32,
    pub cone_deg: f64,
    pub realize: Box<dyn Fn(u64) -> Vec<Primitive> + Sync + 'a>,
}

impl<'a> Counted<'a> {
    /// A cloth in cells; each cell has a list of its own.
    pub fn of(cloth: &'a Cloth, counts: [u32; 3]) -> Counted<'a> {
        Counted {
            cells: CellGrid { counts, period: cloth.period(), thickness: cloth.thickness() },
            list_width: DVec3::ZERO,
            radii: cloth.kinds().iter().map(|fiber| fiber.radius).collect(),
            directions: 1024,
            cone_deg: 0.0,
            realize: Box::new(|number| cloth.realize(5, number)),
        }
    }

    /// Pieces of one kind, the same in every realization, in one cell with a period and a thickness in mm.
    pub fn pieces(pieces: &'a [Primitive], period: f64, thickness: f64) -> Counted<'a> {
        Counted {
            cells: CellGrid { counts: [1; 3], period: DVec2::splat(period), thickness },
            list_width: DVec3::ZERO,
            radii: vec![pieces[0].radius],
            directions: 1024,
            cone_deg: 0.0,
            realize: Box::new(|_| pieces.to_vec()),
        }
    }

    pub fn count(&self, effort: Effort) -> SpecificLength {
        self.try_count(effort).unwrap_or_else(|error| panic!("{error}"))
    }

    pub fn try_count(&self, effort: Effort) -> fiberwalk::Result<SpecificLength> {
        let Counted { cells, list_width, radii, .. } = self;
        let realize = |number| Ok(realization(&(self.realize)(number), cells));
        let element = Element { cells: *cells, list_width: *list_width, radii, realize: &realize };
        let cone = Some(self.cone_deg.to_radians());
        let model = Model { directions: self.directions, cone, ..Model::default() };
        SpecificLength::of_pieces(&element, &model, effort, |_| {}).map(|(length, _)| length)
    }

    /// Millimetres of fiber by cell and kind, F·V.
    pub fn lengths(&self, f: &SpecificLength) -> Vec<Vec<f64>> {
        let edges = f.cells.edges();
        let volume = edges.x * edges.y * edges.z;
        let of = |cell: usize| {
            let mut lengths = vec![0.0; self.radii.len()];
            if f.values[cell].surface > 0.0 {
                let list = &f.lists[f.values[cell].list as usize];
                let scale = volume * f.values[cell].surface / surface(list, |kind| self.radii[kind]);
                list.iter().for_each(|bundle| lengths[bundle.kind] += scale * bundle.length_density);
            }
            lengths
        };
        (0..f.values.len()).map(of).collect()
    }

    /// Millimetres of fiber by cell of the direction grid (column, row), in blocks of cells.
    pub fn directions(
        &self,
        f: &SpecificLength,
        block: impl Fn([u32; 3]) -> usize,
    ) -> BTreeMap<(usize, u32, u32), f64> {
        let n = f.grid.n;
        let mut lengths = BTreeMap::new();
        let edges = f.cells.edges();
        for (value, place) in f.values.iter().zip(f.cells.places()).filter(|(value, _)| value.surface > 0.0) {
            let list = &f.lists[value.list as usize];
            let scale = edges.x * edges.y * edges.z * value.surface / surface(list, |kind| self.radii[kind]);
            for bundle in list {
                let at = (bundle.patch.centre() + 1.0) / 2.0 * f64::from(n);
                let key = (block(place), (at.x as u32).min(n - 1), (at.y as u32).min(n - 1));
                *lengths.entry(key).or_default() += scale * bundle.length_density;
            }
        }
        lengths
    }
}

/// Pieces as fibers, each of its own.
pub fn realization(pieces: &[Primitive], cells: &CellGrid) -> Realization {
    let fiber = |piece: &Primitive| {
        let half = piece.direction * (piece.length / 2.0);
        let points = vec![piece.centre - half, piece.centre + half];
        Curve { points, radius: piece.radius, kind: piece.kind, thread: piece.thread, hair: false }
    };
    Realization { fibers: pieces.iter().map(fiber).collect(), period: cells.period, thickness: cells.thickness }
}

/// z of the squared distance of the means of two sets of independent vectors: the mean of (aᵢ − bᵢ)·(aⱼ − bⱼ) over i < j is
/// free of noise, and where the means are the same the products are uncorrelated, however the components depend on each
/// other.
pub fn vectors_z(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let differences: Vec<Vec<f64>> =
        a.iter().zip(b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect()).collect();
    let (mut sum, mut square, mut pairs) = (0.0, 0.0, 0.0);
    for (i, a) in differences.iter().enumerate() {
        for b in &differences[..i] {
            let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
            (sum, square, pairs) = (sum + product, square + product * product, pairs + 1.0);
        }
    }
    let (mean, error) = mean_error(sum, square, pairs);
    mean / error
}

/// Pieces of one length in mm at random places with directions that `draw` gives.
/// Their length density is L in mm/mm³, of fibers of a radius in an element of a period and a thickness.
pub fn scattered_pieces(
    length_density: f64,
    radius: f64,
    [period, thickness]: [f64; 2],
    piece: f64,
    random: &mut SplitMix,
    mut draw: impl FnMut(&mut SplitMix) -> DVec3,
) -> Vec<Primitive> {
    let count = (length_density * period * period * thickness / piece).round() as usize;
    let mut one = |_| {
        let [x, y, z] = [period, period, -thickness].map(|size| size * random.uniform());
        let direction = draw(random);
        Primitive { centre: DVec3::new(x, y, z), direction, length: piece, radius, kind: 0, thread: 0 }
    };
    (0..count).map(&mut one).collect()
}
