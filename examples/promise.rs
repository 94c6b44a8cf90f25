//! Whether stated errors hold for cloths that nobody has tried: `cargo run --release --example promise -- [COUNT] [TOLERANCE] [SEED]`
//!
//! Draws woven cloths from a wide distribution (weaves from 1/1 to a satin of 8, 1 to 200 fibers a ply, 1 to 3 plies, twist from 0 to
//! 1500/m, radii from 3 to 75 µm, indices from 1.33 to 1.7, absorption from 0 to 1000/mm, open to dense, one or two yarns), plans each at
//! a tolerance for a run from the whole hemisphere, and holds the planned medium against the fibers themselves by blocks of walks of its own.
//! A row is a cloth: what was planned, the stated interval of its error, the error found, both with the planned noise over the tolerance,
//! and the seconds of the plan. At the end: shares of promises kept and of intervals that hold what was found.

use fiberwalk::bsdf::distance;
use fiberwalk::measure::{ChosenEngine, EngineChoice, choose};
use fiberwalk::plan::{Configuration, EngineClass, Extent, Trial, plan};
use fiberwalk::scene::{Medium, Scene, Source};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::error::Error;
use std::time::Instant;

/// Directions (θ, φ) in degrees of the walks that an error is found by, none in a plane in which yarns lie.
const DIRECTIONS: &str = "[[3, 35], [30, 20], [60, 12], [75, 55]]";
/// Walks of each direction and block through the fibers, and times as many through the medium.
const WALKS: u64 = 16_384;
/// A promise is kept up to this times the tolerance: noise ends at the next of a few numbers of walks.
const KEPT: f64 = 1.25;

const WEAVES: [&[&str]; 7] = [
    &["X.", ".X"],
    &["XX.", "X.X", ".XX"],
    &["XXX.", "XX.X", "X.XX", ".XXX"],
    &["XX..", "XX..", "..XX", "..XX"],
    &["X....", "..X..", "....X", ".X...", "...X."],
    &["XX..", ".XX.", "..XX", "X..X"],
    &["X.......", "...X....", "......X.", ".X......", "....X...", ".......X", "..X.....", ".....X.."],
];

/// A cloth file at random.
fn cloth(random: &mut ChaCha8Rng) -> String {
    let mut log = |low: f64, high: f64| low * (high / low).powf(random.random::<f64>());
    let index = log(1.33, 1.7);
    let yarns: Vec<(String, f64)> = ["a", "b"]
        .iter()
        .map(|name| {
            let radius = log(3.0, 75.0);
            // Thick fibers come in small numbers.
            let fibers = log(1.0, (2500.0 / radius).clamp(1.5, 200.0)).round();
            let plies = if fibers > 2.0 { log(1.0, 3.49).round() } else { 1.0 };
            let fill = if fibers * plies < 4.0 { 0.6 } else { log(0.35, 0.7) };
            let size = 2.0 * radius * (fibers * plies / fill).sqrt() * if fibers * plies == 1.0 { 0.8 } else { 1.0 };
            let flat = if fibers * plies < 4.0 { 1.0 } else { log(1.0, 1.6) };
            let absorption = if log(1.0, 10.0) < 4.0 { 0.0 } else { log(0.1, 1000.0) };
            let twist = if log(1.0, 10.0) < 3.0 { 0.0 } else { log(50.0, 1500.0).round() };
            let (width, height) = (size * flat.sqrt(), size / flat.sqrt());
            let text = format!(
                "[fiber.{name}]\nradius_um = {radius:.2}\nior = {index:.3}\nabsorption_per_mm = {absorption:.3}\n[yarn.{name}]\nfiber = \"{name}\"\n\
                 plies = {plies}\nfibers_per_ply = {fibers}\nwidth_um = {width:.1}\nheight_um = {height:.1}\nply_twist_per_m = {twist}\n"
            );
            (text, width)
        })
        .collect();
    let two = log(1.0, 10.0) > 6.0;
    let weft = usize::from(two);
    let (ends, picks) = (1e4 / yarns[0].1 * log(0.35, 0.95), 1e4 / yarns[weft].1 * log(0.35, 0.95));
    let draft = WEAVES[(log(1.0, 8.0) - 1.0) as usize % WEAVES.len()];
    let fibers: String = yarns.iter().take(weft + 1).map(|(text, _)| text.as_str()).collect();
    format!(
        "{fibers}[weave]\ndraft = {draft:?}\nwarp = [\"a\"]\nweft = [\"{}\"]\nends_per_cm = {ends:.2}\npicks_per_cm = {picks:.2}\n",
        ["a", "b"][weft]
    )
}

