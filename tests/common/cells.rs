//! Cloths of cells, put together by hand.

use super::Cloth;
use fiberwalk::distribution::{Bundle, Cell, CellGrid, DirectionGrid, SpecificLength, surface};
use fiberwalk::goniometer::{Goniometer, Tally};
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::tables::SamplingTables;
use fiberwalk::walk::{Engine, WalkPlan};
use glam::DVec2;

/// A periodic grid of cells.
#[derive(Clone, Debug)]
pub struct CellCloth {
    /// Kinds of fiber, thickness and instrument.
    pub base: Cloth,
    pub counts: [u32; 3],
    /// In mm.
    pub period: [f64; 2],
    /// Surface Σ R F in 1/mm and list of each cell.
    pub cells: Vec<(f64, u32)>,
    pub lists: Vec<Vec<Bundle>>,
}

/// The list of a sheet.
pub fn list_of(cloth: &Cloth) -> Vec<Bundle> {
    let prepared = prepare(&cloth.scene()).expect("the cloth is fine");
    prepared.specific_length.lists.into_iter().next().expect("a sheet has one list")
}

/// Σ R F of a sheet in 1/mm.
pub fn surface_of(cloth: &Cloth) -> f64 {
    let scene = cloth.scene();
    surface(&list_of(cloth), |kind| scene.fibers[kind].radius)
}

impl CellCloth {
    /// Cells with the fibers of `base`, whose density counts `share(ix, iy, iz)` times.
    pub fn new(base: Cloth, counts: [u32; 3], period: [f64; 2], share: impl Fn([u32; 3]) -> f64) -> CellCloth {
        let grid = CellGrid { counts, period: DVec2::from(period), thickness: base.thickness_um * 1e-3 };
        let whole = surface_of(&base);
        let cells = grid.places().map(|place| (share(place) * whole, 0)).collect();
        let lists = vec![list_of(&base)];
        CellCloth { base, counts, period, cells, lists }
    }

    pub fn grid(&self) -> CellGrid {
        CellGrid { counts: self.counts, period: DVec2::from(self.period), thickness: self.base.thickness_um * 1e-3 }
    }

    pub fn specific_length(&self) -> SpecificLength {
        SpecificLength {
            grid: DirectionGrid { n: self.base.directions.isqrt() },
            cells: self.grid(),
            values: self.cells.iter().map(|&(surface, list)| Cell { surface, placement: 1.0, list }).collect(),
            lists: self.lists.clone(),
            spread_error: 0.0,
        }
    }

    pub fn prepare(&self) -> (SamplingTables, Goniometer) {
        let scene = self.base.scene();
        let tables = SamplingTables::new(&scene, &self.specific_length()).unwrap_or_else(|error| panic!("{error}"));
        let Prepared { goniometer, .. } = prepare(&scene).expect("the cloth is fine");
        (tables, goniometer)
    }

    /// Measure with an engine and hold the accounts against the plan.
    pub fn run(&self, engine: &dyn Engine, plan: &WalkPlan) -> Tally {
        let (tables, goniometer) = self.prepare();
        let tally = engine.run(&tables, &goniometer, plan, &mut |_| {}).unwrap_or_else(|error| panic!("{error}"));
        tally.check(plan.walks_per_incident).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(tally.origin().seed, plan.seed);
        tally
    }
}
