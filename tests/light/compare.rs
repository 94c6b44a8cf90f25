//! Comparing results: equal runs are called different as often as stated, different ones are.

use crate::common::stats::{GATE, binomial_z, chi2_z};
use crate::common::{Cloth, gpu, rgb, run};
use fiberwalk::bsdf::{Comparison, Component, LEVEL, Outgoing, compare, noise, reciprocity};
use fiberwalk::goniometer::{Goniometer, Tally};
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::reference::Reference;
use fiberwalk::scene::Side;
use fiberwalk::walk::{Engine, WalkPlan};
use rayon::prelude::*;

const PAIRS: u64 = 200;

fn lossless() -> Cloth {
    Cloth { exit: 4, ..Cloth::isotropic(0.5) }.lit_from("[[20, 30], [60, -45]]")
}

/// One channel is clear, one grey, one dark.
fn dyed() -> Cloth {
    Cloth { absorption: rgb([0.0, 20.0, 120.0]), exit: 2, ..lossless() }
}

fn prepared(cloth: &Cloth) -> Prepared {
    prepare(&cloth.scene()).expect("the cloth is fine")
}

fn tally(engine: &dyn Engine, Prepared { tables, goniometer, .. }: &Prepared, seed: u64, walks: u64) -> Tally {
    let tally = engine.run(tables, goniometer, &WalkPlan::new(seed, walks), &mut |_| {}).expect("it runs");
    tally.check(walks).expect("its account closes");
    tally
}

/// Pairs of runs of `walks[0]` and `walks[1]` walks; B is of another cloth if one is given.
fn pairs(engine: &(dyn Engine + Sync), cloth: &Cloth, other: &Cloth, walks: [u64; 2], count: u64) -> Vec<Comparison> {
    let [cloth, other] = [cloth, other].map(prepared);
    let pair = |i| {
        let [a, b] = [(&cloth, 20_000, walks[0]), (&other, 30_000, walks[1])]
            .map(|(of, seed, walks)| tally(engine, of, seed + i, walks));
        compare(&a, &b, &cloth.goniometer, [None; 2])
    };
    (0..count).into_par_iter().map(pair).collect()
}

/// Share of pairs whose probability is below a level: of the farthest pool, and of all together.
fn shares(comparisons: &[Comparison], level: f64) -> [f64; 2] {
    let share = |of: fn(&Comparison) -> f64| {
        comparisons.iter().filter(|comparison| of(comparison) < level).count() as f64 / comparisons.len() as f64
    };
    [share(|c| c.farthest.map_or(1.0, |pool| pool.probability)), share(|c| c.sum.map_or(1.0, |sum| sum.probability))]
}

#[test]
fn equal_runs_are_called_different_as_often_as_stated() {
    let engines: [&(dyn Engine + Sync); 2] = [&Reference, gpu()];
    for (engine, (cloth, channels, least)) in engines.into_iter().zip([(lossless(), 1, 25), (dyed(), 3, 15)]) {
        // Equal runs, and a short against a long one.
        for walks in [[6000, 6000], [4000, 32_000]] {
            let all = pairs(engine, &cloth, &cloth, walks, PAIRS);
            let called = all.iter().filter(|comparison| comparison.differ()).count();
            let tested = all.iter().map(|c| c.each.cells.tested).min().unwrap_or_default();
            println!("{channels} channels, {walks:?}: {called} of {PAIRS} called different, {tested} cells or more");
            assert!(tested > least, "only {tested} cells were tested");
            // Two tests at 10⁻³ each: 0.4 expected, and more than 4 in 6 of 10⁵ such trials.
            assert!(called <= 4, "{called} of {PAIRS} at {LEVEL}");
            for level in [0.5, 0.2, 0.05] {
                let [cell, pooled] = shares(&all, level);
                let z = |share: f64| binomial_z((share * PAIRS as f64) as u64, PAIRS, level);
                println!("  below {level}: cells {cell:.3}, together {pooled:.3}");
                // An exact test of counts and channels that go together are both on the safe side.
                assert!(z(cell) < GATE && z(pooled) < GATE, "below {level}: {cell} and {pooled}");
                if channels == 1 {
                    assert!(z(pooled) > -GATE, "below {level}: {pooled}");
                }
            }
        }
    }
}

#[test]
fn other_fibers_are_called_different() {
    for cloth in [lossless(), dyed()] {
        let bent = Cloth { ior: 1.04 * cloth.ior, ..cloth.clone() };
        let called = |walks| pairs(gpu(), &cloth, &bent, walks, 20).iter().filter(|c| c.differ()).count();
        let called = [called([26_000, 26_000]), called([13_000, 130_000])];
        println!("{called:?} of 20");
        assert!(called.iter().all(|called| *called > 15), "{called:?} of 20");
    }
}

