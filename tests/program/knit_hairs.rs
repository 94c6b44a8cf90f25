//! Disorder in the yarn of a knit: hairs, loops of fibers and migration, and its fibers as curves.

use crate::common::program::Place;
use fiberwalk::cloth::{Cloth, Curve};
use fiberwalk::scene::{Scene, Source};
use glam::DVec3;

/// Radius of the yarn less that of a fiber in mm.
const RIM: f64 = 0.1;

fn text(structure: &str, lines: &str) -> String {
    let wales = if structure == "rib" { 20.0 } else { 10.5 };
    format!(
        "[fiber.wool]\nradius_um = 5\nior = 1.5\n[yarn.wool]\nfiber = \"wool\"\nfibers_per_ply = 18\nwidth_um = 210\n\
         height_um = 210\n{lines}\n[knit]\nstructure = \"{structure}\"\nyarn = \"wool\"\ncourses_per_cm = 13\n\
         wales_per_cm = {wales}\nloop_length_mm = 4\n"
    )
}

fn knitted(structure: &str, lines: &str) -> Cloth {
    let (file, stem) = ("cloth.toml".into(), "cloth".into());
    let source = Source { file, stem, text: text(structure, lines), folder: None };
    Cloth::new(&Scene::parse(&source).expect("it is right")).expect("it fits")
}

fn curves(cloth: &Cloth, draw: u64) -> Vec<Curve> {
    let mut curves = Vec::new();
    cloth.draw_thread(1, draw, 0, &mut |curve| curves.push(curve.clone()));
    curves
}

/// Distance of a point from the axis of its course in mm.
fn off(axis: &[DVec3], point: &DVec3) -> f64 {
    axis.iter().map(|place| place.distance_squared(*point)).fold(f64::INFINITY, f64::min).sqrt()
}

/// The axis over four repeats, densely, from one before the first.
fn axis(cloth: &Cloth) -> Vec<DVec3> {
    let thread = cloth.threads()[0];
    (0..8000).map(|place| cloth.axis_point(&thread, f64::from(place) / 2000.0 - 1.0)).collect()
}

#[test]
fn hairs_of_a_straight_yarn_are_straight_as_long_as_drawn_and_stand_on_its_surface() {
    for structure in ["jersey", "rib"] {
        let lines = "flyaways = { hairs_per_mm = 20, hair_length_um = [400, 0], hair_rise_deg = [30, 0] }";
        let cloth = knitted(structure, lines);
        let axis = axis(&cloth);
        let hairs: Vec<Curve> = curves(&cloth, 0).into_iter().filter(|curve| curve.hair).collect();
        let length = cloth.knit().map_or(0.0, |knit| knit.loop_length * knit.wales() as f64);
        assert!((hairs.len() as f64 - 20.0 * length).abs() <= 1.0, "{} hairs", hairs.len());
        let mut bent = 0;
        for hair in &hairs {
            let [first, last] = [hair.points[0], hair.points[hair.points.len() - 1]];
            assert!((first.distance(last) - 0.4).abs() < 1e-5, "{}", first.distance(last));
            // The table of the axis is as coarse as a thousandth of a mm.
            assert!((off(&axis, &first) - RIM).abs() < 2e-3, "{}", off(&axis, &first));
            // Over a straight yarn the tip would be 0.2 mm above the surface.
            bent += usize::from((off(&axis, &last) - RIM - 0.2).abs() > 0.05);
        }
        assert!(bent > hairs.len() / 4, "the yarn bends away under its hairs: {bent}");
    }
}

#[test]
fn nothing_sticks_out_of_a_hairy_knit_and_hairs_come_near_its_faces() {
    for structure in ["jersey", "rib"] {
        for lines in [
            "ply_twist_per_m = 600\nflyaways = { hairs_per_mm = 30, hair_length_um = [300, 150], hair_rise_deg = [40, 40] }",
            "ply_twist_per_m = 600\nmigration = { radius = [0.5, 1.0], periods_per_turn = 1 }\n\
             flyaways = { loops_per_mm = 2, loop_height_um = [90, 60], loop_span_um = 500 }",
        ] {
            let cloth = knitted(structure, lines);
            let (mut lowest, mut highest) = (0.0f64, -1.0f64);
            for piece in (0..8).flat_map(|draw| cloth.realize(1, draw)) {
                let reach = piece.direction.z.abs() * piece.length / 2.0;
                (lowest, highest) = (lowest.min(piece.centre.z - reach), highest.max(piece.centre.z + reach));
            }
            assert!(highest <= 0.0 && lowest >= -cloth.thickness(), "{structure}: {lowest} to {highest}");
            let plain = knitted(structure, "").thickness();
            let grown = (highest - lowest - plain) / (cloth.thickness() - plain);
            assert!(grown > 0.3, "{structure}: {grown} of the room is used");
        }
    }
}

