//! Cuts of the work, counters near their ends, walks that are given up.

use crate::common::stats::{GATE, binomial_z};
use crate::common::{Cloth, aligned, assert_ran, engines, gpu};
use fiberwalk::Error;
use fiberwalk::goniometer::Tally;
use fiberwalk::gpu::{Report, Settings};
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::walk::WalkPlan;

/// Run on the device in a given cut.
fn cut(cloth: &Cloth, plan: &WalkPlan, settings: Settings) -> (Tally, Report) {
    let Prepared { tables, goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
    let result = gpu().run_with(settings, &tables, &goniometer, plan, &mut |_| {});
    result.unwrap_or_else(|error| panic!("{settings:?}: {error}"))
}

#[test]
fn the_tally_does_not_depend_on_how_the_work_is_cut() {
    let cloth = Cloth { incident: "5".into(), ..Cloth::isotropic(4.0) };
    let plan = WalkPlan::new(31, 1003);
    let (whole, _) = cut(&cloth, &plan, Settings::default());
    let few = Settings { lanes: Some(512), budget: Some(256), ..Settings::default() };
    let mut cuts: Vec<Settings> = [1, 8, 13, 64, 256]
        .map(|group| Settings { workgroup: Some(group), lanes: Some(13 * 256), ..Settings::default() })
        .to_vec();
    cuts.extend([64, 192, 4096, 1 << 15].map(|lanes| Settings { lanes: Some(lanes), ..Settings::default() }));
    cuts.extend([7, 100, 1024].map(|budget| Settings {
        budget: Some(budget),
        lanes: Some(1024),
        ..Settings::default()
    }));
    cuts.extend([1, 2, 5, 40].map(|flush| Settings { flush_every: Some(flush), ..few }));
    cuts.extend([1, 16, 100, 999].map(|walks| Settings { walks_per_segment: Some(walks), ..Settings::default() }));
    cuts.extend([1, 7].map(|cells| Settings { starts_per_batch: Some(cells), ..Settings::default() }));
    cuts.extend([true, false].map(|texture| Settings { table_in_texture: Some(texture), ..few }));
    for settings in cuts {
        let (tally, _) = cut(&cloth, &plan, settings);
        assert_eq!(tally, whole, "{settings:?}");
    }
    let (other, _) = cut(&cloth, &WalkPlan::new(32, 1003), Settings::default());
    assert_ne!(other.bins, whole.bins, "another seed gives another tally");
}

#[test]
fn settings_that_no_device_can_do_are_refused() {
    let Prepared { tables, goniometer, .. } = prepare(&Cloth::isotropic(1.0).scene()).expect("the cloth is fine");
    let wrong = [
        Settings { workgroup: Some(512), ..Settings::default() },
        Settings { workgroup: Some(64), lanes: Some(100), ..Settings::default() },
        Settings { budget: Some(0), ..Settings::default() },
        Settings { flush_every: Some(0), ..Settings::default() },
    ];
    for settings in wrong {
        let result = gpu().run_with(settings, &tables, &goniometer, &WalkPlan::new(1, 10), &mut |_| {});
        assert!(matches!(result, Err(Error::Device { .. })), "{settings:?}");
    }
}

#[test]
fn walks_go_on_over_more_than_a_hundred_dispatches() {
    let cloth = Cloth::isotropic(4.0);
    let plan = WalkPlan::new(33, 2000);
    let settings = Settings { lanes: Some(256), budget: Some(32), ..Settings::default() };
    let (tally, report) = cut(&cloth, &plan, settings);
    assert!(report.dispatches > 100 && report.resumed > 1000, "{report:?}");
    assert_eq!(tally, cut(&cloth, &plan, Settings::default()).0);
}

#[test]
fn more_than_65535_events_of_a_lane_lose_nothing() {
    let cloth = Cloth::isotropic(8.0).lit_from("[[35, 20]]");
    let settings = Settings { lanes: Some(64), ..Settings::default() };
    let (tally, report) = cut(&cloth, &WalkPlan::new(34, 1 << 19), settings);
    let per_lane = tally.counts.tentative_events / 64;
    assert!(per_lane > 2 * 65_535, "{per_lane} events of a lane, {report:?}");
    assert_eq!(tally.lost(0), 0);
    assert_eq!(tally.counts.finished, 1 << 19);
}

#[test]
fn bins_carry_past_two_to_the_32() {
    let cloth = Cloth::isotropic(1.0).lit_from("2");
    let plan = WalkPlan::new(35, 5000);
    let (plain, _) = cut(&cloth, &plan, Settings::default());
    assert!(plain.bins.iter().any(|&count| count > 1000), "some bins pass the end");
    for preset in [u32::MAX, u32::MAX - 20, u32::MAX - 1000] {
        let settings = Settings { bins_preset: preset, walks_per_segment: Some(1000), ..Settings::default() };
        assert_eq!(cut(&cloth, &plan, settings).0, plain, "bins preset at {preset}");
        let settings = Settings { sums_preset: preset, walks_per_segment: Some(1000), ..Settings::default() };
        assert_eq!(cut(&cloth, &plan, settings).0, plain, "sums preset at {preset}");
    }
}

#[test]
fn a_run_that_misses_walks_is_an_error() {
    let cloth = Cloth::isotropic(1.0).lit_from("2");
    let Prepared { tables, goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
    let settings = Settings { withheld_blocks: 3, ..Settings::default() };
    let plan = WalkPlan { max_events: 1 << 16, ..WalkPlan::new(36, 5000) };
    let error = gpu().run_with(settings, &tables, &goniometer, &plan, &mut |_| {}).expect_err("walks are missing");
    assert!(matches!(error, Error::Account { ref engine, .. } if engine == "gpu"), "{error}");
    assert_eq!(error.exit_code(), 1);
}

#[test]
fn walks_that_are_given_up_are_counted_alike() {
    let cloth = Cloth::isotropic(8.0);
    for max_events in [1, 2, 17] {
        let plan = WalkPlan { max_events, ..WalkPlan::new(37, 500) };
        let [on_gpu, on_cpu] = engines().map(|(name, engine)| {
            let tally = cloth.run(engine, &plan);
            assert_ran(&tally, name);
            (0..64).map(|cell| tally.lost(cell)).sum::<u64>()
        });
        assert!(on_gpu > 1000 && on_gpu.abs_diff(on_cpu) <= 5, "{max_events}: {on_gpu} and {on_cpu} lost");
    }
}

#[test]
fn more_walks_extend_a_run() {
    let cloth = Cloth::isotropic(2.0).lit_from("3");
    for (name, engine) in engines() {
        let part = |first, walks_per_incident| {
            let tally = cloth.run(engine, &WalkPlan { first, ..WalkPlan::new(38, walks_per_incident) });
            assert_ran(&tally, name);
            tally.bins
        };
        let sum: Vec<u64> = part(0, 700).iter().zip(part(700, 1300)).map(|(a, b)| a + b).collect();
        assert_eq!(sum, part(0, 2000), "{name}");
        // Walk ids beyond 32 bits are other walks, not the same ones again.
        assert_ne!(part(1 << 40, 700), part(0, 700), "{name}");
    }
    let far = |engine: &dyn fiberwalk::walk::Engine| {
        cloth.run(engine, &WalkPlan { first: (1 << 40) - 350, ..WalkPlan::new(38, 700) }).bins
    };
    let moved: u64 = far(engines()[0].1).iter().zip(far(engines()[1].1)).map(|(a, b)| a.abs_diff(b)).sum();
    assert!(moved <= 4, "{moved} counts differ across a carry of the walk id");
}

#[test]
fn a_ray_along_the_fibers_meets_none() {
    for (name, engine) in engines() {
        let cloth = Cloth::new(2000.0, &aligned([0.0, 0.0, 1.0])).lit_from("[[0, 0]]");
        let tally = cloth.run(engine, &WalkPlan::new(39, 10_000));
        assert_ran(&tally, name);
        assert_eq!(tally.direct(0), 10_000, "{name}");
        // A ray that is nearly along the fibers meets few: H = 2 R L sin(0.1°).
        let cloth = cloth.lit_from("[[0.1, 30]]");
        let tally = cloth.run(engine, &WalkPlan::new(40, 100_000));
        let angle = 0.1f64.to_radians();
        let z = binomial_z(tally.direct(0), 100_000, (-2.0 * 0.01 * 2000.0 * angle.tan()).exp());
        assert!(z.abs() < GATE, "{name}: z = {z:.1}");
    }
}

#[test]
fn extreme_sheets_are_measured_and_close_their_accounts() {
    let horizontal = Cloth::new(100.0, &aligned([1.0, 0.0, 0.0]));
    // Rounding grows from hit to hit, so walks of hundreds of hits differ in more cases.
    let cases = [
        ("hardly any fiber", 2e-3, Cloth::isotropic(1e-3)),
        ("very deep", 5e-2, Cloth { exit: 4, thickness_um: 1e4, ..Cloth::isotropic(6.0) }.lit_from("[[60, 10]]")),
        ("high index", 2e-3, Cloth { ior: 4.0, ..Cloth::isotropic(2.0) }),
        ("grazing light", 2e-3, Cloth::isotropic(0.01).lit_from("[[89.9, 45], [89.9, 90], [89.9, 0]]")),
        ("one exit cell", 2e-3, Cloth { exit: 1, ..Cloth::isotropic(1.0) }.lit_from("1")),
        ("light along x on fibers along x", 2e-3, horizontal.lit_from("[[89.9, 0], [89.9, 180], [45, 0]]")),
        ("16 directions", 2e-3, Cloth { directions: 16, ..Cloth::isotropic(1.0) }),
        ("65536 directions", 2e-3, Cloth { directions: 65536, ..Cloth::isotropic(1.0) }),
        ("all at once", 2e-3, Cloth { directions: 65536, exit: 256, ..Cloth::isotropic(1.0) }.lit_from("[[5, 5]]")),
    ];
    for (what, most, cloth) in cases {
        let [on_gpu, on_cpu] = engines().map(|(name, engine)| {
            let tally = cloth.run(engine, &WalkPlan::new(41, 1000));
            assert_ran(&tally, name);
            (0..tally.starts()).for_each(|cell| assert_eq!(tally.lost(cell), 0, "{name}, {what}"));
            tally
        });
        // The same walks: hardly any may end elsewhere.
        let moved: u64 = on_gpu.bins.iter().zip(&on_cpu.bins).map(|(a, b)| a.abs_diff(*b)).sum::<u64>() / 2;
        let walks = on_gpu.counts.launched;
        assert!(moved as f64 <= 2.0 + most * walks as f64, "{what}: {moved} of {walks} walks differ");
    }
}

#[test]
fn jitter_off_is_the_middle_of_each_patch_in_both_engines() {
    let cloth = Cloth { directions: 16, ..Cloth::isotropic(2.0) };
    let plan = WalkPlan { jitter: false, ..WalkPlan::new(42, 2000) };
    let [on_gpu, on_cpu] = engines().map(|(_, engine)| cloth.run(engine, &plan));
    let moved: u64 = on_gpu.bins.iter().zip(&on_cpu.bins).map(|(a, b)| a.abs_diff(*b)).sum::<u64>() / 2;
    assert!(moved < 50, "{moved} of {} walks differ", on_gpu.counts.launched);
    let jittered = cloth.run(engines()[0].1, &WalkPlan { jitter: true, ..plan });
    let changed: u64 = on_gpu.bins.iter().zip(&jittered.bins).map(|(a, b)| a.abs_diff(*b)).sum::<u64>() / 2;
    assert!(changed > 1000, "jitter changes only {changed} walks");
}
