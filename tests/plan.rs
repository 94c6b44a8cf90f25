//! Trials of a configuration, and the error budget.

mod common;

use fiberwalk::bsdf::{Distance, distance};
use fiberwalk::goniometer::Tally;
use fiberwalk::plan::{BLOCKS, Budget, Configuration, Extent, Part, Trial};
use fiberwalk::reference::Reference;
use fiberwalk::scene::{Placement, Scene, Source};

fn voile() -> (Scene, Extent) {
    let mut scene = Scene::parse(&Source::find("voile").expect("a preset")).expect("it is fine");
    scene.measure.set_from_flag("incident", "[[0, 0], [60, 45]]").expect("a list");
    scene.measure.set_from_flag("exit", "4").expect("a number");
    let extent = Extent::of(&scene).expect("it can be laid out");
    (scene, extent)
}

fn tallies(trial: &Trial, seed: u64, made: u64, walks: u64) -> Vec<Tally> {
    let blocks = trial.blocks(&Reference, seed, made, walks).expect("they can be walked");
    assert!(blocks.iter().all(|block| block.seconds > 0.0));
    blocks.into_iter().map(|block| block.tally).collect()
}

#[test]
fn budget_prints() {
    let (scene, extent) = voile();
    let base = Configuration::of(&scene, &extent).edged(8.0);
    let started = std::time::Instant::now();
    let budget = Budget::measure(&scene, &extent, base, &Reference, 1, 4096).expect("voile");
    println!("{:.1} s {}", started.elapsed().as_secs_f64(), budget.configuration);
    for part in budget.parts {
        println!("{:?} {}: {:?} {:?}", part.part, part.change, part.size, part.missing);
    }
}
