//! The same walks in both engines, one by one: same seed, same draw contract, f32 and complex products against f64 and
//! angles. Walks that differ must have come near a decision.

use crate::common::cells::{CellCloth, random_cells};
use crate::common::{Cloth, ISOTROPIC, PLANAR, SplitMix, aligned, assert_ran, gpu};
use fiberwalk::goniometer::Goniometer;
use fiberwalk::gpu::Settings;
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::reference::{Replay, replay};
use fiberwalk::tables::{Cut, SamplingTables};
use fiberwalk::walk::{WalkPlan, WalkRecord, Walked};

/// Rounding errors of a walk stay below this share of a decision's scale: a few ulps of f32, 1.2e-7 each, for each of
/// some ten events, and curved fibers multiply them from hit to hit.
const NEAR: f64 = 1e-5;

struct Comparison {
    walks: usize,
    /// Walks that ended in another bin or after another number of events, with their nearest decision.
    differing: Vec<f64>,
    /// Nearest decisions of a sample of walks that agree.
    agreeing: Vec<f64>,
}

type Setup = (SamplingTables, Goniometer);

fn setup(cloth: &Cloth) -> Setup {
    let Prepared { tables, goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
    (tables, goniometer)
}

/// Make walks on the device with one setup, and once more in f64 with another.
fn compare((tables, goniometer): Setup, other: Setup, walks_per_cell: u64) -> Comparison {
    let plan = WalkPlan::new(11, walks_per_cell);
    let settings = Settings { walks_per_segment: Some(walks_per_cell / 2), ..Settings::default() };
    let (tally, records) = gpu().trace(settings, &tables, &goniometer, &plan).expect("the device works");
    assert_ran(&tally, "gpu");
    let (tables, goniometer) = other;
    let cells = goniometer.starts();
    let mut result = Comparison { walks: records.len(), differing: Vec::new(), agreeing: Vec::new() };
    let mut bins = vec![0; tally.bins.len()];
    for (slot, record) in records.iter().enumerate() {
        let (i, cell) = (slot / cells, slot % cells);
        let Replay { walked: Walked { record: expected, .. }, nearest_tie } =
            replay(&tables, &goniometer, &plan, cell, i as u64);
        let same = |a: &WalkRecord, b: &WalkRecord| a.bin == b.bin && a.events == b.events && a.hits == b.hits;
        if !same(record, &expected) {
            result.differing.push(nearest_tie);
        } else if slot % 64 == 0 {
            result.agreeing.push(nearest_tie);
        }
        bins[cell * tally.layout.stride() + record.bin as usize] += 1u64;
    }
    assert_eq!(bins, tally.bins, "the records are the walks that were counted");
    let sum = |of: fn(&WalkRecord) -> u32| records.iter().map(|record| u64::from(of(record))).sum::<u64>();
    assert_eq!(tally.counts.tentative_events, sum(|record| record.events));
    assert_eq!(tally.counts.collisions, sum(|record| record.hits));
    result
}

fn check(cloth: &Cloth, walks_per_cell: u64, most: f64) {
    check_setup(setup(cloth), walks_per_cell, most);
}

fn check_setup(setup: Setup, walks_per_cell: u64, most: f64) {
    check_near(setup, walks_per_cell, most, 0.05);
}

/// At most so many walks differ, and so many come near a decision.
fn check_near(setup: Setup, walks_per_cell: u64, most: f64, most_near: f64) {
    let Comparison { walks, differing, agreeing } = compare(setup.clone(), setup, walks_per_cell);
    let share = differing.len() as f64 / walks as f64;
    assert!(share < most, "{share:.1e} of {walks} walks differ");
    let far: Vec<&f64> = differing.iter().filter(|tie| **tie > NEAR).collect();
    assert!(far.is_empty(), "{} of {} differing walks were near no decision: {far:?}", far.len(), differing.len());
    // The bound means something: few walks ever come so near a decision.
    let near = agreeing.iter().filter(|tie| **tie < NEAR).count() as f64 / agreeing.len() as f64;
    println!("{share:.1e} of {walks} walks differ; {near:.3} of all walks come near a decision");
    assert!(near < most_near, "{near} of all walks come near a decision");
}

#[test]
fn thin_sheets_differ_in_few_walks_of_a_hundred_thousand() {
    check(&Cloth::isotropic(0.5), 4096, 5e-5);
}

#[test]
fn sheets_of_depth_four_differ_in_fewer_walks_than_two_of_ten_thousand() {
    check(&Cloth::isotropic(4.0), 2048, 2e-4);
}

#[test]
fn mixed_sheets_lit_from_listed_directions_agree_too() {
    let fibers = vec![(60.0, ISOTROPIC.to_owned()), (60.0, PLANAR.to_owned()), (60.0, aligned([0.48, -0.6, 0.64]))];
    let cloth = Cloth { fibers, ..Cloth::isotropic(1.0) }.lit_from("[[12, 10], [47, 100], [71, -130]]");
    check(&cloth, 40_000, 2e-4);
}

#[test]
fn light_from_rings_and_into_rings_agrees_too() {
    let cloth = Cloth { sides: "[\"front\", \"back\"]".into(), ..Cloth::isotropic(1.0) };
    check(&cloth.clone().lit_from("\"klems\"").counted_in("klems"), 512, 1e-4);
    check(&cloth.lit_from("\"polar:3x7\"").counted_in("polar:18x36"), 2048, 2e-4);
}

#[test]
fn a_bent_index_differs_in_one_walk_of_ten() {
    let cloth = Cloth::isotropic(4.0);
    let bent = Cloth { ior: 1.505, ..cloth.clone() };
    let Comparison { walks, differing, .. } = compare(setup(&cloth), setup(&bent), 64);
    assert!(differing.len() as f64 > 0.1 * walks as f64, "only {} of {walks} differ", differing.len());
    assert!(differing.iter().filter(|tie| **tie > NEAR).count() > 100, "all of them were near a decision");
}

#[test]
fn walks_through_cells_agree() {
    for seed in [1, 2] {
        let cells = random_cells(seed);
        let empty = cells.cells.iter().filter(|cell| cell.0 == 0.0).count() as f64 / cells.cells.len() as f64;
        assert!(empty > 0.5 && empty < 0.9, "{empty} of the cells are empty");
        check_setup(cells.prepare(), 20_000, 1e-4);
    }
}

#[test]
fn walks_through_empty_layers_agree() {
    let base = Cloth::isotropic(1.0).lit_from("[[20, 40], [60, 15], [75, -70]]");
    let layers = CellCloth::new(base, [3, 2, 6], [0.8, 0.3], |[x, _, z]| {
        [0.0, 3.0, 0.0, 0.0, 1.0, 0.0][z as usize] * (1.0 + f64::from(x))
    });
    check_setup(layers.prepare(), 40_000, 2e-4);
}

#[test]
fn a_cell_that_is_one_percent_denser_is_noticed() {
    let cells = random_cells(1);
    let mut bent = cells.clone();
    bent.cells.iter_mut().filter(|cell| cell.0 > 0.0).step_by(10).for_each(|cell| cell.0 *= 1.01);
    assert_noticed(cells.prepare(), bent.prepare(), 1e-3);
}

/// More than this share of the walks differs far from a decision.
fn assert_noticed(cells: Setup, bent: Setup, share: f64) {
    let Comparison { walks, differing, .. } = compare(cells, bent, 20_000);
    let far = differing.iter().filter(|tie| **tie > NEAR).count();
    println!("{far} of {walks} walks differ far from a decision");
    assert!(far as f64 > share * walks as f64, "only {far} of {walks} differ");
}

/// Cells at random with one placement, and factors between 1 and 2 at random.
fn placed(seed: u64, placement: &'static str) -> CellCloth {
    let cells = random_cells(seed);
    let mut random = SplitMix(seed ^ 0x9e37);
    let factors = cells.cells.iter().map(|_| 1.0 + random.uniform()).collect();
    CellCloth { base: cells.base.placed(placement), factors, cut: true, ..cells }
}

#[test]
fn walks_carried_through_fibers_agree_in_sheets() {
    check(&Cloth::isotropic(0.5).placed("carried"), 4096, 1e-4);
    check(&Cloth::isotropic(4.0).placed("carried"), 2048, 2e-4);
    let fibers = vec![(60.0, ISOTROPIC.to_owned()), (60.0, PLANAR.to_owned()), (60.0, aligned([0.48, -0.6, 0.64]))];
    let cloth = Cloth { fibers, length_over_radius: 9.0, ..Cloth::isotropic(1.0) }
        .lit_from("[[12, 10], [47, 100], [71, -130]]");
    check(&cloth.placed("carried-dense"), 40_000, 2e-4);
}

#[test]
fn walks_carried_through_fibers_agree_in_cells() {
    for (seed, placement) in [(1, "carried"), (2, "carried-dense"), (3, "carried-void")] {
        // Hit, axis and list have a cell each.
        check_near(placed(seed, placement).prepare(), 20_000, 1e-4, 0.1);
    }
    // Cells from half a radius to a hundred radii; among thin ones a face is never far.
    for (counts, placement) in [([5, 4, 200], "carried"), ([2, 180, 3], "carried-void"), ([1, 2, 2], "carried-void")] {
        let base = Cloth::isotropic(1.0).lit_from("[[20, 40], [60, 15], [75, -70]]").placed(placement);
        let some = |[x, y, z]: [u32; 3]| f64::from(u8::from((x + y / 40 + z / 40) % 2 == 0));
        check_near(CellCloth::new(base, counts, [1.1, 0.9], some).prepare(), 20_000, 2e-4, 0.1);
    }
}

/// The same cells, whose walks remember their last flight.
fn remembering(cells: CellCloth) -> CellCloth {
    CellCloth { base: cells.base.remembering(), ..cells }
}

#[test]
fn walks_that_remember_agree() {
    check(&Cloth::isotropic(4.0).placed("carried").remembering(), 2048, 2e-4);
    // Nearly parallel fibers, with ends and without: known fibers and corridors matter most.
    let fibers = vec![(120.0, aligned([1.0, 0.0, 0.02])), (80.0, aligned([0.99, 0.1, 0.0]))];
    let dense = Cloth { fibers, ..Cloth::isotropic(1.0) }.lit_from("[[12, 10], [47, 100], [71, -130]]");
    check(&dense.clone().placed("carried").remembering(), 40_000, 2e-4);
    check(&Cloth { length_over_radius: 9.0, ..dense }.placed("carried-dense").remembering(), 40_000, 2e-4);
    for (seed, placement) in [(1, "carried"), (3, "carried-void")] {
        check_near(remembering(placed(seed, placement)).prepare(), 20_000, 2e-4, 0.1);
    }
}

#[test]
fn a_walk_that_forgets_is_noticed() {
    let cells = remembering(placed(1, "carried")).prepare();
    let mut bent = cells.clone();
    bent.0.carry.as_mut().expect("it is carried").memory = false;
    assert_noticed(cells, bent, 1e-2);
}

#[test]
fn a_cut_that_is_moved_by_a_sixteenth_of_a_cell_is_noticed() {
    let cells = placed(1, "carried").prepare();
    let mut bent = cells.clone();
    let entries = &mut bent.0.cells.as_mut().expect("it has cells").entries;
    // The largest component of a normal is 31, an offset comes in 64ths.
    entries.iter_mut().filter(|cell| cell.cut != Cut::NONE).for_each(|cell| cell.cut.offset += 31 * 64 / 16);
    assert_noticed(cells, bent, 1e-3);
}

#[test]
fn a_fiber_that_is_one_percent_thicker_is_noticed() {
    let cells = placed(1, "carried").prepare();
    let mut bent = cells.clone();
    bent.0.kinds[0].radius *= 1.01;
    assert_noticed(cells, bent, 1e-3);
}

/// The same cells, tracked by tables.
fn tabulated(cells: CellCloth) -> CellCloth {
    CellCloth { base: cells.base.tabulated(), ..cells }
}

#[test]
fn walks_by_tables_agree_in_sheets() {
    check(&Cloth::isotropic(0.5).tabulated(), 4096, 1e-4);
    check(&Cloth::isotropic(4.0).tabulated(), 2048, 2e-4);
    let fibers = vec![(60.0, ISOTROPIC.to_owned()), (60.0, PLANAR.to_owned()), (60.0, aligned([0.48, -0.6, 0.64]))];
    let cloth = Cloth { fibers, ..Cloth::isotropic(1.0) }.lit_from("[[12, 10], [47, 100], [71, -130]]");
    check(&cloth.tabulated(), 40_000, 2e-4);
}

#[test]
fn walks_by_tables_agree_in_cells() {
    for seed in [1, 2] {
        check_setup(tabulated(random_cells(seed)).prepare(), 20_000, 3e-4);
    }
    let base = Cloth::isotropic(1.0).lit_from("[[20, 40], [60, 15], [75, -70]]");
    let layers = CellCloth::new(base, [3, 2, 6], [0.8, 0.3], |[x, _, z]| {
        [0.0, 3.0, 0.0, 0.0, 1.0, 0.0][z as usize] * (1.0 + f64::from(x))
    });
    check_setup(tabulated(layers).prepare(), 40_000, 3e-4);
}

#[test]
fn a_table_that_is_one_thousandth_too_high_is_noticed() {
    let cells = tabulated(random_cells(1)).prepare();
    let mut bent = cells.clone();
    let visible = bent.0.visible.as_mut().expect("the cells are tracked by tables");
    visible.nodes.iter_mut().for_each(|node| *node *= 1.001);
    assert_noticed(cells, bent, 1e-3);
}
