//! What the tests share: the device, cloths written as a user would, independent optics, statistics.
#![allow(dead_code, reason = "each test binary uses its own part")]

pub mod cells;
pub mod counted;
pub mod probes;
pub mod program;
pub mod sheet;
pub mod stats;
pub mod straight;
pub mod tracer;
pub mod wif_files;
pub mod woven;

use fiberwalk::goniometer::Tally;
use fiberwalk::gpu::Gpu;
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::reference::Reference;
use fiberwalk::scene::{Scene, Source};
use fiberwalk::walk::{Engine, WalkPlan};
use std::sync::OnceLock;

/// The device of this test binary. No adapter is a failure, not a reason to skip.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::open(None).unwrap_or_else(|error| panic!("these tests need an adapter: {error}")))
}

/// Both engines under their names.
pub fn engines() -> [(&'static str, &'static dyn Engine); 2] {
    [("gpu", gpu()), ("cpu", &Reference)]
}

/// A further kind of fiber and all its fibers.
#[derive(Clone, Debug)]
pub struct Kind {
    pub radius_um: f64,
    pub ior: f64,
    /// Text of `absorption_per_mm`.
    pub absorption: String,
    pub length_density: f64,
    /// The rest of its `[[sheet.fibers]]`.
    pub orientation: String,
}

/// A sheet, as numbers for a cloth file. The first kind has the fields of the cloth itself.
#[derive(Clone, Debug)]
pub struct Cloth {
    pub radius_um: f64,
    pub ior: f64,
    /// Text of `absorption_per_mm`.
    pub absorption: String,
    pub more_kinds: Vec<Kind>,
    pub length_over_radius: f64,
    /// Text of `sides`.
    pub sides: String,
    pub thickness_um: f64,
    /// Length density in mm/mm³ and the rest of a `[[sheet.fibers]]`.
    pub fibers: Vec<(f64, String)>,
    pub directions: u32,
    pub tracking: &'static str,
    pub placement: &'static str,
    pub memory: &'static str,
    pub incident: String,
    pub exit: u32,
    /// A named exit basis in place of the disc's.
    pub exit_basis: Option<&'static str>,
}

impl Kind {
    /// A second kind beside that of the cloth: thinner, of another index, red.
    pub fn dyed(length_density: f64) -> Kind {
        Kind {
            radius_um: 6.0,
            ior: 1.33,
            absorption: rgb([0.5, 3.0, 9.0]),
            length_density,
            orientation: aligned([0.1, 0.9, 0.2]),
        }
    }
}

pub const ISOTROPIC: &str = "orientation = \"isotropic\"";
pub const PLANAR: &str = "orientation = \"planar\"";

pub fn aligned(axis: [f64; 3]) -> String {
    format!("orientation = \"aligned\"\naxis = {axis:?}")
}

/// `absorption_per_mm` of a dye.
pub fn rgb(sigma: [f64; 3]) -> String {
    format!("{{ rgb = {sigma:?} }}")
}

impl Cloth {
    /// Fibers of radius 10 µm in a sheet of 1 mm.
    pub fn new(length_density: f64, orientation: &str) -> Cloth {
        Cloth {
            radius_um: 10.0,
            ior: 1.5,
            absorption: "0".into(),
            more_kinds: Vec::new(),
            length_over_radius: f64::INFINITY,
            sides: "[\"front\"]".into(),
            thickness_um: 1000.0,
            fibers: vec![(length_density, orientation.into())],
            directions: 1024,
            tracking: "null-collision",
            placement: "at-hit",
            memory: "none",
            incident: "8".into(),
            exit: 16,
            exit_basis: None,
        }
    }

    /// Isotropic fibers with a given true optical depth H·d: H = 2 R L π/4.
    pub fn isotropic(depth: f64) -> Cloth {
        Cloth::new(depth / (2.0 * 0.01 * std::f64::consts::FRAC_PI_4), ISOTROPIC)
    }

    pub fn lit_from(self, incident: &str) -> Cloth {
        Cloth { incident: incident.into(), ..self }
    }

    /// The same sheet, with a named basis of exit cells.
    pub fn counted_in(self, exit: &'static str) -> Cloth {
        Cloth { exit_basis: Some(exit), ..self }
    }

    /// The same sheet, tracked by tables.
    pub fn tabulated(self) -> Cloth {
        Cloth { tracking: "tabulated", ..self }
    }

    /// The same sheet with another placement.
    pub fn placed(self, placement: &'static str) -> Cloth {
        Cloth { placement, ..self }
    }

    /// The same sheet, whose walks remember their last flight.
    pub fn remembering(self) -> Cloth {
        Cloth { memory: "flight", ..self }
    }

