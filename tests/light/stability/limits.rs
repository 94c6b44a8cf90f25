//! Ends of ranges: bins at the rim and the pole, counters, seeds, tolerances, sheets so deep that f32 has no places in them.

use super::table::{Found, METHODS, NULL, beyond, fails, refused, right, said, section, setup, track, walks, within};
use crate::common::cells::CellCloth;
use crate::common::probes::bits;
use crate::common::program::Place;
use crate::common::stats::{mean_error, means_z};
use crate::common::{Cloth, ISOTROPIC, SplitMix, aligned, engines, gpu, mean_light, rgb};
use fiberwalk::gpu::{Probe, ProbeInput, Settings};
use fiberwalk::scene::Side;
use fiberwalk::walk::WalkPlan;
use glam::{DVec3, Vec2};
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// Directions in the horizon, along the diagonals of the disc, and next to the pole, as f32 has them.
fn extreme_directions() -> [Vec<DVec3>; 2] {
    let rim = (0..1 << 13).map(|i| {
        let (sin, cos) = (f64::from(i) * TAU / f64::from(1 << 13)).sin_cos();
        DVec3::new(cos, sin, if i % 2 == 0 { 1e-8 } else { -1e-8 })
    });
    let pole = (0..1 << 10).map(|i| {
        let at = |bit: i32| [1e-30, -1e-30, 1e-8, -0.0][(i >> bit & 3) as usize];
        DVec3::new(at(0), at(2), if i & 16 == 0 { 1.0 } else { -1.0 })
    });
    let rounded = |m: DVec3| m.as_vec3().as_dvec3();
    [rim.map(rounded).collect(), pole.map(rounded).collect()]
}

#[test]
fn bins_at_the_rim_and_at_the_pole() {
    section("Bins at the rim and at the pole");
    for (regime, directions) in ["exits in the horizon", "exits along the normal"].into_iter().zip(extreme_directions())
    {
        for n in [1, 16, 129] {
            let (tables, goniometer) = setup(&Cloth { exit: n, ..Cloth::isotropic(1.0) });
            let inputs: Vec<ProbeInput> =
                directions.iter().map(|m| ProbeInput { a: bits(*m, 0.0), b: [1, 0, 0, 0], c: [0; 4] }).collect();
            let outputs = Probe::new(gpu(), &tables, &goniometer).call("probe_exit_bin", &inputs).expect("it works");
            let wrong = directions.iter().zip(&outputs).filter(|(m, output)| {
                let place = goniometer.exit.place(m.truncate());
                let near = |t: f64| (t - t.round()).abs() < 3e-7 * f64::from(n) && t > 0.5 && t < f64::from(n) - 0.5;
                let side = usize::from(m.z < 0.0) * (n * n) as usize;
                let in_range = (side..side + (n * n) as usize).contains(&(output[0] as usize));
                let same = output[0] as usize == goniometer.exit_bin(Side::Front, **m, true);
                !in_range || !(same || near(place.x) || near(place.y))
            });
            within(&format!("{regime}, {n}² cells: wrong bins"), "exit_bin", [Some(wrong.count() as f64), None], 0.0);
        }
        // The column of a place that is not held below the last.
        let beyond_last = directions.iter().filter(|m| {
            let xy: Vec2 = m.truncate().as_vec2();
            (xy.length() + 1.0) * 8.0 >= 16.0
        });
        if regime.contains("horizon") {
            let share = beyond_last.count() as f64 / directions.len() as f64;
            beyond(&format!("{regime}, 16² cells: share of wrong bins"), "a column that is not clamped", share, 0.0);
        }
    }
}

#[test]
fn counters_near_two_to_the_32() {
    section("Counters near 2³²");
    let dyed = Cloth { absorption: rgb([20.0, 2.0, 0.1]), ..Cloth::isotropic(1.0) }.lit_from("2");
    let (tables, goniometer) = setup(&dyed);
    let plan = WalkPlan::new(7000, 5000);
    let run = |settings: Settings| {
        let settings = Settings { walks_per_segment: Some(1000), ..settings };
        gpu().run_with(settings, &tables, &goniometer, &plan, &mut |_| {}).expect("it runs").0
    };
    let plain = run(Settings::default());
    for preset in [u32::MAX, u32::MAX - 1000] {
        for (what, settings) in [
            ("bins and moments", Settings { bins_preset: preset, ..Settings::default() }),
            ("sums of events", Settings { sums_preset: preset, ..Settings::default() }),
        ] {
            let differ = f64::from(u8::from(run(settings) != plain));
            let regime = format!("counters from 2³² − {}: tallies that differ", (1u64 << 32) - u64::from(preset));
            within(&regime, what, [Some(differ), None], 0.0);
        }
    }
    let start = u32::MAX - 1000;
    let kept: u64 = plain.bins.iter().map(|&count| u64::from(start.saturating_add(count as u32) - start)).sum();
    let lost = 1.0 - kept as f64 / plain.bins.iter().sum::<u64>() as f64;
    beyond("counters from 2³² − 1001: share of light lost", "bins that stop at 2³²", lost, 0.0);
}

