//! Cloths of cells, put together by hand.

use super::{Cloth, ISOTROPIC, Kind, PLANAR, SplitMix, aligned, rgb};
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
    /// Factor of each cell; all 1 where there is none.
    pub factors: Vec<f64>,
    /// Fibers lie in a part of each cell.
    pub cut: bool,
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
        CellCloth { base, counts, period, cells, lists, factors: Vec::new(), cut: false }
    }

    pub fn grid(&self) -> CellGrid {
        CellGrid { counts: self.counts, period: DVec2::from(self.period), thickness: self.base.thickness_um * 1e-3 }
    }

    pub fn specific_length(&self) -> SpecificLength {
        let placement = |i: usize| self.factors.get(i).copied().unwrap_or(1.0);
        // Fibers of one place are as good as those of another.
        let centroid = |i: usize| [3, 7, 11].map(|step| 0.15 + 0.7 * ((i * step) % 13) as f32 / 12.0);
        let cell = |(i, &(surface, list))| Cell {
            surface,
            placement: placement(i),
            list,
            centroid: if self.cut { centroid(i) } else { Cell::MIDDLE },
        };
        SpecificLength {
            grid: DirectionGrid { n: self.base.directions.isqrt() },
            cells: self.grid(),
            values: self.cells.iter().enumerate().map(cell).collect(),
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

/// Cells at random: seven of ten empty, in clumps, densities over a factor of 10, two kinds that absorb, three lists.
pub fn random_cells(seed: u64) -> CellCloth {
    let mut random = SplitMix(seed);
    let base = Cloth {
        absorption: rgb([2.0, 1.0, 0.2]),
        sides: "[\"front\", \"back\"]".into(),
        ..Cloth::new(60.0, ISOTROPIC)
    };
    let mixed =
        Cloth { more_kinds: vec![Kind::dyed(40.0)], ..base.clone() }.lit_from("[[12, 10], [47, 100], [83, -130]]");
    let lists = [ISOTROPIC.to_owned(), PLANAR.to_owned(), aligned([0.6, 0.0, 0.8])]
        .map(|orientation| list_of(&Cloth { fibers: vec![(60.0, orientation)], ..mixed.clone() }));
    let mut cells = CellCloth::new(mixed, [9, 7, 6], [1.3, 0.9], |_| 0.0);
    let clumps: Vec<[u32; 3]> = (0..9).map(|_| [9, 7, 6].map(|count: u64| (random.word() % count) as u32)).collect();
    for (index, place) in cells.grid().places().enumerate() {
        let near = clumps.iter().any(|clump| (0..3).all(|axis| clump[axis].abs_diff(place[axis]) <= 1));
        if near && random.uniform() < 0.8 {
            cells.cells[index] = (0.5 + 4.5 * random.uniform(), (random.word() % 3) as u32);
        }
    }
    CellCloth { lists: lists.to_vec(), ..cells }
}
