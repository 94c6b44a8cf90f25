//! The engines against each other, and the error bars against themselves.

use crate::common::stats::{GATE, two_tally_z};
use crate::common::{Cloth, ISOTROPIC, PLANAR, aligned, assert_ran, gpu};
use fiberwalk::bsdf::{Component, Estimate, values};
use fiberwalk::goniometer::Tally;
use fiberwalk::measure::{EngineChoice, Prepared, Stop, choose, prepare, run};
use fiberwalk::reference::Reference;
use fiberwalk::walk::WalkPlan;
use std::sync::OnceLock;
use std::time::Instant;

fn mixed() -> Cloth {
    let fibers = vec![(40.0, ISOTROPIC.to_owned()), (40.0, PLANAR.to_owned()), (40.0, aligned([0.48, -0.6, 0.64]))];
    Cloth { fibers, ..Cloth::isotropic(1.0) }
}

/// Cloths that both engines measure, lit from all over the disc, and walks of each start.
fn stated() -> [(Cloth, u64); 3] {
    [(Cloth::isotropic(0.5), 120_000), (Cloth::isotropic(4.0), 60_000), (mixed(), 95_000)]
        .map(|(cloth, walks)| (cloth.lit_from("4"), walks))
}

/// z of the whole exit table of a stated cloth, different seeds; the gpu engine measures it with another index.
fn engines_z(case: usize, factor: f64) -> f64 {
    let (cloth, walks) = stated()[case].clone();
    static ON_CPU: [OnceLock<Tally>; 3] = [const { OnceLock::new() }; 3];
    let on_cpu = ON_CPU[case].get_or_init(|| cloth.run(&Reference, &WalkPlan::new(22, walks)));
    let on_gpu = Cloth { ior: cloth.ior * factor, ..cloth }.run(gpu(), &WalkPlan::new(21, walks));
    assert_ran(&on_gpu, "gpu");
    assert_ran(on_cpu, "cpu");
    two_tally_z(&on_gpu, on_cpu)
}

#[test]
fn both_engines_measure_the_same_bsdf() {
    for case in 0..3 {
        let z = engines_z(case, 1.0);
        println!("case {case}: z = {z:.1}");
        assert!(z.abs() < GATE, "case {case}: z = {z:.1}");
    }
}

#[test]
fn a_bent_index_is_a_different_bsdf() {
    // Factors of the index that stand at 8 to 10 σ of this comparison.
    for (case, factor) in [1.0225, 1.03, 1.0235].into_iter().enumerate() {
        let z = engines_z(case, factor);
        println!("case {case}, index × {factor}: z = {z:.1}");
        assert!(z > GATE, "z = {z:.1}");
    }
}

/// Walks of each sample.
const CALIBRATED: u64 = 100_000;

