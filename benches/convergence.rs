//! How far the settings of the distribution calculator are from their limit: `cargo bench --bench convergence -- voile`; a
//! further word leaves rows out whose name does not contain it.
//!
//! For each preset named (all three woven ones without a name), a finest model is the reference; then one setting is
//! changed at a time. Each row has E, the difference from the reference without the noise of the walks, and its resolution;
//! R and T by listed direction (of the first channel), direct light by direction, bytes of the tables, the seconds
//! that they took to prepare, and the speed of the walks. Direct light by straight rays through the realizations stands beside. The output is Markdown.
//!
//! Rows of a number of realizations, and the last ones, count realizations that the reference does not have.

#[path = "../tests/common/mod.rs"]
mod common;

use common::straight::{openness, ray};
use fiberwalk::bsdf::{compare, totals};
use fiberwalk::cloth::Cloth;
use fiberwalk::distribution::{CellGrid, Effort, Element, SpecificLength};
use fiberwalk::error::Result;
use fiberwalk::goniometer::{Goniometer, Tally};
use fiberwalk::gpu::Gpu;
use fiberwalk::scene::{Scene, Source};
use fiberwalk::tables::SamplingTables;
use fiberwalk::walk::{Engine, WalkPlan};
use std::time::Instant;

/// Incident directions (θ, φ) in degrees.
const DIRECTIONS: [[f64; 2]; 4] = [[0.0, 0.0], [30.0, 20.0], [60.0, 0.0], [60.0, 45.0]];
/// Exit cells along an edge of the disc.
const EXIT: &str = "8";
/// Walks of each direction of a row; the reference has twice as many.
const WALKS: u64 = 300_000;
/// Edge of the cells of the reference in radii, and its realizations: denim is too large for more.
const FINEST: [(&str, f64, u64); 3] = [("voile", 1.5, 256), ("charmeuse", 1.5, 256), ("denim", 2.0, 128)];
/// Realizations and rays along an edge of each for straight rays.
const STRAIGHT: (u64, u32) = (48, 512);

/// One model.
#[derive(Clone, Copy)]
struct Setting {
    /// Edge of a cell in radii; none for one cell.
    edge: Option<f64>,
    directions: u32,
    cone_deg: f64,
    /// Width of a direction list in shares of the distance of two yarns, and of the thickness.
    lists: f64,
    effort: Effort,
    /// Number of the first realization.
    first: u64,
}

fn main() -> Result<()> {
    let named: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let part = named.iter().find(|word| !FINEST.iter().any(|(name, ..)| name == word)).map_or("", |word| word.as_str());
    let all = !FINEST.iter().any(|(name, ..)| named.iter().any(|known| known == name));
    let gpu = Gpu::open(None)?;
    println!("On {}; {WALKS} walks of each direction, exit cells {EXIT} × {EXIT} on each side.", gpu.adapter());
    for (name, edge, realizations) in FINEST {
        if all || named.iter().any(|known| known == name) {
            let effort = Effort::Realizations(realizations);
            let finest = Setting { edge: Some(edge), directions: 4096, cone_deg: 0.0, lists: 0.25, effort, first: 0 };
            Study::new(&gpu, name)?.print(finest, part)?;
        }
    }
    Ok(())
}

struct Study<'a> {
    gpu: &'a Gpu,
    name: String,
    scene: Scene,
    cloth: Cloth,
    goniometer: Goniometer,
    seed: u64,
}

