//! The engines against each other on a knit with hairs.

use crate::common::stats::{GATE, two_tally_z};
use crate::common::{assert_ran, gpu};
use fiberwalk::goniometer::{Goniometer, Tally};
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::reference::Reference;
use fiberwalk::scene::{Scene, Source};
use fiberwalk::tables::SamplingTables;
use fiberwalk::walk::{Engine, WalkPlan};

/// A jersey of few coarse fibers, and a rib of the same. Walks take no rays through fibers, so none are made.
fn scene(structure: &str, index: f64) -> Scene {
    let wales = if structure == "rib" { 20.0 } else { 10.5 };
    let text = format!(
        "[fiber.wool]\nradius_um = 10\nior = {index}\n[yarn.wool]\nfiber = \"wool\"\nfibers_per_ply = 30\nwidth_um = 210\n\
         height_um = 210\nply_twist_per_m = 400\nflyaways = {{ hairs_per_mm = 3, hair_length_um = [200, 50], \
         hair_rise_deg = [20, 5] }}\n[knit]\nstructure = \"{structure}\"\nyarn = \"wool\"\ncourses_per_cm = 13\n\
         wales_per_cm = {wales}\nloop_length_mm = 4\n[model]\ncells = [24, 24, 8]\ndirect = \"walks\"\nfirst_hit = \"medium\"\n[measure]\nincident = [[10, 20], [50, 200]]\nexit = 12\n"
    );
    let source = Source { file: "cloth.toml".into(), stem: "cloth".into(), text, folder: None };
    Scene::parse(&source).expect("it is right")
}

fn measured(tables: &SamplingTables, goniometer: &Goniometer, engine: &dyn Engine, name: &str, seed: u64) -> Tally {
    let plan = WalkPlan::new(seed, 60_000);
    let tally = engine.run(tables, goniometer, &plan, &mut |_| {}).expect("it runs");
    assert_ran(&tally, name);
    tally
}

#[test]
fn both_engines_see_the_same_knit_and_not_one_of_another_index() {
    // Factors of the index that stand at 8 to 10 σ of this comparison.
    for (structure, factor) in [("jersey", 1.06), ("rib", 1.06)] {
        let Prepared { tables, goniometer, specific_length, .. } = prepare(&scene(structure, 1.55)).expect("it fits");
        let on_cpu = measured(&tables, &goniometer, &Reference, "cpu", 42);
        let z = |tables: &SamplingTables| two_tally_z(&measured(tables, &goniometer, gpu(), "gpu", 41), &on_cpu);
        let same = z(&tables);
        assert!(same.abs() < GATE, "{structure}: z = {same:.1}");
        // The fibers lie where they lay.
        let bent = scene(structure, 1.55 * factor);
        let bent = z(&SamplingTables::new(&bent, &specific_length).expect("it is fine"));
        println!("{structure}, index × {factor}: z = {bent:.1}, of the same {same:.1}");
        assert!(bent > GATE, "{structure}: z = {bent:.1}");
    }
}
