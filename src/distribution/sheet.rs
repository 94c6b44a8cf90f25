//! The specific length of a statistically homogeneous sheet.

use super::cells::{Cell, CellGrid};
use super::directions::{DirectionGrid, direction_of, horizon, square_of};
use super::spread::{cone_points, visible_area_error};
use crate::concentric::Patch;
use crate::scene::{Orientation, Sheet};
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::f64::consts::PI;

/// Points that stand for the directions of a spread bundle.
const CONE_POINTS: u32 = 1 << 16;
/// One in so many of such points is a ray at which the error of H is looked at: 256 of all, 256 near the bundle.
const RAY_STEP: usize = (CONE_POINTS / 256) as usize;
/// Directions that agree to this are one direction.
pub(super) const EXACT: f64 = 1e-6;

/// Fibers of one kind whose directions are uniform over one patch of E⁺.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bundle {
    /// Index of the kind of fiber in the scene.
    pub kind: usize,
    /// Where their directions lie.
    pub patch: Patch,
    /// F of the patch, ∫f dΩ, in mm/mm³; in a list that cells share, up to a factor.
    pub length_density: f64,
}

/// f(p, x) of a cloth (paper §3): a grid of cells, each with a density and a list of bundles that cells may share.
#[derive(Clone, Debug, PartialEq)]
pub struct SpecificLength {
    /// The grid from which the patches were taken.
    pub grid: DirectionGrid,
    /// Where the cells lie.
    pub cells: CellGrid,
    /// What they hold, by index.
    pub values: Vec<Cell>,
    /// Lists of bundles with their relative shares: the surface of a cell sets the scale.
    pub lists: Vec<Vec<Bundle>>,
    /// Largest |H(tabulated) − H(stated)| found of any spread bundle over rays m, relative to its largest H.
    pub spread_error: f64,
}

impl SpecificLength {
    /// Tabulate a sheet: one cell with one list; `radius` gives R of a kind of fiber in mm.
    pub fn of_sheet(sheet: &Sheet, grid: DirectionGrid, radius: impl Fn(usize) -> f64) -> SpecificLength {
        let mut bundles: Vec<Bundle> = Vec::new();
        let mut spread_error: f64 = 0.0;
        let mut places = HashMap::new();
        for fibers in &sheet.fibers {
            let parts = match fibers.orientation {
                Orientation::Isotropic => evenly(grid.cells().collect()),
                Orientation::Planar => evenly(horizon().collect()),
                Orientation::Aligned { axis, spread } if spread.sin() <= EXACT => {
                    evenly(vec![Patch { corner: square_of(axis), extent: DVec2::ZERO }])
                }
                Orientation::Aligned { axis, spread } => {
                    let cone: Vec<DVec3> = cone_points(axis, spread, CONE_POINTS).collect();
                    let parts = smear(&cone, grid);
                    // Look along the bundle too: there H is least and the smear shows most.
                    let near = cone_points(axis, (spread + 2.0 * grid.cell_angle()).min(PI / 2.0), CONE_POINTS);
                    let rays =
                        cone_points(DVec3::Z, PI / 2.0, CONE_POINTS).step_by(RAY_STEP).chain(near.step_by(RAY_STEP));
                    let stated: Vec<(DVec3, f64)> =
                        cone.iter().step_by(16).map(|p| (*p, 16.0 / f64::from(CONE_POINTS))).collect();
                    let error = visible_area_error(&parts, &stated, rays.chain([axis]));
                    spread_error = spread_error.max(error);
                    parts
                }
            };
            for (patch, share) in parts {
                // Merge fibers of one kind that share a patch.
                let place = *places.entry((fibers.fiber, patch.key())).or_insert(bundles.len());
                if place == bundles.len() {
                    bundles.push(Bundle { kind: fibers.fiber, patch, length_density: 0.0 });
                }
                bundles[place].length_density += fibers.length_density * share;
            }
        }
        let surface = surface(&bundles, radius);
        SpecificLength {
            grid,
            cells: CellGrid::homogeneous(sheet.thickness),
            values: vec![Cell { surface, placement: 1.0, list: 0, centroid: Cell::MIDDLE }],
            lists: vec![bundles],
            spread_error,
        }
    }

    /// H(m) = Σ 2 R ∫|m × p| f dΩ of a cell in 1/mm (paper §3), by the midpoints of 8 × 8 parts of each patch; `radius`
    /// gives R of a kind of fiber in mm.
    pub fn visible_area(&self, cell: usize, m: DVec3, radius: impl Fn(usize) -> f64) -> f64 {
        let Cell { surface, .. } = self.values[cell];
        if surface > 0.0 { 2.0 * surface * mean_sine(self.bundles(cell), m, radius) } else { 0.0 }
    }

    /// H(m) in 1/mm, the mean over all cells.
    pub fn mean_visible_area(&self, m: DVec3, radius: impl Fn(usize) -> f64) -> f64 {
        // Look at each list once: cells that share one differ in their surface alone.
        let mut surface = vec![0.0; self.lists.len()];
        for cell in self.values.iter().filter(|cell| cell.surface > 0.0) {
            surface[cell.list as usize] += cell.surface;
        }
        let of_list = |(list, surface): (&Vec<Bundle>, f64)| {
            if surface > 0.0 { 2.0 * surface * mean_sine(list, m, &radius) } else { 0.0 }
        };
        self.lists.iter().zip(surface).map(of_list).sum::<f64>() / self.values.len() as f64
    }

