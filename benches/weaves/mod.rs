//! Cells like those of real cloths: yarns of elliptic section on sine waves, an open plain weave and a dense twill.

use fiberwalk::distribution::{Cell, CellGrid, DirectionGrid, SpecificLength};
use fiberwalk::scene::{Orientation, Placement, Scene, Sheet, SheetFibers, Source};
use fiberwalk::tables::SamplingTables;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// A weave of two systems of yarn; lengths in mm.
pub struct Weave {
    /// Warp over weft, by pick and end.
    pub draft: &'static [&'static [bool]],
    /// Distance of yarns.
    pub spacing: f64,
    /// Half axes of a yarn's section, across and along z.
    pub half: [f64; 2],
    /// Height of the middle of a yarn at a crossing, above and below the middle of the cloth.
    pub height: f64,
    /// Σ R F in the middle of a yarn, in 1/mm, and its share at the rim.
    pub surface: f64,
    pub rim: f64,
    pub counts: [u32; 3],
}

pub const VOILE: Weave = Weave {
    draft: &[&[true, false], &[false, true]],
    spacing: 0.7,
    half: [0.08, 0.055],
    height: 0.06,
    surface: 18.0,
    rim: 0.5,
    counts: [40, 40, 8],
};

pub const DENIM: Weave = Weave {
    draft: &[&[true, true, false], &[true, false, true], &[false, true, true]],
    spacing: 0.4,
    half: [0.16, 0.12],
    height: 0.12,
    surface: 20.0,
    rim: 0.1,
    counts: [32, 32, 16],
};

impl Weave {
    /// Density (share of `surface`) and direction of the yarn at a place, if there is one.
    fn yarn(&self, place: DVec3) -> Option<(f64, DVec3)> {
        let n = self.draft.len();
        let systems = [(place.x, place.y, true), (place.y, place.x, false)];
        let found = systems.into_iter().filter_map(|(across, along, warp)| {
            let nearest = (across / self.spacing).round();
            let yarn = nearest.rem_euclid(n as f64) as usize;
            let up = |crossing: f64| {
                let other = crossing.rem_euclid(n as f64) as usize;
                let over = if warp { self.draft[other][yarn] } else { !self.draft[yarn][other] };
                if over { 1.0 } else { -1.0 }
            };
            // Go from crossing to crossing on half a cosine.
            let at = along / self.spacing;
            let (from, to) = (up(at.floor()), up(at.floor() + 1.0));
            let fraction = at - at.floor();
            let z = self.height * (0.5 * (from + to) + 0.5 * (from - to) * (PI * fraction).cos());
            let slope = self.height / self.spacing * 0.5 * (to - from) * PI * (PI * fraction).sin();
            let offset = DVec2::new((across - nearest * self.spacing) / self.half[0], (place.z - z) / self.half[1]);
            let direction = if warp { DVec3::new(0.0, 1.0, slope) } else { DVec3::new(1.0, 0.0, slope) };
            let radius = offset.length_squared();
            (radius < 1.0).then(|| (1.0 - (1.0 - self.rim) * radius, direction.normalize()))
        });
        found.max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Cut into cells, with a list for each yarn system and slope.
    pub fn specific_length(&self) -> SpecificLength {
        let thickness = 2.0 * (self.height + self.half[1]);
        let period = DVec2::splat(self.spacing * self.draft.len() as f64);
        let cells = CellGrid { counts: self.counts, period, thickness };
        let grid = DirectionGrid { n: 32 };
        let mut lists = Vec::new();
        for warp in [true, false] {
            for slope in [-0.6, -0.3, 0.0, 0.3, 0.6] {
                let axis = if warp { DVec3::new(0.0, 1.0, slope) } else { DVec3::new(1.0, 0.0, slope) };
                let orientation = Orientation::Aligned { axis: axis.normalize(), spread: 15f64.to_radians() };
                let fibers = vec![SheetFibers { fiber: 0, length_density: 1.0, orientation }];
                let sheet = Sheet { thickness, fibers };
                lists.extend(SpecificLength::of_sheet(&sheet, grid, |_| 0.0065).lists);
            }
        }
        let values = cells.places().map(|place| self.cell(&cells, place)).collect();
        SpecificLength { grid, cells, values, lists, spread_error: 0.0 }
    }

    /// Average over 6³ places of a cell.
    fn cell(&self, cells: &CellGrid, place: [u32; 3]) -> Cell {
        let corner = DVec3::from(place.map(f64::from));
        let (mut density, mut direction) = (0.0, DVec3::ZERO);
        for i in 0..216 {
            let within = (DVec3::from([i % 6, i / 6 % 6, i / 36].map(f64::from)) + 0.5) / 6.0;
            let at = (corner + within) * cells.edges() - DVec3::Z * (cells.thickness / 2.0);
            if let Some((share, along)) = self.yarn(at) {
                density += share / 216.0;
                direction += share * along;
            }
        }
        let warp = direction.y.abs() > direction.x.abs();
        let slope = direction.z / direction.truncate().max_element().max(1e-9);
        let step = (slope / 0.3).round().clamp(-2.0, 2.0) as i32 + 2;
        // Fibers of 6.5 µm that do not overlap.
        let surface = self.surface * density;
        let placement = 1.0 / (1.0 - PI * 0.0065 * surface);
        Cell { surface, placement, list: step as u32 + if warp { 0 } else { 5 }, centroid: Cell::MIDDLE }
    }
}

/// The tables of a placement.
pub fn tables(specific_length: &SpecificLength, placement: Placement) -> SamplingTables {
    let mut scene = scene();
    scene.model.placement = placement;
    SamplingTables::new(&scene, specific_length).unwrap_or_else(|error| panic!("{error}"))
}

/// One kind of fiber, in whatever sheet.
fn scene() -> Scene {
    let text = "[fiber.f]\nradius_um = 6.5\nior = 1.55\nabsorption_per_mm = 0\n[sheet]\nthickness_um = 400\n\
                [[sheet.fibers]]\nfiber = \"f\"\nlength_density_per_mm2 = 100\norientation = \"isotropic\"\n";
    let source = Source { file: "bench.toml".into(), stem: "bench".into(), text: text.into(), folder: None };
    Scene::parse(&source).unwrap_or_else(|error| panic!("{error}"))
}
