//! Speed of the engines, in alternation, with spread: `cargo bench --bench engines [-- ROUNDS [NAME]]`; NAME leaves rows
//! out whose name does not contain it.
//!
//! Isotropic fibers of index 1.5 at optical depths H·d = 0.5, 4 and 32 (H is the true total specific visible area, not
//! the majorant, which is 4/π of it), 1024 directions, 64 incident cells. The variants leave out jitter, let walks start in
//! the middle of their incident cells instead of at random, read directions from a texture, track by a table of H(m), carry
//! light through the fibers, dye them in three channels, and give them ends. The weaves are grids of cells, open and dense. Each figure is the median
//! over the rounds, with the smallest and the largest.

mod weaves;

use fiberwalk::concentric::Patch;
use fiberwalk::distribution::DirectionGrid;
use fiberwalk::goniometer::{Basis, DiscBasis, Goniometer, Incidence, Tally};
use fiberwalk::gpu::{Gpu, Settings};
use fiberwalk::reference::Reference;
use fiberwalk::scene::{Placement, Side};
use fiberwalk::tables::{AliasTable, Carry, Kind, List, SamplingTables, VisibleArea};
use fiberwalk::walk::{Engine, WalkPlan};
use glam::DVec2;
use std::f64::consts::PI;
use std::rc::Rc;
use std::time::Instant;

/// One row of the table.
struct Case<'a> {
    name: String,
    /// None for the cpu engine.
    gpu: Option<&'a Gpu>,
    tables: Rc<SamplingTables>,
    disc: bool,
    jitter: bool,
    texture: bool,
    cells_in_texture: bool,
    walks: u64,
}

