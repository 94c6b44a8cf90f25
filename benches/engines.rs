//! Speed of the engines, in alternation, with spread: `cargo bench --bench engines [-- ROUNDS]`.
//!
//! Isotropic fibers of index 1.5 at optical depths H·d = 0.5, 4 and 32 (H is the true total specific visible area, not
//! the majorant, which is 4/π of it), 1024 directions, 64 incident cells. The variants leave out jitter, and let walks
//! start in the middle of their incident cells instead of at random. Each figure is the median over the rounds, with the smallest and the largest.

use fiberwalk::concentric::Patch;
use fiberwalk::distribution::DirectionGrid;
use fiberwalk::goniometer::{DiscBasis, Goniometer, Incidence, Tally};
use fiberwalk::gpu::Gpu;
use fiberwalk::reference::Reference;
use fiberwalk::tables::{AliasTable, SamplingTables};
use fiberwalk::walk::{Engine, WalkPlan};
use glam::DVec2;
use std::f64::consts::PI;
use std::time::Instant;

/// One row of the table.
struct Case {
    name: String,
    engine: usize,
    depth: f64,
    disc: bool,
    jitter: bool,
    walks: u64,
}

fn main() {
    let rounds = std::env::args().filter_map(|argument| argument.parse().ok()).next().unwrap_or(5);
    let cpu = Reference;
    let gpu = Gpu::open(None);
    if let Err(error) = &gpu {
        println!("no gpu rows: {error}");
    }
    let mut engines: Vec<(&str, &dyn Engine)> = vec![("cpu", &cpu)];
    if let Ok(gpu) = &gpu {
        println!("gpu: {}", gpu.adapter());
        engines.push(("gpu", gpu));
    }
    let cases = cases(&engines);
    println!("{rounds} rounds in alternation; median (smallest, largest)");
    let mut seconds = vec![Vec::new(); cases.len()];
    let mut tallies: Vec<Option<Tally>> = cases.iter().map(|_| None).collect();
    for round in 0..=rounds {
        for (i, case) in cases.iter().enumerate() {
            let (time, tally) = run(engines[case.engine].1, case);
            // The first round warms up compilers and caches.
            if round > 0 {
                seconds[i].push(time);
            }
            tallies[i] = Some(tally);
        }
    }
    println!("{:<34} {:>24} {:>24} {:>24}", "case", "walks/s", "tentative events/s", "collisions/s");
    for ((case, seconds), tally) in cases.iter().zip(&mut seconds).zip(&tallies) {
        let Some(tally) = tally else { continue };
        let counts = tally.counts;
        let [walks, events, hits] =
            [counts.launched, counts.tentative_events, counts.collisions].map(|n| rates(n, seconds));
        println!("{:<34} {walks:>24} {events:>24} {hits:>24}", case.name);
    }
}

fn cases(engines: &[(&str, &dyn Engine)]) -> Vec<Case> {
    let mut cases = Vec::new();
    for (depth, walks) in [(0.5, 8_000_000), (4.0, 4_000_000), (32.0, 500_000)] {
        for (engine, (name, _)) in engines.iter().enumerate() {
            let walks = if *name == "cpu" { walks / 4 } else { walks };
            let case = |label: &str, disc, jitter| {
                let name = format!("{name}, H d = {depth}{label}");
                Case { name, engine, depth, disc, jitter, walks }
            };
            cases.push(case("", true, true));
            if *name == "gpu" {
                cases.push(case(", no jitter", true, false));
                cases.push(case(", fixed start", false, true));
                cases.push(case(", neither", false, false));
            }
        }
    }
    cases
}

fn run(engine: &dyn Engine, case: &Case) -> (f64, Tally) {
    let n = 32;
    let grid = DirectionGrid { n };
    let patches: Vec<Patch> = grid.cells().collect();
    let tables = SamplingTables {
        thickness: 1.0,
        majorant: case.depth * 4.0 / PI,
        ior: 1.5,
        alias: AliasTable::new(&vec![1.0; patches.len()]),
        patches,
        patch_unit: grid.unit(),
    };
    let disc = DiscBasis { n: 8 };
    let incidence = if case.disc {
        Incidence::Disc(disc)
    } else {
        Incidence::Listed((0..disc.cells()).map(|cell| disc.direction(cell, DVec2::splat(0.5))).collect())
    };
    let goniometer = Goniometer { incidence, exit: DiscBasis { n: 16 } };
    let cells = goniometer.incident_cells() as u64;
    let plan = WalkPlan { jitter: case.jitter, ..WalkPlan::new(1, case.walks / cells) };
    let started = Instant::now();
    match engine.run(&tables, &goniometer, &plan, &mut |_| {}) {
        Ok(tally) => (started.elapsed().as_secs_f64(), tally),
        Err(error) => panic!("{}: {error}", case.name),
    }
}

/// Median, smallest and largest rate.
fn rates(count: u64, seconds: &mut [f64]) -> String {
    seconds.sort_by(f64::total_cmp);
    let rate = |time: f64| count as f64 / time;
    let [fastest, median, slowest] = [seconds[0], seconds[seconds.len() / 2], seconds[seconds.len() - 1]].map(rate);
    format!("{median:.2e} ({slowest:.1e}, {fastest:.1e})")
}
