//! Separate fibers: none runs into another, by brute force, and what they had before is kept.

use crate::common::stats::{GATE, mean_error};
use crate::common::woven::{Woven, Yarn};
use crate::common::{Cloth, ISOTROPIC, PLANAR, SplitMix};
use fiberwalk::Error;
use fiberwalk::cloth::{DrawnFor, Primitive, Realization, Realizer, Separation, System};
use fiberwalk::scene::{Packing, Scene, Source};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;

fn preset(name: &str) -> Scene {
    Scene::parse(&Source::find(name).expect("it is a preset")).expect("it is right")
}

fn random(scene: &Scene, number: u64) -> Realization {
    Realizer::new(scene, Packing::Random, DrawnFor::Medium)
        .expect("it can be laid out")
        .draw(number)
        .expect("nothing is refused")
}

pub fn separate(scene: &Scene, number: u64) -> (Realization, Separation) {
    let realizer = Realizer::new(scene, Packing::Separate, DrawnFor::Medium).expect("it can be laid out");
    realizer.draw_separate(number).unwrap_or_else(|error| panic!("{error}"))
}

/// Fiber, length of it up to the start of a piece, and both ends of the piece.
struct Piece {
    fiber: usize,
    along: f64,
    ends: [DVec3; 2],
}

fn pieces(drawn: &Realization) -> Vec<Piece> {
    let of = |(fiber, curve): (usize, &fiberwalk::cloth::Curve)| {
        let mut along = 0.0;
        let piece = |ends: &[DVec3]| {
            along += ends[0].distance(ends[1]);
            Piece { fiber, along: along - ends[0].distance(ends[1]), ends: [ends[0], ends[1]] }
        };
        curve.points.windows(2).map(piece).collect::<Vec<_>>()
    };
    drawn.fibers.iter().enumerate().flat_map(of).collect()
}

/// Distance of two pieces and the lengths along both to where it is: inside of both, or at one of the four ends.
fn distance(a: [DVec3; 2], b: [DVec3; 2]) -> (f64, [f64; 2]) {
    let to_piece = |point: DVec3, [from, to]: [DVec3; 2]| {
        let along = to - from;
        let share = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (point.distance(from + along * share), share * along.length())
    };
    let mut best = (f64::INFINITY, [0.0; 2]);
    for (end, at) in [(a[0], 0.0), (a[1], a[0].distance(a[1]))] {
        let (far, along) = to_piece(end, b);
        best = if far < best.0 { (far, [at, along]) } else { best };
    }
    for (end, at) in [(b[0], 0.0), (b[1], b[0].distance(b[1]))] {
        let (far, along) = to_piece(end, a);
        best = if far < best.0 { (far, [along, at]) } else { best };
    }
    // Cramer's rule for the feet of the common normal.
    let (u, v, r) = ((a[1] - a[0]).normalize(), (b[1] - b[0]).normalize(), b[0] - a[0]);
    let normal = u.cross(v);
    if normal.length_squared() > 1e-12 {
        let [s, t] = [r.cross(v), r.cross(u)].map(|side| side.dot(normal) / normal.length_squared());
        if s >= 0.0 && t >= 0.0 && s <= a[0].distance(a[1]) && t <= b[0].distance(b[1]) {
            best = (r.dot(normal).abs() / normal.length(), [s, t]);
        }
    }
    best
}

/// Whole periods from the start of a fiber to its end, and how far its end lies from the image of its start there, in mm.
pub fn onward(drawn: &Realization, fiber: usize) -> (DVec2, f64) {
    let points = &drawn.fibers[fiber].points;
    let way = points[points.len() - 1] - points[0];
    let periods = (way.truncate() / drawn.period).round();
    (periods, way.distance((periods * drawn.period).extend(0.0)))
}

