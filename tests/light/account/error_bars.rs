//! Error bars of dark channels are as wide as the scatter of repeated runs.

use crate::common::stats::{GATE, mean_error};
use crate::common::{Cloth, gpu, rgb, run};
use fiberwalk::bsdf::{Estimate, mean_weight, totals};
use fiberwalk::goniometer::Tally;
use fiberwalk::walk::WalkPlan;
use std::sync::OnceLock;

/// Repeated runs that scatter, and runs of fewer walks, whose error bars differ less.
const SEEDS: u64 = 100;
const REPORTS: u64 = 50;

/// Sample variance of the light over 100 seeds over the mean variance that runs of `reported` walks report, averaged over
/// 12 directions, with its standard error, behind the mean light: reflected in the clear channel, transmitted in all three.
fn calibration(reported: u64) -> Vec<(f64, f64, f64)> {
    let list: Vec<[f64; 2]> = (0..12).map(|i| [f64::from(i % 3), 90.0 * f64::from(i / 3)]).collect();
    let cloth = Cloth { ior: 1.02, absorption: rgb(DARK), thickness_um: 1e5, exit: 4, ..Cloth::isotropic(0.4) };
    let cloth = cloth.lit_from(&format!("{list:?}"));
    let measure = |seed, walks| -> Vec<Estimate> {
        let tally = run("gpu", gpu(), &cloth, &WalkPlan::new(seed, walks));
        let each = (0..12).flat_map(|start| (0..3).map(move |channel| (start, channel)));
        let each = each.map(|(start, channel)| totals(&tally, start, channel));
        each.flat_map(|totals| [totals.reflectance, totals.transmittance]).collect()
    };
    static SAMPLES: OnceLock<Vec<Vec<Estimate>>> = OnceLock::new();
    let samples = SAMPLES.get_or_init(|| (0..SEEDS).map(|seed| measure(2000 + seed, CALIBRATED)).collect());
    let fewer: Vec<Vec<Estimate>>;
    let reports = if reported == CALIBRATED {
        samples
    } else {
        fewer = (0..REPORTS).map(|seed| measure(4000 + seed, reported)).collect();
        &fewer
    };
    let n = SEEDS as f64;
    let of = |place: usize| {
        let mean = samples.iter().map(|sample| sample[place].value).sum::<f64>() / n;
        let variance = samples.iter().map(|sample| (sample[place].value - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let reported = reports.iter().map(|report| report[place].stderr.powi(2)).sum::<f64>() / reports.len() as f64;
        (mean, variance / reported)
    };
    let quantity = |i: usize| {
        let each: Vec<(f64, f64)> = (0..12).map(|start| of(6 * start + i)).collect();
        let sum = |f: &dyn Fn(&(f64, f64)) -> f64| each.iter().map(f).sum::<f64>();
        let (ratio, error) = mean_error(sum(&|pair| pair.1), sum(&|pair| pair.1 * pair.1), 12.0);
        // 12 ratios say little of their own spread: it is at least that of normal samples.
        (sum(&|pair| pair.0) / 12.0, ratio, error.max((2.0 / (n - 1.0) / 12.0).sqrt()))
    };
    // Reflected light of dark channels is a few walks of full weight: none of a run's may be seen.
    [0, 1, 3, 5].map(quantity).to_vec()
}

/// Walks of each sample.
const CALIBRATED: u64 = 3000;
const DARK: [f64; 3] = [0.01, 9.5, 21.0];

#[test]
fn error_bars_of_dark_channels_are_as_wide_as_the_scatter_of_repeated_runs() {
    let all = calibration(CALIBRATED);
    println!("{all:?}");
    for (mean, ratio, error) in &all {
        assert!((ratio - 1.0).abs() < GATE * error, "mean {mean:.1e}: {ratio:.3} ± {error:.3}");
    }
    assert!(all[2].0 < 2e-3 && all[3].0 < 2e-6, "the channels are dark: {all:?}");
}

#[test]
fn error_bars_of_fewer_walks_are_too_wide() {
    for (mean, ratio, error) in calibration(2000) {
        println!("mean {mean:.1e}: {ratio:.3} ± {error:.3}");
        assert!((ratio - 1.0).abs() > GATE * error, "mean {mean:.1e}: {ratio:.3} ± {error:.3}");
    }
}

/// As [`calibration`], of single cells of transmitted light that hold 50 walks and, in the darkest channel, 25 units of light or more on
/// average: the mean light of a cell and the ratio of variances in the clear and in the two dark channels.
fn cell_calibration(reported: u64) -> Vec<(f64, f64, f64)> {
    let cloth = Cloth { ior: 1.02, absorption: rgb(DARK), thickness_um: 1e5, exit: 2, ..Cloth::isotropic(0.4) };
    let cloth = cloth.lit_from("[[5, 20], [8, 100], [12, -70]]");
    let sample = |seed, walks| run("gpu", gpu(), &cloth, &WalkPlan::new(seed, walks));
    static SAMPLES: OnceLock<Vec<Tally>> = OnceLock::new();
    let samples = SAMPLES.get_or_init(|| (0..SEEDS).map(|seed| sample(6000 + seed, CELLS_CALIBRATED)).collect());
    let fewer: Vec<Tally>;
    let reports = if reported == CELLS_CALIBRATED {
        samples
    } else {
        fewer = (0..REPORTS).map(|seed| sample(7000 + seed, reported)).collect();
        &fewer
    };
    let enough = |&(start, bin): &(usize, usize)| {
        let sum = |of: &dyn Fn(&Tally) -> u64| samples.iter().map(of).sum::<u64>();
        sum(&|t| t.of_start(start)[bin]) >= 50 * SEEDS && sum(&|t| t.light(start, bin, 2).sum) >= 25 * SEEDS
    };
    let bins: Vec<_> = (0..3).flat_map(|start| (4..8).map(move |bin| (start, bin))).filter(enough).collect();
    assert!(bins.len() > 6, "only {} cells hold light enough", bins.len());
    let n = SEEDS as f64;
    let ratio = |&(start, bin): &(usize, usize), channel: usize| {
        let estimate =
            |tally: &Tally| mean_weight(tally.light(start, bin, channel), tally.walks_per_incident(), tally.unit());
        let values: Vec<f64> = samples.iter().map(|tally| estimate(tally).value).collect();
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let reported = reports.iter().map(|tally| estimate(tally).stderr.powi(2)).sum::<f64>() / reports.len() as f64;
        (mean, variance / reported)
    };
    let quantity = |channel: usize| {
        let each: Vec<(f64, f64)> = bins.iter().map(|bin| ratio(bin, channel)).collect();
        let count = each.len() as f64;
        let (mean, error) = mean_error(each.iter().map(|e| e.1).sum(), each.iter().map(|e| e.1 * e.1).sum(), count);
        (each.iter().map(|e| e.0).sum::<f64>() / count, mean, error.max((2.0 / (n - 1.0) / count).sqrt()))
    };
    (0..3).map(quantity).collect()
}

/// Walks of each sample of [`cell_calibration`].
const CELLS_CALIBRATED: u64 = 35_000;

#[test]
fn error_bars_of_single_exit_cells_of_dark_channels_are_calibrated() {
    let all = cell_calibration(CELLS_CALIBRATED);
    println!("{all:?}");
    for (mean, ratio, error) in &all {
        assert!((ratio - 1.0).abs() < GATE * error, "mean {mean:.1e}: {ratio:.3} ± {error:.3}");
    }
    assert!(all[1].0 < 1e-3 && all[2].0 < 1e-6, "the channels are dark: {all:?}");
}

#[test]
fn error_bars_of_single_exit_cells_of_fewer_walks_are_too_wide() {
    for (mean, ratio, error) in cell_calibration(17_500) {
        println!("mean {mean:.1e}: {ratio:.3} ± {error:.3}");
        assert!((ratio - 1.0).abs() > GATE * error, "mean {mean:.1e}: {ratio:.3} ± {error:.3}");
    }
}
