//! Free surface and covered volume, measured on fibers whose overlap is known.

use crate::common::SplitMix;
use crate::common::counted::{realization, scattered_pieces};
use crate::common::stats::{GATE, binomial_z, mean_error};
use fiberwalk::cloth::Primitive;
use fiberwalk::distribution::{CellGrid, Effort, Element, Gathering, SpecificLength, Voids};
use fiberwalk::scene::{Model, Placement};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_3, PI};

const RADIUS: f64 = 0.02;

/// Cells of half a tenth of a millimetre.
fn grid() -> CellGrid {
    CellGrid { counts: [10, 10, 8], period: DVec2::splat(0.5), thickness: 0.4 }
}

fn measure(
    placement: Placement,
    realize: &(dyn Fn(u64) -> Vec<Primitive> + Sync),
    realizations: u64,
) -> (SpecificLength, Gathering) {
    let realize = |number| Ok(realization(&realize(number), &grid()));
    let element = Element { cells: grid(), list_width: DVec3::splat(0.1), radii: &[RADIUS], realize: &realize };
    let model = Model { placement, cone: Some(0.0), directions: 64, ..Model::default() };
    SpecificLength::of_pieces(&element, &model, Effort::Realizations(realizations), |_| {})
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Factors of all cells, and what was found in all.
fn voids(realize: &(dyn Fn(u64) -> Vec<Primitive> + Sync), realizations: u64) -> (Vec<f64>, Voids) {
    let (length, gathering) = measure(Placement::CarriedVoid, realize, realizations);
    let voids = gathering.voids.expect("the placement asks for it");
    (length.values.iter().map(|cell| cell.placement).collect(), voids)
}

/// Fibers through the element along x: in the middle of a square of 0.05 mm and so far beside it, in every `step`th square.
fn lattice(beside: &[f64], step: usize) -> Vec<Primitive> {
    let at = |i: usize| {
        let (row, column) = (i / 10, i % 10);
        DVec3::new(0.25, 0.05 * (column as f64 + 0.5), -0.05 * (row as f64 + 0.5))
    };
    let fiber = |centre| Primitive { centre, direction: DVec3::X, length: 0.5, radius: RADIUS, kind: 0, thread: 0 };
    (0..80).step_by(step).flat_map(|i| beside.iter().map(move |beside| fiber(at(i) + DVec3::Y * *beside))).collect()
}

#[test]
fn separate_fibers_have_all_their_surface_and_cover_their_volume() {
    let v = PI * RADIUS.powi(2) / 0.05f64.powi(2);
    let (factors, found) = voids(&|_| lattice(&[0.0], 1), 128);
    assert_eq!(found.free_surface, 1.0);
    let points = 800 * 128;
    let z = binomial_z((found.covered * f64::from(points)).round() as u64, points as u64, v);
    println!("{found:?}, z = {z:.1}");
    assert!(z.abs() < GATE, "c = {} for {v}, z = {z:.1}", found.covered);
    let mean = factors.iter().sum::<f64>() / factors.len() as f64;
    // 1/(1 − c) of a c that is known to 1.4 % of 1 − c at least is 0.02 % too large.
    assert!((mean * (1.0 - v) - 1.0).abs() < 0.005, "{mean} for {}", 1.0 / (1.0 - v));
    let spread = mean_error(factors.iter().sum(), factors.iter().map(|f| f * f).sum(), factors.len() as f64).1;
    let spread = spread * (factors.len() as f64).sqrt() / mean;
    assert!(spread > 0.6 * found.error && spread < 1.6 * found.error, "{spread} for {}", found.error);
    // Fibers that half cover each other are not separate.
    assert!(voids(&|_| lattice(&[-0.005, 0.005], 1), 8).1.free_surface < 0.9);
}

#[test]
fn pairs_of_fibers_show_the_lens_in_which_they_overlap() {
    // Axes a radius apart: a third of each circle lies in the other, and the lens is (2π/3 − √3/2) R².
    let (_, found) = voids(&|_| lattice(&[-RADIUS / 2.0, RADIUS / 2.0], 2), 128);
    let covered = (2.0 * PI - 2.0 * FRAC_PI_3 + 0.75f64.sqrt()) * RADIUS.powi(2) / (0.05 * 0.1);
    let z = binomial_z((found.covered * 102_400.0).round() as u64, 102_400, covered);
    println!("{found:?} for {covered}, z = {z:.1}");
    assert!(z.abs() < GATE, "c = {} for {covered}", found.covered);
    // Points on 80 fibers of 0.5 mm, one for each 0.0025 mm², in each of 128 realizations.
    let points = 80.0 * 0.5 * 2.0 * PI * RADIUS / 0.0025 * 128.0;
    let sigma = (2.0 / 9.0 / points).sqrt();
    assert!((found.free_surface - 2.0 / 3.0).abs() < GATE * sigma, "{} ± {sigma}", found.free_surface);
    let (_, other) = voids(&|_| lattice(&[-RADIUS / 2.0, 0.545 * RADIUS], 2), 128);
    assert!((other.free_surface - 2.0 / 3.0).abs() > 8.0 * sigma, "{} ± {sigma}", other.free_surface);
}

/// Pieces at random in all directions, of volume fraction v, a new draw in each realization.
fn random_box(set: u64, number: u64) -> Vec<Primitive> {
    let mut random = SplitMix(set << 32 | number);
    let length_density = 0.5 / (PI * RADIUS.powi(2));
    let mut pieces =
        scattered_pieces(length_density, RADIUS, [0.5, 0.8], 0.15, &mut random, |random| random.direction());
    // Let them be as many beyond the faces.
    pieces.iter_mut().for_each(|piece| piece.centre.z += 0.2);
    pieces
}

#[test]
fn independent_fibers_have_a_factor_of_one() {
    let sets: Vec<(Vec<f64>, Voids)> = (0..8).map(|set| voids(&|number| random_box(set, number), 64)).collect();
    let mean = |factors: &[f64]| factors.iter().sum::<f64>() / factors.len() as f64;
    let means: Vec<f64> = sets.iter().map(|(factors, _)| mean(factors)).collect();
    let (value, error) = mean_error(means.iter().sum(), means.iter().map(|m| m * m).sum(), means.len() as f64);
    let (_, found) = sets[0];
    println!("{found:?}: factor {value:.4} ± {error:.4}");
    // A cell's own spread raises the mean of 1/(1 − c) by its square.
    let bias = found.error.powi(2);
    assert!((value - 1.0).abs() < 4.0 * error + bias, "{value} ± {error}");
    assert!((found.covered - (1.0 - (-0.5f64).exp())).abs() < 0.02, "c = {}", found.covered);
    // The same cover without the lost surface would show.
    assert!((1.0 / (1.0 - found.covered) - 1.0).abs() > 10.0 * (4.0 * error + bias));
    // The stated error is that of one set against the others.
    let cell = |i: usize| {
        let values = sets.iter().map(|(factors, _)| factors[i]);
        mean_error(values.clone().sum(), values.map(|f| f * f).sum(), 8.0).1.powi(2) * 8.0
    };
    let spread = (sets[0].0.len() as f64).recip() * (0..sets[0].0.len()).map(cell).sum::<f64>();
    assert!((spread.sqrt() / found.error - 1.0).abs() < 0.2, "{} for {}", spread.sqrt(), found.error);
}

#[test]
fn nothing_is_measured_that_is_not_asked_for() {
    for placement in [Placement::AtHit, Placement::Carried, Placement::CarriedDense] {
        let (length, gathering) = measure(placement, &|_| lattice(&[0.0], 1), 2);
        assert_eq!(gathering.voids, None);
        let v = PI * RADIUS.powi(2) / 0.05f64.powi(2);
        let factor = if placement == Placement::CarriedDense { 1.0 / (1.0 - v) } else { 1.0 };
        assert!(length.values.iter().all(|cell| (cell.placement - factor).abs() < 1e-6), "{placement:?}");
    }
    // What is asked for does not depend on the order of the work.
    let all = || voids(&|number| random_box(9, number), 5);
    assert_eq!(all(), all());
}
