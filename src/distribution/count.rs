//! One realization, counted cell by cell.

use super::cells::CellGrid;
use super::clip::Clipper;
use super::directions::DirectionGrid;
use super::sheet::EXACT;
use crate::cloth::Primitive;
use glam::DVec3;
use rustc_hash::FxHashMap;

/// Units of R·length in a mm²: sums are integers, so they do not depend on their order.
pub const SURFACE_UNIT: f64 = (1u64 << 32) as f64;

/// The grids that a calculator counts on.
#[derive(Clone, Copy, Debug)]
pub struct Grids {
    /// Densities.
    pub cells: CellGrid,
    /// Cells of the density grid along each edge of a cell of the grid of direction lists.
    pub block: [u32; 3],
    /// Directions as they are counted, before the cone.
    pub raw: DirectionGrid,
    /// Whether to measure what fibers leave free.
    pub voids: bool,
    /// Whether to tell where in a cell its fibers are.
    pub centroids: bool,
}

/// Units of a cell's edge in which places are told.
pub const EDGE_UNITS: f64 = 1024.0;

impl Grids {
    /// Cells of the grid of lists along each axis.
    pub fn list_counts(&self) -> [u32; 3] {
        [0, 1, 2].map(|axis| self.cells.counts[axis].div_ceil(self.block[axis]))
    }

    /// The list cell that holds a density cell.
    pub fn list_of(&self, place: [u32; 3]) -> u32 {
        let [nx, ny, _] = self.list_counts();
        let [ix, iy, iz] = [0, 1, 2].map(|axis| place[axis] / self.block[axis]);
        (iz * ny + iy) * nx + ix
    }
}

impl Grids {
    /// The axis along which lists are narrowest, by the width in mm that they should have, among those that they do not fill.
    pub fn narrowest(&self, width: DVec3) -> usize {
        let (edges, counts) = (self.cells.edges(), self.list_counts());
        let share = |axis: usize| f64::from(self.block[axis]) * edges[axis] / width[axis];
        let open = (0..3).filter(|axis| counts[*axis] > 1);
        open.min_by(|a, b| share(*a).total_cmp(&share(*b))).unwrap_or_default()
    }

    /// Make lists twice as wide along an axis, and gather what was counted in them.
    pub fn widen(&mut self, axis: usize, counted: FxHashMap<Key, Gathered>) -> FxHashMap<Key, Gathered> {
        let narrow = self.list_counts();
        self.block[axis] *= 2;
        let wide = self.list_counts();
        let of = |list: u32| {
            let mut place = [list % narrow[0], list / narrow[0] % narrow[1], list / narrow[0] / narrow[1]];
            place[axis] /= 2;
            (place[2] * wide[1] + place[1]) * wide[0] + place[0]
        };
        // Directions are summed in floating point: keep the order.
        let mut sorted: Vec<(Key, Gathered)> = counted.into_iter().collect();
        sorted.sort_unstable_by_key(|(key, _)| *key);
        let mut gathered: FxHashMap<Key, Gathered> = FxHashMap::default();
        for (key, part) in sorted {
            let key = Key { list: of(key.list), ..key };
            gathered.entry(key).and_modify(|known| known.add(&part)).or_insert(part);
        }
        gathered
    }
}

/// Fibers of one kind in one list cell whose directions lie in one cell of the raw grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key {
    /// List cell.
    pub list: u32,
    /// Kind of fiber.
    pub kind: u32,
    /// Cell of the raw grid of directions.
    pub bin: u32,
}

/// What was counted of a key.
#[derive(Clone, Copy, Debug)]
pub struct Gathered {
    /// Σ R·length in units of 1/[`SURFACE_UNIT`] mm².
    pub surface: u64,
    /// Parts of pieces.
    pub parts: u32,
    /// Σ R·length·p in mm², p of one sign in the bin. Realizations are added in their order, so floats do.
    direction: DVec3,
    /// Whether all directions are the same.
    one: bool,
}

impl Gathered {
    /// The mean direction.
    pub fn mean(&self) -> DVec3 {
        self.direction.normalize_or(DVec3::Z)
    }

    /// The direction that all fibers share to 10⁻⁶, if they do.
    pub fn only(&self) -> Option<DVec3> {
        self.one.then(|| self.mean())
    }

    /// Take in another count; always in the same order, since directions are summed in floating point.
    pub fn add(&mut self, other: &Gathered) {
        self.surface += other.surface;
        self.parts += other.parts;
        let across =
            self.direction.cross(other.direction).length() / (self.direction.length() * other.direction.length());
        self.one &= other.one && across <= EXACT;
        // Directions on the horizon may have come with either sign.
        let same = self.direction.dot(other.direction) >= 0.0;
        self.direction += if same { other.direction } else { -other.direction };
    }
}

