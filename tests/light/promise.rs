//! Errors that are measured on the cloth at hand: media that do not serve a cloth are found out, and so are media that are tampered with.

use crate::common::gpu;
use fiberwalk::bsdf::{Kept, Verdict};
use fiberwalk::measure::{AgainstFibers, Prepared, prepare};
use fiberwalk::plan::{Beside, Configuration, EngineClass, Extent, Pilot, Plan, plan};
use fiberwalk::scene::{Medium, Scene, Source};
use fiberwalk::tables::SamplingTables;
use fiberwalk::walk::{WalkPlan, Walker};

/// Cloths unlike the presets, on which E of a medium of 4 R is 25, 9 and 6.5 % against the fibers, as an independent tracer confirms:
/// a mesh of single filaments, yarns of seven twisted filaments, a dense twill of two plies that absorbs.
const MESH: &str = "[fiber.a]\nradius_um = 30\nior = 1.55\nabsorption_per_mm = 10
[yarn.A]\nfiber = \"a\"\nfibers_per_ply = 1\nwidth_um = 62\nheight_um = 62\nply_twist_per_m = 0
[weave]\ndraft = [\"X.\", \".X\"]\nwarp = [\"A\"]\nweft = [\"A\"]\nends_per_cm = 80\npicks_per_cm = 80\n";
const SEVEN: &str = "[fiber.a]\nradius_um = 10\nior = 1.55\nabsorption_per_mm = 0
[yarn.A]\nfiber = \"a\"\nfibers_per_ply = 7\nwidth_um = 80\nheight_um = 60\nply_twist_per_m = 400
[weave]\ndraft = [\"X.\", \".X\"]\nwarp = [\"A\"]\nweft = [\"A\"]\nends_per_cm = 70\npicks_per_cm = 70\n";
const TWO_PLY: &str = "[fiber.a]\nradius_um = 8\nior = 1.55\nabsorption_per_mm = 3
[yarn.A]\nfiber = \"a\"\nplies = 2\nfibers_per_ply = 11\nwidth_um = 180\nheight_um = 120\nply_twist_per_m = 700\ntwist_per_m = -400
[weave]\ndraft = [\"XX.\", \"X.X\", \".XX\"]\nwarp = [\"A\"]\nweft = [\"A\", \"A\"]\nends_per_cm = 45\npicks_per_cm = 38
warp_crimp_share = 0.3\n";
/// Monofilaments beside a spun yarn: cells of the usual edge would be 2.5 times full.
const MIXED: &str = "[fiber.mono]\nradius_um = 60\nior = 1.55\nabsorption_per_mm = 1
[fiber.wool]\nradius_um = 10\nior = 1.55\nabsorption_per_mm = 1
[yarn.M]\nfiber = \"mono\"\nfibers_per_ply = 1\nwidth_um = 130\nheight_um = 130
[yarn.W]\nfiber = \"wool\"\nfibers_per_ply = 60\nwidth_um = 220\nheight_um = 160\nply_twist_per_m = 400
[weave]\ndraft = [\"X.\", \".X\"]\nwarp = [\"M\"]\nweft = [\"W\"]\nends_per_cm = 30\npicks_per_cm = 24\n";

fn scene(text: &str) -> Scene {
    let source = Source { file: "cloth.toml".into(), stem: "cloth".into(), text: text.into(), folder: None };
    Scene::parse(&source).unwrap_or_else(|error| panic!("{error}"))
}

fn preset(name: &str) -> Scene {
    let mut scene = Scene::parse(&Source::find(name).expect("a preset")).expect("it is right");
    scene.model.set_from_flag("packing", "random").expect("it is a packing");
    scene
}

/// The plan of a long run at 5 %.
fn planned(scene: &Scene) -> Plan {
    let mut scene = scene.clone();
    scene.measure.set_from_flag("incident", "8").expect("a basis");
    scene.measure.set_from_flag("exit", "16").expect("a basis");
    let extent = Extent::of(&scene).expect("it can be laid out");
    let engine = (gpu() as &dyn fiberwalk::walk::Engine, EngineClass::SoftwareGpu);
    plan(&scene, &extent, 0.05, engine, 1, true, false).expect("there is a plan").0
}

#[test]
fn cloths_that_no_medium_serves_are_walked_through_fiber_by_fiber() {
    for (name, text) in [("mesh", MESH), ("two_ply", TWO_PLY)] {
        let plan = planned(&scene(text));
        println!("{name}: {}", plan.lines().join("; "));
        assert_eq!(plan.configuration().model.medium, Medium::Explicit, "{name}: {}", plan.reason);
        assert!(
            plan.reason.starts_with("fibers: the medium is off by") || plan.reason.contains("do not tell"),
            "{}",
            plan.reason
        );
    }
}

/// A cloth that a medium serves gets one, whose error was measured on it; yarns of few filaments one of fine cells.
#[test]
fn cloths_that_a_medium_serves_get_one_that_is_fine_enough() {
    for (name, scene, finest) in [("muslin", preset("muslin"), 4.0), ("seven", scene(SEVEN), 1.4)] {
        let plan = planned(&scene);
        println!("{name}: {}", plan.lines().join("; "));
        assert_eq!(plan.configuration().model.medium, Medium::Implicit, "{}", plan.reason);
        assert!(plan.configuration().edge.is_some_and(|edge| edge <= finest), "{name}: {}", plan.chosen);
        let kept = plan.interval.is_some_and(|[_, high]| high <= 0.05) && plan.reason.contains("keeps 5 %");
        assert!(kept, "{name}: {}", plan.reason);
    }
}

#[test]
fn nothing_is_refused_that_the_fibers_can_do() {
    let scene = scene(MIXED);
    let error = prepare(&scene).expect_err("its cells are too full").to_string();
    let plan = planned(&scene);
    println!("{error}; {}", plan.lines().join("; "));
    assert!(
        plan.candidates.iter().any(|one| one.refused.is_some())
            || plan.configuration().model.medium == Medium::Implicit
    );
    assert!(plan.candidates.iter().any(|one| one.name == plan.chosen && one.walk_seconds.is_some()), "{}", plan.reason);
}

/// What a pilot says of a medium of so many times its lengths.
fn verdict(scene: &Scene, walks: f64, factor: f64) -> Verdict {
    let mut scene = scene.clone();
    scene.measure.set_from_flag("incident", "8").expect("a basis");
    let extent = Extent::of(&scene).expect("it can be laid out");
    let configuration = Configuration::of(&scene, &extent).edged(4.0).without_rays();
    let medium = configuration.apply(&scene, &extent);
    let Prepared { mut specific_length, .. } = prepare(&medium).expect("it can be counted");
    specific_length.values.iter_mut().for_each(|cell| cell.surface *= factor);
    let tables = SamplingTables::new(&medium, &specific_length).expect("it is no fuller than it may be");
    let pilot = Pilot::new(&scene, extent.realizer(), 1, |_, _| walks).expect("it can be drawn");
    pilot.hold(&mut Beside::default(), &tables, gpu()).expect("it runs")
}

#[test]
fn a_pilot_finds_a_medium_that_is_tampered_with() {
    for (name, walks) in [("voile", 3e5), ("lining", 4e5)] {
        let scene = preset(name);
        let right = verdict(&scene, walks, 1.0);
        let bent = verdict(&scene, walks, 1.3);
        println!("{name}: {:?}, lengths × 1.3 {:?}", right.interval(), bent.interval());
        assert_eq!(right.kept(0.05), Kept::Yes, "{name}: {:?} {:?}", right.interval(), right.broken(0.05));
        assert_eq!(bent.kept(0.05), Kept::No, "{name}: {:?} {:?}", bent.interval(), bent.broken(0.05));
    }
}

#[test]
fn the_check_at_the_end_finds_a_medium_that_is_tampered_with() {
    let mut scene = preset("muslin");
    scene.measure.set_from_flag("incident", "[[3, 35], [30, 20], [60, 12], [60, 55]]").expect("directions");
    scene.model.set_from_flag("cells", "48x48x12").expect("cells");
    let prepared = prepare(&scene).expect("it can be counted");
    let check = |factor: f64| {
        let mut length = prepared.specific_length.clone();
        length.values.iter_mut().for_each(|cell| cell.surface *= factor);
        let tables = SamplingTables::new(&scene, &length).expect("it is no fuller than it may be");
        let bent = Prepared { tables, ..prepared.clone() };
        let tally = bent.with(gpu()).run(&bent.goniometer, &WalkPlan::new(3, 60_000), &mut |_| {}).expect("it runs");
        AgainstFibers::new(&scene, &bent, &tally, 3).expect("it runs").expect("they are cheap").verdict()
    };
    let (right, bent) = (check(1.0), check(1.4));
    println!("{:?} {:?}", right.interval(), bent.interval());
    assert!(right.kept(0.05) != Kept::No, "{:?} {:?}", right.interval(), right.broken(0.05));
    assert_eq!(bent.kept(0.05), Kept::No, "{:?} {:?}", bent.interval(), bent.broken(0.05));
}
