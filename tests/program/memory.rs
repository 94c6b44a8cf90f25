//! Memory that is stated before a run is true after it.

use crate::common::program::Place;
use serde_json::Value;

const MIB: f64 = 1_048_576.0;

/// 31 channels, 16 × 16 incident and 2 × 32 × 32 exit cells, both sides.
fn cloth(incident: u32) -> String {
    format!(
        "[fiber.dyed]\nradius_um = 8\nior = 1.5\nabsorption_per_mm = {{ spectrum = \"dye.csv\" }}\n\
         [measure]\nsides = [\"front\", \"back\"]\nincident = {incident}\nexit = 32\n\
         [sheet]\nthickness_um = 500\n[[sheet.fibers]]\nfiber = \"dyed\"\nlength_density_per_mm2 = 300\n\
         orientation = \"isotropic\"\n"
    )
}

/// MiB that `inspect` states.
fn stated(place: &Place) -> f64 {
    let outcome = place.run(&["inspect", "cloth.toml"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    let words: Vec<&str> = outcome.stdout.split_whitespace().collect();
    let most = words.windows(3).find(|words| words[0] == "most" && words[2] == "MiB");
    most.and_then(|words| words[1].parse().ok()).unwrap_or_else(|| panic!("{}", outcome.stdout))
}

/// Largest resident memory of a run in MiB.
fn used(place: &Place, incident: u32) -> f64 {
    place.write("cloth.toml", cloth(incident));
    place.write("dye.csv", "nm,per_mm\n400,2\n550,20\n700,0.5\n");
    let outcome = place.run(&["measure", "cloth.toml", "--walks", "64", "--engine", "gpu", "--quiet", "--force"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    let summary = std::fs::read(place.path("cloth/summary.json")).expect("the summary is there");
    let summary: Value = serde_json::from_slice(&summary).expect("the summary is JSON");
    assert_eq!(summary["walks"], 64 * 2 * incident * incident);
    summary["peak_bytes"].as_u64().expect("this system tells") as f64 / MIB
}

#[test]
fn many_channels_take_the_memory_that_was_stated() {
    let place = Place::new();
    // The program itself, with shaders and device.
    let program = used(&place, 1);
    let all = used(&place, 16);
    let stated = stated(&place);
    println!("stated {stated:.0} MiB, used {:.0} MiB besides {program:.0} MiB", all - program);
    assert!(all - program <= stated, "{:.0} MiB were used and {stated:.0} MiB stated", all - program);
    assert!(all - program >= 0.5 * stated, "{stated:.0} MiB were stated for {:.0} MiB", all - program);
}
