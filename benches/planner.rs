//! Whether plans meet their tolerance and what they cost: `cargo bench --bench planner -- [PRESET...] [list]`, all presets without
//! words; `list` prints every configuration of the list instead, with its E and the microseconds of a walk.
//!
//! For each preset every configuration of the planner's list is held against the fibers themselves, with E and its standard error from
//! independent blocks of walks and the seconds of a walk. A row is a plan: what was chosen, its E as found here, the noise
//! that it leaves, both together, and the cost of its walks over that of the cheapest configuration of the list that
//! meets the tolerance by what was found: events × measured nanoseconds × walks until the noise that is left; behind a comma the same over
//! the cheapest that does with E² one standard error higher. Then the seconds of the pilots.
//! The output is Markdown.

#[path = "../tests/common/mod.rs"]
mod common;

use fiberwalk::bsdf::{Distance, distance};
use fiberwalk::error::Result;
use fiberwalk::goniometer::Tally;
use fiberwalk::plan::{Configuration, EngineClass, Extent, Trial, candidates, plan};
use fiberwalk::scene::{Medium, PRESETS, Scene, Source};

/// Directions (θ, φ) in degrees, none in a plane in which yarns lie.
const DIRECTIONS: &str = "[[3, 35], [30, 20], [60, 12], [60, 55]]";
const EXIT: &str = "8";
const TOLERANCES: [f64; 3] = [0.1, 0.05, 0.02];
/// Walks of each direction and block: four times as many where so many of them take less than the first number of seconds, twice as
/// many where they take less than the second.
const WALKS: u64 = 32_768;
const QUICK: [f64; 2] = [2.0, 5.0];
/// Walks of each direction through one realization of the fibers.
const EACH: u64 = 512;

/// A configuration as it was found.
struct Found {
    configuration: Configuration,
    distance: Distance,
    seconds_a_walk: f64,
}

impl Found {
    /// Cost of the walks that bring the noise to what E² leaves of a tolerance, E² so many standard errors higher than it was found;
    /// infinite if nothing is left.
    fn cost(&self, tolerance: f64, z: f64) -> f64 {
        let left = tolerance * tolerance - (self.distance.square + z * self.distance.square_error).max(0.0);
        if left > 0.0 { self.seconds_a_walk / left } else { f64::INFINITY }
    }
}

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    println!("Light from {DIRECTIONS}; exit cells {EXIT} × {EXIT} on each side.\n");
    let listed = words.iter().any(|word| word == "list");
    if listed {
        println!("| preset | configuration | E % | µs a walk |");
        println!("|---|---|---|---|");
    } else {
        println!(
            "| preset | tolerance % | plan | E % | noise % | both % | met | cost over the cheapest, over the cheapest that surely meets it | pilots s |"
        );
        println!("|---|---|---|---|---|---|---|---|---|");
    }
    let named = |name: &str| words.iter().all(|word| word == "list") || words.iter().any(|word| word == name);
    for (name, _) in PRESETS.into_iter().filter(|(name, _)| named(name)) {
        if let Err(error) = study(name, listed) {
            println!("| {name} | {error} ||||||||");
        }
    }
    Ok(())
}

fn study(name: &str, listed: bool) -> Result<()> {
    let mut scene = Scene::parse(&Source::find(name)?)?;
    scene.measure.set_from_flag("incident", DIRECTIONS)?;
    scene.measure.set_from_flag("exit", EXIT)?;
    // Separate fibers of all presets would take hours to be drawn.
    scene.model.set_from_flag("packing", "random")?;
    let extent = Extent::of(&scene)?;
    let trial = Trial::prepare(&scene, &extent, Configuration::fibers(&scene, EACH))?;
    let seconds = trial.block(common::gpu(), trial.configuration().seed(1), 0, 0, WALKS)?.seconds;
    let walks = WALKS << QUICK.into_iter().filter(|quick| seconds < *quick).count();
    let fibers = blocks(&trial, walks)?;
    let mut list = Vec::new();
    for configuration in candidates(&scene, &extent) {
        let explicit = configuration.model.medium == Medium::Explicit;
        // The fibers are held against themselves by definition.
        let (found, seconds_a_walk) = if explicit {
            (None, fibers.1)
        } else {
            let (tallies, seconds) = blocks(&Trial::prepare(&scene, &extent, configuration)?, walks)?;
            (Some(tallies), seconds)
        };
        let distance = found.map_or(Ok(Distance::default()), |found| distance(&found, &fibers.0))?;
        if listed {
            let estimate = distance.estimate();
            let [value, error] = [estimate.value, estimate.stderr].map(|share| 100.0 * share);
            println!("| {name} | {} | {value:.1} ± {error:.1} | {:.2} |", configuration.name(), 1e6 * seconds_a_walk);
        }
        list.push(Found { configuration, distance, seconds_a_walk });
    }
    if listed {
        return Ok(());
    }
    for tolerance in TOLERANCES {
        let engine = (common::gpu() as &dyn fiberwalk::walk::Engine, EngineClass::SoftwareGpu);
        let (plan, _) = plan(&scene, &extent, tolerance, engine, 1, true, false)?;
        let Some(chosen) = list.iter().find(|one| one.configuration.name() == plan.chosen) else { continue };
        let estimate = chosen.distance.estimate();
        let both = |square: f64| (plan.noise.powi(2) + square.max(0.0)).sqrt();
        let [low, middle] = [-2.0, 0.0].map(|z| both(chosen.distance.square + z * chosen.distance.square_error));
        let own = chosen.seconds_a_walk / plan.noise.powi(2);
        let over = |z: f64| {
            let costs = list.iter().map(|one| (own / one.cost(tolerance, z), one.configuration.name()));
            costs.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default()
        };
        let ((surely, _), (ratio, cheapest)) = (over(1.0), over(0.0));
        let ratio = format!("{ratio:.2}, {surely:.2} ({cheapest})");
        println!(
            "| {name} | {:.0} | {} | {:.1} ± {:.1} | {:.1} | {:.1} | {} | {ratio} | {:.1} |",
            100.0 * tolerance,
            plan.chosen,
            100.0 * estimate.value,
            100.0 * estimate.stderr,
            100.0 * plan.noise,
            100.0 * middle,
            if middle <= tolerance {
                "yes"
            } else if low <= tolerance {
                "within its error"
            } else {
                "no"
            },
            plan.pilot_seconds,
        );
    }
    Ok(())
}

/// Blocks of walks, and the seconds of a walk: events by the nanoseconds of one.
fn blocks(trial: &Trial, walks: u64) -> Result<(Vec<Tally>, f64)> {
    let blocks = trial.blocks(common::gpu(), trial.configuration().seed(1), 0, walks)?;
    let launched: u64 = blocks.iter().map(|block| block.tally.counts.launched).sum();
    // The median block, since others may use the machine.
    let mut seconds: Vec<f64> = blocks.iter().map(|block| block.seconds).collect();
    seconds.sort_by(f64::total_cmp);
    let seconds = seconds[seconds.len() / 2] * blocks.len() as f64;
    Ok((blocks.into_iter().map(|block| block.tally).collect(), seconds / launched as f64))
}
