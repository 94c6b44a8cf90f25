//! The implicit medium in a homogeneous box, where its cells and directions are exact: what is left is the medium itself.
//! `cargo bench --bench boxes`; words leave out tables that are not named (`random`, `separate`, `parallel`).
//!
//! Fibers along x, y and z in equal lengths, radius 10 µm, index 1.55, in a sheet of true optical depth 2 for light along an
//! axis between them; the volume fraction v sets how thick it is. In the table `parallel` all lie along x, at random, in a sheet
//! of depth 2 along its normal. Light from three directions, pooled. Each row has the
//! explicit model and the deviations of the medium from it with their standard errors (of light: in percent of the
//! incident light; of hits: relative). The output is Markdown.
//!
//! The last column divides the deviation of the hits by v: it tends to a constant where a placement is right to first order.

#[path = "../tests/common/mod.rs"]
mod common;

use fiberwalk::bsdf::{compare, totals};
use fiberwalk::error::Result;
use fiberwalk::explicit::Explicit;
use fiberwalk::goniometer::{Goniometer, Tally};
use fiberwalk::measure::prepare;
use fiberwalk::scene::{Packing, Placement, Scene, Source};
use fiberwalk::walk::{Engine, WalkPlan, Walker};

/// Volume fractions of the rows.
const FRACTIONS: [f64; 6] = [0.003, 0.01, 0.03, 0.1, 0.3, 0.5];
/// Radius in mm.
const RADIUS: f64 = 0.01;
/// Rate times thickness.
const DEPTH: f64 = 2.0;
/// Walks of each direction through fibers, and through the medium.
const WALKS: [u64; 2] = [1 << 19, 1 << 21];
/// Axes of the fibers.
const AXES: [&str; 3] = ["[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"];
const DIRECTIONS: &str = "[[20, 30], [45, 100], [65, 50]]";
const PLACEMENTS: [Placement; 4] =
    [Placement::AtHit, Placement::Carried, Placement::CarriedDense, Placement::CarriedVoid];

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    println!(
        "Light from {DIRECTIONS}; {} walks of each direction through fibers, {} through the medium.",
        WALKS[0], WALKS[1]
    );
    let tables = [
        ("random", Packing::Random, &AXES[..]),
        ("separate", Packing::Separate, &AXES[..]),
        ("parallel", Packing::Random, &AXES[..1]),
    ];
    for (word, packing, axes) in tables {
        if !words.is_empty() && !words.iter().any(|known| known == word) {
            continue;
        }
        println!("\n{word}:\n");
        println!("| v | placement | R | T | direct | E % (resolution) | hits of the fibers | hits % | hits %/v |");
        println!("|---|---|---|---|---|---|---|---|---|");
        for v in FRACTIONS {
            if let Err(error) = rows(v, packing, axes) {
                println!("| {v} | {error} ||||||||");
            }
        }
    }
    Ok(())
}

/// A sheet of sets of parallel fibers.
fn scene(v: f64, packing: Packing, axes: &[&str]) -> Result<Scene> {
    // Σ π R² L = v, and the rate of light between the axes is about 2 R L √(2/3), that across parallel ones 2 R L.
    let length = v / (std::f64::consts::PI * RADIUS * RADIUS);
    let across = if axes.len() > 1 { (2.0f64 / 3.0).sqrt() } else { 1.0 };
    let thickness = DEPTH / (2.0 * RADIUS * length * across);
    let mut text = format!(
        "[fiber.f]\nradius_um = {}\nior = 1.55\nabsorption_per_mm = 0\n[model]\nlength_over_radius = inf\n[measure]\n\
         incident = {DIRECTIONS}\nexit = 8\n[sheet]\nthickness_um = {}\n",
        1e3 * RADIUS,
        1e3 * thickness
    );
    for axis in axes {
        text += &format!(
            "[[sheet.fibers]]\nfiber = \"f\"\nlength_density_per_mm2 = {}\norientation = \"aligned\"\naxis = {axis}\n",
            length / axes.len() as f64
        );
    }
    let source = Source { file: "box".into(), stem: "box".into(), text, folder: None };
    let mut scene = Scene::parse(&source)?;
    scene.model.packing = packing;
    Ok(scene)
}

/// The rows of one volume fraction.
fn rows(v: f64, packing: Packing, axes: &[&str]) -> Result<()> {
    let mut scene = scene(v, packing, axes)?;
    let goniometer = Goniometer::new(&scene.measure);
    let explicit = Explicit::new(&scene)?;
    let reference = explicit.run(&goniometer, &WalkPlan::new(1, WALKS[0]), &mut |_| {})?;
    let spread = explicit.clustering(&reference).map_or([1.0; 3], |found| {
        [found.reflectance, found.transmittance, found.direct].map(|factor| factor.max(1.0).sqrt())
    });
    let hits = |tally: &Tally| tally.counts.collisions as f64 / tally.counts.launched as f64;
    for (seed, placement) in (2..).zip(PLACEMENTS) {
        scene.model.placement = placement;
        let tables = prepare(&scene)?.tables;
        let tally = common::gpu().run(&tables, &goniometer, &WalkPlan::new(seed, WALKS[1]), &mut |_| {})?;
        let sums = |tally: &Tally| {
            let starts = tally.starts();
            let parts = (0..starts).map(|start| totals(tally, start, 0));
            let mut sums = [(0.0, 0.0); 3];
            for part in parts {
                for (sum, share) in sums.iter_mut().zip([part.reflectance, part.transmittance, part.direct]) {
                    sum.0 += share.value / starts as f64;
                    sum.1 += (share.stderr / starts as f64).powi(2);
                }
            }
            sums
        };
        let (here, there) = (sums(&tally), sums(&reference));
        let column = |i: usize| {
            let error = (here[i].1 + spread[i].powi(2) * there[i].1).sqrt();
            format!("{:+.2} ± {:.2}", 100.0 * (here[i].0 - there[i].0), 100.0 * error)
        };
        let found = compare(&tally, &reference, &goniometer, [None; 2]);
        let deviation = hits(&tally) / hits(&reference) - 1.0;
        println!(
            "| {v} | {} | {} | {} | {} | {:.1} ({:.1}) | {:.3} | {:+.2} | {:+.2} |",
            placement.name(),
            column(0),
            column(1),
            column(2),
            100.0 * found.error,
            100.0 * found.resolution,
            hits(&reference),
            100.0 * deviation,
            deviation / v,
        );
    }
    Ok(())
}