#[test]
fn the_error_is_the_difference_without_its_noise() {
    // Equal cloths: E² scatters around 0 by its resolution; of another index, E does not depend on the walks.
    let all = pairs(gpu(), &lossless(), &lossless(), [4000, 4000], PAIRS);
    let above = all.iter().filter(|c| c.error > c.resolution).count() as u64;
    println!("E above its resolution in {above} of {PAIRS}");
    // One in 6.3 of normal deviates lies above one standard deviation.
    assert!(binomial_z(above, PAIRS, 0.1587).abs() < GATE, "{above}");
    let bent = Cloth { ior: 1.1 * lossless().ior, ..lossless() };
    let mean = |walks| {
        let all = pairs(gpu(), &lossless(), &bent, [walks, walks], PAIRS);
        let sum = |power: i32| all.iter().map(|c| c.error.powi(2 * power)).sum::<f64>() / PAIRS as f64;
        (sum(1), ((sum(2) - sum(1).powi(2)) / (PAIRS - 1) as f64).sqrt())
    };
    let (few, many) = (mean(1000), mean(8000));
    let z = (few.0 - many.0) / few.1.hypot(many.1);
    println!("E² {few:?} and {many:?}: z = {z:.1}");
    assert!(z.abs() < GATE && many.0 > 10.0 * many.1, "{few:?}, {many:?}");
    // Without the noise taken out it would.
    let raw =
        |(square, _): (f64, f64), walks| square + 2.0 * noise(&tally(gpu(), &prepared(&lossless()), 5, walks)).powi(2);
    assert!((raw(few, 1000) - raw(many, 8000)).abs() > GATE * few.1.hypot(many.1));
}

#[test]
fn direct_light_takes_part() {
    let thin = |length| Cloth { exit: 2, ..Cloth::new(length, crate::common::ISOTROPIC) }.lit_from("[[0, 0]]");
    let [a, b] = [(1.0, 1), (1.2, 2)].map(|(length, seed)| tally(gpu(), &prepared(&thin(length)), seed, 400_000));
    let goniometer = Goniometer::new(&thin(1.0).scene().measure);
    let comparison = compare(&a, &b, &goniometer, [None; 2]);
    let share = |tally: &Tally| tally.direct(0) as f64 / 400_000.0;
    assert_eq!(comparison.direct, (share(&a) - share(&b), 0));
    let farthest = comparison.farthest.expect("it was tested");
    assert!(farthest.pool.outgoing == Outgoing::Direct && comparison.differ(), "{comparison:?}");
}

/// Reciprocity as results report it: of reflection and transmission of both sides, in a dyed channel.
fn residuals(tally: &Tally, goniometer: &Goniometer) -> Vec<[f64; 2]> {
    let sides = [Side::Front, Side::Back];
    let each = sides.into_iter().flat_map(|side| [Component::Reflection, Component::Transmission].map(|c| (side, c)));
    let residual = |(side, component)| reciprocity(tally, goniometer, component, side, 1).expect("there is one");
    each.map(residual).map(|r| [chi2_z(r.chi_square, r.pairs as f64), r.pairs as f64]).collect()
}

#[test]
fn results_report_how_reciprocal_the_light_is() {
    let part = |axis| crate::common::aligned(axis) + "\nspread_deg = 15";
    let both = "[\"front\", \"back\"]";
    // Exit cells are pooled four to one.
    let cloth = Cloth {
        absorption: rgb([0.0, 20.0, 2.0]),
        sides: both.into(),
        exit: 16,
        ..Cloth::new(40.0, &part([1.0, 0.2, 0.8]))
    };
    let tally = run("gpu", gpu(), &cloth, &WalkPlan::new(31, 40_000));
    let goniometer = Goniometer::new(&cloth.scene().measure);
    let fine = residuals(&tally, &goniometer);
    println!("z and pairs: {fine:.1?}");
    assert!(fine.iter().all(|[z, pairs]| z.abs() < GATE && *pairs > 300.0), "{fine:.1?}");
    // Light of the back counted as that of the front, and the other way round, breaks transmission only.
    let mut swapped = tally.clone();
    let half = swapped.bins.len() / 2;
    swapped.bins.rotate_left(half);
    let moments = &mut swapped.weights.as_mut().expect("it has weights").moments;
    let half = moments.len() / 2;
    moments.rotate_left(half);
    // Turn every incident cell by half a turn.
    let stride = moments.len() / 128;
    let turned: Vec<_> =
        moments.chunks(64 * stride).flat_map(|side| side.chunks(stride).rev().flatten()).copied().collect();
    *moments = turned;
    let broken = residuals(&swapped, &goniometer);
    println!("turned: {broken:.1?}");
    assert!(broken.iter().all(|[z, _]| *z > GATE), "{broken:.1?}");
    // A list of directions, or an exit grid that does not hold the incident one, has no answer.
    let odd = Goniometer::new(&Cloth { exit: 12, ..cloth.clone() }.scene().measure);
    assert!(reciprocity(&tally, &odd, Component::Reflection, Side::Front, 0).is_none());
    let list = Goniometer::new(&cloth.lit_from("[[20, 30]]").scene().measure);
    assert!(reciprocity(&tally, &list, Component::Reflection, Side::Front, 0).is_none());
}
