//! How wrong the implicit medium is for a cloth: `cargo bench --bench medium -- [PRESET...] [random] [separate]`, all presets
//! and both packings without words.
//!
//! For each preset and packing, walks through the fibers themselves are the reference; their row has the shares of light by
//! direction. A row of the medium has one placement and one edge of the cells: by how many percent R and T (of the first
//! channel) are off in the direction where they are off most, by how many percent of the incident light direct light is,
//! by how many percent the number of hits is; E, the difference of all scattered light without the noise of the walks,
//! pooled over directions, exit cells and channels, with its resolution. Then the same when the direct light is that of
//! straight rays through the fibers and the walks share out the rest. The medium counts the realizations that the
//! reference walks through. The output is Markdown.

#[path = "../tests/common/mod.rs"]
mod common;

use fiberwalk::bsdf::{Component, Totals, compare, noise, totals, values};
use fiberwalk::cloth::{Cloth, FiberGrid, Realization, Realizer, Way, Work};
use fiberwalk::distribution::{CellGrid, Effort, Element, SpecificLength};
use fiberwalk::error::Result;
use fiberwalk::explicit::Explicit;
use fiberwalk::goniometer::{Coverage, Goniometer, Origin, Tally};
use fiberwalk::measure::prepare;
use fiberwalk::optics::Encounter;
use fiberwalk::reference::{Begun, walk_on};
use fiberwalk::scene::{PRESETS, Packing, Placement, Scene, Source, Structure};
use fiberwalk::tables::{Kind, SamplingTables};
use fiberwalk::walk::{EventDraws, Purpose, Score, WalkPlan, Walked, Walker, draw, start_draws, start_place};
use rayon::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// Incident directions (θ, φ) in degrees.
const DIRECTIONS: &str = "[[0, 0], [30, 20], [60, 0], [60, 45]]";
/// Exit cells along an edge of the disc.
const EXIT: &str = "8";
/// Walks of each direction, through the fibers and through the medium.
const WALKS: u64 = 196_608;
/// Realizations that both have, and of how many pieces each has to be for fewer to do.
const REALIZATIONS: [u64; 2] = [48, 8];
const LARGE: usize = 100_000;
/// Edges of cells in radii of the thinnest fiber.
const EDGES: [f64; 3] = [8.0, 4.0, 2.0];
const PLACEMENTS: [Placement; 4] =
    [Placement::AtHit, Placement::Carried, Placement::CarriedDense, Placement::CarriedVoid];

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let named = |name: &str| words.iter().any(|word| word == name);
    let any = PRESETS.iter().any(|(name, _)| named(name));
    println!(
        "Light from {DIRECTIONS}; {WALKS} walks of each direction, {} realizations, {} of separate fibers in more than {LARGE} \
         pieces; exit cells {EXIT} × {EXIT} on each side.\n",
        REALIZATIONS[0], REALIZATIONS[1]
    );
    println!(
        "| preset | fibers | placement | cells | R | T | direct | hits | E % | with straight light: R | T | E % | KiB |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for (name, _) in PRESETS.into_iter().filter(|(name, _)| !any || named(name)) {
        for (word, packing) in [("random", Packing::Random), ("separate", Packing::Separate)] {
            if named(word) || !(named("random") || named("separate")) {
                if let Err(error) = study(name, word, packing) {
                    println!("| {name} | {word} | {error} ||||||||||");
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
    let first = realizer.draw(0)?;
    let drawing = started.elapsed().as_secs_f64();
    let large = first.pieces().len() > LARGE && packing == Packing::Separate;
    let realizations = REALIZATIONS[usize::from(large)];
    let drawn: Arc<Vec<Realization>> =
        Arc::new((0..realizations).into_par_iter().map(|number| realizer.draw(number)).collect::<Result<_>>()?);
    let (kept, each) = (drawn.clone(), WALKS as usize / realizations as usize * goniometer.starts());
    let explicit = Explicit::drawn(&scene, Some(each), move |number| Ok(kept[number as usize].clone()))?;
    let started = Instant::now();
    let reference = explicit.run(&goniometer, &WalkPlan::new(1, WALKS), &mut |_| {})?;
    let seconds = started.elapsed().as_secs_f64();
    println!("{}", fibers(&format!("| {name} | {word}"), &reference, &explicit, [drawing, seconds]));
    let edges = if let Structure::Sheet(_) = &scene.structure { &EDGES[..1] } else { &EDGES[..] };
    let mut seed = 1;
    for placement in PLACEMENTS {
        for &edge in edges {
            seed += 1;
            scene.model.placement = placement;
            match row(&scene, &drawn, &goniometer, edge, seed, &reference) {
                Ok(line) => println!("| {name} | {word} {line}"),
                Err(error) => println!("| {name} | {word} | {} | {edge} R | {error} |||||||||", placement.name()),
            }
        }
    }
    for &edge in edges.iter().filter(|_| edges.len() > 1) {
        seed += 1;
        scene.model.placement = if packing == Packing::Random { Placement::Carried } else { Placement::CarriedVoid };
        let handed = handed_on(&scene, &drawn, &goniometer, edge, seed)?;
        let (placement, cells) = (scene.model.placement.name(), deviations(&handed, &reference, &goniometer, 0));
        println!("| {name} | {word} | first hit on fibers, {placement} | {edge} R {cells}");
    }
    Ok(())
}

/// Walks whose first hit is on a fiber of a realization, and whose later ones are in the medium.
fn handed_on(scene: &Scene, drawn: &[Realization], goniometer: &Goniometer, edge: f64, seed: u64) -> Result<Tally> {
    let (tables, _) = medium(scene, drawn, edge)?;
    let plan = WalkPlan::new(seed, WALKS);
    let each = WALKS / drawn.len() as u64;
    let used = scene.kinds();
    let through = |number: usize| -> Result<Vec<(usize, Score)>> {
        let grid = FiberGrid::new(&drawn[number].fibers, drawn[number].period)?;
        let one = |start: usize, i: u64| {
            let id = WalkPlan::walk_id(goniometer.starts(), i, start);
            let words = draw(seed, id, 0, Purpose::Start);
            let m = -goniometer.start_direction(start, start_draws(words));
            let face = if m.z < 0.0 { grid.span()[1] } else { grid.span()[0] };
            let place = (start_place(words) * grid.period()).extend(face);
            let mut begun = Begun { place, m, walked: Walked::default() };
            begun.walked.record.bin = goniometer.exit_bin(goniometer.side(start), m, false) as u32;
            if let Way::Fiber { tube, point, meeting } = grid.first_entry(place, m, None, &mut Work::default()) {
                let piece = &grid.tubes()[tube];
                let kind = used.iter().position(|&kind| kind == piece.kind()).unwrap_or_default();
                let number = EventDraws::new(draw(seed, id, 0, Purpose::Event)).accept;
                let encounter = Encounter::new(m, piece.direction(), meeting.offset, tables.kinds[kind].ior);
                let passage = encounter.pass(number, tables.half_length);
                begun.m = passage.direction.normalize();
                begun.place = point + passage.displacement * piece.radius();
                (begun.walked.record.events, begun.walked.record.hits) = (1, 1);
                begun.walked.lengths[kind] = passage.path * piece.radius();
                begun.walked = walk_on(&tables, goniometer, &plan, start, i, begun);
            }
            (start, Score::new(&begun.walked, &tables.kinds, goniometer, seed, start, i))
        };
        let own = number as u64 * each..(number as u64 + 1) * each;
        let walks = (0..goniometer.starts()).flat_map(|start| own.clone().map(move |i| (start, i)));
        Ok(walks.map(|(start, i)| one(start, i)).collect())
    };
    let parts: Vec<Vec<(usize, Score)>> = (0..drawn.len()).into_par_iter().map(through).collect::<Result<_>>()?;
    let origin = Origin { engine: "cpu".into(), adapter: "f64".into(), seed };
    let channels = Kind::channels(&tables.kinds);
    let mut tally = Tally::new(origin.clone(), goniometer.layout(), goniometer.starts(), channels);
    parts.iter().flatten().for_each(|(start, score)| score.add_to(&mut tally, *start));
    tally.coverage = Coverage::new(origin, 0..WALKS);
    tally.check(WALKS)?;
    Ok(tally)
}

/// The row of the fibers: values by direction.
fn fibers(label: &str, reference: &Tally, explicit: &Explicit, [drawing, seconds]: [f64; 2]) -> String {
    let of = |value: &dyn Fn(&Totals) -> f64| {
        let one = |start| format!("{:.3}", value(&totals(reference, start, 0)));
        (0..reference.starts()).map(one).collect::<Vec<_>>().join(" ")
    };
    let walks = reference.counts.launched as f64;
    let spread = explicit.clustering(reference).map_or(1.0, |found| {
        [found.reflectance, found.transmittance, found.direct].into_iter().fold(1.0, f64::max).sqrt()
    });
    format!(
        "{label} | fibers | | {} | {} | {} | {:.2} | noise {:.1} | errors × {spread:.1} | {drawing:.2} s to draw | {:.1e} walks/s | {} |",
        of(&|totals| totals.reflectance.value),
        of(&|totals| totals.transmittance.value),
        of(&|totals| totals.direct.value),
        reference.counts.collisions as f64 / walks,
        100.0 * noise(reference),
        walks / seconds,
        explicit.bytes().iter().sum::<usize>() / 1024,
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
    let (tables, cells) = medium(scene, drawn, edge)?;
    let tally =
        fiberwalk::walk::Engine::run(common::gpu(), &tables, goniometer, &WalkPlan::new(seed, WALKS), &mut |_| {})?;
    tally.check(WALKS)?;
    let (name, kib) = (scene.model.placement.name(), tables.bytes() / 1024);
    Ok(format!("| {name} | {cells} {}", deviations(&tally, reference, goniometer, kib)))
}

/// The tables of a medium that counts all that were drawn, and a word for its cells.
fn medium(scene: &Scene, drawn: &[Realization], edge: f64) -> Result<(SamplingTables, String)> {
    Ok(match &scene.structure {
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
            let effort = Effort::Realizations(drawn.len() as u64);
            let (length, _) = SpecificLength::of_pieces(&element, &scene.model, effort, |_| {})?;
            (SamplingTables::new(scene, &length)?, format!("{edge} R"))
        }
    })
}

/// How far a tally is from that of the fibers.
fn deviations(tally: &Tally, reference: &Tally, goniometer: &Goniometer, kib: usize) -> String {
    let comparison = compare(tally, reference);
    let worst = |value: &dyn Fn(&Totals) -> f64, factor: &dyn Fn(usize) -> f64, relative: bool| {
        let one = |start| {
            let (here, there) = (value(&totals(tally, start, 0)), value(&totals(reference, start, 0)));
            100.0 * (here * factor(start) - there) / if relative { there } else { 1.0 }
        };
        let all = (0..reference.starts()).map(one);
        format!("{:+.1}", all.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or_default())
    };
    // The same with the direct light of the reference.
    let factor = |start: usize| {
        let [here, there] = [tally, reference].map(|tally| 1.0 - totals(tally, start, 0).direct.value);
        there / here
    };
    let (mut excess, mut square) = (0.0f64, 0.0);
    for start in 0..tally.starts() {
        for component in [Component::Reflection, Component::Transmission] {
            for channel in 0..tally.channels() {
                let [here, there] =
                    [tally, reference].map(|tally| values(tally, goniometer, component, start, channel));
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
    let same = |_: usize| 1.0;
    format!(
        "| {} | {} | {} | {:+.1} | {:.1} ± {:.1} | {} | {} | {:.1} | {kib} |",
        worst(&|totals| totals.reflectance.value, &same, true),
        worst(&|totals| totals.transmittance.value, &same, true),
        worst(&|totals| totals.direct.value, &same, false),
        100.0 * (per_walk(tally) / per_walk(reference) - 1.0),
        100.0 * comparison.error,
        100.0 * comparison.resolution,
        worst(&|totals| totals.reflectance.value, &factor, true),
        worst(&|totals| totals.transmittance.value, &factor, true),
        100.0 * scaled_error,
    )
}