/// Deepest that two fibers run into each other over the sum of their radii, by all pairs of pieces and their images but those
/// along a fiber, which may go on as its own image, and those that a thread's cut parts.
pub fn deepest(drawn: &Realization) -> f64 {
    let all = pieces(drawn);
    let lengths: Vec<f64> =
        drawn.fibers.iter().map(|fiber| fiber.pieces(drawn.period).map(|p| p.length).sum()).collect();
    let onward: Vec<(DVec2, f64)> = (0..drawn.fibers.len()).map(|fiber| onward(drawn, fiber)).collect();
    let radius = |piece: &Piece| drawn.fibers[piece.fiber].radius;
    let half = |piece: &Piece| piece.ends[0].distance(piece.ends[1]) / 2.0;
    let spheres: Vec<(DVec3, f64)> =
        all.iter().map(|piece| ((piece.ends[0] + piece.ends[1]) / 2.0, half(piece) + radius(piece))).collect();
    let per_period = 1.0 / drawn.period;
    let depth = |index: usize| {
        let piece = &all[index];
        let mut deepest = 0.0f64;
        for (other, (middle, reach)) in all.iter().zip(&spheres).take(index + 1) {
            let touching = radius(piece) + radius(other);
            let apart = spheres[index].0 - middle;
            let far = spheres[index].1 + reach;
            if apart.z.abs() > far {
                continue;
            }
            let nearest = (apart.truncate() * per_period).round();
            // Where the nearest image is too far away all are.
            if (apart - (nearest * drawn.period).extend(0.0)).length_squared() > far * far {
                continue;
            }
            let around = [-1.0, 0.0, 1.0];
            for periods in around.into_iter().flat_map(|x| around.map(|y| nearest + DVec2::new(x, y))) {
                let shift = (periods * drawn.period).extend(0.0);
                if (apart - shift).length_squared() > far * far {
                    continue;
                }
                let (far, at) = distance(piece.ends, other.ends.map(|end| end + shift));
                let place = [piece.along + at[0], other.along + at[1]];
                let (own, (ahead, jump)) = (piece.fiber == other.fiber, onward[piece.fiber]);
                // Count lengths past the end of a fiber that meets itself.
                let turns = [0.0, 1.0, -1.0]
                    .into_iter()
                    .find(|turns| periods == ahead * *turns && (*turns == 0.0 || jump < 1e-6 * radius(piece)));
                let along = turns.map(|turns| (piece.along - other.along - turns * lengths[piece.fiber]).abs());
                let beside = 4.0 * radius(piece) + 2.0 * half(piece).max(half(other));
                if own && along.is_some_and(|along| along < beside) {
                    continue;
                }
                // Where a thread is cut the end of a fiber faces the start of another, one period on.
                let near = |left: f64, piece: &Piece| left <= 2.0 * radius(piece) * (1.0 + 1e-6);
                let ends = near(lengths[piece.fiber] - place[0], piece) && near(place[1], other) && periods == ahead;
                let starts = near(place[0], piece) && near(lengths[other.fiber] - place[1], other) && periods == -ahead;
                let one_thread = drawn.fibers[piece.fiber].thread == drawn.fibers[other.fiber].thread;
                if !(one_thread && ahead != DVec2::ZERO && (ends || starts)) {
                    deepest = deepest.max(1.0 - far / touching);
                }
            }
        }
        deepest
    };
    (0..all.len()).into_par_iter().map(depth).reduce(|| 0.0, f64::max)
}

/// Share of a layer that lies inside of fibers, by points at random.
fn covered(drawn: &Realization, layer: [f64; 2], points: u32, seed: u64) -> f64 {
    const TILES: usize = 16;
    let all: Vec<Primitive> = drawn.pieces();
    let tile = drawn.period / TILES as f64;
    // The pieces that reach into each tile of the repeat.
    let near: Vec<Vec<&Primitive>> = (0..TILES * TILES)
        .map(|index| {
            let middle = (DVec2::new((index % TILES) as f64, (index / TILES) as f64) + 0.5) * tile;
            let reaches = |piece: &&Primitive| {
                let apart = piece.centre.truncate() - middle;
                let apart = apart - (apart / drawn.period).round() * drawn.period;
                apart.length() <= tile.length() / 2.0 + piece.length / 2.0 + piece.radius
            };
            all.iter().filter(reaches).collect()
        })
        .collect();
    let inside = |number: u32| {
        let mut random = SplitMix(seed.wrapping_mul(0x1_0000_0001) ^ (u64::from(number) << 20));
        let [x, y, z] = [0; 3].map(|_| random.uniform());
        let point = DVec3::new(x * drawn.period.x, y * drawn.period.y, layer[0] + z * (layer[1] - layer[0]));
        let [column, row] = [x, y].map(|share| (share * TILES as f64) as usize);
        near[row * TILES + column].iter().any(|piece| {
            let apart = point - piece.centre;
            let nearest = (apart.truncate() / drawn.period).round();
            // A piece is shorter than half of the element, so its nearest image is enough.
            let apart = apart - (nearest * drawn.period).extend(0.0);
            let along = apart.dot(piece.direction);
            along.abs() <= piece.length / 2.0 && apart.length_squared() - along * along < piece.radius.powi(2)
        })
    };
    (0..points).into_par_iter().filter(|number| inside(*number)).count() as f64 / f64::from(points)
}

fn lengths(drawn: &Realization) -> f64 {
    drawn.pieces().iter().map(|piece| piece.length).sum()
}

/// z of a share of points against the stated one.
fn share_z(found: f64, stated: f64, points: u32) -> f64 {
    (found - stated) / (stated * (1.0 - stated) / f64::from(points)).sqrt()
}

