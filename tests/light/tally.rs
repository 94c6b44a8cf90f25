//! Tallies as files: identical runs give identical bytes, shards add up exactly, broken files are refused.

use crate::common::{Cloth, ISOTROPIC, Kind, assert_ran, engines, gpu, rgb};
use fiberwalk::goniometer::Tally;
use fiberwalk::gpu::Settings;
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::results::{About, Stored, write_tally};
use fiberwalk::walk::WalkPlan;
use std::fs::{self, File};
use std::path::Path;

/// Dyed fibers of two kinds with ends, lit from both sides: every integer of a tally is there.
fn dyed() -> Cloth {
    let kind = Kind {
        radius_um: 5.0,
        ior: 1.33,
        absorption: rgb([40.0, 3.0, 0.0]),
        length_density: 60.0,
        orientation: ISOTROPIC.into(),
    };
    Cloth {
        absorption: rgb([0.0, 90.0, 4.0]),
        ior: 1.3,
        more_kinds: vec![kind],
        length_over_radius: 4.0,
        sides: "[\"front\", \"back\"]".into(),
        exit: 4,
        ..Cloth::isotropic(4.0)
    }
    .lit_from("3")
}

fn lossless() -> Cloth {
    Cloth { exit: 6, ..Cloth::isotropic(1.0) }.lit_from("[[20, 30], [60, -45]]")
}

fn bytes(cloth: &Cloth, tally: &Tally) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let path = folder.path().join("tally.exr");
    write_tally(&mut File::create(&path).expect("a file can be made"), &About::new(&cloth.scene()), tally)
        .expect("it can be written");
    fs::read(path).expect("it can be read")
}

fn stored(cloth: &Cloth, tally: Tally) -> Stored {
    Stored { about: About::new(&cloth.scene()), tally }
}

#[test]
fn identical_runs_give_identical_bytes_however_they_are_cut() {
    for cloth in [dyed(), lossless()] {
        let Prepared { tables, goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
        let plan = WalkPlan::new(7, 500);
        let cut = |settings: Settings, plan: &WalkPlan| {
            let tally = gpu().run_with(settings, &tables, &goniometer, plan, &mut |_| {}).expect("the device works").0;
            bytes(&cloth, &tally)
        };
        let whole = cut(Settings::default(), &plan);
        let few = Settings {
            lanes: Some(128),
            walks_per_segment: Some(96),
            starts_per_batch: Some(2),
            ..Settings::default()
        };
        assert!(cut(few, &plan) == whole, "another cut gives other bytes");
        assert!(cut(few, &WalkPlan::new(8, 500)) != whole, "another seed gives the same bytes");
        let threads = |n: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads can be made");
            pool.install(|| bytes(&cloth, &cloth.run(engines()[1].1, &plan)))
        };
        assert!(threads(1) == threads(3), "the number of threads shows");
    }
}

#[test]
fn a_file_gives_back_every_integer() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    for cloth in [dyed(), lossless()] {
        for (name, engine) in engines() {
            let tally = cloth.run(engine, &WalkPlan { first: 1 << 33, ..WalkPlan::new(u64::MAX, 300) });
            assert_ran(&tally, name);
            fs::write(folder.path().join("tally.exr"), bytes(&cloth, &tally)).expect("it can be written");
            let read = Stored::read(folder.path()).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(read, stored(&cloth, tally));
        }
    }
}

#[test]
fn shards_add_up_to_the_whole_in_any_order() {
    for cloth in [dyed(), lossless()] {
        for (name, engine) in engines() {
            let part = |first, walks_per_incident| {
                let tally = cloth.run(engine, &WalkPlan { first, ..WalkPlan::new(9, walks_per_incident) });
                assert_ran(&tally, name);
                stored(&cloth, tally)
            };
            let whole = part(0, 900);
            let shards = [part(0, 100), part(100, 450), part(550, 350)];
            for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
                let mut sum = shards[order[0]].clone();
                sum.merge(&shards[order[1]]).expect("they are disjoint");
                sum.merge(&shards[order[2]]).expect("they are disjoint");
                assert_eq!(sum, whole, "{name}, {order:?}");
                assert!(bytes(&cloth, &sum.tally) == bytes(&cloth, &whole.tally));
            }
            let mut twice = whole.clone();
            let error = twice.merge(&shards[1]).expect_err("walks would count twice").to_string();
            assert!(error.contains("walks 100 to 549 of seed 9"), "{error}");
            assert_eq!(twice, whole, "a merge that fails changes nothing");
        }
    }
}

#[test]
fn tallies_of_other_seeds_add_and_of_other_cloths_do_not() {
    let run = |cloth: &Cloth, seed| stored(cloth, cloth.run(engines()[1].1, &WalkPlan::new(seed, 200)));
    let mut sum = run(&lossless(), 1);
    sum.merge(&run(&lossless(), 2)).expect("they share no walk");
    assert_eq!(sum.tally.walks_per_incident(), 400);
    sum.tally.check(400).expect("the account closes");
    let denser = Cloth { thickness_um: 1001.0, ..lossless() };
    let error = sum.merge(&run(&denser, 3)).expect_err("another cloth").to_string();
    assert!(error.contains("differ in `cloth`"), "{error}");
}

#[test]
fn a_file_that_was_cut_or_changed_is_refused() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let cloth = dyed();
    let mut tally = cloth.run(engines()[1].1, &WalkPlan::new(3, 200));
    let whole = bytes(&cloth, &tally);
    let complaint = |bytes: &[u8], what: &str| {
        let path = folder.path().join("t.exr");
        fs::write(&path, bytes).expect("it can be written");
        let error = Stored::read(Path::new(&path)).expect_err(what);
        assert_eq!(error.exit_code(), 2, "{error}");
        error.to_string()
    };
    for length in [0, 4, 100, whole.len() / 2, whole.len() - 1] {
        complaint(&whole[..length], "a cut file");
    }
    complaint(b"not an image", "another file");
    // One walk more in a bin: the account does not close.
    tally.bins[5] += 1;
    let error = complaint(&bytes(&cloth, &tally), "a changed bin");
    assert!(error.contains("account does not close"), "{error}");
    tally.bins[5] -= 1;
    tally.weights.as_mut().expect("it has weights").moments[3].sum += 1;
    let error = complaint(&bytes(&cloth, &tally), "a changed weight");
    assert!(error.contains("units of light"), "{error}");
}
