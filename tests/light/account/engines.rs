//! Both engines find the same light, however the work is cut.

use super::cloths::{DYES, two_dyes};
use crate::common::stats::{GATE, chi2_z, largest, means_z};
use crate::common::{Cloth, assert_ran, engines, gpu, mean_light, run};
use fiberwalk::goniometer::{Outcome, Tally};
use fiberwalk::gpu::Settings;
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::reference::Reference;
use fiberwalk::walk::WalkPlan;

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
