//! The methods, the table's rows, and what is asked of them.

use crate::common::stats::binomial_z;
use crate::common::{Cloth, assert_ran, engines, gpu};
use fiberwalk::goniometer::{Goniometer, Tally};
use fiberwalk::gpu::Settings;
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::tables::SamplingTables;
use fiberwalk::walk::{Engine, WalkPlan};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Comparisons of the whole family.
const FAMILY: usize = 500;
/// 1 − (1 − 2Φ(−z))⁵⁰⁰ = 2Φ(−3).
pub const GATE: f64 = 4.55;

/// How the next collision is drawn and where the next flight starts.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    pub name: &'static str,
    tracking: &'static str,
    placement: &'static str,
}

const fn method(name: &'static str, tracking: &'static str, placement: &'static str) -> Method {
    Method { name, tracking, placement }
}

pub const NULL: Method = method("null collisions", "null-collision", "at-hit");
pub const TABULATED: Method = method("tabulated", "tabulated", "at-hit");
pub const METHODS: [Method; 5] = [
    NULL,
    TABULATED,
    method("carried", "null-collision", "carried"),
    method("carried-dense", "null-collision", "carried-dense"),
    method("carried-void", "null-collision", "carried-void"),
];

impl Method {
    pub fn of(&self, cloth: &Cloth) -> Cloth {
        Cloth { tracking: self.tracking, placement: self.placement, ..cloth.clone() }
    }

    /// Whether fibers leave less room to each other: rates count 1/(1 − v) times.
    pub fn separate(&self) -> bool {
        matches!(self.placement, "carried-dense" | "carried-void")
    }

    pub fn carried(&self) -> bool {
        self.placement != "at-hit"
    }
}

/// Walks of a comparison that is usually made with so many.
pub fn walks(usual: u64) -> u64 {
    let factor = std::env::var("FIBERWALK_STABILITY").ok().and_then(|text| text.parse().ok());
    usual * factor.unwrap_or(1u64)
}

/// What was found, and how far it is from what it should be, in standard errors.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    pub value: f64,
    pub z: f64,
}

impl Found {
    /// A share of walks.
    pub fn share(count: u64, walks: u64, probability: f64) -> Found {
        Found { value: count as f64 / walks as f64, z: binomial_z(count, walks, probability) }
    }
}

/// As a row has it.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if (size - size.round()).abs() < 1e-9 && size < 1e5 {
        format!("{}", size.round().copysign(value))
    } else if (1e-3..1e3).contains(&size) {
        format!("{value:.4}")
    } else {
        format!("{value:.2e}")
    }
}

/// A number of which only the size matters.
fn size(value: f64) -> String {
    if value == 0.0 { "0".into() } else { format!("{value:.0e}") }
}

/// Standard errors, without a sign where there are none.
fn errors(z: f64) -> String {
    format!("{:.1}", (10.0 * z).round() / 10.0 + 0.0)
}

/// The head of a table.
pub fn section(title: &str) {
    let names = ["regime", "method", "independent", "gpu", "z", "cpu", "z", "verdict"];
    print!("\n### {title}\n| {} |\n|{}\n", names.join(" | "), "---|".repeat(names.len()));
}

fn row(regime: &str, method: &str, independent: &str, found: [&str; 4], verdict: &str) {
    let cells = [&[regime, method, independent], &found[..], &[verdict]].concat();
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
    // One call: tests run beside each other.
    print!("\n| {} |\n", cells.join(" | "));
}

/// Both engines, or the only one there is, must find the independent value.
pub fn right(regime: &str, method: &str, independent: f64, gpu: Option<Found>, cpu: Option<Found>) {
    static MADE: AtomicUsize = AtomicUsize::new(0);
    let found: Vec<Found> = [gpu, cpu].into_iter().flatten().collect();
    let value = |found: Option<Found>| found.map_or("—".into(), |found| number(found.value));
    let z = |found: Option<Found>| found.map_or("—".into(), |found| errors(found.z));
    row(regime, method, &number(independent), [&value(gpu), &z(gpu), &value(cpu), &z(cpu)], "right");
    assert!(
        MADE.fetch_add(found.len(), Ordering::Relaxed) + found.len() <= FAMILY,
        "the gate is for fewer comparisons"
    );
    assert!(found.iter().all(|found| found.z.abs() < GATE), "{regime}, {method}: {found:?} for {independent}");
}

