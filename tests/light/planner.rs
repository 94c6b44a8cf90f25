//! Plans meet their tolerance against the fibers themselves, do not depend on the clock, and go wrong when they are tampered with.

use crate::common::gpu;
use fiberwalk::bsdf::{Distance, distance};
use fiberwalk::goniometer::Tally;
use fiberwalk::plan::{Configuration, EngineClass, Extent, Plan, Trial, plan};
use fiberwalk::scene::{Medium, Scene, Source};
use std::sync::{LazyLock, Mutex, OnceLock};

/// Directions in no plane of the yarns.
const DIRECTIONS: &str = "[[17, 25], [30, 160], [40, 295], [50, 70], [60, 205], [73, 340]]";
/// Walks of each direction and block.
const WALKS: u64 = 8192;

struct Case {
    scene: Scene,
    extent: Extent,
    fibers: OnceLock<Vec<Tally>>,
    /// Of configurations from the fibers, as far as they are known.
    distances: Mutex<Vec<(Configuration, Distance)>>,
}

/// The presets, for all tests.
static SHEER: LazyLock<Case> = LazyLock::new(|| Case::new("sheer"));
static LINING: LazyLock<Case> = LazyLock::new(|| Case::new("lining"));
static NONWOVEN: LazyLock<Case> = LazyLock::new(|| Case::new("nonwoven"));

/// A scene, measured from as many directions and in as many exit cells as make a run some times as long as it takes to prepare a
/// medium: the finer the tolerance, the fewer.
fn long(scene: &Scene, tolerance: f64) -> Scene {
    let mut scene = scene.clone();
    let (incident, exit) = if tolerance < 0.03 { ("3", "8") } else { ("8", "16") };
    scene.measure.set_from_flag("incident", incident).expect("it is fine");
    scene.measure.set_from_flag("exit", exit).expect("it is fine");
    scene
}

impl Case {
    /// Of a preset whose fibers may overlap, which are quick to draw.
    fn new(name: &str) -> Case {
        let mut scene = Scene::parse(&Source::find(name).expect("a preset")).expect("it is fine");
        scene.measure.set_from_flag("incident", DIRECTIONS).expect("they are fine");
        scene.measure.set_from_flag("exit", "8").expect("it is fine");
        scene.model.set_from_flag("packing", "random").expect("it is fine");
        let extent = Extent::of(&scene).expect("it can be laid out");
        Case { scene, extent, fibers: OnceLock::new(), distances: Mutex::default() }
    }

    /// The plan of a long run from the whole hemisphere, which is worth the tables of a medium.
    fn plan(&self, tolerance: f64, fibers: bool) -> Plan {
        let engine = (gpu() as &dyn fiberwalk::walk::Engine, EngineClass::SoftwareGpu);
        plan(&long(&self.scene, tolerance), &self.extent, tolerance, engine, 1, fibers, false)
            .expect("there is a plan")
            .0
    }

    /// Light through the fibers themselves.
    fn fibers(&self) -> &[Tally] {
        self.fibers.get_or_init(|| self.blocks(Configuration::fibers(&self.scene, 1024), 1))
    }

    fn blocks(&self, configuration: Configuration, seed: u64) -> Vec<Tally> {
        let trial = Trial::prepare(&self.scene, &self.extent, configuration).expect("it can be prepared");
        let seed = trial.configuration().seed(seed);
        let blocks = trial.blocks(gpu(), seed, 0, WALKS).expect("it runs");
        blocks.into_iter().map(|block| block.tally).collect()
    }

    /// √(noise² + E²) of a configuration against the fibers, three standard errors of E² low and high, at the planned noise.
    fn error(&self, configuration: Configuration, noise: f64) -> [f64; 2] {
        if configuration.model.medium == Medium::Explicit {
            return [noise; 2];
        }
        let mut distances = self.distances.lock().expect("nobody failed");
        let known = distances.iter().find(|(known, _)| *known == configuration).map(|(_, found)| *found);
        let found = known.unwrap_or_else(|| {
            let found = distance(&self.blocks(configuration, 2), self.fibers()).expect("they are alike");
            distances.push((configuration, found));
            found
        });
        [-3.0, 3.0].map(|z| (noise * noise + (found.square + z * found.square_error).max(0.0)).sqrt())
    }
}

#[test]
fn plans_meet_their_tolerance() {
    for (name, case) in [("sheer", &SHEER), ("lining", &LINING), ("nonwoven", &NONWOVEN)] {
        for tolerance in [0.1, 0.05, 0.02] {
            let plan = case.plan(tolerance, true);
            let [low, _] = case.error(*plan.configuration(), plan.noise);
            println!("{name}, {tolerance}: {}, noise {:.4}, error from {low:.4}", plan.chosen, plan.noise);
            // A plan that is right is called wrong once in 700.
            assert!(low <= tolerance, "{name}, {tolerance}: {plan:?} has an error of {low} at least");
            let measured = plan.configuration().model.medium == Medium::Explicit || plan.interval.is_some();
            assert!(measured && plan.interval.is_none_or(|[_, high]| high <= tolerance), "{plan:?}");
        }
    }
}

#[test]
fn a_plan_whose_cells_are_halved_in_number_does_not_meet_it() {
    let plan = LINING.plan(0.1, false);
    let edge = plan.configuration().edge.expect("a medium of cells is planned");
    let [planned, _] = LINING.error(*plan.configuration(), plan.noise);
    assert!(planned <= 0.1, "as planned the error is {planned} at least");
    let [low, high] = LINING.error(plan.configuration().edged(2.0 * edge), plan.noise);
    println!(
        "{}: noise {:.4}; with cells twice as wide the error is from {low:.4} to {high:.4}",
        plan.chosen, plan.noise
    );
    assert!(low > 0.1, "with cells twice as wide the error is {low}");
}

#[test]
fn plans_are_made_alike_however_long_they_take() {
    let [a, b] = [SHEER.plan(0.05, true), SHEER.plan(0.05, true)];
    assert_eq!(a.summary(), b.summary());
    assert!(a.pilot_walks > 0);
}

#[test]
fn without_the_fibers_to_choose_a_medium_is_taken_and_it_is_said_that_none_does() {
    let plan = SHEER.plan(0.002, false);
    assert_eq!(plan.configuration().model.medium, Medium::Implicit);
    assert!(plan.reason.starts_with("no medium is sure to keep it"), "{}", plan.reason);
}

/// Where separate fibers of a sheet take too long to be drawn, the medium that every other stop rule takes is taken, and it is said
/// what is not known.
#[test]
fn without_a_pilot_the_usual_medium_is_taken_and_its_error_is_stated() {
    let scene = Scene::parse(&Source::find("felt").expect("a preset")).expect("it is fine");
    let extent = Extent::of(&scene).expect("it can be laid out");
    let planned = |tolerance| {
        let engine = (gpu() as &dyn fiberwalk::walk::Engine, EngineClass::SoftwareGpu);
        plan(&scene, &extent, tolerance, engine, 1, true, true).expect("there is a plan").0
    };
    let (loose, tight) = (planned(0.1), planned(0.05));
    for plan in [&loose, &tight] {
        assert_eq!(plan.apply(&scene, &extent).model, scene.model);
        assert!(plan.model_error.value > 0.05 && plan.reason.contains("of other cloths 5.8"), "{}", plan.reason);
    }
    assert!(loose.noise < 0.08 && tight.noise == 0.05);
    let held = |plan: &Plan| plan.reason.contains("the noise alone is held to the tolerance");
    assert!(held(&tight) && !held(&loose));
}
