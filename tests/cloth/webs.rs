//! Realizations of sheets: how much fiber lies at which depth and in which direction, and what straight light sees of it.

use crate::common::stats::{GATE, largest, mean_error};
use crate::common::straight::{openness, ray};
use crate::common::{Cloth, ISOTROPIC, Kind, PLANAR, aligned};
use fiberwalk::cloth::{DrawnFor, Primitive, Realizer};
use fiberwalk::scene::Packing;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_4, PI};

const LAYERS: usize = 10;
const DRAWS: u64 = 64;

fn spread(axis: [f64; 3], degrees: f64) -> String {
    aligned(axis) + &format!("\nspread_deg = {degrees}")
}

/// All kinds of directions: flat, steep, and neither.
fn orientations() -> Vec<String> {
    let tilted = [0.6, 0.0, 0.8];
    let steep = [
        ISOTROPIC.into(),
        aligned([0.0, 0.0, 1.0]),
        aligned(tilted),
        spread(tilted, 25.0),
        spread([0.0, 0.0, 1.0], 90.0),
    ];
    let flat = [PLANAR.into(), aligned([1.0, 0.0, 0.0]), aligned([1.0, 2.0, 0.0]), spread([0.0, 1.0, 0.01], 3.0)];
    steep.into_iter().chain(flat).collect()
}

fn realizer(cloth: &Cloth) -> Realizer {
    Realizer::new(&cloth.scene(), Packing::Random, DrawnFor::Medium).expect("it can be laid out")
}

/// Length of fiber in each layer of the sheet and in each of so many classes, over the volume of a layer: z of its mean over draws
/// against `stated`.
fn densities_z(cloth: &Cloth, stated: f64, classes: usize, class: impl Fn(&Primitive) -> usize + Sync) -> Vec<f64> {
    let realizer = realizer(cloth);
    let (period, thickness) = (realizer.period(), realizer.thickness());
    let volume = period.x * period.y * thickness / LAYERS as f64;
    let one = |number: u64| {
        let mut lengths = vec![0.0; LAYERS * classes];
        for piece in realizer.draw(number).expect("nothing is refused").pieces() {
            let half = piece.direction.z.abs() * piece.length / 2.0;
            let depth = -piece.centre.z / thickness * LAYERS as f64;
            let reach = half / thickness * LAYERS as f64;
            assert!(
                piece.centre.z + half <= 1e-12 && piece.centre.z - half >= -thickness - 1e-12,
                "{piece:?} sticks out"
            );
            for layer in 0..LAYERS {
                let [top, bottom] = [layer as f64, layer as f64 + 1.0];
                let share = if reach > 1e-9 {
                    ((depth + reach).min(bottom) - (depth - reach).max(top)).max(0.0) / (2.0 * reach)
                } else {
                    f64::from(depth >= top && depth < bottom)
                };
                lengths[layer * classes + class(&piece)] += share * piece.length / volume;
            }
        }
        lengths
    };
    let draws: Vec<Vec<f64>> = (0..DRAWS).into_par_iter().map(one).collect();
    let z = |place: usize| {
        let values = draws.iter().map(|lengths| lengths[place]);
        let (mean, error) = mean_error(values.clone().sum(), values.map(|value| value * value).sum(), DRAWS as f64);
        (mean - stated) / error
    };
    (0..LAYERS * classes).map(z).collect()
}

#[test]
fn every_depth_holds_the_stated_length_whatever_its_direction() {
    for orientation in orientations() {
        let sheet = |density: f64| Cloth { thickness_um: 700.0, ..Cloth::new(density, &orientation) };
        let found = largest(&densities_z(&sheet(1000.0), 1000.0, 1, |_| 0));
        // A layer and a direction hold some thousands of fibers in all draws.
        assert!(found < GATE, "{orientation}: {found}");
        let bent = densities_z(&sheet(1150.0), 1000.0, 1, |_| 0);
        assert!(largest(&bent) > 2.0 * GATE, "{orientation}: {bent:?}");
    }
}