#[test]
fn no_two_fibers_run_into_each_other() {
    for name in ["sheer", "lining"] {
        let scene = preset(name);
        let (drawn, separation) = separate(&scene, 0);
        let found = deepest(&drawn);
        println!("{name}: {separation:?}, by brute force {found:.4}");
        assert!(found <= 0.02, "{name}: {found}");
        let overlapping = deepest(&random(&scene, 0));
        assert!(overlapping > 0.8, "{name}: {overlapping}");
    }
    for orientation in [ISOTROPIC, PLANAR] {
        let scene = Cloth { thickness_um: 150.0, ..Cloth::new(400.0, orientation) }.scene();
        let found = deepest(&separate(&scene, 1).0);
        assert!(found <= 0.02, "{orientation}: {found}");
        let overlapping = deepest(&random(&scene, 1));
        assert!(overlapping > 0.8, "{orientation}: {overlapping}");
    }
}

#[test]
fn separate_fibers_cover_their_volume() {
    let points = 100_000;
    let scene = preset("voile");
    let (drawn, separation) = separate(&scene, 2);
    let cover = |drawn: &Realization| {
        share_z(covered(drawn, [-drawn.thickness, 0.0], points, 1), drawn.volume_fraction(), points)
    };
    let found = cover(&drawn);
    assert!(found.abs() < GATE, "{found}");
    assert!(separation.covered >= 0.995 && separation.covered <= 1.0, "{separation:?}");
    let overlapping = cover(&random(&scene, 2));
    assert!(overlapping < -2.0 * GATE, "{overlapping}");
}

#[test]
fn random_fibers_of_a_sheet_cover_one_less_the_exponential() {
    // The law of overlapping fibers, 1 − exp(−v), inside of the sheet by a radius and more.
    let z = |density: f64| {
        let scene = Cloth { thickness_um: 150.0, ..Cloth::new(density, ISOTROPIC) }.scene();
        let v = 1000.0 * PI * 1e-4;
        let one = |number: u64| covered(&random(&scene, number), [-0.135, -0.015], 4000, number + 1);
        let shares: Vec<f64> = (0..32).map(one).collect();
        let square = shares.iter().map(|share| share * share).sum();
        let (mean, error) = mean_error(shares.iter().sum(), square, shares.len() as f64);
        [(mean - (1.0 - f64::exp(-v))) / error, mean, error]
    };
    let found = z(1000.0);
    assert!(found[0].abs() < GATE, "{found:?}");
    let bent = z(1150.0);
    assert!(bent[0] > 2.0 * GATE, "{bent:?}");
}

/// Root mean square distance of the fibers of the ends from the middle of their yarn, across and up, in mm.
fn spread(scene: &Scene, drawn: &Realization) -> DVec2 {
    let cloth = fiberwalk::cloth::Cloth::new(scene).expect("it can be laid out");
    let (mut sum, mut count) = (DVec2::ZERO, 0.0);
    for fiber in &drawn.fibers {
        let thread = &cloth.threads()[fiber.thread];
        if thread.system == System::Warp {
            for ends in fiber.points.windows(2) {
                let middle = (ends[0] + ends[1]) / 2.0;
                let off = DVec2::new(middle.x - thread.at, middle.z - cloth.axis_height(thread, middle.y));
                sum += off * off * ends[0].distance(ends[1]);
                count += ends[0].distance(ends[1]);
            }
        }
    }
    let mean: DVec2 = sum / count;
    DVec2::new(mean.x.sqrt(), mean.y.sqrt())
}

/// Lengths by height in the slab, in tenths of it, over all length.
fn profile(drawn: &Realization) -> Vec<f64> {
    let (mut shares, whole) = (vec![0.0; 10], lengths(drawn));
    for piece in drawn.pieces() {
        for part in 0..64 {
            let height = piece.direction.z * piece.length * ((f64::from(part) + 0.5) / 64.0 - 0.5);
            let place = (-(piece.centre.z + height) / drawn.thickness * 10.0) as usize;
            shares[place.min(9)] += piece.length / 64.0 / whole;
        }
    }
    shares
}

#[test]
fn yarns_keep_their_size_their_length_and_their_place() {
    let scene = preset("voile");
    let (mut grown, mut longer, mut moved) = (DVec2::ZERO, 0.0, 0.0f64);
    for number in 0..2 {
        let (before, after) = (random(&scene, number), separate(&scene, number).0);
        grown += spread(&scene, &after) / spread(&scene, &before) / 2.0;
        longer += lengths(&after) / lengths(&before) / 2.0;
        let shift = profile(&before).into_iter().zip(profile(&after)).map(|(a, b)| (a - b).abs());
        moved = moved.max(shift.fold(0.0, f64::max));
        for (old, new) in before.fibers.iter().zip(&after.fibers) {
            assert_eq!((old.radius, old.kind, old.thread, old.hair), (new.radius, new.kind, new.thread, new.hair));
            let slack = new.radius * (1.0 - 1e-9);
            assert!(new.points.iter().all(|point| point.z <= -slack && point.z >= slack - after.thickness));
        }
    }
    println!(
        "spread × {grown}, length × {longer:.4}, a tenth of the height holds up to {moved:.4} more or less of the length"
    );
    assert!(grown.min_element() > 0.95 && grown.max_element() < 1.1, "{grown}");
    assert!(longer > 0.999 && longer < 1.015, "{longer}");
    assert!(moved < 0.015, "{moved}");
}