/// What became of a cloth.
struct Row {
    kept: bool,
    held: Option<bool>,
    medium: bool,
}

/// Plan a cloth, find its error and print its row; none where it cannot be laid out.
fn study(text: &str, number: u64, tolerance: f64, engine: &ChosenEngine) -> fiberwalk::Result<Option<Row>> {
    let source = Source { file: format!("cloth {number}"), stem: "cloth".into(), text: text.into(), folder: None };
    let Ok(mut scene) = Scene::parse(&source) else { return Ok(None) };
    scene.measure.set_from_flag("incident", "8")?;
    scene.measure.set_from_flag("exit", "16")?;
    let Ok(extent) = Extent::of(&scene) else { return Ok(None) };
    let started = Instant::now();
    let (plan, _) = plan(&scene, &extent, tolerance, (engine, EngineClass::of(engine)), 1, true, false)?;
    let seconds = started.elapsed().as_secs_f64();
    let configuration = *plan.configuration();
    let name = &plan.chosen;
    if configuration.model.medium == Medium::Explicit {
        println!("| {number} | {name} | {} | — | 1.00 | {seconds:.1} |", plan.reason);
        return Ok(Some(Row { kept: true, held: None, medium: false }));
    }
    scene.measure.set_from_flag("incident", DIRECTIONS)?;
    scene.measure.set_from_flag("exit", "8")?;
    let tallies = |configuration: Configuration, walks: u64| {
        let trial = Trial::prepare(&scene, &extent, configuration)?;
        let blocks = trial.blocks(engine, configuration.seed(2), 0, walks)?;
        Ok(blocks.into_iter().map(|block| block.tally).collect::<Vec<_>>())
    };
    let fibers = tallies(Configuration::fibers(&scene, 512), WALKS)?;
    let found = distance(&tallies(configuration, 2 * WALKS)?, &fibers)?;
    let [low, high] = plan.interval.unwrap_or_default();
    let own = found.estimate();
    let least = (found.square - 2.0 * found.square_error).max(0.0).sqrt();
    let most = (found.square.max(0.0) + 2.0 * found.square_error).sqrt();
    let both = (plan.noise.powi(2) + found.square.max(0.0)).sqrt() / tolerance;
    let row = Row {
        kept: (plan.noise.powi(2) + least * least).sqrt() <= KEPT * tolerance,
        held: Some(least <= high && most >= low),
        medium: true,
    };
    println!(
        "| {number} | {name} | {:.1} to {:.1} % | {:.1} ± {:.1} % | {both:.2}{} | {seconds:.1} |",
        100.0 * low,
        100.0 * high,
        100.0 * own.value,
        100.0 * own.stderr,
        if row.kept { "" } else { " **broken**" }
    );
    Ok(Some(row))
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let word = |place: usize, usual: f64| words.get(place).map_or(Ok(usual), |word| word.parse::<f64>());
    let (count, tolerance, seed) = (word(0, 200.0)? as usize, word(1, 0.05)?, word(2, 1.0)? as u64);
    let engine = choose(EngineChoice::Auto, None)?;
    println!(
        "| cloth | plan | stated error | error found | with noise over the tolerance | seconds of the plan |\n|---|---|---|---|---|---|"
    );
    let mut rows = Vec::new();
    for number in 0.. {
        if rows.len() == count {
            break;
        }
        // Each cloth has a generator of its own, so that any can be drawn alone.
        let text = cloth(&mut ChaCha8Rng::seed_from_u64(seed << 32 | number));
        match study(&text, number, tolerance, &engine) {
            Ok(row) => rows.extend(row),
            Err(error) => println!("| {number} | {error} |||||"),
        }
    }
    let media = rows.iter().filter(|row| row.medium).count();
    let kept = rows.iter().filter(|row| row.kept).count();
    let held = rows.iter().filter(|row| row.held == Some(true)).count();
    println!(
        "\n{count} cloths at {} %: {kept} promises kept, {media} media, {held} of whose intervals hold the error found.",
        100.0 * tolerance
    );
    Ok(())
}
