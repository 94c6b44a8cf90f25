//! Light straight through, and the algebra of path lengths.

use super::cloths::{DYES, INFINITE, bundle, dyed_cloth, two_dyes};
use crate::common::sheet::DyedSheet;
use crate::common::stats::{GATE, largest, mean_error, means_z};
use crate::common::{Cloth, engines, mean_light, run};
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::reference::replay;
use fiberwalk::walk::{Engine, WalkPlan};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;
use std::sync::OnceLock;

/// Mean over α of exp(−σ c) with chords c = 2 R √(1−α²) of light at right angles to its fibers.
fn mean_chord_weight(sigma: f64, radius: f64) -> f64 {
    let steps = 20_000;
    let at = |i: i32| {
        // α = sin t.
        let cos = ((f64::from(i) + 0.5) / f64::from(steps) * FRAC_PI_2).cos();
        (-2.0 * sigma * radius * cos).exp() * cos * FRAC_PI_2 / f64::from(steps)
    };
    (0..steps).map(at).sum()
}

/// Dyes, walks and bends of sheets of index 1: optical depths of two bundles, dyes in 1/mm.
const STRAIGHT: [([f64; 2], [[f64; 3]; 2], u64); 3] = [
    ([40.0, 60.0], [[0.0, 9.0, 13.0], [0.05, 3.6, 14.4]], 92_000),
    ([4.0, 8.0], [[20.0, 60.0, 40.0], [20.0, 20.0, 50.0]], 370_000),
    ([40.0, 60.0], [[4.6, 5.0, 6.0], [4.8, 4.5, 4.7]], 92_000),
];

/// z by channel of the light through fibers of index 1 at right angles to it, against
/// exp(−Σ τ_k (1 − A_k)) − exp(−Σ τ_k), A_k = ⟨exp(−σ_k c)⟩: the hits are Poisson and the light goes straight.
fn straight_z(name: &str, engine: &dyn Engine, case: usize, bend: [f64; 3]) -> Vec<f64> {
    let (depths, dyes, walks) = STRAIGHT[case];
    let radii = [0.01, 0.005];
    let axes = [[1.0, 0.0, 0.0], [0.6, 0.8, 0.0]];
    let bundle = |k: usize| bundle(radii[k], depths[k], 1.0, axes[k], std::array::from_fn(|c| dyes[k][c] * bend[c]));
    let sheet = DyedSheet { bundles: vec![bundle(0), bundle(1)], half_length: INFINITE };
    // Fibers may fill at most 0.9 of the sheet: make it thicker and them fewer.
    let mut cloth = dyed_cloth(&sheet, [0.0, 0.0]);
    cloth.thickness_um *= 100.0;
    cloth.fibers[0].0 /= 100.0;
    cloth.more_kinds[0].length_density /= 100.0;
    let tally = run(name, engine, &cloth, &WalkPlan::new(80 + case as u64, walks));
    let light = mean_light(&tally, 0);
    let z = |channel: usize| {
        let taken = |k: usize| depths[k] * (1.0 - mean_chord_weight(dyes[k][channel], radii[k]));
        let expected = (-taken(0) - taken(1)).exp() - (-depths[0] - depths[1]).exp();
        let z = (light[3 + channel].0 - expected) / light[3 + channel].1;
        println!("{name}, case {case}: {:.3e} ± {:.1e} for {expected:.3e}", light[3 + channel].0, light[3 + channel].1);
        z
    };
    (0..3).map(z).collect()
}

#[test]
fn light_straight_through_has_the_closed_form_down_to_a_millionth() {
    for case in 0..STRAIGHT.len() {
        for (name, engine) in engines() {
            let z = straight_z(name, engine, case, [1.0; 3]);
            assert!(largest(&z) < GATE, "{name}, case {case}: z = {z:.1?}");
        }
    }
}

#[test]
fn light_straight_through_shows_a_bent_dye() {
    for (case, bend) in [(0, [1.0128, 0.9955, 0.9616]), (1, [0.9923, 0.9872, 0.9885]), (2, [0.9552; 3])] {
        for (name, engine) in engines() {
            let z = straight_z(name, engine, case, bend);
            println!("{name}, case {case}: z = {z:.1?}");
            assert!(z.iter().all(|z| z.abs() > GATE), "{name}, case {case}: z = {z:.1?}");
        }
    }
}

/// Light by side and channel in f64 with neither fixed point nor roulette, weights from path lengths by the stated dyes.
fn algebra(cloth: &Cloth, dyes: [[f64; 3]; 2], seed: u64, walks: u64) -> Vec<(f64, f64)> {
    let Prepared { tables, goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
    let plan = WalkPlan { roulette: false, ..WalkPlan::new(seed, walks) };
    let cells = goniometer.exit.cells();
    let thick = usize::from(tables.kinds[0].radius < 0.0075);
    let task = |first: u64| {
        let mut sums = [[0.0; 2]; 6];
        for i in first..(first + 1000).min(walks) {
            let walked = replay(&tables, &goniometer, &plan, 0, i).walked;
            let bin = walked.record.bin as usize;
            assert!(bin <= 2 * cells, "nothing ends or loses these walks");
            for channel in 0..if bin < 2 * cells { 3 } else { 0 } {
                let depth = dyes[0][channel] * walked.lengths[thick] + dyes[1][channel] * walked.lengths[1 - thick];
                let weight = (-depth).exp();
                let sum = &mut sums[bin / cells * 3 + channel];
                *sum = [sum[0] + weight, sum[1] + weight * weight];
            }
        }
        sums
    };
    let add = |a: [[f64; 2]; 6], b: [[f64; 2]; 6]| std::array::from_fn(|i| [a[i][0] + b[i][0], a[i][1] + b[i][1]]);
    let firsts = (0..walks.div_ceil(1000)).into_par_iter().map(|i| 1000 * i);
    let sums = firsts.map(task).reduce(|| [[0.0; 2]; 6], add);
    sums.iter().map(|[sum, square]| mean_error(*sum, *square, walks as f64)).collect()
}

fn algebra_z(name: &str, engine: &dyn Engine, case: usize, bend: f64) -> Vec<f64> {
    let (dyes, depth, walks) = DYES[case];
    let cloth = two_dyes(dyes.map(|dye| dye.map(|sigma| sigma * bend)), depth);
    let light = mean_light(&run(name, engine, &cloth, &WalkPlan::new(90 + case as u64, walks)), 0);
    static EXPECTED: [OnceLock<Vec<(f64, f64)>>; 3] = [const { OnceLock::new() }; 3];
    let expected = EXPECTED[case].get_or_init(|| algebra(&two_dyes(dyes, depth), dyes, 900 + case as u64, walks));
    light.into_iter().zip(expected.iter().copied()).map(|(a, b)| means_z(a, b)).collect()
}

#[test]
fn dyes_follow_the_algebra_of_path_lengths() {
    for case in 0..DYES.len() {
        for (name, engine) in engines() {
            let z = algebra_z(name, engine, case, 1.0);
            assert!(largest(&z) < GATE, "{name}, case {case}: z = {z:.1?}");
        }
    }
}

#[test]
fn bent_dyes_do_not() {
    for (case, bend) in [(0, 1.1), (1, 1.1), (2, 1.04)] {
        for (name, engine) in engines() {
            let z = algebra_z(name, engine, case, bend);
            println!("{name}, case {case}: z = {z:.1?}");
            assert!(largest(&z) > GATE, "{name}, case {case}: z = {z:.1?}");
        }
    }
}