    /// F = ∫f dΩ over E⁺ of a cell, in mm/mm³.
    pub fn total(&self, cell: usize, radius: impl Fn(usize) -> f64) -> f64 {
        self.scale(cell, radius) * self.bundles(cell).iter().map(|bundle| bundle.length_density).sum::<f64>()
    }

    /// The list of a cell; an empty cell has none.
    fn bundles(&self, cell: usize) -> &[Bundle] {
        let Cell { surface, list, .. } = self.values[cell];
        if surface > 0.0 { &self.lists[list as usize] } else { &[] }
    }

    /// What turns the shares of a cell's list into densities.
    fn scale(&self, cell: usize, radius: impl Fn(usize) -> f64) -> f64 {
        let surface = surface(self.bundles(cell), radius);
        if surface > 0.0 { self.values[cell].surface / surface } else { 0.0 }
    }
}

/// Σ R F of a list, in 1/mm when its shares are densities in mm/mm³; `radius` gives R of a kind of fiber in mm.
pub fn surface(bundles: &[Bundle], radius: impl Fn(usize) -> f64) -> f64 {
    bundles.iter().map(|bundle| radius(bundle.kind) * bundle.length_density).sum()
}

/// ⟨|m × p|⟩ over the fibers of a list with weight R f, by the midpoints of 8 × 8 parts of each patch.
fn mean_sine(bundles: &[Bundle], m: DVec3, radius: impl Fn(usize) -> f64) -> f64 {
    let part = |bundle: &Bundle| {
        let middles = (0..64).map(|i| (DVec2::new(f64::from(i % 8), f64::from(i / 8)) + 0.5) / 8.0);
        let sines = middles.map(|place| m.cross(direction_of(bundle.patch.at(place))).length());
        radius(bundle.kind) * bundle.length_density * sines.sum::<f64>() / 64.0
    };
    bundles.iter().map(part).sum::<f64>() / surface(bundles, &radius)
}

/// Equal shares for patches of equal measure.
fn evenly(patches: Vec<Patch>) -> Vec<(Patch, f64)> {
    let share = 1.0 / patches.len() as f64;
    patches.into_iter().map(|patch| (patch, share)).collect()
}

/// The share of the cone that each cell of the grid holds.
fn smear(cone: &[DVec3], grid: DirectionGrid) -> Vec<(Patch, f64)> {
    let mut shares = vec![0.0; (grid.n * grid.n) as usize];
    for &p in cone {
        shares[grid.cell_of(p)] += 1.0 / cone.len() as f64;
    }
    grid.cells().zip(shares).filter(|(_, share)| *share > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SheetFibers;

    fn sheet(orientations: &[Orientation]) -> Sheet {
        let fibers =
            |orientation: &Orientation| SheetFibers { fiber: 0, length_density: 100.0, orientation: *orientation };
        Sheet { thickness: 1.0, fibers: orientations.iter().map(fibers).collect() }
    }

    #[test]
    fn the_total_is_the_stated_length_whatever_the_orientation() {
        let spread = Orientation::Aligned { axis: DVec3::new(0.6, 0.0, 0.8), spread: 0.2 };
        let all = [Orientation::Isotropic, Orientation::Planar, spread];
        let f = SpecificLength::of_sheet(&sheet(&all), DirectionGrid { n: 16 }, |_| 0.01);
        let total = f.total(0, |_| 0.01);
        assert!((total - 300.0).abs() < 1e-9, "{total}");
    }

    #[test]
    fn the_visible_area_has_its_closed_forms() {
        let area = |orientation, m| {
            SpecificLength::of_sheet(&sheet(&[orientation]), DirectionGrid { n: 32 }, |_| 0.01).visible_area(
                0,
                m,
                |_| 0.01,
            )
        };
        let tilted = DVec3::new(0.6, 0.0, 0.8);
        // ⟨|m × p|⟩ is π/4 for isotropic fibers, 1 for planar ones seen from above, a sine for aligned ones.
        assert!((area(Orientation::Isotropic, tilted) - 2.0 * PI / 4.0).abs() < 1e-4);
        assert!((area(Orientation::Planar, DVec3::Z) - 2.0).abs() < 1e-12);
        assert!((area(Orientation::Aligned { axis: DVec3::X, spread: 0.0 }, tilted) - 1.6).abs() < 1e-12);
    }

    #[test]
    fn equal_bundles_are_merged() {
        let aligned = Orientation::Aligned { axis: DVec3::X, spread: 0.0 };
        let f = SpecificLength::of_sheet(&sheet(&[aligned, aligned]), DirectionGrid { n: 16 }, |_| 0.01);
        assert_eq!(f.lists[0].len(), 1);
        assert_eq!(f.lists[0][0].length_density, 200.0);
        assert_eq!(f.values[0].surface, 2.0);
    }

    #[test]
    fn a_finer_grid_smears_a_spread_bundle_less() {
        let spread = Orientation::Aligned { axis: DVec3::new(0.6, 0.0, 0.8), spread: 0.1 };
        let error = |n| SpecificLength::of_sheet(&sheet(&[spread]), DirectionGrid { n }, |_| 0.01).spread_error;
        let (coarse, fine) = (error(8), error(64));
        assert!(fine < coarse / 4.0 && fine < 0.01, "8: {coarse}, 64: {fine}");
    }
}
