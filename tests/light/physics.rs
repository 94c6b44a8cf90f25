//! Closed forms and independent simulations, for both engines.

use crate::common::sheet::{AlignedSheet, disc_cell};
use crate::common::stats::{GATE, binomial_z, chi2_z, two_sample_chi2};
use crate::common::{Cloth, ISOTROPIC, PLANAR, aligned, assert_ran, engines};
use fiberwalk::goniometer::Tally;
use fiberwalk::walk::{Engine, WalkPlan};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::OnceLock;

/// The unit vector at θ, φ in degrees.
fn from_degrees([theta, phi]: [f64; 2]) -> DVec3 {
    let (theta, phi) = (theta.to_radians(), phi.to_radians());
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

const ANGLES: [[f64; 2]; 4] = [[10.0, 20.0], [35.0, 75.0], [55.0, 140.0], [70.0, -100.0]];
const AXIS: [f64; 3] = [0.48, -0.6, 0.64];

/// ⟨|m × p|⟩ of the stated orientation by quadrature.
fn mean_sine(orientation: &str, m: DVec3) -> f64 {
    let steps = 2000;
    let middle = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
    match orientation {
        // Over the angle t between m and p, with density sin t on [0, π/2].
        ISOTROPIC => {
            (0..steps).map(|i| (middle(i) * FRAC_PI_2).sin().powi(2)).sum::<f64>() * FRAC_PI_2 / f64::from(steps)
        }
        PLANAR => {
            let sine = |i| {
                let (sin, cos) = (middle(i) * PI).sin_cos();
                m.cross(DVec3::new(cos, sin, 0.0)).length()
            };
            (0..steps).map(sine).sum::<f64>() / f64::from(steps)
        }
        _ => m.cross(DVec3::from(AXIS)).length(),
    }
}

/// z of the direct light of each listed direction against exp(−H d / cos θ) of the stated cloth.
fn direct_z(name: &str, engine: &dyn Engine, cloth: &Cloth, stated: &Cloth, seed: u64) -> Vec<f64> {
    let walks = 620_000;
    let tally = cloth.run(engine, &WalkPlan::new(seed, walks));
    assert_ran(&tally, name);
    let (density, orientation) = &stated.fibers[0];
    let z = |(cell, angles): (usize, &[f64; 2])| {
        let wi = from_degrees(*angles);
        let h = 2.0 * stated.radius_um * 1e-3 * density * mean_sine(orientation, wi);
        binomial_z(tally.direct(cell), walks, (-h * stated.thickness_um * 1e-3 / wi.z).exp())
    };
    ANGLES.iter().enumerate().map(z).collect()
}

fn direct_cloth(orientation: &str) -> Cloth {
    Cloth::new(40.0, orientation).lit_from(&format!("{ANGLES:?}"))
}

#[test]
fn direct_light_follows_the_exponential_law() {
    for (i, orientation) in [ISOTROPIC, PLANAR, &aligned(AXIS)].into_iter().enumerate() {
        let cloth = direct_cloth(orientation);
        for (name, engine) in engines() {
            let z = direct_z(name, engine, &cloth, &cloth, 100 + i as u64);
            assert!(z.iter().all(|z| z.abs() < GATE), "{name}, {orientation}: z = {z:.1?}");
        }
    }
}

#[test]
fn direct_light_shows_a_radius_that_is_one_and_a_half_percent_off() {
    // At depths near 1, δP = P·H d·δ against √(P(1−P)/n): 1.5 % stand at 8 to 10 σ.
    for (i, orientation) in [ISOTROPIC, PLANAR, &aligned(AXIS)].into_iter().enumerate() {
        let stated = direct_cloth(orientation);
        let bent = Cloth { radius_um: 10.15, ..stated.clone() };
        for (name, engine) in engines() {
            let z = direct_z(name, engine, &bent, &stated, 200 + i as u64);
            assert!(z.iter().any(|z| z.abs() > GATE), "{name}, {orientation}: z = {z:.1?}");
            println!("{name}, {orientation}: z = {z:.1?}");
        }
    }
}

#[test]
fn a_lossless_sheet_returns_all_light() {
    for cloth in [Cloth::isotropic(0.3), Cloth::isotropic(8.0), direct_cloth(PLANAR), direct_cloth(&aligned(AXIS))] {
        for (name, engine) in engines() {
            let tally = cloth.run(engine, &WalkPlan::new(3, 2000));
            assert_ran(&tally, name);
            for cell in 0..tally.starts() {
                let out = tally.reflection(cell).iter().chain(tally.transmission(cell)).sum::<u64>();
                assert_eq!(out + tally.direct(cell), 2000, "{name}, cell {cell}");
                assert_eq!(tally.lost(cell), 0, "{name}, cell {cell}");
            }
        }
    }
}

#[test]
fn a_sheet_whose_walks_are_cut_short_does_not_return_all_light() {
    for (name, engine) in engines() {
        let tally = Cloth::isotropic(8.0).run(engine, &WalkPlan { max_events: 8, ..WalkPlan::new(3, 2000) });
        assert_ran(&tally, name);
        assert!((0..64).all(|cell| tally.lost(cell) > 0), "{name}");
    }
}

/// Light in the cell of (−x, −y) on the far side, and everywhere else.
fn undeflected(tally: &Tally, n: usize, angles: &[[f64; 2]]) -> Vec<(u64, u64)> {
    let split = |(cell, angles): (usize, &[f64; 2])| {
        let wi = from_degrees(*angles);
        let straight = tally.transmission(cell)[disc_cell(-wi.x, -wi.y, n)];
        let all: u64 = tally.reflection(cell).iter().chain(tally.transmission(cell)).sum();
        (straight, all - straight)
    };
    angles.iter().enumerate().map(split).collect()
}

#[test]
fn at_index_one_light_goes_straight_on() {
    for orientation in [ISOTROPIC, PLANAR, &aligned(AXIS)] {
        let cloth = Cloth { ior: 1.0, ..direct_cloth(orientation) };
        for (name, engine) in engines() {
            let tally = cloth.run(engine, &WalkPlan::new(4, 100_000));
            assert_ran(&tally, name);
            for (cell, (straight, elsewhere)) in undeflected(&tally, 16, &ANGLES).into_iter().enumerate() {
                assert_eq!(elsewhere, 0, "{name}, {orientation}");
                assert_eq!(straight + tally.direct(cell), 100_000);
                assert!(straight > 10_000, "{name}: hardly any light touched a fiber");
            }
        }
    }
}

#[test]
fn at_index_slightly_above_one_some_light_leaves_its_cell() {
    for (name, engine) in engines() {
        let tally = Cloth { ior: 1.001, ..direct_cloth(ISOTROPIC) }.run(engine, &WalkPlan::new(4, 100_000));
        assert_ran(&tally, name);
        assert!(undeflected(&tally, 16, &ANGLES).iter().all(|(_, elsewhere)| *elsewhere > 10), "{name}");
    }
}

/// Sheets of exactly aligned fibers: axis, light, index, optical depth at right angles 2 R L d.
const ALIGNED: [([f64; 3], [f64; 2], f64, f64); 4] = [
    ([1.0, 0.0, 0.0], [20.0, 65.0], 1.5, 0.1),
    ([0.0, 1.0, 0.0], [50.0, 25.0], 1.33, 1.0),
    (AXIS, [35.0, 75.0], 1.55, 0.1),
    (AXIS, [65.0, -140.0], 1.8, 2.0),
];

fn aligned_cloth((axis, angles, ior, depth): ([f64; 3], [f64; 2], f64, f64)) -> Cloth {
    Cloth { ior, ..Cloth::new(depth / 0.02, &aligned(axis)) }.lit_from(&format!("[{angles:?}]"))
}

/// Walks of engines and of brute force.
const ALIGNED_WALKS: u64 = 1_000_000;

/// z of an engine's exit table against brute force on the stated sheet.
fn aligned_z(name: &str, engine: &dyn Engine, case: usize, ior_factor: f64) -> f64 {
    let (axis, angles, ior, depth) = ALIGNED[case];
    let tally = aligned_cloth((axis, angles, ior * ior_factor, depth)).run(engine, &WalkPlan::new(5, ALIGNED_WALKS));
    assert_ran(&tally, name);
    let axis = DVec3::from(axis).normalize();
    let sheet = AlignedSheet { radius: 0.01, length_density: depth / 0.02, thickness: 1.0, ior, axis, exit: 16 };
    static EXPECTED: [OnceLock<Vec<u64>>; 4] = [const { OnceLock::new() }; 4];
    let expected = EXPECTED[case].get_or_init(|| sheet.measure(from_degrees(angles), ALIGNED_WALKS, 900 + case as u64));
    let counted = &tally.of_start(0)[..expected.len()];
    let (chi2, freedom) = two_sample_chi2(counted, ALIGNED_WALKS, expected, ALIGNED_WALKS);
    chi2_z(chi2, freedom)
}

#[test]
fn scattering_off_aligned_fibers_is_what_a_ray_tracer_finds() {
    for case in 0..ALIGNED.len() {
        for (name, engine) in engines() {
            let z = aligned_z(name, engine, case, 1.0);
            assert!(z < GATE, "{name}, case {case}: z = {z:.1}");
        }
    }
}

#[test]
fn scattering_off_aligned_fibers_shows_a_bent_index() {
    // Factors of the index that stand at 8 to 10 σ of this comparison.
    for (case, factor) in [(0, 1.0128), (1, 1.0051), (2, 1.0119), (3, 1.0173)] {
        for (name, engine) in engines() {
            let z = aligned_z(name, engine, case, factor);
            println!("{name}, case {case}, index × {factor}: z = {z:.1}");
            assert!(z > GATE, "{name}, case {case}: z = {z:.1}");
        }
    }
}

/// Light outside of the cells that the cone |m·p| = const of a case passes through.
fn off_the_cone(tally: &Tally, axis: DVec3, m: DVec3) -> u64 {
    let (e1, e2) = axis.any_orthonormal_pair();
    let axial = m.dot(axis);
    let transverse = (1.0 - axial * axial).sqrt();
    let mut on_cone = vec![false; 512];
    for i in 0..1_000_000 {
        let (sin, cos) = (f64::from(i) * TAU * 1e-6).sin_cos();
        let exit = axis * axial + (e1 * cos + e2 * sin) * transverse;
        on_cone[disc_cell(exit.x, exit.y, 16) + if exit.z > 0.0 { 0 } else { 256 }] = true;
    }
    let counts = tally.reflection(0).iter().chain(tally.transmission(0));
    counts.zip(on_cone).filter(|(_, on)| !on).map(|(count, _)| count).sum()
}

#[test]
fn light_off_aligned_fibers_stays_on_the_cone() {
    for case in ALIGNED {
        let (axis, m) = (DVec3::from(case.0).normalize(), -from_degrees(case.1));
        for (name, engine) in engines() {
            let tally = aligned_cloth(case).run(engine, &WalkPlan::new(6, 200_000));
            assert_ran(&tally, name);
            assert_eq!(off_the_cone(&tally, axis, m), 0, "{name}, axis {axis}");
            let spread =
                Cloth { fibers: vec![(case.3 / 0.02, aligned(case.0) + "\nspread_deg = 5")], ..aligned_cloth(case) };
            let tally = spread.run(engine, &WalkPlan::new(6, 200_000));
            assert!(off_the_cone(&tally, axis, m) > 1000, "{name}: a spread of 5° must leave the cone");
        }
    }
}

#[test]
fn unpolarised_light_is_off_by_what_the_readme_says() {
    // Light normal to fibers of index 1.55, mean over α: true s and p light against the mean reflectance.
    let steps = 200_000;
    let (mut truth, mut computed) = ([0.0; 4], [0.0; 4]);
    for i in 0..steps {
        let offset = (f64::from(i) + 0.5) / f64::from(steps);
        let f = fiberwalk::optics::Encounter::new(-DVec3::Z, DVec3::X, offset, 1.55).reflectance;
        let (ci, ct) = ((1.0 - offset * offset).sqrt(), (1.0 - (offset / 1.55).powi(2)).sqrt());
        let s = ((ci - 1.55 * ct) / (ci + 1.55 * ct)).powi(2);
        let p = ((1.55 * ci - ct) / (1.55 * ci + ct)).powi(2);
        for chords in 1..4 {
            let share = |f: f64| (1.0 - f).powi(2) * f.powi(chords as i32 - 1);
            truth[chords] += 0.5 * (share(s) + share(p));
            computed[chords] += share(f);
        }
    }
    for (chords, stated) in [(1, 1.004), (2, 0.913), (3, 1.12)] {
        let ratio: f64 = truth[chords] / computed[chords];
        assert!((ratio - stated).abs() < 5e-4, "{chords} chords: {ratio:.4}");
    }
}

/// Share of the hits at an angle between ray and fiber whose light passes more than 1024 chords: ∫ T (1−T)¹⁰²⁴ dα.
fn beyond_the_cap(angle: f64) -> f64 {
    let p = DVec3::new(angle.sin(), 0.0, angle.cos());
    let steps = 600;
    // α = 1 − exp(−x): grazing offsets hold most of it.
    let step = 25.0 / f64::from(steps);
    let share = |i: i32| {
        let rest = (-(f64::from(i) + 0.5) * step).exp();
        let t = 1.0 - fiberwalk::optics::Encounter::new(DVec3::Z, p, 1.0 - rest, 1.55).reflectance;
        t * (1024.0 * (-t).ln_1p()).exp() * rest * step
    };
    (0..steps).map(share).sum()
}

#[test]
fn the_cap_on_chords_cuts_off_as_little_as_the_readme_says() {
    assert!(beyond_the_cap(3f64.to_radians()) < 1e-7);
    assert!(beyond_the_cap(0.1f64.to_radians()) > 1e-5, "nearer to the fibers it is more");
    // Isotropic fibers are hit at angle t with density (4/π) sin² t; t = (π/2) exp(−x).
    let step = 0.025;
    let at = |i: i32| {
        let t = FRAC_PI_2 * (-(f64::from(i) + 0.5) * step).exp();
        beyond_the_cap(t) * 4.0 / PI * t.sin().powi(2) * t * step
    };
    let isotropic: f64 = (0..400).map(at).sum();
    assert!(isotropic > 1e-11 && isotropic < 2e-10, "{isotropic:e}");
}

/// z of direct light through a bundle that is spread by `spread` degrees, against quadrature of the cone of 8 degrees.
fn spread_z(name: &str, engine: &dyn Engine, spread: f64) -> Vec<f64> {
    let walks = 1_000_000;
    let orientation = format!("{}\nspread_deg = {spread}", aligned(AXIS));
    let cloth = Cloth { directions: 65536, ..direct_cloth(&orientation) };
    let tally = cloth.run(engine, &WalkPlan::new(7, walks));
    assert_ran(&tally, name);
    let (axis, half) = (DVec3::from(AXIS).normalize(), 8f64.to_radians());
    let (e1, e2) = axis.any_orthonormal_pair();
    let steps = 200;
    let middle = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
    let z = |(cell, angles): (usize, &[f64; 2])| {
        let wi = from_degrees(*angles);
        // Equal solid angles are equal steps of the cosine.
        let sines = (0..steps * steps).map(|i| {
            let cosine = 1.0 - middle(i / steps) * (1.0 - half.cos());
            let (sin, cos) = (middle(i % steps) * TAU).sin_cos();
            wi.cross(axis * cosine + (e1 * cos + e2 * sin) * (1.0 - cosine * cosine).sqrt()).length()
        });
        let h = 2.0 * 0.01 * 40.0 * sines.sum::<f64>() / f64::from(steps * steps);
        binomial_z(tally.direct(cell), walks, (-h / wi.z).exp())
    };
    ANGLES.iter().enumerate().map(z).collect()
}

#[test]
fn a_spread_bundle_fills_its_cone_by_solid_angle() {
    for (name, engine) in engines() {
        let z = spread_z(name, engine, 8.0);
        assert!(z.iter().all(|z| z.abs() < GATE), "{name}: z = {z:.1?}");
        let bent = spread_z(name, engine, 21.0);
        println!("{name}, spread of 21 for 8: z = {bent:.1?}");
        assert!(bent.iter().any(|z| z.abs() > GATE), "{name}: z = {bent:.1?}");
    }
}
