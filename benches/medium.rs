//! How wrong the implicit medium is for a cloth: `cargo bench --bench medium -- [PRESET...] [random] [separate]`, all presets
//! and both packings without words.
//!
//! For each preset and packing, the explicit model is the reference. A row has one placement and one edge of the cells; R,
//! T and direct light differ from the reference by so many percent of it (direct light: percent of the light that came),
//! by incident direction; E is the difference of all scattered light without the noise of the walks, pooled over directions,
//! exit cells and channels. The medium counts the same realizations that the reference walks through. The output is
//! Markdown.

#[path = "../tests/common/mod.rs"]
mod common;

use fiberwalk::bsdf::{Component, Totals, compare, totals, values};
use fiberwalk::cloth::{Cloth, Realization, Realizer};
use fiberwalk::distribution::{CellGrid, Effort, Element, SpecificLength};
use fiberwalk::error::Result;
use fiberwalk::explicit::Explicit;
use fiberwalk::goniometer::{Goniometer, Tally};
use fiberwalk::measure::prepare;
use fiberwalk::scene::{PRESETS, Packing, Placement, Scene, Source, Structure};
use fiberwalk::tables::SamplingTables;
use fiberwalk::walk::{WalkPlan, Walker};
use rayon::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// Incident directions (θ, φ) in degrees.
const DIRECTIONS: &str = "[[0, 0], [30, 20], [60, 0], [60, 45]]";
/// Exit cells along an edge of the disc.
const EXIT: &str = "8";
/// Walks of each direction, through the fibers and through the medium.
const WALKS: u64 = 196_608;
/// Realizations that both have.
const REALIZATIONS: u64 = 48;
/// Edges of cells in radii of the thinnest fiber.
const EDGES: [f64; 3] = [8.0, 4.0, 2.0];
const PLACEMENTS: [Placement; 4] =
    [Placement::AtHit, Placement::Carried, Placement::CarriedDense, Placement::CarriedVoid];

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let named = |name: &str| words.iter().any(|word| word == name);
    let any = PRESETS.iter().any(|(name, _)| named(name));
    println!(
        "Light from {DIRECTIONS}; {WALKS} walks of each direction, {REALIZATIONS} realizations, exit cells {EXIT} × {EXIT} on each \
         side.\n\nBy direction: R, T in percent of the reference, direct light in percent of the incident light.\n"
    );
    for (name, _) in PRESETS.into_iter().filter(|(name, _)| !any || named(name)) {
        for (word, packing) in [("random", Packing::Random), ("separate", Packing::Separate)] {
            if named(word) || !(named("random") || named("separate")) {
                if let Err(error) = study(name, word, packing) {
                    println!("\n## {name}, {word}\n\n{error}\n");
                }
            }
        }
    }
    Ok(())
}