impl<'a> Case<'a> {
    /// A row with the usual settings.
    fn new(name: String, gpu: Option<&'a Gpu>, tables: &Rc<SamplingTables>, walks: u64) -> Case<'a> {
        let tables = Rc::clone(tables);
        Case { name, gpu, tables, disc: true, jitter: true, texture: false, cells_in_texture: false, walks }
    }
}

fn main() {
    let rounds = std::env::args().filter_map(|argument| argument.parse().ok()).next().unwrap_or(5);
    let gpu = Gpu::open(None);
    match &gpu {
        Ok(gpu) => println!("gpu: {}", gpu.adapter()),
        Err(error) => println!("no gpu rows: {error}"),
    }
    let gpu = gpu.ok();
    let wanted =
        std::env::args().skip(1).find(|argument| !argument.starts_with('-') && argument.parse::<u32>().is_err());
    let mut cases = cases(gpu.as_ref());
    cases.extend(weave_cases(gpu.as_ref()));
    cases.retain(|case| wanted.as_ref().is_none_or(|name| case.name.contains(name)));
    println!("{rounds} rounds in alternation; median (smallest, largest)");
    let mut seconds = vec![Vec::new(); cases.len()];
    let mut tallies: Vec<Option<Tally>> = cases.iter().map(|_| None).collect();
    for round in 0..=rounds {
        for (i, case) in cases.iter().enumerate() {
            let (time, tally) = run(case);
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

fn cases(gpu: Option<&Gpu>) -> Vec<Case<'_>> {
    let mut cases = Vec::new();
    for (depth, walks) in [(0.5, 8_000_000), (4.0, 4_000_000), (32.0, 500_000)] {
        let tables = Rc::new(sheet(depth));
        let plain = |name: &str, gpu, walks| Case::new(format!("{name}, H d = {depth}"), gpu, &tables, walks);
        cases.push(plain("cpu", None, walks / 4));
        let Some(gpu) = gpu else { continue };
        let variant = |what: &str| Case { name: format!("gpu, H d = {depth}, {what}"), ..plain("", Some(gpu), walks) };
        cases.push(plain("gpu", Some(gpu), walks));
        cases.push(Case { jitter: false, ..variant("no jitter") });
        cases.push(Case { disc: false, ..variant("fixed starts") });
        cases.push(Case { jitter: false, disc: false, ..variant("neither") });
        cases.push(Case { texture: true, ..variant("in a texture") });
        cases.push(Case { tables: Rc::new(with_table(&tables)), ..variant("tabulated") });
        cases.push(Case { tables: Rc::new(carried(&tables)), ..variant("carried") });
        cases.push(Case { tables: Rc::new(dyed(&tables)), ..variant("dyed, 3 channels") });
        cases.push(Case { tables: Rc::new(short(&tables)), ..variant("fibers with ends") });
    }
    cases
}

/// The same fibers, one channel clear, one grey, one dark.
fn dyed(tables: &SamplingTables) -> SamplingTables {
    let kind = Kind { absorption: vec![0.0, 20.0, 120.0], ..tables.kinds[0].clone() };
    SamplingTables { kinds: vec![kind], ..tables.clone() }
}

/// The same fibers, from whose surfaces flights start.
fn carried(tables: &SamplingTables) -> SamplingTables {
    SamplingTables {
        carry: Some(Carry { radius: tables.kinds[0].radius, factors: false, memory: false }),
        ..tables.clone()
    }
}

/// The same fibers, cut to 20 radii.
fn short(tables: &SamplingTables) -> SamplingTables {
    SamplingTables { half_length: 10.0, ..tables.clone() }
}

/// Cells of an open plain weave and of a dense twill.
fn weave_cases(gpu: Option<&Gpu>) -> Vec<Case<'_>> {
    let mut cases = Vec::new();
    // The coarse grid fits a uniform buffer.
    let coarse = weaves::Weave { counts: [24, 24, 7], ..weaves::VOILE };
    for (name, weave, walks) in
        [("voile", weaves::VOILE, 4_000_000), ("coarse voile", coarse, 4_000_000), ("denim", weaves::DENIM, 1_000_000)]
    {
        let specific_length = weave.specific_length();
        let tables = Rc::new(weaves::tables(&specific_length, Placement::AtHit));
        if let Some(cells) = &tables.cells {
            let empty =
                cells.entries.iter().filter(|cell| cell.share == 0.0).count() as f64 / cells.entries.len() as f64;
            println!(
                "{name}: {} cells, {empty:.2} of them empty, {} entries, majorant depth {:.1}",
                cells.entries.len(),
                tables.patches.len(),
                tables.majorant * tables.thickness
            );
        }
        let case = |engine: &str, gpu, walks| Case::new(format!("{engine}, {name}"), gpu, &tables, walks);
        cases.push(case("cpu", None, walks / 8));
        let Some(gpu) = gpu else { continue };
        cases.push(case("gpu", Some(gpu), walks));
        let placements = [
            ("carried", Placement::Carried),
            ("carried-dense", Placement::CarriedDense),
            ("carried-void", Placement::CarriedVoid),
        ];
        for (word, placement) in placements {
            let (name, tables) = (format!("gpu, {name}, {word}"), Rc::new(weaves::tables(&specific_length, placement)));
            cases.push(Case { name, tables, ..case("", Some(gpu), walks) });
        }
        let name_of_table = format!("gpu, {name}, tabulated");
        let tabulated = Rc::new(with_table(&tables));
        cases.push(Case { name: name_of_table, tables: tabulated, ..case("", Some(gpu), walks) });
        if name == "coarse voile" {
            let name = format!("gpu, {name}, cells in a texture");
            cases.push(Case { name, cells_in_texture: true, ..case("", Some(gpu), walks) });
        }
    }
    cases
}

/// The same medium, tracked by tables.
fn with_table(tables: &SamplingTables) -> SamplingTables {
    let visible = VisibleArea::new(tables).unwrap_or_else(|error| panic!("{error}"));
    SamplingTables { visible: Some(visible), ..tables.clone() }
}

fn sheet(depth: f64) -> SamplingTables {
    let grid = DirectionGrid { n: 32 };
    let patches: Vec<Patch> = grid.cells().collect();
    SamplingTables {
        thickness: 1.0,
        majorant: depth * 4.0 / PI,
        kinds: vec![Kind { radius: 0.01, ior: 1.5, absorption: vec![0.0] }],
        half_length: f64::INFINITY,
        lists: vec![List { first: 0, alias: AliasTable::new(&vec![1.0; patches.len()]) }],
        entry_kinds: vec![0; patches.len()],
        patches,
        patch_unit: grid.unit(),
        cells: None,
        visible: None,
        carry: None,
    }
}

fn run(case: &Case) -> (f64, Tally) {
    let tables = &case.tables;
    let disc = DiscBasis { n: 8 };
    let incidence = if case.disc {
        Incidence::Cells(Basis::Disc(disc))
    } else {
        Incidence::Listed((0..disc.cells()).map(|cell| disc.direction(cell, DVec2::splat(0.5))).collect())
    };
    let goniometer = Goniometer { incidence, exit: Basis::Disc(DiscBasis { n: 16 }), sides: vec![Side::Front] };
    let cells = goniometer.incident_cells() as u64;
    let plan = WalkPlan { jitter: case.jitter, ..WalkPlan::new(1, case.walks / cells) };
    let started = Instant::now();
    let settings = Settings {
        table_in_texture: Some(case.texture),
        cells_in_texture: Some(case.cells_in_texture),
        ..Settings::default()
    };
    let result = match case.gpu {
        Some(gpu) => gpu.run_with(settings, tables, &goniometer, &plan, &mut |_| {}).map(|(tally, _)| tally),
        None => Reference.run(tables, &goniometer, &plan, &mut |_| {}),
    };
    match result {
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