#[test]
fn fibers_of_a_sheet_keep_their_directions_and_their_depth() {
    let scene = Cloth { thickness_um: 200.0, ..Cloth::new(400.0, ISOTROPIC) }.scene();
    let (before, after) = (random(&scene, 0), separate(&scene, 0).0);
    // ⟨p_z²⟩ by length is ⅓ of isotropic fibers.
    let steep = |drawn: &Realization| {
        drawn.pieces().iter().map(|piece| piece.direction.z.powi(2) * piece.length).sum::<f64>() / lengths(drawn)
    };
    let shift = profile(&before).into_iter().zip(profile(&after)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let longer = lengths(&after) / lengths(&before);
    println!("⟨p_z²⟩ {:.4} to {:.4}, a layer moves by {shift:.4}, length × {longer:.4}", steep(&before), steep(&after));
    assert!((steep(&before) - steep(&after)).abs() < 0.02 && shift < 0.02 && longer < 1.03);
    for (old, new) in before.fibers.iter().zip(&after.fibers) {
        let ends = |points: &[DVec3]| [points[0].z, points[points.len() - 1].z];
        for (old, new) in ends(&old.points).into_iter().zip(ends(&new.points)) {
            assert!(old == new || (old < 0.0 && old > -after.thickness), "an end left its face: {old} {new}");
        }
        assert!(new.points.iter().all(|point| point.z <= 0.0 && point.z >= -after.thickness));
    }
}

#[test]
fn a_realization_does_not_depend_on_the_number_of_threads() {
    let scene = preset("sheer");
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had");
    let many = rayon::ThreadPoolBuilder::new().num_threads(5).build().expect("five threads can be had");
    let first = alone.install(|| separate(&scene, 7));
    assert_eq!(first, many.install(|| separate(&scene, 7)));
    assert_ne!(first.0, separate(&scene, 8).0);
    let realizer = Realizer::new(&scene, Packing::Separate, DrawnFor::Medium).expect("it can be laid out");
    assert_eq!(first.0, realizer.draw(7).expect("it fits"), "what is drawn is separate");
}

pub fn read(stem: &str, text: String) -> Scene {
    let source = Source { file: format!("{stem}.toml"), stem: stem.into(), text, folder: None };
    Scene::parse(&source).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn what_does_not_fit_is_refused_and_each_cure_works() {
    let draw = |fibers: u32, threads_per_cm: f64| {
        let yarn = Yarn::new(fibers, 37.0, 37.0, "ply_twist_per_m = 1000");
        let scene = read("tight", Woven::of(&[".X", "X."], yarn, threads_per_cm).text());
        let packed =
            |packing| Realizer::new(&scene, packing, DrawnFor::Medium).expect("it can be laid out").draw(0).map(|_| ());
        [packed(Packing::Separate), packed(Packing::Random)]
    };
    let [tight, random] = draw(12, 185.0);
    let error = tight.expect_err("it is too dense");
    assert!(matches!(error, Error::Input(_)) && error.exit_code() == 2);
    let message = error.to_string();
    println!("{message}");
    for part in ["cannot all be laid apart", "after 400 sweeps", "% of a diameter", "packing = \"random\""] {
        assert!(message.contains(part), "{message}");
    }
    assert!(message.contains("Give the yarns more room or take fewer fibers"), "{message}");
    let ([roomy, _], [fewer, _]) = (draw(12, 160.0), draw(8, 185.0));
    for cured in [random, roomy, fewer] {
        assert!(cured.is_ok(), "{cured:?}");
    }
}

#[test]
fn the_packing_is_read_from_the_file_and_the_flag() {
    let read = |text: &str| {
        let text =
            format!("{}\n[model]\n{text}", Woven::of(&[".X", "X."], Yarn::new(20, 100.0, 100.0, ""), 20.0).text());
        Scene::parse(&Source { file: "test.toml".into(), stem: "test".into(), text, folder: None })
    };
    assert_eq!(read("").expect("it is right").model.packing, Packing::Random);
    let mut model = read("packing = \"separate\"").expect("it is right").model;
    assert_eq!(model.packing, Packing::Separate);
    model.set_from_flag("packing", "random").expect("it is a packing");
    assert_eq!(model.packing, Packing::Random);
    let error = model.set_from_flag("packing", "dense").expect_err("it is no packing").to_string();
    assert!(error.contains("random, separate"), "{error}");
}
