//! What walks remember of their last flight: light that comes back from a fiber flies through a corridor that it knows to be free,
//! and may meet the fiber that sent it.

use crate::common::{Cloth, aligned, gpu, mean_light, run};
use fiberwalk::explicit::Explicit;
use fiberwalk::goniometer::{Goniometer, Tally};
use fiberwalk::walk::{WalkPlan, Walker};
use std::f64::consts::PI;

/// Directions of light in degrees. Fibers along x have the same light from the three others that each is mirrored to: all of them share
/// the realizations, which take longer to draw than to walk through.
const DIRECTIONS: [[f64; 2]; 3] = [[20.0, 85.0], [50.0, 60.0], [65.0, 80.0]];
const MIRRORED: usize = 4;
/// Walks of each mirrored direction through the fibers, twice as many through fibers drawn anew, and through the medium.
const WALKS: [u64; 2] = [1 << 16, 1 << 17];
/// One comparison in 16 000 of a right program is off by more.
const SIGMAS: f64 = 4.0;

/// Fibers along x, laid at random, of radius 10 µm, that fill half of a sheet of depth 4.
fn parallel(absorption: &str) -> Cloth {
    let length = 0.5 / (PI * 0.01 * 0.01);
    let mirrored = DIRECTIONS.map(|[theta, phi]| [phi, 180.0 - phi, -phi, phi - 180.0].map(|phi| [theta, phi]));
    Cloth {
        absorption: absorption.into(),
        thickness_um: 1e3 * 4.0 / (2.0 * 0.01 * length),
        exit: 8,
        ..Cloth::new(length, &aligned([1.0, 0.0, 0.0]))
    }
    .lit_from(&format!("{:?}", mirrored.as_flattened()))
    .placed("carried")
}

/// Reflected and transmitted light of each direction, the mean over those it is mirrored to.
fn light(tally: &Tally) -> Vec<Vec<(f64, f64)>> {
    let of = |direction: usize| {
        let each: Vec<_> = (0..MIRRORED).map(|image| mean_light(tally, MIRRORED * direction + image)).collect();
        let mean = |part: usize| {
            let sum = each.iter().fold((0.0, 0.0f64), |sum, light| (sum.0 + light[part].0, sum.1.hypot(light[part].1)));
            (sum.0 / MIRRORED as f64, sum.1 / MIRRORED as f64)
        };
        (0..each[0].len()).map(mean).collect()
    };
    (0..DIRECTIONS.len()).map(of).collect()
}

/// Reflected and transmitted light of each direction through the fibers, or through others after each hit, with errors that know of
/// realizations.
fn through_fibers(cloth: &Cloth, anew: bool) -> Vec<Vec<(f64, f64)>> {
    let scene = cloth.scene();
    let explicit = Explicit::new(&scene).expect("they can be laid");
    let explicit = if anew { explicit.anew() } else { explicit };
    let goniometer = Goniometer::new(&scene.measure);
    let tally =
        explicit.run(&goniometer, &WalkPlan::new(7, WALKS[0] << u32::from(anew)), &mut |_| {}).expect("it runs");
    let factor = explicit.clustering(&tally).map_or(1.0, |found| found.reflectance.max(found.transmittance).max(1.0));
    let widened =
        |light: Vec<(f64, f64)>| light.into_iter().map(|(mean, error)| (mean, error * factor.sqrt())).collect();
    light(&tally).into_iter().map(widened).collect()
}

/// The largest deviation of the medium from the fibers, in standard errors.
fn off(cloth: &Cloth, fibers: &[Vec<(f64, f64)>]) -> f64 {
    // Both engines walk alike (tests/light/lockstep.rs).
    let tally = run("gpu", gpu(), cloth, &WalkPlan::new(3, WALKS[1]));
    let pairs = light(&tally).into_iter().flatten().zip(fibers.iter().flatten());
    pairs.map(|(here, there)| (here.0 - there.0).abs() / here.1.hypot(there.1)).fold(0.0, f64::max)
}

#[test]
fn black_parallel_fibers_send_back_what_the_fibers_themselves_do() {
    // Black fibers send back what their surfaces reflect, most of it after one hit.
    let cloth = parallel("2000");
    let fibers = through_fibers(&cloth, false);
    let [remembers, forgets] = [cloth.clone().remembering(), cloth].map(|one| off(&one, &fibers));
    println!("{remembers:.1} σ off, {forgets:.1} without memory");
    assert!(remembers < SIGMAS, "{remembers:.1} σ");
    assert!(forgets > 1.25 * SIGMAS, "a medium that forgets is not noticed: {forgets:.1} σ");
}

#[test]
fn walks_through_fibers_drawn_anew_are_those_of_a_medium_that_forgets() {
    let cloth = parallel("2000");
    let anew = through_fibers(&cloth, true);
    let [remembers, forgets] = [cloth.clone().remembering(), cloth].map(|one| off(&one, &anew));
    println!("{forgets:.1} σ off, {remembers:.1} with memory");
    assert!(forgets < SIGMAS, "{forgets:.1} σ");
    assert!(remembers > 1.25 * SIGMAS, "a medium that remembers is not noticed: {remembers:.1} σ");
}

#[test]
fn clear_parallel_fibers_do_as_well() {
    let cloth = parallel("0");
    let fibers = through_fibers(&cloth, false);
    let remembers = off(&cloth.remembering(), &fibers);
    println!("{remembers:.1} σ off");
    assert!(remembers < SIGMAS, "{remembers:.1} σ");
}
