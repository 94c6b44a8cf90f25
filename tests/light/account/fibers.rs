//! Dyes, radii and kinds of fiber against a ray tracer and closed forms.

use super::cloths::{INFINITE, bundle, dyed_cloth, from_degrees, isotropic_kind};
use crate::common::sheet::{DyedBundle, DyedLight, DyedSheet};
use crate::common::stats::{GATE, binomial_z, largest, means_z, two_tally_z};
use crate::common::{Cloth, ISOTROPIC, Kind, engines, mean_light, rgb, run};
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::reference::replay;
use fiberwalk::walk::{Engine, WalkPlan};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_4;
use std::sync::OnceLock;

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