#[test]
fn loops_of_fibers_leave_the_yarn_by_their_height() {
    let lines = "ply_twist_per_m = 600\nflyaways = { loops_per_mm = 2, loop_height_um = [80, 0], loop_span_um = 800 }";
    let cloth = knitted("jersey", lines);
    let axis = axis(&cloth);
    let mut tops = 0;
    for curve in curves(&cloth, 0) {
        let farthest = curve.points.iter().map(|point| off(&axis, point)).fold(0.0, f64::max);
        assert!(farthest < RIM + 0.08 + 2e-3, "{farthest}");
        tops += usize::from(farthest > RIM + 0.076);
    }
    assert!((5..=8).contains(&tops), "eight loops on up to as many fibers: {tops}");
}

#[test]
fn fibers_that_migrate_lie_nearer_to_the_axis_by_the_mean_of_their_shares() {
    let mean = |lines: &str| {
        let cloth = knitted("jersey", lines);
        let axis = axis(&cloth);
        let curves: Vec<Curve> = (0..20).flat_map(|draw| curves(&cloth, draw)).collect();
        let points = curves.iter().flat_map(|curve| curve.points.iter().step_by(8));
        let (sum, count) = points.fold((0.0, 0.0), |(sum, count), point| (sum + off(&axis, point), count + 1.0));
        sum / count
    };
    // 360 fibers know the mean distance to two per cent.
    let still = mean("ply_twist_per_m = 600");
    assert!((still / RIM - 2.0 / 3.0).abs() < 0.05, "{still}");
    let ratio = mean("ply_twist_per_m = 600\nmigration = { radius = [0.4, 1.0], periods_per_turn = 1 }") / still;
    assert!((ratio - 0.7).abs() < 0.06, "{ratio}");
}

#[test]
fn curves_of_a_knit_can_be_written() {
    let place = Place::new();
    std::fs::write(place.path("cloth.toml"), text("jersey", "ply_twist_per_m = 300")).expect("it can be written");
    let outcome = place.run(&["curves", "cloth.toml", "--to", "mitsuba", "--repeats", "2x1", "-o", "file.txt"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    let file = std::fs::read_to_string(place.path("file.txt")).expect("it is there");
    assert!(file.lines().next().is_some_and(|line| line.contains("x courses, y wales")));
    assert_eq!(file.split("\n\n").filter(|fiber| !fiber.trim().is_empty()).count(), 36);
}

#[test]
fn inspect_says_what_hairs_loops_and_migration_a_yarn_has() {
    let place = Place::new();
    let inspected = |lines: &str| {
        let model = "[model]\ncells = [8, 8, 8]\n";
        std::fs::write(place.path("cloth.toml"), text("jersey", lines) + model).expect("it can be written");
        let outcome = place.run(&["inspect", "cloth.toml", "--width", "600", "-o", "drawn"]);
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        outcome.stdout
    };
    let hairy = inspected(
        "ply_twist_per_m = 500\nmigration = { radius = [0.8, 1.0], periods_per_turn = 1.5 }\n\
         flyaways = { hairs_per_mm = 2.5, hair_length_um = [200, 50], hair_rise_deg = [20, 5], loops_per_mm = 1, \
         loop_height_um = [80, 30] }",
    );
    for line in [
        "  hairs          2.5 on a mm, 200 ± 50 µm long, rising 20 ± 5°\n",
        // A loop takes one swing of the migration: 2 mm / 1.5.
        "  loops          1 on a mm, 80 ± 30 µm high, 1333 µm of yarn each\n",
        "  migration      0.8 to 1 of a fiber's distance from its ply's centre, 1.5 swings a turn\n",
    ] {
        assert!(hairy.contains(line), "{hairy}");
    }
    let plain = inspected("ply_twist_per_m = 500");
    assert!(!["hairs", "migration", "µm high"].iter().any(|word| plain.contains(word)), "{plain}");
}