#[test]
fn every_depth_holds_every_direction_alike() {
    // Shares of equal solid angle of the half-sphere, or of the cone, are shares of equal length.
    let classes = 5;
    let uniform = |share: f64| ((share * classes as f64) as usize).min(classes - 1);
    let isotropic = |density: f64| Cloth { thickness_um: 700.0, ..Cloth::new(density, ISOTROPIC) };
    let height = |piece: &Primitive| uniform(piece.direction.z.abs());
    let each = 1000.0 / classes as f64;
    let found = densities_z(&isotropic(1000.0), each, classes, height);
    assert!(largest(&found) < GATE, "{found:?}");
    let turned = densities_z(&Cloth::new(1000.0, &spread([0.0, 0.0, 1.0], 80.0)), each, classes, height);
    assert!(largest(&turned) > 2.0 * GATE, "{turned:?}");

    let azimuth = |piece: &Primitive| uniform((piece.direction.y.atan2(piece.direction.x) / PI).rem_euclid(1.0));
    for orientation in [ISOTROPIC, PLANAR] {
        let found = densities_z(&Cloth::new(1000.0, orientation), each, classes, azimuth);
        assert!(largest(&found) < GATE, "{orientation}: {found:?}");
    }
    let axis = DVec3::new(0.6, 0.0, 0.8);
    let cone = |degrees: f64| Cloth::new(1000.0, &spread([0.6, 0.0, 0.8], degrees));
    let off = |piece: &Primitive| {
        let along = piece.direction.dot(axis).abs();
        uniform((1.0 - along) / (1.0 - 25f64.to_radians().cos()))
    };
    let found = densities_z(&cone(25.0), each, classes, off);
    assert!(largest(&found) < GATE, "{found:?}");
    let bent = densities_z(&cone(27.0), each, classes, off);
    assert!(largest(&bent) > 2.0 * GATE, "{bent:?}");
}

#[test]
fn straight_light_comes_through_by_the_law_of_overlapping_fibers() {
    // exp(−H t / cos θ); that the element repeats lets more through, and that must not be seen.
    let z = |cloth: &Cloth, depth: f64, theta: f64| {
        let realizer = realizer(cloth);
        let realize = |number: u64| realizer.draw(number).expect("nothing is refused").pieces();
        let (found, error) = openness(&realize, 48, realizer.period(), ray(theta, 20.0), 256);
        let stated = f64::exp(-depth / theta.to_radians().cos());
        println!("{theta}°: {found:.5} ± {error:.5}, stated {stated:.5}");
        (found - stated) / error
    };
    let sheet =
        |density: f64, orientation: &str, thickness_um: f64| Cloth { thickness_um, ..Cloth::new(density, orientation) };
    for (theta, thickness_um) in [(0.0, 300.0), (60.0, 300.0), (60.0, 3000.0), (75.0, 1000.0)] {
        let isotropic = |density: f64| sheet(density, ISOTROPIC, thickness_um);
        let density = 400.0 * 300.0 / thickness_um;
        let depth = 2.0 * 0.01 * density * FRAC_PI_4 * thickness_um / 1000.0;
        let found = z(&isotropic(density), depth, theta);
        assert!(found.abs() < GATE, "{theta}° through {thickness_um} µm: {found}");
        let bent = z(&isotropic(1.2 * density), depth, theta);
        assert!(bent < -2.0 * GATE, "{theta}° through {thickness_um} µm: {bent}");
    }
    let flat = sheet(300.0, PLANAR, 200.0);
    let found = z(&flat, 2.0 * 0.01 * 300.0 * 0.2, 0.0);
    assert!(found.abs() < GATE, "{found}");
}

#[test]
fn fibers_are_those_of_their_populations() {
    let other = Kind {
        radius_um: 15.0,
        ior: 1.5,
        absorption: "0".into(),
        length_density: 300.0,
        orientation: aligned([1.0, 0.0, 0.0]),
    };
    let cloth = Cloth { more_kinds: vec![other], ..Cloth::new(600.0, PLANAR) };
    let realizer = realizer(&cloth);
    let drawn = realizer.draw(3).expect("nothing is refused");
    assert_eq!(drawn, realizer.draw(3).expect("nothing is refused"));
    assert_ne!(drawn, realizer.draw(4).expect("nothing is refused"));
    assert_eq!((drawn.period, drawn.thickness), (realizer.period(), realizer.thickness()));
    assert_eq!((drawn.fibers[0].kind, drawn.fibers[0].radius), (0, 0.01));
    for fiber in &drawn.fibers {
        assert_eq!([(0, 0.01), (1, 0.015)][fiber.thread], (fiber.kind, fiber.radius));
        for ends in fiber.points.windows(2) {
            assert!(ends[0].distance(ends[1]) <= drawn.period.x / 4.0 * (1.0 + 1e-9));
        }
        // A fiber along an axis of the element ends where it begins.
        let [first, last] = [fiber.points[0], fiber.points[fiber.points.len() - 1]];
        let (along, flat) = (last - first, (last - first).truncate().length());
        assert!((flat - drawn.period.x).abs() < 1e-9, "{along}");
        assert!(fiber.thread == 0 || (along - DVec3::X * drawn.period.x).length() < 1e-9);
    }
}

#[test]
fn a_sheet_that_would_take_too_many_pieces_is_refused() {
    let thick = Cloth { thickness_um: 1e6, ..Cloth::new(2500.0, ISOTROPIC) };
    let error = Realizer::new(&thick.scene(), Packing::Random, DrawnFor::Medium).expect_err("it is a metre thick");
    assert!(error.to_string().contains("straight pieces of fiber; make the sheet thinner"), "{error}");
}