/// Sample variance over 100 seeds over the mean variance that runs of `reported` walks report;
/// averaged over cells with 25 counts or more, with its standard error.
fn calibration(reported: u64) -> (f64, f64) {
    const SEEDS: u64 = 100;
    let cloth = Cloth::isotropic(2.0).lit_from("[[35, 20]]");
    let Prepared { goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
    let table = |seed, walks| -> Vec<Estimate> {
        let tally = cloth.run(gpu(), &WalkPlan::new(seed, walks));
        assert_ran(&tally, "gpu");
        let of = |component| values(&tally, &goniometer, component, 0, 0);
        [of(Component::Reflection), of(Component::Transmission)].concat()
    };
    static SAMPLES: OnceLock<Vec<Vec<Estimate>>> = OnceLock::new();
    let samples = SAMPLES.get_or_init(|| (0..SEEDS).map(|seed| table(1000 + seed, CALIBRATED)).collect());
    let fewer: Vec<Vec<Estimate>>;
    let reports = if reported == CALIBRATED {
        samples
    } else {
        fewer = (0..SEEDS).map(|seed| table(3000 + seed, reported)).collect();
        &fewer
    };
    let n = SEEDS as f64;
    let one_walk = 1.0 / (CALIBRATED as f64 * goniometer.exit.projected_solid_angle(0));
    let ratios: Vec<f64> = (0..samples[0].len())
        .filter_map(|cell| {
            let mean = samples.iter().map(|sample| sample[cell].value).sum::<f64>() / n;
            let variance = samples.iter().map(|sample| (sample[cell].value - mean).powi(2)).sum::<f64>() / (n - 1.0);
            let report = reports.iter().map(|report| report[cell].stderr.powi(2)).sum::<f64>() / n;
            (mean >= 25.0 * one_walk).then_some(variance / report)
        })
        .collect();
    let count = ratios.len() as f64;
    assert!(count > 300.0, "only {count} cells have enough counts");
    (ratios.iter().sum::<f64>() / count, (2.0 / (n - 1.0) / count).sqrt())
}

#[test]
fn error_bars_are_as_wide_as_the_scatter_of_repeated_runs() {
    let (ratio, error) = calibration(CALIBRATED);
    assert!((ratio - 1.0).abs() < GATE * error, "variance over reported variance: {ratio:.4} ± {error:.4}");
}

#[test]
fn error_bars_of_six_percent_fewer_walks_are_too_wide() {
    let (ratio, error) = calibration(94_000);
    println!("{ratio:.4} ± {error:.4}");
    assert!((ratio - 1.0).abs() > GATE * error, "variance over reported variance: {ratio:.4} ± {error:.4}");
}

/// Root mean square over 50 seeds of the true relative error of runs of `cloth` to a noise of 3 %, against a long run of the
/// stated cloth; only scattered light.
fn true_error(cloth: &Cloth) -> f64 {
    let stated = Cloth { exit: 8, ..Cloth::isotropic(1.0) }.lit_from("[[35, 20]]");
    static LONG: OnceLock<Tally> = OnceLock::new();
    let long = LONG.get_or_init(|| stated.run(gpu(), &WalkPlan::new(5000, 20_000_000)));
    let share = |tally: &Tally| -> Vec<f64> {
        let walks = tally.walks_per_incident() as f64;
        tally.reflection(0).iter().chain(tally.transmission(0)).map(|count| *count as f64 / walks).collect()
    };
    let truth = share(long);
    let power: f64 = truth.iter().map(|p| p * p).sum();
    let prepared = prepare(&cloth.scene()).expect("the cloth is fine");
    let engine = choose(EngineChoice::Gpu, None).expect("these tests need an adapter");
    let square = (0..50).map(|seed| {
        let run = run(
            &prepared.with(&engine),
            &prepared.goniometer,
            5001 + seed,
            Stop::Tolerance(0.03),
            Instant::now(),
            None,
        );
        let tally = run.expect("the run ends").tally;
        assert_ran(&tally, "gpu");
        share(&tally).iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / power
    });
    (square.sum::<f64>() / 50.0).sqrt()
}

#[test]
fn a_run_to_a_tolerance_has_the_error_that_it_promised() {
    // Decisions are up to a factor of 1.5 in walks apart, so noise stops between 3 % and 3 %/√1.5 = 2.45 %. Of the mean
    // square of 50 runs of some 50 effective cells the standard deviation is √(2/2500) = 3 %.
    let cloth = Cloth { exit: 8, ..Cloth::isotropic(1.0) }.lit_from("[[35, 20]]");
    let error = true_error(&cloth);
    println!("true error {error:.4}");
    assert!(error > 0.0245 * 0.94 && error < 0.03 * 1.06, "{error:.4}");
}

#[test]
fn a_run_of_another_cloth_misses_the_tolerance() {
    let bent = Cloth { exit: 8, ior: 1.52, ..Cloth::isotropic(1.0) }.lit_from("[[35, 20]]");
    let error = true_error(&bent);
    println!("error of a bent index {error:.4}");
    assert!(error > 0.03 * 1.06, "{error:.4}");
}