#[test]
fn the_first_and_the_last_seed() {
    section("Seeds");
    let setup = setup(&Cloth::isotropic(1.0).lit_from("[[0, 0]]"));
    let n = walks(40_000);
    for seed in [0, u64::MAX] {
        let tallies = engines().map(|(name, engine)| {
            let tally = engine.run(&setup.0, &setup.1, &WalkPlan::new(seed, n), &mut |_| {}).expect("it runs");
            assert_eq!((tally.origin().seed, tally.origin().engine.as_str()), (seed, name));
            tally
        });
        let [gpu, cpu] = [0, 1].map(|i| Some(Found::share(tallies[i].direct(0), n, (-1f64).exp())));
        right(&format!("seed {seed}"), NULL.name, (-1f64).exp(), gpu, cpu);
        let moved: u64 = tallies[0].bins.iter().zip(&tallies[1].bins).map(|(a, b)| a.abs_diff(*b)).sum::<u64>() / 2;
        let share = moved as f64 / n as f64;
        within(&format!("seed {seed}: walks that end elsewhere on the cpu"), NULL.name, [Some(share), None], 1e-3);
    }
    // A generator whose state is the seed stays at 0.
    let mut state = 0u64;
    let weak = (0..100).filter(|_| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state as f64 * 2f64.powi(-64) < (-1f64).exp()
    });
    fails("seed 0", "xorshift from the seed", (-1f64).exp(), Found::share(weak.count() as u64, 100, (-1f64).exp()));
}

