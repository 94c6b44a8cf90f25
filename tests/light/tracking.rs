//! Tracking by tables of H(m) against null collisions, and rays along the fibers, where a table knows least.

use crate::common::cells::{CellCloth, random_cells};
use crate::common::stats::{GATE, binomial_z, means_z, two_tally_z};
use crate::common::{Cloth, ISOTROPIC, Kind, PLANAR, SplitMix, aligned, assert_ran, engines, gpu, mean_light, rgb};
use fiberwalk::Error;
use fiberwalk::goniometer::{Goniometer, Tally};
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::scene::{Scene, Source};
use fiberwalk::tables::{Carry, SamplingTables, VisibleArea};
use fiberwalk::walk::{Engine, WalkPlan};
use std::f64::consts::FRAC_PI_4;

/// N of the exit disc: densities change the light of wide cells as well.
const EXIT: u32 = 4;

/// A medium tracked by null collisions, its instrument, and the factor of all densities that stands at 8 to 10 σ.
struct Case {
    name: &'static str,
    tables: SamplingTables,
    goniometer: Goniometer,
    walks: u64,
    bend: f64,
}

fn with_table(mut tables: SamplingTables) -> SamplingTables {
    tables.visible = Some(VisibleArea::new(&tables).expect("the tables have room"));
    tables
}