/// The counts of one realization.
#[derive(Clone, Debug)]
pub struct Count {
    /// Σ R·length in mm².
    pub total: f64,
    /// Σ R·length by density cell, in units of 1/[`SURFACE_UNIT`] mm².
    pub surface: Vec<u64>,
    /// Σ R·length × place from the cell's corner, in the same units times 1/[`EDGE_UNITS`] of an edge; none where it is not told.
    pub moments: Vec<[u64; 3]>,
    /// By list cell, kind and direction.
    pub directions: FxHashMap<Key, Gathered>,
}

/// Count all pieces of a realization.
pub fn count(pieces: &[Primitive], grids: &Grids) -> Count {
    let cells = grids.cells.len();
    let moments = vec![[0; 3]; if grids.centroids { cells } else { 0 }];
    let mut counted = Count { total: 0.0, surface: vec![0; cells], moments, directions: FxHashMap::default() };
    let mut clipper = Clipper::new(grids.cells);
    for piece in pieces {
        let half = piece.direction * (piece.length / 2.0);
        let whole = piece.radius * piece.length;
        let bin = grids.raw.cell_of(piece.direction) as u32;
        // Round the ends of the parts, not the parts: they add up to the piece.
        let units = |share: f64| (share * whole * SURFACE_UNIT).round() as u64;
        let gather = |directions: &mut FxHashMap<Key, Gathered>, (list, start, end): (u32, f64, f64), surface: u64| {
            if end > start {
                let key = Key { list, kind: piece.kind as u32, bin };
                let direction = piece.direction * ((end - start) * whole);
                let gathered = Gathered { surface, parts: 1, direction, one: true };
                directions.entry(key).and_modify(|known| known.add(&gathered)).or_insert(gathered);
            }
        };
        let (mut run, mut run_surface) = ((u32::MAX, 0.0, 0.0), 0);
        counted.total += whole;
        let Count { surface, moments, directions, .. } = &mut counted;
        clipper.parts(piece.centre - half, piece.centre + half, |place, start, end, within| {
            let part = units(end) - units(start);
            let cell = grids.cells.index(place);
            surface[cell] += part;
            if let Some(moment) = moments.get_mut(cell) {
                let units = (within * EDGE_UNITS).as_u64vec3().to_array();
                moment.iter_mut().zip(units).for_each(|(sum, units)| *sum += part * units);
            }
            // Parts in one list cell follow each other.
            let list = grids.list_of(place);
            if list != run.0 {
                gather(directions, run, run_surface);
                (run, run_surface) = ((list, start, start), 0);
            }
            run.2 = end;
            run_surface += part;
        });
        gather(&mut counted.directions, run, run_surface);
    }
    counted
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    /// Straight pieces that lean everywhere, of two kinds.
    fn pieces() -> Vec<Primitive> {
        let piece = |i: u32| {
            let turn = f64::from(i) * 2.4;
            let height = (f64::from(i) * 0.618).fract() - 0.5;
            let direction = DVec3::new(turn.cos(), turn.sin(), height).normalize();
            let at = |step: f64| (f64::from(i) * step).fract();
            let centre = DVec3::new(at(0.7548), at(0.5698), -0.05 - 0.3 * at(0.3247));
            Primitive { centre, direction, length: 0.06, radius: 0.005, kind: (i % 2) as usize, thread: 0 }
        };
        (0..500).map(piece).collect()
    }

    #[test]
    fn lists_that_are_widened_are_those_that_are_counted_wide() {
        // Counts that are no powers of two: the last list of a row is smaller.
        let cells = CellGrid { counts: [11, 6, 5], period: DVec2::ONE, thickness: 0.4 };
        let grids = |block| Grids { cells, block, raw: DirectionGrid { n: 8 }, voids: false, centroids: false };
        let pieces = pieces();
        let mut narrow = grids([1, 1, 1]);
        let mut widened = count(&pieces, &narrow).directions;
        for axis in [0, 2, 0, 1] {
            widened = narrow.widen(axis, widened);
        }
        let wide = count(&pieces, &grids([4, 2, 2]));
        assert_eq!(narrow.list_counts(), grids([4, 2, 2]).list_counts());
        let surfaces = |counted: &FxHashMap<Key, Gathered>| {
            let mut sorted: Vec<(Key, u64)> = counted.iter().map(|(key, found)| (*key, found.surface)).collect();
            sorted.sort_unstable();
            sorted
        };
        assert_eq!(surfaces(&widened), surfaces(&wide.directions));
        for (key, found) in &widened {
            let away = found.mean().cross(wide.directions[key].mean()).length();
            assert!(away < 1e-12, "{key:?}: {away}");
        }
        // Along another axis it is another grid.
        let mut other = grids([1, 1, 1]);
        let lengthened = other.widen(1, count(&pieces, &other).directions);
        assert_ne!(surfaces(&lengthened), surfaces(&wide.directions));
    }
}
