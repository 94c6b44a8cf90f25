//! Lossless sheets so deep that walks make thousands of events.

use super::table::{Found, METHODS, NULL, TABULATED, fails, right, scattered, section, setup, track, walks};
use crate::common::stats::mean_error;
use crate::common::{Cloth, ISOTROPIC, assert_ran, engines, gpu};
use fiberwalk::goniometer::Goniometer;
use fiberwalk::gpu::Settings;
use fiberwalk::reference::replay;
use fiberwalk::tables::SamplingTables;
use fiberwalk::walk::WalkPlan;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_4;

/// Isotropic fibers of 0.1 µm in a sheet of 1 mm.
fn deep(depth: f64) -> Cloth {
    let length_density = depth / (2e-4 * FRAC_PI_4);
    Cloth { radius_um: 0.1, exit: 4, ..Cloth::new(length_density, ISOTROPIC) }
}

/// Mean number of hits of a walk and its standard error; walks are lost after so many events.
fn hits(name: &str, setup: &(SamplingTables, Goniometer), seed: u64, walks: u64, max_events: u32) -> (f64, f64) {
    let plan = WalkPlan { max_events, ..WalkPlan::new(seed, walks) };
    let hits: Vec<u32> = if name == "gpu" {
        let (tally, records) = gpu().trace(Settings::default(), &setup.0, &setup.1, &plan).expect("it runs");
        assert_ran(&tally, name);
        records.iter().map(|record| record.hits).collect()
    } else {
        (0..walks).into_par_iter().map(|i| replay(&setup.0, &setup.1, &plan, 0, i).walked.record.hits).collect()
    };
    let sum = |power: i32| hits.iter().map(|&hits| f64::from(hits).powi(power)).sum::<f64>();
    mean_error(sum(1), sum(2), walks as f64)
}

/// Diffuse light makes 2 d of way on the average inside a sheet without absorption, however it is scattered (Blanco and
/// Fournier, "An invariance property of diffusive random walks", Europhysics Letters 61, 2003): 2 H d hits.
#[test]
fn diffuse_light_hits_as_many_fibers_as_the_sheet_is_deep() {
    section("Diffuse light in deep lossless sheets");
    for (depth, usual, seed) in [(30.0, 20_000, 5000), (1000.0, 2_000, 5100)] {
        let regime = format!("optical depth {depth}: mean number of hits");
        let cloth = deep(depth).lit_from("1");
        for (method, seed) in [NULL, TABULATED].iter().zip(seed..) {
            let setup = setup(&method.of(&cloth));
            let found = |name: &str, seed: u64, n: u64| {
                let (value, error) = hits(name, &setup, seed, n, 1 << 24);
                Found { value, z: (value - 2.0 * depth) / error }
            };
            let gpu = found("gpu", seed, walks(usual));
            let cpu = (depth < 100.0).then(|| found("cpu", seed + 10, walks(usual / 4)));
            right(&regime, method.name, 2.0 * depth, Some(gpu), cpu);
        }
    }
    let setup = setup(&deep(30.0).lit_from("1"));
    let (value, error) = hits("gpu", &setup, 5200, walks(20_000), 256);
    let found = Found { value, z: (value - 60.0) / error };
    fails("optical depth 30: mean number of hits", "at most 256 events", 60.0, found);
}

/// 1/T of deep sheets without absorption is linear in their depth.
#[test]
fn the_transmittance_of_deep_sheets_falls_as_their_depth() {
    section("Transmittance of deep lossless sheets");
    for (method, seed) in METHODS.iter().zip((5300..).step_by(10)) {
        let sheet = |depth: f64| setup(&method.of(&deep(depth).lit_from("[[20, 30]]")));
        let through = |name: &str, depth: f64, seed: u64, n: u64| {
            let engine = engines().into_iter().find(|(known, _)| *known == name).expect("there is one").1;
            let tally = track(name, engine, &sheet(depth), seed, n);
            let [reflected, transmitted] = scattered(&tally, 0);
            assert_eq!(reflected + transmitted + tally.direct(0), n, "{name}: light was lost");
            (transmitted as f64, n as f64)
        };
        // 1/T and its variance.
        let inverse = |(count, n): (f64, f64)| (n / count, (n / count).powi(2) * (1.0 - count / n) / count);
        let [near, far] = [(20.0, seed, 40_000), (80.0, seed + 1, 12_000)]
            .map(|(depth, seed, n)| inverse(through("gpu", depth, seed, walks(n))));
        let at = (1000.0 - 20.0) / 60.0;
        let inverse = near.0 + (far.0 - near.0) * at;
        let error = ((1.0 - at).powi(2) * near.1 + at * at * far.1).sqrt() / inverse;
        let found = |(count, n): (f64, f64)| {
            // The root of a small count has a variance of a quarter.
            let expected = n / inverse;
            let z = 2.0 * (count.sqrt() - expected.sqrt()) / (1.0 + expected * error * error).sqrt();
            Found { value: count / n, z }
        };
        let gpu = found(through("gpu", 1000.0, seed + 2, walks(2000)));
        let cpu = (method.name == NULL.name).then(|| found(through("cpu", 1000.0, seed + 3, walks(1500))));
        right("optical depth 1000: share transmitted", method.name, 1.0 / inverse, Some(gpu), cpu);
    }
}