/// The weak method must not find it.
pub fn fails(regime: &str, weak: &str, independent: f64, found: Found) {
    let (value, z) = (number(found.value), errors(found.z));
    row(regime, &format!("*{weak}*"), &number(independent), ["—", "—", &value, &z], "*fails*");
    assert!(found.z.is_nan() || found.z.abs() > 2.0 * GATE, "{regime}, {weak}: {found:?} passes");
}

/// An error that is no matter of chance, and what it may be.
pub fn within(regime: &str, method: &str, [gpu, cpu]: [Option<f64>; 2], bound: f64) {
    let cell = |error: Option<f64>| error.map_or("—".into(), size);
    row(regime, method, &format!("0, ± {}", size(bound)), [&cell(gpu), "—", &cell(cpu), "—"], "right");
    let fine = [gpu, cpu].into_iter().flatten().all(|error| error.abs() <= bound);
    assert!(fine, "{regime}, {method}: off by {gpu:?}, {cpu:?}, allowed {bound:e}");
}

/// The weak method's error is far beyond.
pub fn beyond(regime: &str, weak: &str, error: f64, bound: f64) {
    row(regime, &format!("*{weak}*"), &format!("0, ± {}", size(bound)), ["—", "—", &size(error), "—"], "*fails*");
    assert!(error.is_nan() || error > 10.0 * bound, "{regime}, {weak}: off by {error:e} only");
}

/// What cannot be right is refused.
pub fn refused(regime: &str, method: &str, message: &str, expected: &str) {
    row(regime, method, "—", ["—"; 4], &format!("refused: “{message}”"));
    assert!(message.contains(expected), "{regime}, {method}: {message}");
}

/// What is right in a sense that the user must know of comes with a note.
pub fn said(regime: &str, method: &str, message: &str, expected: &str) {
    row(regime, method, "—", ["—"; 4], &format!("says: “{message}”"));
    assert!(message.contains(expected), "{regime}, {method}: {message}");
}

/// A line under the rows.
pub fn note(text: &str) {
    print!("\n> {text}\n\n");
}

/// The tables of a sheet and its instrument.
pub fn setup(cloth: &Cloth) -> (SamplingTables, Goniometer) {
    let Prepared { tables, goniometer, .. } = prepare(&cloth.scene()).unwrap_or_else(|error| panic!("{error}"));
    (tables, goniometer)
}

/// Run an engine, from random numbers of its own; all walks must come to an end.
pub fn track(name: &str, engine: &dyn Engine, setup: &(SamplingTables, Goniometer), seed: u64, walks: u64) -> Tally {
    let plan = WalkPlan::new(if name == "cpu" { seed + 500_000 } else { seed }, walks);
    // Kernels are compiled for a number of passes between flushes, which the tally does not depend on.
    let settings = Settings { flush_every: Some(5), ..Settings::default() };
    let tally = match name {
        "gpu" => gpu().run_with(settings, &setup.0, &setup.1, &plan, &mut |_| {}).map(|(tally, _)| tally),
        _ => engine.run(&setup.0, &setup.1, &plan, &mut |_| {}),
    };
    let tally = tally.unwrap_or_else(|error| panic!("{name}: {error}"));
    tally.check(walks).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_ran(&tally, name);
    assert!((0..tally.starts()).all(|start| tally.lost(start) == 0), "{name}: walks were lost");
    tally
}

/// Shares of reflected and transmitted walks of a start.
pub fn scattered(tally: &Tally, start: usize) -> [u64; 2] {
    [tally.reflection(start), tally.transmission(start)].map(|cells| cells.iter().sum())
}

/// Direct light of all methods, lit from one direction, against exp(−depth); fibers fill v of the sheet.
pub fn direct(regime: &str, cloth: &Cloth, depth: f64, v: f64, seed: u64, methods: &[Method]) {
    for (method, seed) in methods.iter().zip(seed..) {
        let expected = (-depth / if method.separate() { 1.0 - v } else { 1.0 }).exp();
        let setup = setup(&method.of(cloth));
        let [gpu, cpu] = engines().map(|(name, engine)| direct_share(name, engine, &setup, seed, expected));
        right(regime, method.name, expected, Some(gpu), Some(cpu));
    }
}

/// The share of direct light, in a lossless medium whose accounts must close.
pub fn direct_share(
    name: &str,
    engine: &dyn Engine,
    setup: &(SamplingTables, Goniometer),
    seed: u64,
    expected: f64,
) -> Found {
    let walks = walks(40_000);
    let tally = track(name, engine, setup, seed, walks);
    assert_eq!(scattered(&tally, 0).iter().sum::<u64>() + tally.direct(0), walks, "{name}: light was lost");
    Found::share(tally.direct(0), walks, expected)
}
