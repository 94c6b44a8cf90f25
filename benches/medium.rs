//! How wrong the implicit medium is for a cloth: `cargo bench --bench medium -- [PRESET...] [random] [separate] [short] [anew]
//! [long]`, all presets and both packings without words; `short` leaves all rows out but those of the default medium at several edges
//! and of the finest, `anew` all media; `long` takes four times the walks.
//!
//! The row *anew* is walks through the fibers that go on through another realization after each hit: what a medium without memory
//! would have if its cells and directions were exact.
//!
//! For each preset and packing, walks through the fibers themselves are the reference; their row has the shares of light by
//! direction. A row of the medium has one placement and one edge of the cells: by how many percent R and T (of the first
//! channel) are off in the direction where they are off most, by how many percent of the incident light direct light is;
//! each with its standard error;
//! E, the difference of all scattered light, pooled over directions, exit cells and channels, with its standard error, from
//! products of independent blocks of walks, so that noise is not in it. The output is Markdown.

#[path = "../tests/common/mod.rs"]
mod common;

use fiberwalk::bsdf::{Totals, block_noise, distance, totals};
use fiberwalk::error::Result;
use fiberwalk::goniometer::Tally;
use fiberwalk::plan::{BLOCKS, Configuration, Extent, Trial};
use fiberwalk::scene::{PRESETS, Packing, Placement, Scene, Source};
use std::time::Instant;

/// Incident directions (θ, φ) in degrees, none in a plane in which yarns lie: there filaments send light along edges of exit
/// cells, and rounding would decide between two of them.
const DIRECTIONS: &str = "[[3, 35], [30, 20], [60, 12], [60, 55]]";
/// Exit cells along an edge of the disc.
const EXIT: &str = "8";
/// Walks of each direction and block, through the fibers and through the default medium.
const WALKS: u64 = 32_768;
/// As many times more of a long run.
const LONGER: u64 = 4;
/// The same through the media by placement, whose E is large.
const FEW: u64 = 8_192;
/// Walks of each direction through one realization; more where a realization of separate fibers takes long.
const EACH: [u64; 2] = [256, 8192];
/// Edges of cells in radii of the thinnest fiber.
const EDGES: [f64; 3] = [8.0, 4.0, 2.0];
/// The finest cells.
const FINEST: f64 = 1.4;
/// Edges that are nearer to the usual one than this factor are left out.
const NEAR: f64 = 1.2;
const PLACEMENTS: [Placement; 4] =
    [Placement::AtHit, Placement::Carried, Placement::CarriedDense, Placement::CarriedVoid];

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let named = |name: &str| words.iter().any(|word| word == name);
    let any = PRESETS.iter().any(|(name, _)| named(name));
    let walks = [WALKS, FEW].map(|walks| if named("long") { LONGER * walks } else { walks });
    println!(
        "Light from {DIRECTIONS}; {} walks of each direction in {BLOCKS} blocks, {} through media with first hits of \
         their own; exit cells {EXIT} × {EXIT} on each side.\n",
        BLOCKS * walks[0],
        BLOCKS * walks[1]
    );
    println!("| preset | fibers | model | R | T | direct | E % | KiB | prepare s |");
    println!("|---|---|---|---|---|---|---|---|---|");
    for (name, _) in PRESETS.into_iter().filter(|(name, _)| !any || named(name)) {
        for (word, packing) in [("random", Packing::Random), ("separate", Packing::Separate)] {
            if named(word) || !(named("random") || named("separate")) {
                if let Err(error) = study(name, word, packing, walks, &named) {
                    println!("| {name} | {word} | {error} |||||||");
                }
            }
        }
    }
    Ok(())
}

/// All rows of a preset and packing.
fn study(name: &str, word: &str, packing: Packing, [walks, few]: [u64; 2], named: &dyn Fn(&str) -> bool) -> Result<()> {
    let mut scene = Scene::parse(&Source::find(name)?)?;
    scene.measure.set_from_flag("incident", DIRECTIONS)?;
    scene.measure.set_from_flag("exit", EXIT)?;
    scene.model.set_from_flag("packing", word)?;
    let extent = Extent::of(&scene)?;
    let label = format!("| {name} | {word}");
    let fibers = Configuration::fibers(&scene, EACH[usize::from(packing == Packing::Separate)]);
    let trial = Trial::prepare(&scene, &extent, fibers)?;
    let started = Instant::now();
    let reference = tallies(&trial, walks)?;
    let seconds = started.elapsed().as_secs_f64();
    println!("{}", fiber_row(&label, &reference, &trial, seconds)?);
    let row = |configuration: Configuration| {
        let trial = Trial::prepare(&scene, &extent, configuration)?;
        let own = trial.medium().is_some_and(|medium| medium.first_hits.is_none() && medium.cloth.is_some());
        row(&trial, &tallies(&trial, if own { few } else { walks })?, &reference)
    };
    match row(fibers.anew()) {
        Ok(line) => println!("{label} | fibers, anew after each hit {line}"),
        Err(error) => println!("{label} | fibers, anew after each hit | {error} ||||||"),
    }
    if named("anew") {
        return Ok(());
    }
    let usual = Configuration::of(&scene, &extent);
    // A sheet has no cells, and its default is among the placements.
    let edges = usual.edge.map_or_else(Vec::new, |edge| by_edge(usual, edge));
    let placements = if named("short") && !edges.is_empty() { Vec::new() } else { by_placement(usual) };
    for configuration in placements.into_iter().chain(edges) {
        match row(configuration) {
            Ok(line) => println!("{label} | {} {line}", configuration.name()),
            Err(error) => println!("{label} | {} | {error} ||||||", configuration.name()),
        }
    }
    Ok(())
}

