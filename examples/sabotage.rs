//! Whether pilots find media that are tampered with: `cargo run --release --example sabotage -- [WALKS] [PRESET]…`
//!
//! Holds the 4 R medium of each preset (of a sheet its one medium) against the fibers by a pilot: as it is, with all specific lengths × 1.1,
//! and without memory. A row has the interval of E of each at the level of 95 %, and the least of the tolerances 10, 5, 3, 2 and 1 % that the pilot says it
//! keeps; a medium that is tampered with keeps less. Fibers overlap, since separate ones take long to be drawn.

use fiberwalk::bsdf::{Kept, Verdict};
use fiberwalk::measure::{EngineChoice, Prepared, choose, prepare};
use fiberwalk::plan::{Beside, Configuration, Extent, Pilot};
use fiberwalk::scene::{Memory, PRESETS, Scene, Source};
use fiberwalk::tables::SamplingTables;
use std::error::Error;

/// What the lengths are multiplied by.
const BENT: f64 = 1.1;
const TOLERANCES: [f64; 5] = [0.1, 0.05, 0.03, 0.02, 0.01];

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let walks: f64 = words.first().map_or(Ok(2e6), |word| word.parse())?;
    let names: Vec<&str> = match words.len() {
        0 | 1 => PRESETS.iter().map(|(name, _)| *name).collect(),
        _ => words[1..].iter().map(String::as_str).collect(),
    };
    let engine = choose(EngineChoice::Auto, None)?;
    println!("| preset | as it is | lengths × {BENT} | without memory |\n|---|---|---|---|");
    for name in names {
        let mut scene = Scene::parse(&Source::find(name)?)?;
        scene.model.set_from_flag("packing", "random")?;
        let extent = Extent::of(&scene)?;
        let pilot = Pilot::new(&scene, extent.realizer(), 1, |_, _| walks)?;
        let usual = Configuration::of(&scene, &extent);
        let usual = if usual.edge.is_some() { usual.edged(4.0) } else { usual }.without_rays();
        let hold = |configuration: Configuration, factor: f64| -> fiberwalk::Result<Verdict> {
            let medium = configuration.apply(&scene, &extent);
            let Prepared { mut specific_length, .. } = prepare(&medium)?;
            specific_length.values.iter_mut().for_each(|cell| cell.surface *= factor);
            let tables = SamplingTables::new(&medium, &specific_length)?;
            pilot.hold(&mut Beside::default(), &tables, &engine)
        };
        let word = |verdict: fiberwalk::Result<Verdict>| {
            let verdict = match verdict {
                Ok(verdict) => verdict,
                Err(error) => return error.to_string(),
            };
            let [low, high] = verdict.interval().map(|end| 100.0 * end);
            let least = TOLERANCES.iter().rev().find(|tolerance| verdict.kept(**tolerance) == Kept::Yes);
            let least = least.map_or("none".into(), |tolerance| format!("{} %", 100.0 * tolerance));
            format!("{low:.1} to {high:.1} %, keeps {least}")
        };
        let forgets = match usual.model.memory {
            Memory::None => "has none".into(),
            Memory::Flight => word(hold(usual.remembering(Memory::None), 1.0)),
        };
        println!("| {name} | {} | {} | {forgets} |", word(hold(usual, 1.0)), word(hold(usual, BENT)));
    }
    Ok(())
}