    /// The file's text.
    pub fn toml(&self) -> String {
        let Cloth { radius_um, ior, absorption, thickness_um, directions, tracking, placement, memory, .. } = self;
        let Cloth { incident, sides, .. } = self;
        let exit = self.exit_basis.map_or_else(|| self.exit.to_string(), |name| format!("{name:?}"));
        let fiber = |name: &str, radius: &f64, ior: &f64, absorption: &str| {
            format!("[fiber.{name}]\nradius_um = {radius}\nior = {ior}\nabsorption_per_mm = {absorption}\n")
        };
        let mut text = fiber("f", radius_um, ior, absorption);
        for (i, kind) in self.more_kinds.iter().enumerate() {
            text += &fiber(&format!("g{i}"), &kind.radius_um, &kind.ior, &kind.absorption);
        }
        text += &format!(
            "[model]\ntracking = \"{tracking}\"\nplacement = \"{placement}\"\nmemory = \"{memory}\"\npacking = \"random\"\ndirections = {directions}\n\
             length_over_radius = {}\n[measure]\nsides = {sides}\nincident = {incident}\nexit = {exit}\n[sheet]\nthickness_um = {thickness_um}\n",
            self.length_over_radius
        );
        let mut part = |name: &str, density: f64, rest: &str| {
            text += &format!("[[sheet.fibers]]\nfiber = \"{name}\"\nlength_density_per_mm2 = {density}\n{rest}\n");
        };
        self.fibers.iter().for_each(|(density, rest)| part("f", *density, rest));
        for (i, kind) in self.more_kinds.iter().enumerate() {
            part(&format!("g{i}"), kind.length_density, &kind.orientation);
        }
        text
    }

    pub fn scene(&self) -> Scene {
        let source = Source { file: "test.toml".into(), stem: "test".into(), text: self.toml(), folder: None };
        Scene::parse(&source).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Measure with an engine and hold the accounts against the plan.
    pub fn run(&self, engine: &dyn Engine, plan: &WalkPlan) -> Tally {
        let Prepared { tables, goniometer, .. } = prepare(&self.scene()).unwrap_or_else(|error| panic!("{error}"));
        let tally = engine.run(&tables, &goniometer, plan, &mut |_| {}).unwrap_or_else(|error| panic!("{error}"));
        tally.check(plan.walks_per_incident).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(tally.origin().seed, plan.seed);
        tally
    }
}

/// Assert from the result which engine ran.
pub fn assert_ran(tally: &Tally, engine: &str) {
    assert_eq!(tally.origin().engine, engine, "the wrong engine ran");
}

/// Run with an engine, each from random numbers of its own, and see that it was this engine.
pub fn run(name: &str, engine: &dyn Engine, cloth: &Cloth, plan: &WalkPlan) -> Tally {
    let seed = plan.seed + if name == "cpu" { 10_000 } else { 0 };
    let tally = cloth.run(engine, &WalkPlan { seed, ..plan.clone() });
    assert_ran(&tally, name);
    tally
}

/// All counts of scattered light.
pub fn scattered(tally: &Tally) -> Vec<u64> {
    (0..tally.starts()).flat_map(|cell| [tally.reflection(cell), tally.transmission(cell)].concat()).collect()
}

/// Mean light of one walk and its standard error: reflected by channel, then transmitted by channel.
pub fn mean_light(tally: &Tally, start: usize) -> Vec<(f64, f64)> {
    let cells = tally.layout.exit_cells;
    let (n, unit) = (tally.walks_per_incident() as f64, tally.unit() as f64);
    let of = |side: usize, channel| {
        let moments = (side * cells..(side + 1) * cells).map(|bin| tally.light(start, bin, channel));
        let (sum, square) = moments.fold((0, 0), |(sum, square), light| (sum + light.sum, square + light.square));
        stats::mean_error(sum as f64 / unit, square as f64 / (unit * unit), n)
    };
    (0..2).flat_map(|side| (0..tally.channels()).map(move |channel| of(side, channel))).collect()
}

/// A generator that has nothing to do with the program's own: SplitMix64.
#[derive(Clone, Debug)]
pub struct SplitMix(pub u64);

impl SplitMix {
    pub fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in (0, 1).
    pub fn uniform(&mut self) -> f64 {
        ((self.word() >> 12) as f64 + 0.5) * 2f64.powi(-52)
    }

    /// Uniform on the sphere.
    pub fn direction(&mut self) -> glam::DVec3 {
        let z = 2.0 * self.uniform() - 1.0;
        let (sin, cos) = (std::f64::consts::TAU * self.uniform()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        glam::DVec3::new(r * cos, r * sin, z)
    }
}