impl<'a> Study<'a> {
    fn new(gpu: &'a Gpu, name: &str) -> Result<Study<'a>> {
        let mut scene = Scene::parse(&Source::find(name)?)?;
        scene.measure.set_from_flag("incident", &format!("{DIRECTIONS:?}"))?;
        scene.measure.set_from_flag("exit", EXIT)?;
        let (cloth, goniometer) = (Cloth::new(&scene)?, Goniometer::new(&scene.measure));
        Ok(Study { gpu, name: name.into(), scene, cloth, goniometer, seed: 0 })
    }

    fn print(mut self, finest: Setting, part: &str) -> Result<()> {
        println!("\n## {}\n\nDirections of light (θ, φ): {DIRECTIONS:?} degrees.\n", self.name);
        let (count, n) = STRAIGHT;
        let open = DIRECTIONS.map(|[theta, phi]| {
            openness(&|number| self.cloth.realize(2, number), count, self.cloth.period(), ray(theta, phi), n)
        });
        let list: Vec<String> = open.iter().map(|(share, error)| format!("{share:.4} ± {error:.4}")).collect();
        println!("Straight rays through {count} realizations that touch no fiber: {}.\n", list.join(", "));
        self.table("One setting changed at a time", finest, rows(finest), part)?;
        let single = Setting { edge: Some(2.0), lists: 0.0, effort: Effort::Realizations(128), ..finest };
        self.table("Lists of directions, against those of single cells of 2 R", single, lists(), part)
    }

    /// The reference and the rows that are wanted.
    fn table(&mut self, title: &str, finest: Setting, rows: Vec<(String, Setting)>, part: &str) -> Result<()> {
        let rows: Vec<_> = rows.into_iter().filter(|(label, _)| label.contains(part)).collect();
        if rows.is_empty() {
            return Ok(());
        }
        println!("\n{title}:\n");
        println!(
            "| changed | cells | realizations | E % | resolution % | R | T | direct | H error % | KiB | prepare s | walks/s |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
        let reference = self.row("the reference", finest, None)?;
        for (label, setting) in rows {
            self.row(&label, setting, Some(&reference))?;
        }
        Ok(())
    }

    /// Measure with a setting and print it.
    fn row(&mut self, label: &str, setting: Setting, reference: Option<&Tally>) -> Result<Tally> {
        let started = Instant::now();
        let counts = self.counts(setting.edge);
        let radii: Vec<f64> = self.cloth.kinds().iter().map(|fiber| fiber.radius).collect();
        let element = Element {
            cells: CellGrid { counts, period: self.cloth.period(), thickness: self.cloth.thickness() },
            list_width: self.cloth.spacing().extend(self.cloth.thickness()) * setting.lists,
            radii: &radii,
            realize: &|number| Ok(self.cloth.draw(0, setting.first + number)),
        };
        let mut model = self.scene.model;
        (model.directions, model.cone) = (setting.directions, Some(setting.cone_deg.to_radians()));
        let made = SpecificLength::of_pieces(&element, &model, setting.effort, |_| {});
        let (specific_length, gathering) = match made {
            Ok(made) => made,
            Err(error) => {
                println!("| {label} | {counts:?} | {error} ||||||||||");
                return reference.map_or(Err(error), |tally| Ok(tally.clone()));
            }
        };
        let tables = SamplingTables::new(&self.scene, &specific_length)?;
        let seconds = started.elapsed().as_secs_f64();
        self.seed += 1;
        let walks = if reference.is_none() { 2 * WALKS } else { WALKS };
        let started = Instant::now();
        let tally = self.gpu.run(&tables, &self.goniometer, &WalkPlan::new(self.seed, walks), &mut |_| {})?;
        tally.check(walks)?;
        let walked = started.elapsed().as_secs_f64();
        let comparison = reference.map(|reference| compare(&tally, reference, &self.goniometer, [None; 2]));
        let error = comparison.as_ref().map_or("–".into(), |found| format!("{:.1}", 100.0 * found.error));
        let resolution = comparison.as_ref().map_or("–".into(), |found| format!("{:.1}", 100.0 * found.resolution));
        let of = |value: &dyn Fn(usize) -> f64, digits: usize| {
            (0..DIRECTIONS.len()).map(|start| format!("{:.digits$}", value(start))).collect::<Vec<_>>().join(" ")
        };
        let cells = tables.cells.as_ref().map_or(1, |cells| cells.entries.len());
        println!(
            "| {label} | {} | {} | {error} | {resolution} | {} | {} | {} | {:.2} | {} | {seconds:.1} | {:.1e} |",
            counts.map(|count| count.to_string()).join(" × "),
            gathering.realizations,
            of(&|start| totals(&tally, start, 0).reflectance.value, 3),
            of(&|start| totals(&tally, start, 0).transmittance.value, 3),
            of(&|start| totals(&tally, start, 0).direct.value, 4),
            100.0 * specific_length.spread_error,
            16 * (cells + tables.patches.len()) / 1024,
            tally.counts.launched as f64 / walked,
        );
        Ok(tally)
    }

    /// Cells of an edge in radii of the thinnest fiber.
    fn counts(&self, edge: Option<f64>) -> [u32; 3] {
        let kinds = self.cloth.used_kinds();
        let radius = kinds.iter().map(|&kind| self.cloth.kinds()[kind].radius).fold(f64::INFINITY, f64::min);
        let size = self.cloth.size().to_array();
        edge.map_or([1; 3], |edge| size.map(|size| ((size / (edge * radius)).ceil() as u32).clamp(1, 256)))
    }
}

fn rows(finest: Setting) -> Vec<(String, Setting)> {
    let mut rows = Vec::new();
    let coarser = |edge: &f64| finest.edge.is_some_and(|finest| *edge > finest);
    for edge in [2.0, 3.0, 4.0, 8.0, 16.0].into_iter().filter(coarser) {
        rows.push((format!("edge {edge} R"), Setting { edge: Some(edge), ..finest }));
    }
    rows.push(("one cell".into(), Setting { edge: None, ..finest }));
    for directions in [64, 256, 1024, 16384] {
        rows.push((format!("{directions} directions"), Setting { directions, ..finest }));
    }
    for cone_deg in [2.0, 5.0, 10.0, 20.0] {
        rows.push((format!("cone {cone_deg}°"), Setting { cone_deg, ..finest }));
    }
    for count in [2, 4, 16, 64] {
        // Realizations that the reference does not have.
        let effort = Effort::Realizations(count);
        rows.push((format!("{count} realizations"), Setting { effort, first: 10_000, ..finest }));
    }
    let usual = |edge, directions, cone_deg, precision| Setting {
        edge: Some(edge),
        directions,
        cone_deg,
        lists: 0.25,
        effort: Effort::Precision(precision),
        first: 10_000,
    };
    for (edge, directions, cone, precision) in [
        (4.0, 1024, 2.0, 0.05),
        (3.0, 1024, 0.0, 0.1),
        (2.0, 1024, 0.0, 0.1),
        (2.0, 1024, 2.0, 0.1),
        (2.0, 1024, 0.0, 0.2),
    ] {
        let label = format!("{edge} R, {directions} directions, cone {cone}°, {} %", 100.0 * precision);
        rows.push((label, usual(edge, directions, cone, precision)));
    }
    rows
}

/// Rows that differ in their lists of directions.
fn lists() -> Vec<(String, Setting)> {
    let row = |edge: f64, lists: f64, directions, precision: f64| {
        let width = if lists > 0.0 { format!("1/{} of a yarn spacing", 1.0 / lists) } else { "one cell".into() };
        let label = format!("lists of {width}, {edge} R, {directions} directions, {} %", 100.0 * precision);
        let effort = Effort::Precision(precision);
        (label, Setting { edge: Some(edge), directions, cone_deg: 0.0, lists, effort, first: 10_000 })
    };
    vec![
        row(2.0, 0.25, 4096, 0.1),
        row(2.0, 0.125, 4096, 0.1),
        row(2.0, 0.0, 4096, 0.1),
        row(2.0, 0.0, 1024, 0.1),
        row(2.0, 0.0, 1024, 0.05),
        row(2.0, 0.125, 1024, 0.1),
        row(2.0, 0.25, 1024, 0.1),
        row(3.0, 0.0, 1024, 0.1),
        row(4.0, 0.0, 1024, 0.1),
        row(4.0, 0.25, 1024, 0.05),
        row(2.0, 0.0625, 1024, 0.15),
    ]
}
