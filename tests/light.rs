//! The account of light: dyes and kinds of fiber, fixed point and roulette, in both engines.

mod common;

use common::sheet::{DyedBundle, DyedLight, DyedSheet};
use common::stats::{GATE, binomial_z, chi2_z, largest, mean_error, means_z, two_tally_z};
use common::{Cloth, ISOTROPIC, Kind, aligned, assert_ran, engines, gpu, mean_light, rgb, run};
use fiberwalk::bsdf::{Estimate, mean_weight, totals};
use fiberwalk::goniometer::{Outcome, Tally};
use fiberwalk::gpu::Settings;
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::reference::{Reference, replay};
use fiberwalk::walk::{Engine, WalkPlan};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::sync::OnceLock;

/// The unit vector at θ, φ in degrees.
fn from_degrees([theta, phi]: [f64; 2]) -> DVec3 {
    let (theta, phi) = (theta.to_radians(), phi.to_radians());
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// The same isotropic, lossless kind again: radius, length density.
fn isotropic_kind(radius_um: f64, length_density: f64, absorption: &str) -> Kind {
    Kind { radius_um, ior: 1.5, absorption: absorption.into(), length_density, orientation: ISOTROPIC.into() }
}

// ---- Sheets of aligned, dyed fibers against brute force ----

/// A sheet as a brute-force simulation sees it, its light, and the cloth file that says the same.
fn dyed_cloth(sheet: &DyedSheet, angles: [f64; 2]) -> Cloth {
    let orientation = |bundle: &DyedBundle| aligned(bundle.axis.to_array());
    let kind = |bundle: &DyedBundle| Kind {
        radius_um: bundle.radius * 1e3,
        ior: bundle.ior,
        absorption: rgb(bundle.absorption),
        length_density: bundle.length_density,
        orientation: orientation(bundle),
    };
    let first = kind(&sheet.bundles[0]);
    Cloth {
        radius_um: first.radius_um,
        ior: first.ior,
        absorption: first.absorption,
        more_kinds: sheet.bundles[1..].iter().map(kind).collect(),
        length_over_radius: 2.0 * sheet.half_length,
        ..Cloth::new(first.length_density, &first.orientation)
    }
    .lit_from(&format!("[{angles:?}]"))
}

fn bundle(radius: f64, depth: f64, ior: f64, axis: [f64; 3], absorption: [f64; 3]) -> DyedBundle {
    let axis = DVec3::from(axis).normalize();
    DyedBundle { radius, length_density: depth / (2.0 * radius), ior, axis, absorption }
}

const INFINITE: f64 = f64::INFINITY;

/// Sheets and the light on them.
fn dyed_sheets() -> Vec<(DyedSheet, [f64; 2])> {
    let sheet = |half_length, bundles: &[DyedBundle]| DyedSheet { bundles: bundles.to_vec(), half_length };
    let (oblique, flat) = ([0.48, -0.6, 0.64], [0.0, 1.0, 0.0]);
    vec![
        // One dyed fiber at a time.
        (sheet(INFINITE, &[bundle(0.01, 0.05, 1.5, oblique, [5.0, 60.0, 400.0])]), [35.0, 75.0]),
        // Equal length densities, radii 1:4, each opaque in its own channel.
        (
            sheet(
                INFINITE,
                &[bundle(0.005, 0.02, 1.5, flat, [9e4, 0.0, 3.0]), bundle(0.02, 0.08, 1.5, flat, [0.0, 9e4, 3.0])],
            ),
            [20.0, 30.0],
        ),
        // Kinds of other dyes, radii and indices, many hits.
        (
            sheet(
                INFINITE,
                &[
                    bundle(0.01, 0.8, 1.55, oblique, [3.0, 20.0, 0.5]),
                    bundle(0.006, 0.6, 1.33, flat, [60.0, 2.0, 0.0]),
                    bundle(0.02, 0.7, 1.8, [1.0, 0.1, -0.2], [0.0, 0.3, 30.0]),
                ],
            ),
            [50.0, -120.0],
        ),
        // Short fibers.
        (sheet(2.0, &[bundle(0.01, 1.5, 1.33, [0.0, 0.3, 1.0], [5.0, 60.0, 0.0])]), [25.0, 40.0]),
        (
            sheet(
                2.0,
                &[
                    bundle(0.01, 1.0, 1.1, [0.6, 0.0, 0.8], [5.0, 60.0, 0.0]),
                    bundle(0.02, 1.0, 1.36, [0.5, -0.2, 0.8], [30.0, 1.0, 0.0]),
                ],
            ),
            [20.0, 10.0],
        ),
    ]
}

const DYED_WALKS: u64 = 400_000;

/// z of light by side and channel, and of base exits, of an engine on a bent sheet against brute force on the stated one.
fn dyed_z(name: &str, engine: &dyn Engine, case: usize, bend: impl Fn(&mut DyedSheet)) -> Vec<f64> {
    let (stated, angles) = dyed_sheets().swap_remove(case);
    let mut bent = stated.clone();
    bend(&mut bent);
    let tally = run(name, engine, &dyed_cloth(&bent, angles), &WalkPlan::new(50 + case as u64, DYED_WALKS));
    static EXPECTED: [OnceLock<DyedLight>; 5] = [const { OnceLock::new() }; 5];
    let expected = EXPECTED[case].get_or_init(|| stated.measure(from_degrees(angles), DYED_WALKS, 500 + case as u64));
    let light = mean_light(&tally, 0);
    let mut z: Vec<f64> = light.into_iter().zip(expected.mean()).map(|(a, b)| means_z(a, b)).collect();
    let (bases, error) = expected.bases();
    z.push(means_z((tally.counts.base_exits as f64 / DYED_WALKS as f64, error), (bases, error)));
    z
}

#[test]
fn dyed_fibers_take_the_light_that_a_ray_tracer_finds() {
    for case in 0..dyed_sheets().len() {
        for (name, engine) in engines() {
            let z = dyed_z(name, engine, case, |_| {});
            println!("{name}, case {case}: z = {z:.1?}");
            assert!(largest(&z) < GATE, "{name}, case {case}: z = {z:.1?}");
        }
    }
}

#[test]
fn bent_dyes_radii_and_lengths_show() {
    type Bend = fn(&mut DyedSheet);
    let bends: [(usize, Bend); 5] = [
        (0, |sheet| sheet.bundles[0].absorption[1] *= 1.09),
        (1, |sheet| sheet.bundles[0].radius *= 1.2),
        (2, |sheet| sheet.bundles[1].absorption[0] *= 1.09),
        (3, |sheet| sheet.half_length *= 1.0015),
        (4, |sheet| sheet.half_length *= 1.1),
    ];
    for (case, bend) in bends {
        for (name, engine) in engines() {
            let z = dyed_z(name, engine, case, bend);
            println!("{name}, case {case}: z = {z:.1?}");
            assert!(largest(&z) > GATE, "{name}, case {case}: z = {z:.1?}");
        }
    }
}

// ---- Kinds ----

/// z of direct light through isotropic fibers of radii 5 and 20 µm of equal length density, H = 2 Σ R L π/4, and of the
/// number of single hits that entered the thinner ones, a fifth.
fn two_radii_z(name: &str, engine: &dyn Engine, thin_um: f64) -> [f64; 2] {
    let (density, walks) = (30.0, 400_000);
    let cloth = Cloth {
        radius_um: thin_um,
        more_kinds: vec![isotropic_kind(20.0, density, "2")],
        ..Cloth::new(density, ISOTROPIC)
    }
    .lit_from("[[20, 0]]");
    let plan = WalkPlan::new(60, walks);
    let tally = run(name, engine, &cloth, &plan);
    let h = 2.0 * (0.005 + 0.02) * density * FRAC_PI_4;
    let direct = binomial_z(tally.direct(0), walks, (-h / 20f64.to_radians().cos()).exp());
    let Prepared { tables, goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
    let thin = usize::from(tables.kinds[0].radius > 0.01);
    let plan = WalkPlan { seed: 61, ..plan };
    let entered = |i: u64| {
        let walked = replay(&tables, &goniometer, &plan, 0, i).walked;
        let single = walked.record.hits == 1;
        [u64::from(single && walked.lengths[thin] > 0.0), u64::from(single && walked.lengths[1 - thin] > 0.0)]
    };
    let counts = (0..100_000).into_par_iter().map(entered).reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    [direct, binomial_z(counts[0], counts[0] + counts[1], 0.2)]
}

#[test]
fn radii_of_one_to_four_are_hit_one_to_four() {
    for (name, engine) in engines() {
        let z = two_radii_z(name, engine, 5.0);
        assert!(largest(&z) < GATE, "{name}: z = {z:.1?}");
    }
}

#[test]
fn a_bent_radius_is_hit_more_often() {
    for (name, engine) in engines() {
        let z = two_radii_z(name, engine, 5.55);
        println!("{name}: z = {z:.1?}");
        assert!(z.iter().all(|z| z.abs() > GATE), "{name}: z = {z:.1?}");
    }
}

/// z of the exit table and of the light of a sheet whose fibers are two kinds, against one kind.
fn split_z(name: &str, engine: &dyn Engine, second_ior: f64) -> Vec<f64> {
    let one = Cloth { absorption: rgb([3.0, 10.0, 40.0]), ..Cloth::isotropic(2.0) }.lit_from("2");
    let (density, dye) = (one.fibers[0].0, one.absorption.clone());
    let second = Kind { ior: second_ior, ..isotropic_kind(10.0, 0.4 * density, &dye) };
    let two = Cloth { fibers: vec![(0.6 * density, ISOTROPIC.into())], more_kinds: vec![second], ..one.clone() };
    let a = run(name, engine, &one, &WalkPlan::new(70, 100_000));
    let b = run(name, engine, &two, &WalkPlan::new(71, 100_000));
    let light = (0..4).flat_map(|start| mean_light(&a, start).into_iter().zip(mean_light(&b, start)));
    [two_tally_z(&a, &b)].into_iter().chain(light.map(|(a, b)| means_z(a, b))).collect()
}

#[test]
fn two_equal_kinds_are_one_kind() {
    for (name, engine) in engines() {
        let z = split_z(name, engine, 1.5);
        assert!(largest(&z) < GATE, "{name}: z = {z:.1?}");
    }
}

#[test]
fn two_kinds_of_slightly_other_index_are_not() {
    for (name, engine) in engines() {
        let z = split_z(name, engine, 1.62);
        println!("{name}: z = {z:.1?}");
        assert!(largest(&z) > GATE, "{name}: z = {z:.1?}");
    }
}

// ---- Fixed point and roulette ----

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
    ([40.0, 60.0], [[0.0, 9.0, 13.0], [0.05, 3.6, 14.4]], 150_000),
    ([4.0, 8.0], [[20.0, 60.0, 40.0], [20.0, 20.0, 50.0]], 600_000),
    ([40.0, 60.0], [[4.6, 5.0, 6.0], [4.8, 4.5, 4.7]], 150_000),
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
    for (case, bend) in [(0, [1.01, 0.9965, 0.97]), (1, [0.994, 0.99, 0.991]), (2, [0.965; 3])] {
        for (name, engine) in engines() {
            let z = straight_z(name, engine, case, bend);
            println!("{name}, case {case}: z = {z:.1?}");
            assert!(z.iter().all(|z| z.abs() > GATE), "{name}, case {case}: z = {z:.1?}");
        }
    }
}

/// A sheet of two dyed, isotropic kinds: mean weights from order 1 down to 10⁻³ and 10⁻⁶ of what is transmitted.
fn two_dyes(dyes: [[f64; 3]; 2], depth: f64) -> Cloth {
    let density = depth / (2.0 * 0.015 * FRAC_PI_4);
    let second = isotropic_kind(5.0, density, &rgb(dyes[1]));
    let first = Cloth { absorption: rgb(dyes[0]), exit: 8, ..Cloth::new(density, ISOTROPIC) };
    Cloth { more_kinds: vec![second], ..first }.lit_from("[[30, 50]]")
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

/// Dyes of two kinds, depth, walks of an engine and of the f64 run.
const DYES: [([[f64; 3]; 2], f64, u64); 3] = [
    ([[0.1, 5.0, 60.0], [30.0, 1.0, 200.0]], 3.0, 150_000),
    ([[0.2, 60.0, 400.0], [0.1, 100.0, 800.0]], 6.0, 150_000),
    ([[25.0, 30.0, 60.0], [40.0, 20.0, 100.0]], 4.0, 300_000),
];

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

/// z by start, side and channel of the light of both engines; the cpu engine measures the stated dyes.
fn engines_z(bend: f64) -> Vec<f64> {
    let (dyes, depth, _) = DYES[0];
    let cloth = |bend: f64| {
        let cloth = two_dyes(dyes.map(|dye| dye.map(|sigma| sigma * bend)), depth);
        Cloth { sides: "[\"front\", \"back\"]".into(), ..cloth }.lit_from("4")
    };
    let on_gpu = run("gpu", gpu(), &cloth(bend), &WalkPlan::new(100, 8000));
    let on_cpu = run("cpu", &Reference, &cloth(1.0), &WalkPlan::new(101, 8000));
    let mut z = Vec::new();
    let mut sums = [(0.0, 0.0); 12];
    for start in 0..on_gpu.starts() {
        for (i, (a, b)) in mean_light(&on_gpu, start).into_iter().zip(mean_light(&on_cpu, start)).enumerate() {
            z.push(means_z(a, b));
            sums[2 * i] = (sums[2 * i].0 + a.0, a.1.hypot(sums[2 * i].1));
            sums[2 * i + 1] = (sums[2 * i + 1].0 + b.0, b.1.hypot(sums[2 * i + 1].1));
        }
    }
    // All starts together, by side and channel, and the sum of squares of each start.
    let square: f64 = z.iter().map(|z| z * z).sum();
    let mut all: Vec<f64> = sums.chunks(2).map(|pair| means_z(pair[0], pair[1])).collect();
    all.push(chi2_z(square / 3.0, z.len() as f64 / 3.0));
    all
}

#[test]
fn both_engines_find_the_same_colors() {
    let z = engines_z(1.0);
    println!("{z:.1?}");
    assert!(largest(&z) < GATE, "z = {z:.1?}");
}

#[test]
fn bent_dyes_are_other_colors() {
    let z = engines_z(1.1);
    println!("{z:.1?}");
    assert!(largest(&z) > GATE, "z = {z:.1?}");
}

/// Walks that end elsewhere, and differences of the light by bin and channel in light of one walk, between the engines
/// on the same random numbers.
fn lockstep(bend: f64) -> (f64, f64) {
    let (dyes, depth, _) = DYES[2];
    let bent = dyes.map(|dye| dye.map(|sigma| sigma * bend));
    let both = "[\"front\", \"back\"]";
    let cloth = |dyes| Cloth { sides: both.into(), length_over_radius: 4.0, ior: 1.33, ..two_dyes(dyes, 2.0 * depth) };
    let [on_gpu, on_cpu] = engines().map(|(name, engine)| {
        let dyes = if name == "gpu" { bent } else { dyes };
        let tally = cloth(dyes).run(engine, &WalkPlan::new(110, 20_000));
        assert_ran(&tally, name);
        tally
    });
    let moved: u64 = on_gpu.bins.iter().zip(&on_cpu.bins).map(|(a, b)| a.abs_diff(*b)).sum();
    println!("{} and {} ended", on_gpu.outcome(0, Outcome::Ended), on_cpu.outcome(0, Outcome::Ended));
    assert!(on_gpu.outcome(0, Outcome::Ended) > 1000, "roulette ends some walks");
    let mut light = 0.0;
    for start in 0..2 {
        for bin in 0..2 * on_gpu.layout.exit_cells {
            for channel in 0..3 {
                let units = |tally: &Tally| tally.light(start, bin, channel).sum as f64 / tally.unit() as f64;
                light += (units(&on_gpu) - units(&on_cpu)).abs();
            }
        }
    }
    assert!(on_gpu.counts.base_exits.abs_diff(on_cpu.counts.base_exits) < 20 + on_cpu.counts.base_exits / 1000);
    (moved as f64 / 2.0 / 40_000.0, light / 3.0 / 40_000.0)
}

#[test]
fn the_same_walks_have_the_same_fate_and_light() {
    let (moved, light) = lockstep(1.0);
    println!("{moved:.1e} of the walks and {light:.1e} of the light differ");
    assert!(moved < 5e-4 && light < 5e-4, "{moved:.1e} of the walks and {light:.1e} of the light differ");
}

#[test]
fn dyes_that_are_five_percent_off_change_fate_and_light() {
    let (moved, light) = lockstep(1.05);
    println!("{moved:.1e} of the walks and {light:.1e} of the light differ");
    assert!(moved > 5e-4 && light > 5e-4, "{moved:.1e} of the walks and {light:.1e} of the light differ");
}

// ---- Error bars ----

/// Sample variance of the light over 100 seeds over the mean variance that runs of `reported` walks report, averaged over
/// 12 directions, with its standard error, behind the mean light: reflected in the clear channel, transmitted in all three.
fn calibration(reported: u64) -> Vec<(f64, f64, f64)> {
    const SEEDS: u64 = 100;
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
        fewer = (0..SEEDS).map(|seed| measure(4000 + seed, reported)).collect();
        &fewer
    };
    let n = SEEDS as f64;
    let of = |place: usize| {
        let mean = samples.iter().map(|sample| sample[place].value).sum::<f64>() / n;
        let variance = samples.iter().map(|sample| (sample[place].value - mean).powi(2)).sum::<f64>() / (n - 1.0);
        (mean, variance / (reports.iter().map(|report| report[place].stderr.powi(2)).sum::<f64>() / n))
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
    const SEEDS: u64 = 100;
    let cloth = Cloth { ior: 1.02, absorption: rgb(DARK), thickness_um: 1e5, exit: 2, ..Cloth::isotropic(0.4) };
    let cloth = cloth.lit_from("[[5, 20], [8, 100], [12, -70]]");
    let sample = |seed, walks| run("gpu", gpu(), &cloth, &WalkPlan::new(seed, walks));
    static SAMPLES: OnceLock<Vec<Tally>> = OnceLock::new();
    let samples = SAMPLES.get_or_init(|| (0..SEEDS).map(|seed| sample(6000 + seed, CELLS_CALIBRATED)).collect());
    let fewer: Vec<Tally>;
    let reports = if reported == CELLS_CALIBRATED {
        samples
    } else {
        fewer = (0..SEEDS).map(|seed| sample(7000 + seed, reported)).collect();
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
        (mean, variance / (reports.iter().map(|tally| estimate(tally).stderr.powi(2)).sum::<f64>() / n))
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
const CELLS_CALIBRATED: u64 = 50_000;

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
    for (mean, ratio, error) in cell_calibration(25_000) {
        println!("mean {mean:.1e}: {ratio:.3} ± {error:.3}");
        assert!((ratio - 1.0).abs() > GATE * error, "mean {mean:.1e}: {ratio:.3} ± {error:.3}");
    }
}

// ---- Cuts of the work ----

#[test]
fn the_light_does_not_depend_on_how_the_work_is_cut() {
    let (dyes, depth, _) = DYES[2];
    let both = "[\"front\", \"back\"]";
    let short = Cloth { sides: both.into(), length_over_radius: 4.0, ior: 1.33, ..two_dyes(dyes, 2.0 * depth) };
    let cloth = Cloth { exit: 4, ..short }.lit_from("3");
    let Prepared { tables, goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
    let plan = WalkPlan::new(170, 403);
    let cut = |plan: &WalkPlan, settings: Settings| {
        let result = gpu().run_with(settings, &tables, &goniometer, plan, &mut |_| {});
        result.unwrap_or_else(|error| panic!("{settings:?}: {error}")).0
    };
    let whole = cut(&plan, Settings::default());
    assert!(whole.counts.base_exits > 100 && (0..18).any(|start| whole.outcome(start, Outcome::Ended) > 10));
    let few = Settings { lanes: Some(512), budget: Some(256), ..Settings::default() };
    let mut cuts: Vec<Settings> = [1, 2, 7, 14, 15, 16, 40].map(|n| Settings { flush_every: Some(n), ..few }).to_vec();
    cuts.extend([64, 4096].map(|lanes| Settings { lanes: Some(lanes), ..Settings::default() }));
    cuts.extend([7, 100].map(|budget| Settings { lanes: Some(1024), budget: Some(budget), ..Settings::default() }));
    cuts.extend([1, 100].map(|walks| Settings { walks_per_segment: Some(walks), ..few }));
    cuts.extend([1, 5, 11].map(|starts| Settings { starts_per_batch: Some(starts), ..few }));
    cuts.extend([13, 256].map(|group| Settings { workgroup: Some(group), lanes: Some(13 * 256), ..few }));
    cuts.push(Settings { table_in_texture: Some(true), ..few });
    cuts.extend([u32::MAX, u32::MAX - 1000, u32::MAX - 100_000].map(|preset| Settings {
        bins_preset: preset,
        walks_per_segment: Some(100),
        ..few
    }));
    for settings in cuts {
        assert_eq!(cut(&plan, settings), whole, "{settings:?}");
    }
    assert_ne!(cut(&WalkPlan { seed: 171, ..plan }, few).weights, whole.weights, "another seed gives another tally");
}