#[test]
fn a_tolerance_that_cannot_be_met() {
    section("Tolerances that cannot be met");
    let place = Place::new();
    for tolerance in ["0", "0.0001%", "-5%", "nan"] {
        let outcome = place.run(&["measure", "felt", &format!("--tolerance={tolerance}")]);
        assert_eq!(outcome.code, Some(2), "{outcome:?}");
        let line = outcome.stderr.lines().find(|line| line.contains("tolerance")).unwrap_or_default();
        refused(&format!("a tolerance of {tolerance}"), "all", line, "must be a share from 0.001% to 100%");
    }
    // Light that meets nothing has no noise to go by.
    let along = Cloth { exit: 4, ..Cloth::new(40.0, &aligned([0.0, 0.0, 1.0])) }.lit_from("[[0, 0]]");
    place.write("along.toml", along.toml());
    let outcome = place.run(&["measure", "along.toml", "--tolerance", "1%"]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let output = format!("{}{}", outcome.stdout, outcome.stderr);
    let line = output.lines().find(|line| line.contains("noise of the scattered")).unwrap_or_default();
    said("a tolerance of 1%, and nothing that scatters", "gpu", line, "unknown: nothing scattered");
}

#[test]
fn fibers_that_absorb_more_than_a_real_index_can_say() {
    section("Absorption beyond a real index");
    let place = Place::new();
    for (sigma, index, warned) in [(2e3, 1.5, false), (2001.0, 1.5, true), (1e5, 1.5, true)] {
        let cloth = Cloth { absorption: format!("{sigma}"), ior: index, exit: 2, ..Cloth::isotropic(1.0) };
        place.write("dark.toml", cloth.lit_from("1").toml());
        for model in ["implicit", "explicit"] {
            let arguments = ["measure", "dark.toml", "--walks", "16", "--engine", "cpu", "--force", "--model", model];
            let outcome = place.run(if model == "implicit" { &arguments[..7] } else { &arguments });
            assert_eq!(outcome.code, Some(0), "{outcome:?}");
            let line = outcome.stderr.lines().find(|line| line.contains("warning: fiber `f` absorbs up to"));
            assert_eq!(line.is_some(), warned, "{model}, {sigma}/mm: {}", outcome.stderr);
            if let Some(line) = line.filter(|_| model == "implicit") {
                said(&format!("absorption of {sigma}/mm"), "all", line, "a real index is not enough");
                // κ = σ λ/4π and Fresnel's law along the normal.
                let kappa = sigma * 550e-6 / (4.0 * PI);
                let reflected = 100.0 * (0.25 + kappa * kappa) / (6.25 + kappa * kappa);
                assert!(
                    line.contains(&format!("is {kappa:.2},")) && line.contains(&format!("{reflected:.2} %")),
                    "{line}"
                );
            }
        }
    }
    place.write("dark.toml", Cloth { absorption: "100001".into(), ..Cloth::isotropic(1.0) }.toml());
    let outcome = place.run(&["measure", "dark.toml"]);
    refused("absorption of 100001/mm", "all", outcome.stderr.trim(), "must be a number from 0 to 100000");
}

/// A sheet of 1 m of fibers of 0.1 µm: the mean free path is 3·10⁻⁷ of it, about a step of f32 at its back.
#[test]
fn sheets_whose_back_lies_far_from_their_front() {
    section("Sheets whose back lies far from their front");
    let length_density = 0.5 / (PI * 1e-8);
    let sheet = Cloth {
        radius_um: 0.1,
        thickness_um: 1e6,
        absorption: "3000".into(),
        exit: 4,
        ..Cloth::new(length_density, ISOTROPIC)
    };
    let sheet = Cloth { sides: "[\"front\", \"back\"]".into(), ..sheet }.lit_from("[[80, 0]]");
    for (method, seed) in METHODS.iter().zip(7100..) {
        let setup = setup(&method.of(&sheet));
        let [gpu, cpu] = engines().map(|(name, engine)| {
            let tally = track(name, engine, &setup, seed, walks(40_000));
            [0, 1].map(|start| mean_light(&tally, start)[0])
        });
        // Both faces are alike, and f64 has places near both.
        let found = |a: (f64, f64), b: (f64, f64)| Some(Found { value: a.0, z: means_z(a, b) });
        let regime = "optical depth 3·10⁶, lit from the back: share reflected";
        right(regime, method.name, cpu[0].0, found(gpu[1], cpu[0]), found(cpu[1], gpu[0]));
    }
    // Cells have heights above the back, fine enough at the front up to a depth of 8192.
    for (method, seed) in METHODS.iter().zip(7110..) {
        let cells = |thickness_um: f64| {
            let base = Cloth { thickness_um, ..method.of(&sheet) };
            let mut cells = CellCloth::new(base, [1, 1, 64], [1.0, 1.0], |_| 1.0);
            cells.factors = vec![if method.separate() { 2.0 } else { 1.0 }; 64];
            cells.prepare()
        };
        let setup = cells(500.0);
        let [gpu, cpu] = engines().map(|(name, engine)| {
            let tally = track(name, engine, &setup, seed, walks(20_000));
            [0, 1].map(|start| mean_light(&tally, start)[0])
        });
        let found = |a: (f64, f64), b: (f64, f64)| Some(Found { value: a.0, z: means_z(a, b) });
        let regime = "64 layers of optical depth 1600, lit from the front: share reflected";
        right(regime, method.name, cpu[1].0, found(gpu[0], cpu[1]), found(cpu[0], gpu[1]));
        if method.name == NULL.name {
            let (tables, goniometer) = cells(3000.0);
            let plan = WalkPlan::new(1, 10);
            let message =
                engines()[0].1.run(&tables, &goniometer, &plan, &mut |_| {}).expect_err("it is too deep").to_string();
            refused("64 layers of optical depth 9500", "gpu", &message, "need finer places than f32 has");
            assert!(engines()[1].1.run(&tables, &goniometer, &plan, &mut |_| {}).is_ok());
        }
    }
    // Isotropic scattering below such a back, in heights above the front.
    let walk = |random: &mut SplitMix, single: bool| {
        let (mut z, mut m, mut weight) = (-1000.0, 0.17, 1.0);
        loop {
            let step: f64 = m * -random.uniform().ln() / (2e-4 * length_density * FRAC_PI_4);
            z += step;
            if single {
                z = f64::from(z as f32);
            }
            if z < -1000.0 {
                return weight;
            }
            weight *= 0.9;
            if weight < 1e-3 {
                return 0.0;
            }
            m = 2.0 * random.uniform() - 1.0;
        }
    };
    let n = walks(100_000);
    let mean = |single: bool| {
        let mut random = SplitMix(7200 + u64::from(single));
        let weights: Vec<f64> = (0..n).map(|_| walk(&mut random, single)).collect();
        mean_error(weights.iter().sum(), weights.iter().map(|w| w * w).sum(), n as f64)
    };
    let (exact, weak) = (mean(false), mean(true));
    let found = Found { value: weak.0, z: means_z(weak, exact) };
    fails(
        "optical depth 3·10⁶, lit from the back: an isotropic scatterer",
        "heights above the front in f32",
        exact.0,
        found,
    );
}