fn sheet(cloth: &Cloth) -> (SamplingTables, Goniometer) {
    let Prepared { tables, goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
    (tables, goniometer)
}

/// Cells at random of which a share is filled, and of eight layers two that hold nothing where `gaps`.
fn scattered(filled: f64, gaps: bool) -> CellCloth {
    let mut random = SplitMix(5);
    let base = Cloth { exit: EXIT, ..Cloth::isotropic(2.0) }.lit_from("[[10, 20], [50, 100], [80, -60]]");
    let mut cells = CellCloth::new(base, [11, 7, 8], [1.3, 0.9], |_| 1.0);
    for ([.., z], cell) in cells.grid().places().zip(&mut cells.cells) {
        let full = random.uniform() < filled && !(gaps && [2, 6].contains(&z));
        cell.0 *= if full { (0.2 + 1.8 * random.uniform()) / filled } else { 0.0 };
        cell.1 = (random.word() % 3) as u32;
    }
    cells.lists = random_cells(1).lists;
    cells.lists.iter_mut().flatten().for_each(|bundle| bundle.kind = 0);
    cells
}

/// The preset voile in coarse cells.
fn voile() -> (SamplingTables, Goniometer) {
    let mut scene = Scene::parse(&Source::find("voile").expect("voile is a preset")).expect("the preset is fine");
    scene.model.set_from_flag("cells", "12x12x6").expect("the flag is fine");
    scene.model.set_from_flag("placement", "at-hit").expect("the flag is fine");
    scene.model = scene.model.without_rays();
    scene.measure.set_from_flag("incident", "[[15, 30], [65, -50]]").expect("the flag is fine");
    scene.measure.set_from_flag("exit", &EXIT.to_string()).expect("the flag is fine");
    let Prepared { tables, goniometer, .. } = prepare(&scene).expect("the cloth is fine");
    (tables, goniometer)
}

fn cases() -> Vec<Case> {
    let oblique = aligned([0.48, -0.6, 0.64]);
    let angles = "[[5, 10], [47, 100], [71, -130], [85, 40]]";
    let mixed = vec![(50.0, ISOTROPIC.to_owned()), (50.0, PLANAR.to_owned()), (50.0, oblique.clone())];
    let mixed = Cloth { fibers: mixed, exit: EXIT, ..Cloth::isotropic(1.0) }.lit_from(angles);
    // Light stays on cones, which wide cells blur.
    let aligned = Cloth { exit: 6, ..Cloth::new(120.0, &oblique) }.lit_from(angles);
    let dyed = Cloth { exit: EXIT, ..dyed() }.lit_from(angles);
    let case = |name, (tables, goniometer): (SamplingTables, Goniometer), walks, bend| Case {
        name,
        tables,
        goniometer,
        walks,
        bend,
    };
    vec![
        case("isotropic sheet", sheet(&isotropic()), 10_000, 1.095),
        case("mixed sheet", sheet(&mixed), 42_000, 1.066),
        case("aligned sheet", sheet(&aligned), 75_000, 1.058),
        case("dyed sheet", sheet(&dyed), 40_000, 1.062),
        case("dense cells", scattered(1.0, false).prepare(), 46_000, 1.064),
        case("sparse cells", scattered(0.2, true).prepare(), 50_000, 1.094),
        case("voile", voile(), 62_000, 1.125),
    ]
}

/// Light from all over the disc, from few cells.
fn isotropic() -> Cloth {
    Cloth { exit: EXIT, ..Cloth::isotropic(2.0) }.lit_from("3")
}

/// Two kinds of fiber that absorb.
fn dyed() -> Cloth {
    Cloth { absorption: rgb([4.0, 2.0, 0.4]), more_kinds: vec![Kind::dyed(90.0)], ..Cloth::new(60.0, ISOTROPIC) }
}

/// Run an engine, each from random numbers of its own. Roulette ends walks at numbers of events, which trackings do
/// not share, so it stays off where bins are compared.
fn track(name: &str, engine: &dyn Engine, tables: &SamplingTables, goniometer: &Goniometer, plan: WalkPlan) -> Tally {
    let seed = plan.seed + if name == "cpu" { 10_000 } else { 0 };
    let plan = WalkPlan { seed, ..plan };
    let tally = engine.run(tables, goniometer, &plan, &mut |_| {}).unwrap_or_else(|error| panic!("{error}"));
    tally.check(plan.walks_per_incident).unwrap_or_else(|error| panic!("{error}"));
    assert_ran(&tally, name);
    assert!((0..tally.starts()).all(|start| tally.lost(start) == 0), "{name}: walks were lost");
    tally
}

fn plan(seed: u64, walks: u64) -> WalkPlan {
    WalkPlan { roulette: false, ..WalkPlan::new(seed, walks) }
}

/// Direct, reflected and transmitted walks of a start.
fn shares(tally: &Tally, start: usize) -> [f64; 3] {
    let sum = |cells: &[u64]| cells.iter().sum::<u64>();
    let counts = [tally.direct(start), sum(tally.reflection(start)), sum(tally.transmission(start))];
    counts.map(|count| count as f64 / tally.walks_per_incident() as f64)
}

/// The excess of |ΔP| over what the table's error explains, in standard errors; the largest of direct, R and T.
///
/// The table is off by at most `error` of the largest H, so an optical depth along the way is off by `error` times the
/// `depth` of the largest H, and a share that falls exponentially with it by no larger a part.
fn excess(a: &Tally, b: &Tally, error: f64, depth: f64) -> f64 {
    let mut most = f64::NEG_INFINITY;
    for start in 0..a.starts() {
        for (p, q) in shares(a, start).into_iter().zip(shares(b, start)) {
            let variance = |p: f64, tally: &Tally| p * (1.0 - p) / tally.walks_per_incident() as f64;
            let sigma = (variance(p, a) + variance(q, b)).sqrt().max(1e-12);
            most = most.max(((p - q).abs() - error * depth * q) / sigma);
        }
    }
    most
}

#[test]
fn both_trackings_give_the_same_light() {
    for (i, case) in (0..).zip(cases()) {
        let Case { name, tables, goniometer, walks, bend } = case;
        let exact = track("gpu", gpu(), &tables, &goniometer, plan(300 + i, walks));
        let tabulated = with_table(tables);
        let bent = SamplingTables { majorant: bend * tabulated.majorant, ..tabulated.clone() };
        let error = tabulated.visible.as_ref().map_or(0.0, |visible| visible.error);
        let depth = tabulated.depth();
        for (engine, run) in engines() {
            let tally = track(engine, run, &tabulated, &goniometer, plan(400 + i, walks));
            // The table's error is far below what the cells of exits can tell at so many walks: it gets no allowance there.
            let z = two_tally_z(&tally, &exact);
            let excess = excess(&tally, &exact, error, depth);
            let off = two_tally_z(&track(engine, run, &bent, &goniometer, plan(500 + i, walks)), &exact);
            println!(
                "{name}, {engine}: z = {z:.1}, R, T, direct {excess:.1}; density × {bend}: z = {off:.1}; H error {error:.4}, depth {depth:.1}"
            );
            assert!(z.abs() < GATE, "{name}, {engine}: z = {z:.1}");
            assert!(excess < GATE, "{name}, {engine}: R, T or direct is {excess:.1} σ off");
            assert!(off > GATE, "{name}, {engine}: z = {off:.1}");
        }
    }
}

#[test]
fn dyed_light_with_roulette_is_the_same() {
    let (tables, goniometer) = sheet(&dyed().lit_from("[[20, 30], [60, 200]]"));
    let exact = track("gpu", gpu(), &tables, &goniometer, WalkPlan::new(310, 400_000));
    let tabulated = with_table(tables);
    for (engine, run) in engines() {
        for (factor, seed) in [(1.0, 410), (1.068, 510)] {
            let mut tables = tabulated.clone();
            let dye = tables.kinds.iter_mut().flat_map(|kind| &mut kind.absorption);
            dye.for_each(|sigma| *sigma *= factor);
            let tally = track(engine, run, &tables, &goniometer, WalkPlan::new(seed, 400_000));
            let pairs = (0..2).flat_map(|start| mean_light(&tally, start).into_iter().zip(mean_light(&exact, start)));
            let z = pairs.map(|(a, b)| means_z(a, b).abs()).fold(0.0, f64::max);
            println!("{engine}: absorption × {factor}: z = {z:.1}");
            assert_eq!(z < GATE, factor == 1.0, "{engine}: absorption × {factor}: z = {z:.1}");
        }
    }
}

#[test]
fn rays_along_the_fibers_come_through() {
    // H of the whole sheet across the fibers is 6 / mm.
    let (radius, length) = (0.01, 300.0);
    for (tilt, incident) in
        [(0.0f64, "[[0, 0], [0.1, 40], [1, 40], [5, 40]]"), (30.0, "[[30, 0], [30.1, 0], [31, 0], [35, 0]]")]
    {
        let axis = [tilt.to_radians().sin(), 0.0, tilt.to_radians().cos()];
        let (tables, goniometer) = sheet(&Cloth::new(length, &aligned(axis)).lit_from(incident));
        for tables in [tables.clone(), with_table(tables)] {
            let error = tables.visible.as_ref().map_or(0.0, |visible| visible.error);
            for (engine, run) in engines() {
                let walks = 20_000;
                let tally = track(engine, run, &tables, &goniometer, plan(600, walks));
                for (start, off) in [0.0, 0.1, 1.0, 5.0f64].into_iter().enumerate() {
                    let depth = 2.0 * radius * length / (tilt + off).to_radians().cos();
                    let expected = (-depth * off.to_radians().sin()).exp();
                    let share = tally.direct(start) as f64 / walks as f64;
                    let sigma = (expected * (1.0 - expected) / walks as f64).sqrt();
                    println!("{engine}, error {error:.4}: {off}° off {tilt}°: {share:.4} for {expected:.4}");
                    // The table is off by its error times the depth across the fibers.
                    let bound = 4.0 * sigma + error * depth * expected.max(share) + 1e-6;
                    assert!((share - expected).abs() <= bound, "{engine}: {off}° off {tilt}°: {share} for {expected}");
                }
                let events = tally.counts.tentative_events as f64 / tally.counts.finished as f64;
                println!("{engine}, error {error:.4}: {events:.1} events a walk");
                // Along the fibers there are as many collisions as the table errs, each given up after 1024 refusals.
                let most = 10.0 + 1024.0 * error * 2.0 * radius * length / (tilt + 5.0).to_radians().cos();
                assert!(events < most, "{engine}: {events} events a walk, at most {most}");
            }
        }
    }
}

#[test]
fn equal_cells_are_one_cell() {
    let (sheet, walks) = (isotropic(), 40_000);
    let (tables, goniometer) = self::sheet(&sheet.clone().tabulated());
    let whole = track("gpu", gpu(), &tables, &goniometer, plan(700, walks));
    for (engine, run) in engines() {
        for (seed, counts, share) in [(701, [4, 3, 5], 1.0), (702, [1, 1, 17], 1.0), (703, [4, 3, 5], 1.048)] {
            let (tables, goniometer) =
                CellCloth::new(sheet.clone().tabulated(), counts, [0.7, 1.9], |_| share).prepare();
            let z = two_tally_z(&track(engine, run, &tables, &goniometer, plan(seed, walks)), &whole);
            println!("{engine}: {counts:?}, density × {share}: z = {z:.1}");
            // A density of 1.048 stands at 8 to 10 σ of this comparison.
            assert_eq!(z.abs() < GATE, share == 1.0, "{engine}: {counts:?}, density × {share}: z = {z:.1}");
        }
    }
}

#[test]
fn direct_light_has_its_closed_form() {
    let (tables, goniometer) = sheet(&Cloth::isotropic(1.0).tabulated().lit_from("[[0, 0], [60, 75]]"));
    let error = tables.visible.as_ref().map_or(0.0, |visible| visible.error);
    for (engine, run) in engines() {
        for (factor, seed) in [(1.0, 800), (1.0105, 801)] {
            let tables = SamplingTables { majorant: factor * tables.majorant, ..tables.clone() };
            let tally = track(engine, run, &tables, &goniometer, plan(seed, 1_000_000));
            let z = |(start, depth): (usize, f64)| binomial_z(tally.direct(start), 1_000_000, (-depth).exp()).abs();
            let z = [(0, 1.0), (1, 2.0)].map(z);
            println!("{engine}: density × {factor}: z = {z:.1?}, H error {error:.5}");
            assert_eq!(z[0] < GATE && z[1] < GATE, factor == 1.0, "{engine}: density × {factor}: z = {z:.1?}");
        }
    }
    assert!((tables.majorant * FRAC_PI_4 - 1.0).abs() < 1e-9);
}

#[test]
fn what_the_tables_are_not_made_for_is_refused() {
    let (tables, goniometer) = sheet(&Cloth::isotropic(1.0).tabulated());
    for (_, engine) in engines() {
        let plan = WalkPlan { jitter: false, ..WalkPlan::new(1, 10) };
        let error = engine.run(&tables, &goniometer, &plan, &mut |_| {}).expect_err("the table is jittered");
        assert!(matches!(error, Error::Input(_)), "{error}");
        assert!(error.to_string().contains("leave jitter on"), "{error}");
        let carried =
            SamplingTables { carry: Some(Carry { radius: 0.01, factors: false, memory: false }), ..tables.clone() };
        let error = engine.run(&carried, &goniometer, &WalkPlan::new(1, 10), &mut |_| {}).expect_err("it is carried");
        assert!(error.to_string().contains("place flights at hits"), "{error}");
    }
    let base = Cloth { directions: 16, ..Cloth::isotropic(1.0) };
    let mut cells = CellCloth::new(base.tabulated(), [100, 100, 4], [1.0, 1.0], |_| 1.0);
    cells.lists = vec![cells.lists[0][..1].to_vec(); 40_000];
    let error =
        SamplingTables::new(&cells.base.scene(), &cells.specific_length()).expect_err("there are too many lists");
    assert!(error.to_string().starts_with("tables of H(m) for 40000 lists"), "{error}");
}
