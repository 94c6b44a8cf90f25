//! Separate fibers of cloths of few fibers: monofilaments, plies of one fiber, few twisted filaments.

use crate::packing::{deepest, onward, read, separate};
use fiberwalk::cloth::{DrawnFor, Realization, Realizer};
use fiberwalk::scene::{Packing, Scene};
use glam::DVec3;

/// A plain weave of filaments: their radius in µm, the lines of their yarn, its width and height in µm, threads on a cm.
fn plain(radius: f64, lines: &str, size: [f64; 2], threads: f64) -> Scene {
    let [width, height] = size;
    read(
        "few",
        format!(
            "[fiber.clear]\nradius_um = {radius}\nior = 1.55\n[yarn.few]\nfiber = \"clear\"\nwidth_um = {width}\n\
             height_um = {height}\n{lines}\n[weave]\ndraft = [\".X\", \"X.\"]\nwarp = [\"few\"]\nweft = [\"few\"]\n\
             ends_per_cm = {threads}\npicks_per_cm = {threads}\n"
        ),
    )
}

fn screen() -> Scene {
    plain(10.0, "fibers_per_ply = 1", [22.4, 22.4], 200.0)
}

fn seven(lines: &str) -> Scene {
    plain(10.0, &format!("fibers_per_ply = 7\n{lines}"), [80.0, 60.0], 70.0)
}

#[test]
fn cloths_of_few_fibers_are_laid_apart() {
    let single = "plies = 7\nfibers_per_ply = 1";
    let cloths = [
        ("screen", screen()),
        ("filaments that fill their yarns", plain(30.0, "fibers_per_ply = 1", [60.0, 60.0], 80.0)),
        ("flat yarns of one filament", plain(10.0, "fibers_per_ply = 1", [150.0, 22.4], 55.0)),
        ("five plies of one filament", plain(8.0, "plies = 5\nfibers_per_ply = 1", [58.0, 58.0], 70.0)),
        ("seven plies of one filament", plain(10.0, single, [76.0, 76.0], 60.0)),
        ("seven filaments, twisted", seven("ply_twist_per_m = 400")),
        ("one filament, twisted", plain(10.0, "fibers_per_ply = 1\nply_twist_per_m = 400", [40.0, 40.0], 100.0)),
    ];
    for (name, scene) in cloths {
        for number in 0..3 {
            let (drawn, separation) = separate(&scene, number);
            let found = deepest(&drawn);
            println!("{name}: {separation:?}, by brute force {found:.4}");
            assert!(found <= 0.02 && separation.covered >= 0.995, "{name}: {found}, {separation:?}");
        }
    }
    // Of fibers that may overlap, the same search finds filaments in each other.
    let overlapping =
        Realizer::new(&seven(""), Packing::Random, DrawnFor::Medium).and_then(|realizer| realizer.draw(0));
    assert!(deepest(&overlapping.expect("nothing is refused")) > 0.5);
}

/// How far fibers end from where they started one period on, at most, in radii.
fn jump(drawn: &Realization) -> f64 {
    (0..drawn.fibers.len()).map(|fiber| onward(drawn, fiber).1 / drawn.fibers[fiber].radius).fold(0.0, f64::max)
}

#[test]
fn separate_fibers_without_twist_meet_themselves_one_period_on() {
    for (name, scene) in [("screen", screen()), ("seven", seven(""))] {
        let found = jump(&separate(&scene, 0).0);
        assert!(found < 1e-9, "{name}: {found}");
    }
    // With a twist that does not close, ends lie elsewhere.
    let twisted = jump(&separate(&seven("ply_twist_per_m = 400"), 0).0);
    assert!(twisted > 0.5, "{twisted}");
}

#[test]
fn ends_of_twisted_fibers_stay_in_the_plane_that_their_thread_is_cut_in() {
    let scene = seven("ply_twist_per_m = 400");
    let (drawn, _) = separate(&scene, 0);
    // The widest way along the thread between the corners of its fibers that `corner` names, in radii.
    let spread = |corner: &dyn Fn(&[DVec3]) -> DVec3| {
        let mut widest = 0.0f64;
        for (index, fiber) in drawn.fibers.iter().enumerate() {
            let (ahead, _) = onward(&drawn, index);
            for other in drawn.fibers.iter().filter(|other| other.thread == fiber.thread) {
                let way = corner(&fiber.points) - corner(&other.points);
                widest = widest.max(way.truncate().dot(ahead).abs() / fiber.radius);
            }
        }
        widest
    };
    let [first, last] = [spread(&|points| points[0]), spread(&|points| points[points.len() - 1])];
    assert!(first < 1e-9 && last < 1e-9, "{first} {last}");
    // Other corners lie anywhere.
    let inner = spread(&|points| points[1]);
    assert!(inner > 0.1, "{inner}");
}

#[test]
fn separate_filaments_keep_the_bends_that_they_have() {
    // What does not touch is not moved, and bends as sharply: corners may be left out within a fiftieth of the radius.
    let farthest = |scene: &Scene, number: u64| {
        let random = Realizer::new(scene, Packing::Random, DrawnFor::Medium).and_then(|realizer| realizer.draw(number));
        let (random, separate) = (random.expect("nothing is refused"), separate(scene, number).0);
        let off = |point: DVec3, points: &[DVec3]| {
            let beside = |ends: &[DVec3]| {
                let along = ends[1] - ends[0];
                let share = ((point - ends[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
                point.distance(ends[0] + along * share)
            };
            points.windows(2).map(beside).fold(f64::INFINITY, f64::min)
        };
        let fibers = random.fibers.iter().zip(&separate.fibers);
        let off =
            fibers.flat_map(|(old, new)| old.points.iter().map(move |&point| off(point, &new.points) / old.radius));
        off.fold(0.0, f64::max)
    };
    let found = farthest(&plain(10.0, "fibers_per_ply = 1", [28.0, 28.0], 150.0), 0);
    assert!(found < 0.021, "{found}");
    // Filaments that touch are moved.
    let moved = farthest(&seven(""), 0);
    assert!(moved > 0.1, "{moved}");
}