/// Media by placement and edge, with first hits of their own.
fn by_placement(usual: Configuration) -> Vec<Configuration> {
    let placed = PLACEMENTS.map(|placement| usual.without_rays().placed(placement));
    if usual.edge.is_none() { placed.to_vec() } else { placed.map(|one| EDGES.map(|edge| one.edged(edge))).concat() }
}

/// The default with first hits on fibers by edge, and the finest.
fn by_edge(usual: Configuration, edge: f64) -> Vec<Configuration> {
    let coarser = EDGES.into_iter().filter(|coarser| *coarser > NEAR * edge);
    let mut all: Vec<Configuration> = coarser.map(|edge| usual.edged(edge)).collect();
    let finest = usual.edged(FINEST).directed(16384);
    all.extend([usual, finest]);
    all.dedup_by_key(|configuration| configuration.name());
    all
}

fn tallies(trial: &Trial, walks: u64) -> Result<Vec<Tally>> {
    let seed = trial.configuration().seed(1);
    let blocks = trial.blocks(common::gpu(), seed, 0, walks)?;
    Ok(blocks.into_iter().map(|block| block.tally).collect())
}

/// The mean of a share over the blocks and its standard error, by start.
fn means(blocks: &[Tally], share: impl Fn(&Totals) -> f64) -> Vec<[f64; 2]> {
    let n = blocks.len() as f64;
    let of = |start: usize| {
        let shares: Vec<f64> = blocks.iter().map(|block| share(&totals(block, start, 0))).collect();
        let mean = shares.iter().sum::<f64>() / n;
        let square = shares.iter().map(|share| (share - mean).powi(2)).sum::<f64>();
        [mean, (square / n / (n - 1.0)).sqrt()]
    };
    (0..blocks[0].starts()).map(of).collect()
}

/// The row of the fibers: values by direction.
fn fiber_row(label: &str, reference: &[Tally], trial: &Trial, seconds: f64) -> Result<String> {
    let of = |share: fn(&Totals) -> f64| {
        means(reference, share).iter().map(|[value, _]| format!("{value:.3}")).collect::<Vec<_>>().join(" ")
    };
    let walks = reference.iter().map(|block| block.counts.launched).sum::<u64>() as f64;
    let hits = reference.iter().map(|block| block.counts.collisions).sum::<u64>() as f64;
    Ok(format!(
        "{label} | fibers, {:.2} hits | {} | {} | {} | noise {:.1}, {:.1e} walks/s | {} | {:.2} to draw |",
        hits / walks,
        of(|totals| totals.reflectance.value),
        of(|totals| totals.transmittance.value),
        of(|totals| totals.direct.value),
        100.0 * block_noise(reference)?.value,
        walks / seconds,
        trial.bytes() / 1024,
        trial.drawing(),
    ))
}

/// One medium.
fn row(trial: &Trial, blocks: &[Tally], reference: &[Tally]) -> Result<String> {
    let worst = |share: fn(&Totals) -> f64, relative: bool| {
        let (here, there) = (means(blocks, share), means(reference, share));
        let off = here.iter().zip(&there).map(|(a, b)| {
            let percent = 100.0 / if relative { b[0] } else { 1.0 };
            (percent * (a[0] - b[0]), percent * a[1].hypot(b[1]))
        });
        let (value, error) = off.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs())).unwrap_or_default();
        format!("{value:+.1} ± {error:.1}")
    };
    let found = distance(blocks, reference)?.estimate();
    Ok(format!(
        "| {} | {} | {} | {:.1} ± {:.1} | {} | {:.1} |",
        worst(|totals| totals.reflectance.value, true),
        worst(|totals| totals.transmittance.value, true),
        worst(|totals| totals.direct.value, false),
        100.0 * found.value,
        100.0 * found.stderr,
        trial.bytes() / 1024,
        trial.seconds(),
    ))
}
