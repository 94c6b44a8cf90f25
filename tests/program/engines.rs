//! `fiberwalk engines`, and the engine that a measurement takes by itself.

use crate::common::program::{Outcome, Place, finish};
use serde_json::Value;
use std::process::Command;

/// What hides every Vulkan driver from the loader.
const NO_DRIVER: [(&str, &str); 2] = [("VK_DRIVER_FILES", "/nonexistent"), ("VK_ICD_FILENAMES", "/nonexistent")];
const MEASURE: [&str; 6] = ["measure", "nonwoven", "--walks", "200", "--incident", "2"];

/// The program with changes of its environment.
fn run(place: &Place, arguments: &[&str], change: impl Fn(&mut Command)) -> Outcome {
    let mut command = place.command(arguments);
    change(&mut command);
    finish(command)
}

/// What a measurement says of its choice, and the note on the engine.
fn choice(place: &Place, change: impl Fn(&mut Command)) -> (Value, String) {
    let Outcome { code, stderr, .. } = run(place, &[&MEASURE[..], &["--force"]].concat(), change);
    assert_eq!(code, Some(0), "{stderr}");
    let note = stderr.lines().find(|line| line.starts_with("engine: ")).expect("the engine is told");
    let text = std::fs::read(place.path("nonwoven/summary.json")).expect("the summary is there");
    let summary: Value = serde_json::from_slice(&text).expect("the summary is JSON");
    (summary["choice"].clone(), note.to_owned())
}

#[test]
fn engines_are_listed_tested_and_timed() {
    let place = Place::new();
    let Outcome { code, stdout, stderr } = place.run(&["engines"]);
    assert_eq!(code, Some(0), "{stdout}{stderr}");
    assert!(stdout.contains("gpu 1  ") && stdout.contains("cpu  "), "{stdout}");
    let engines = stdout.lines().filter(|line| line.starts_with("gpu") || line.starts_with("cpu")).count();
    for told in ["self-test passed", "standard run: "] {
        assert_eq!(stdout.matches(told).count(), engines, "{stdout}");
    }
    assert!(stdout.lines().last().is_some_and(|line| line.starts_with("auto   ")), "{stdout}");
    assert_eq!(place.run(&["engines", "--adapter", "nosuch"]).code, Some(3));
}

#[test]
fn a_driver_that_does_not_load_is_named_and_the_others_are_listed() {
    let place = Place::new();
    place.write("broken.json", "{\"ICD\": {\"library_path\": \"./libgone.so\"}}");
    let Outcome { code, stdout, stderr } = run(&place, &["engines"], |command| {
        command.env("VK_ADD_DRIVER_FILES", place.path("broken.json"));
    });
    assert_eq!(code, Some(0), "{stdout}{stderr}");
    let told =
        format!("driver {} does not load: its library ./libgone.so is not there", place.path("broken.json").display());
    assert!(stdout.lines().any(|line| line == told) && stdout.contains("gpu 1  "), "{stdout}");
}

#[test]
fn without_any_adapter_engines_ends_with_a_fault_of_the_device() {
    let place = Place::new();
    let Outcome { code, stdout, stderr } = run(&place, &["engines"], |command| {
        command.envs(NO_DRIVER);
    });
    assert_eq!(code, Some(3), "{stdout}{stderr}");
    for told in
        ["gpu    no adapter\n", "driver /nonexistent does not load: the file cannot be read", "\nauto   cpu on "]
    {
        assert!(stdout.contains(told), "{stdout}");
    }
    assert_eq!(stdout.matches("self-test passed").count(), 1, "the processor works: {stdout}");
    let last = stderr.lines().last().unwrap_or_default();
    assert!(
        last.starts_with("error: the gpu engine needs a Vulkan") && last.contains("no adapter was found"),
        "{stderr}"
    );
}

#[test]
fn a_measurement_says_why_it_took_its_engine() {
    let place = Place::new();
    let (choice, note) = choice(&place, |_| {});
    let reason = choice["reason"].as_str().expect("a reason is given");
    assert!(note.ends_with(&format!("; {reason}")), "{note}");
    let rates = choice["compared"].as_array().expect("a list").iter().map(|rated| &rated["walks_per_second"]);
    let rates: Vec<f64> = rates.map(|rate| rate.as_f64().expect("a number")).collect();
    assert!(rates.is_sorted_by(|a, b| a >= b) && rates.iter().all(|rate| *rate > 0.0), "{rates:?}");
    // A graphics processor is compared with nothing.
    assert!(rates.is_empty() != reason.starts_with("the fastest"), "{reason}");
    let asked = place.run(&[&MEASURE[..], &["--engine", "cpu", "--force"]].concat());
    assert!(asked.stderr.contains("; asked for\n"), "{}", asked.stderr);
}

#[test]
fn figures_are_kept_and_a_cache_that_is_damaged_or_closed_is_no_error() {
    let place = Place::new();
    let cache = place.path("cache");
    let in_cache = |command: &mut Command| {
        command.env("XDG_CACHE_HOME", &cache);
    };
    let (first, note) = choice(&place, in_cache);
    if first["compared"].as_array().is_some_and(|compared| compared.is_empty()) {
        assert!(note.contains("the best adapter"), "{note}");
        return;
    }
    let (again, _) = choice(&place, in_cache);
    assert_eq!(first, again, "the figures of the first run serve the second");
    let file =
        std::fs::read_dir(cache.join("fiberwalk")).expect("the folder is there").next().expect("it holds a file");
    let file = file.expect("it can be read").path();
    // Whoever is said to be the fastest is taken.
    let text = std::fs::read_to_string(&file).expect("figures are text");
    let mut figures: serde_json::Map<String, Value> = serde_json::from_str(&text).expect("figures are JSON");
    figures.iter_mut().for_each(|(name, figure)| *figure = if name.starts_with("cpu") { 9e9 } else { 1.0 }.into());
    std::fs::write(&file, Value::Object(figures).to_string()).expect("it can be written");
    let (_, note) = choice(&place, in_cache);
    assert!(note.starts_with("engine: cpu on ") && note.contains("9.0e9 walks/s against 1.0e0 of gpu on "), "{note}");
    std::fs::write(&file, "{\"gpu").expect("it can be written");
    let (_, note) = choice(&place, in_cache);
    assert!(note.contains("the fastest by the standard run") && !note.contains("9.0e9"), "{note}");
    place.write("closed", "");
    let (_, note) = choice(&place, |command| {
        command.env("XDG_CACHE_HOME", place.path("closed"));
    });
    assert!(note.contains("; figures cannot be kept: ") && note.contains("closed/fiberwalk"), "{note}");
}