/// All rows of a preset and packing.
fn study(name: &str, word: &str, packing: Packing) -> Result<()> {
    let mut scene = Scene::parse(&Source::find(name)?)?;
    scene.measure.set_from_flag("incident", DIRECTIONS)?;
    scene.measure.set_from_flag("exit", EXIT)?;
    scene.model.packing = packing;
    let goniometer = Goniometer::new(&scene.measure);
    let started = Instant::now();
    let realizer = Realizer::new(&scene, packing)?;
    let drawn: Arc<Vec<Realization>> =
        Arc::new((0..REALIZATIONS).into_par_iter().map(|number| realizer.draw(number)).collect::<Result<_>>()?);
    let drawing = started.elapsed().as_secs_f64() / REALIZATIONS as f64;
    let (kept, each) = (drawn.clone(), WALKS as usize / REALIZATIONS as usize * goniometer.starts());
    let explicit = Explicit::drawn(&scene, Some(each), move |number| Ok(kept[number as usize].clone()))?;
    let started = Instant::now();
    let reference = explicit.run(&goniometer, &WalkPlan::new(1, WALKS), &mut |_| {})?;
    let seconds = started.elapsed().as_secs_f64();
    let bytes = explicit.bytes().iter().sum::<usize>();
    println!("\n## {name}, {word}\n\n{}", first_lines(&reference, seconds, bytes, drawing));
    if let Some(found) = explicit.clustering(&reference) {
        let [r, t, d] = [found.reflectance, found.transmittance, found.direct].map(|factor| factor.max(1.0).sqrt());
        println!(
            "Errors of means over the directions are {r:.1} (R), {t:.1} (T), {d:.1} (direct) times those of independent walks.\n"
        );
    }
    println!(
        "| placement | cells | R % | T % | direct % | hits % | E % | resolution % | R' % | T' % | E' % | events | KiB | prepare s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    let edges = if let Structure::Sheet(_) = &scene.structure { &EDGES[..1] } else { &EDGES[..] };
    let mut seed = 1;
    for placement in PLACEMENTS {
        for &edge in edges {
            seed += 1;
            scene.model.placement = placement;
            match row(&scene, &drawn, &goniometer, edge, seed, &reference) {
                Ok(line) => println!("{line}"),
                Err(error) => println!("| {} | {edge} R | {error} |||||||||", placement.name()),
            }
        }
    }
    Ok(())
}

/// What the reference has.
fn first_lines(reference: &Tally, seconds: f64, bytes: usize, drawing: f64) -> String {
    let of = |value: &dyn Fn(&Totals) -> f64| {
        let one = |start| format!("{:.4}", value(&totals(reference, start, 0)));
        (0..reference.starts()).map(one).collect::<Vec<_>>().join(" ")
    };
    let (walks, hits) = (reference.counts.launched as f64, reference.counts.collisions as f64);
    format!(
        "Explicit: R {}, T {}, direct {}; {:.2} hits and {:.0} tests a walk, {:.1e} walks/s; {:.1} MiB and {drawing:.2} s a \
         realization.\n",
        of(&|totals| totals.reflectance.value),
        of(&|totals| totals.transmittance.value),
        of(&|totals| totals.direct.value),
        hits / walks,
        reference.counts.tentative_events as f64 / walks,
        walks / seconds,
        bytes as f64 / f64::from(1 << 20),
    )
}

/// One medium.
fn row(
    scene: &Scene,
    drawn: &[Realization],
    goniometer: &Goniometer,
    edge: f64,
    seed: u64,
    reference: &Tally,
) -> Result<String> {
    let started = Instant::now();
    let (tables, cells) = match &scene.structure {
        Structure::Sheet(_) => (prepare(scene)?.tables, "one".into()),
        Structure::Weave(_) | Structure::Knit(_) => {
            let cloth = Cloth::new(scene)?;
            let radii: Vec<f64> = cloth.kinds().iter().map(|fiber| fiber.radius).collect();
            let used = cloth.used_kinds();
            let thinnest = used.iter().map(|&kind| radii[kind]).fold(f64::INFINITY, f64::min);
            let count = |size: f64| ((size / (edge * thinnest)).ceil() as u32).clamp(1, 256);
            let counts = cloth.size().to_array().map(count);
            let element = Element {
                cells: CellGrid { counts, period: cloth.period(), thickness: cloth.thickness() },
                list_width: cloth.spacing().extend(cloth.thickness()) / 16.0,
                radii: &radii,
                realize: &|number| Ok(drawn[number as usize].clone()),
            };
            let effort = Effort::Realizations(REALIZATIONS);
            let (length, _) = SpecificLength::of_pieces(&element, &scene.model, effort, |_| {})?;
            (SamplingTables::new(scene, &length)?, format!("{edge} R"))
        }
    };
    let seconds = started.elapsed().as_secs_f64();
    let tally =
        fiberwalk::walk::Engine::run(common::gpu(), &tables, goniometer, &WalkPlan::new(seed, WALKS), &mut |_| {})?;
    tally.check(WALKS)?;
    let comparison = compare(&tally, reference);
    let by_direction = |value: &dyn Fn(&Totals) -> f64, relative: bool| {
        let one = |start| {
            let (here, there) = (value(&totals(&tally, start, 0)), value(&totals(reference, start, 0)));
            format!("{:+.1}", 100.0 * (here - there) / if relative { there } else { 1.0 })
        };
        (0..reference.starts()).map(one).collect::<Vec<_>>().join(" ")
    };
    // The same with the direct light of the reference.
    let factor = |start: usize| {
        let [here, there] = [&tally, reference].map(|tally| 1.0 - totals(tally, start, 0).direct.value);
        there / here
    };
    let scaled = |value: &dyn Fn(&Totals) -> f64| {
        let one = |start| {
            let (here, there) = (value(&totals(&tally, start, 0)), value(&totals(reference, start, 0)));
            format!("{:+.1}", 100.0 * (here * factor(start) / there - 1.0))
        };
        (0..reference.starts()).map(one).collect::<Vec<_>>().join(" ")
    };
    let (mut excess, mut square) = (0.0f64, 0.0);
    for start in 0..tally.starts() {
        for component in [Component::Reflection, Component::Transmission] {
            for channel in 0..tally.channels() {
                let [here, there] =
                    [&tally, reference].map(|tally| values(tally, goniometer, component, start, channel));
                for (here, there) in here.iter().zip(&there) {
                    let (value, error) = (here.value * factor(start), here.stderr * factor(start));
                    excess += (value - there.value).powi(2) - error * error - there.stderr * there.stderr;
                    square += there.value * there.value;
                }
            }
        }
    }
    let scaled_error = (excess.max(0.0) / square).sqrt();
    let per_walk = |tally: &Tally| tally.counts.collisions as f64 / tally.counts.launched as f64;
    Ok(format!(
        "| {} | {cells} | {} | {} | {} | {:+.1} | {:.1} | {:.1} | {} | {} | {:.1} | {:.0} | {:.0} | {seconds:.1} |",
        scene.model.placement.name(),
        by_direction(&|totals| totals.reflectance.value, true),
        by_direction(&|totals| totals.transmittance.value, true),
        by_direction(&|totals| totals.direct.value, false),
        100.0 * (per_walk(&tally) / per_walk(reference) - 1.0),
        100.0 * comparison.error,
        100.0 * comparison.resolution,
        scaled(&|totals| totals.reflectance.value),
        scaled(&|totals| totals.transmittance.value),
        100.0 * scaled_error,
        tally.counts.tentative_events as f64 / tally.counts.launched as f64,
        tables.bytes() as f64 / 1024.0,
    ))
}
