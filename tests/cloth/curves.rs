//! `fiberwalk curves`: what is written is what was drawn, and Mitsuba reads it.

use crate::common::program::Place;
use crate::common::woven::{Woven, Yarn};
use fiberwalk::cloth::{Cloth, Curve, DrawnFor, Realizer};
use fiberwalk::scene::{Packing, Scene, Source};
use glam::DVec3;
use std::path::Path;
use std::process::Command;

const HAIRY: &str = "ply_twist_per_m = 700\nmigration = { radius = [0.7, 1.0], periods_per_turn = 1 }\n\
                     flyaways = { hairs_per_mm = 4, hair_length_um = [300, 100], hair_rise_deg = [30, 0], \
                     loops_per_mm = 2, loop_height_um = [60, 20] }";

fn woven() -> Woven {
    let yarn = Yarn { fiber: "{ thin = 0.6, thick = 0.4 }", ..Yarn::new(20, 300.0, 200.0, HAIRY) };
    Woven::of(&["X..", ".X.", "..X"], yarn, 20.0)
}

/// The fibers of a realization of the explicit model.
fn drawn(cloth: &Cloth, number: u64) -> Vec<Curve> {
    let mut curves = Vec::new();
    for thread in 0..cloth.threads().len() {
        cloth.draw_thread(1, DrawnFor::Fibers.number(number, 0), thread, &mut |curve| curves.push(curve.clone()));
    }
    curves
}

fn length(points: &[DVec3]) -> f64 {
    points.windows(2).map(|ends| ends[0].distance(ends[1])).sum()
}

/// The curves of a Mitsuba file, each point with its radius; a comment may stand behind the numbers.
fn read_mitsuba(text: &str) -> Vec<Vec<(DVec3, f64)>> {
    let point = |line: &str| {
        let numbers = line.split('#').next().expect("there is a part").split_whitespace();
        let numbers: Vec<f64> = numbers.map(|number| number.parse().expect("it is a number")).collect();
        assert_eq!(numbers.len(), 4, "{line}");
        (DVec3::new(numbers[0], numbers[1], numbers[2]), numbers[3])
    };
    text.trim_end().split("\n\n").map(|curve| curve.lines().map(point).collect()).collect()
}

/// The polylines of an OBJ file with their materials.
fn read_obj(text: &str) -> Vec<(Vec<DVec3>, String)> {
    let (mut points, mut curves, mut material) = (Vec::new(), Vec::new(), String::new());
    for line in text.lines() {
        let (key, rest) = line.split_once(' ').expect("a line has a key");
        match key {
            "v" => {
                let numbers: Vec<f64> = rest.split(' ').map(|number| number.parse().expect("it is a number")).collect();
                points.push(DVec3::from_slice(&numbers));
            }
            "l" => {
                let index = |number: &str| number.parse::<usize>().expect("it is a number") - 1;
                curves.push((rest.split(' ').map(|number| points[index(number)]).collect(), material.clone()));
            }
            "usemtl" => material = rest.into(),
            _ => assert!(["#", "g"].contains(&key), "{line}"),
        }
    }
    curves
}

#[test]
fn files_hold_the_fibers_of_the_realization() {
    let (place, cloth) = (Place::new(), woven().cloth());
    std::fs::write(place.path("hairy.toml"), woven().text()).expect("it can be written");
    for number in ["0", "3"] {
        let fibers = drawn(&cloth, number.parse().expect("it is a number"));
        let total: f64 = fibers.iter().map(|fiber| length(&fiber.points)).sum();
        assert!(fibers.iter().any(|fiber| fiber.hair));
        for (to, file) in [("mitsuba", "hairy.txt"), ("obj", "hairy.obj")] {
            let outcome = place.run(&["curves", "hairy.toml", "--to", to, "--realization", number]);
            assert_eq!((outcome.code, outcome.stdout.lines().last()), (Some(0), Some(file)), "{}", outcome.stderr);
            let text = std::fs::read_to_string(place.path(file)).expect("it is there");
            assert!(text.contains(&format!("realization {number}")) && text.contains("period 1.500000000 1.500000000"));
            let read: Vec<(Vec<DVec3>, Option<f64>)> = match to {
                "mitsuba" => {
                    let split = |curve: Vec<(DVec3, f64)>| {
                        let radius = curve[0].1;
                        assert!(curve.len() >= 4 && curve.iter().all(|(_, other)| *other == radius));
                        (curve.into_iter().map(|(point, _)| point).collect(), Some(radius))
                    };
                    read_mitsuba(&text).into_iter().map(split).collect()
                }
                _ => read_obj(&text).into_iter().map(|(points, _)| (points, None)).collect(),
            };
            assert_eq!(read.len(), fibers.len());
            let sum: f64 = read.iter().map(|(points, _)| length(points)).sum();
            assert!((sum / total - 1.0).abs() < 1e-6, "{sum} and {total}");
            for ((points, radius), fiber) in read.iter().zip(&fibers) {
                // Short curves have more points on their pieces.
                assert!(points.len() == fiber.points.len() || fiber.points.len() < 4);
                let ends = [(points.first(), fiber.points.first()), (points.last(), fiber.points.last())];
                assert!(ends.iter().all(|(a, b)| a.zip(*b).is_some_and(|(a, b)| a.distance(*b) < 1e-6)));
                assert!(radius.is_none_or(|radius| (radius - fiber.radius).abs() < 1e-9));
                if points.len() == fiber.points.len() {
                    assert!(points.iter().zip(&fiber.points).all(|(a, b)| a.distance(*b) < 1e-6));
                }
            }
        }
    }
}

#[test]
fn curves_lie_as_the_cloth_file_or_the_flag_says() {
    let place = Place::new();
    let woven = Woven::of(&[".X", "X."], Yarn::new(7, 60.0, 60.0, "ply_twist_per_m = 400"), 60.0);
    std::fs::write(place.path("apart.toml"), woven.text() + "[model]\npacking = \"separate\"\n")
        .expect("it can be written");
    let scene = Scene::parse(&Source::find(&place.path("apart.toml").to_string_lossy()).expect("it is there"));
    let scene = scene.expect("it is right");
    let fibers = |packing| {
        let drawn = Realizer::new(&scene, packing, DrawnFor::Fibers).and_then(|realizer| realizer.draw(3));
        drawn.unwrap_or_else(|error| panic!("{error}")).fibers
    };
    let (apart, random) = (fibers(Packing::Separate), fibers(Packing::Random));
    let same = |points: &[(Vec<DVec3>, String)], fibers: &[Curve]| {
        points.iter().zip(fibers).all(|((points, _), fiber)| {
            points.len() == fiber.points.len() && points.iter().zip(&fiber.points).all(|(a, b)| a.distance(*b) < 1e-6)
        })
    };
    for (flags, drawn, other, words) in [
        (&[][..], &apart, &random, "moved apart, so they do not overlap"),
        (&["--packing", "separate"], &apart, &random, "moved apart, so they do not overlap"),
        (&["--packing", "random"], &random, &apart, "laid at random, so they may overlap"),
    ] {
        let outcome = place.run(&[&["curves", "apart.toml", "--to", "obj", "--realization", "3"], flags].concat());
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        let text = std::fs::read_to_string(place.path("apart.obj")).expect("it is there");
        assert!(outcome.stdout.contains(words) && text.contains(&format!("# fibers {words}\n")), "{}", outcome.stdout);
        let read = read_obj(&text);
        assert!(read.len() == drawn.len() && same(&read, drawn), "{flags:?}");
        assert!(!same(&read, other), "{flags:?}");
    }
    let outcome = place.run(&["curves", "apart.toml", "--to", "obj", "--packing", "dense"]);
    assert!(outcome.code == Some(2) && outcome.stderr.contains("random, separate"), "{}", outcome.stderr);
}

#[test]
fn repeats_are_moved_by_periods_and_kinds_can_be_written_alone() {
    let (place, cloth) = (Place::new(), woven().cloth());
    std::fs::write(place.path("hairy.toml"), woven().text()).expect("it can be written");
    let run = |flags: &[&str]| {
        let outcome = place.run(&[&["curves", "hairy.toml", "--to", "obj", "-o", "made/file.obj"], flags].concat());
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        read_obj(&std::fs::read_to_string(place.path("made/file.obj")).expect("it is there"))
    };
    let one = run(&[]);
    let six = run(&["--repeats", "3x2"]);
    assert_eq!(six.len(), 6 * one.len());
    for (index, (points, _)) in six.iter().enumerate() {
        let (repeat, base) = (index / one.len(), &one[index % one.len()].0);
        let shift = DVec3::new((repeat % 3) as f64 * cloth.period().x, (repeat / 3) as f64 * cloth.period().y, 0.0);
        assert!(points.iter().zip(base).all(|(a, b)| a.distance(*b + shift) < 2e-6));
    }
    let [thin, thick] = ["thin", "thick"].map(|kind| run(&["--fiber", kind]));
    assert!(thin.iter().all(|(_, material)| material == "thin") && !thick.is_empty());
    assert_eq!(thin.len() + thick.len(), one.len());
}

#[test]
fn wrong_requests_are_refused_and_leave_nothing() {
    let place = Place::new();
    let sheet = "a sheet has no fibers that lie anywhere: it says how many run which way; curves are those of a weave or a knit";
    let repeats = "must be two whole numbers from 1 to 1000, such as 3x2";
    for (flags, message) in [
        (&["felt", "--to", "obj"][..], sheet.to_owned()),
        (&["voile", "--to", "obj", "--fiber", "x"], "no thread has fibers named `x`; fibers: cotton".into()),
        (&["voile", "--to", "obj", "--repeats", "2"], format!("invalid value '2' for '--repeats <NxM>': {repeats}")),
        (
            &["voile", "--to", "obj", "--repeats", "0x1"],
            format!("invalid value '0x1' for '--repeats <NxM>': {repeats}"),
        ),
        (&["voile", "--to", "obj", "-o", ".."], ".. is not the name of a file: -o names one".into()),
    ] {
        let outcome = place.run(&[&["curves"], flags].concat());
        assert_eq!((outcome.code, outcome.stderr), (Some(2), format!("error: {message}\n")), "{flags:?}");
    }
    assert_eq!(std::fs::read_dir(place.path("")).expect("it is there").count(), 0);
}

/// What Mitsuba says of a file: the number of pieces, and the heights that rays from above meet.
fn trace(shape: &str, file: &Path, places: &[[f64; 2]]) -> (usize, Vec<Option<f64>>) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let places: Vec<String> = places.iter().map(|[x, y]| format!("{x},{y}")).collect();
    let output = Command::new(root.join("target/venv/bin/python"))
        .arg(root.join("tests/cloth/trace_curves.py"))
        .args([shape.as_ref(), file.as_os_str()])
        .args(&places)
        .output()
        .expect("tools/setup.sh makes target/venv");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout);
    let mut lines = text.lines();
    let pieces = lines.next().and_then(|line| line.parse().ok()).expect("it says a number");
    (pieces, lines.map(|line| line.parse().ok()).collect())
}

#[test]
fn mitsuba_reads_the_curves_and_meets_a_fiber_where_it_lies() {
    // Threads of one fiber of 10 µm; the ends are straight, so a ray beside their axis by d meets them √(R² − d²) above it.
    let woven = Woven { warp_crimp_share: 0.0, ..Woven::of(&[".X", "X."], Yarn::new(1, 10.0, 10.0, ""), 20.0) };
    let (place, cloth) = (Place::new(), woven.cloth());
    std::fs::write(place.path("net.toml"), woven.text()).expect("it can be written");
    let outcome = place.run(&["curves", "net.toml", "--to", "mitsuba", "--repeats", "2x2"]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (Some(0), ""));
    let axis = cloth.axis_height(&cloth.threads()[0], 0.0);
    let rays = [[0.25, 0.9], [0.253, 0.9], [1.75 - 0.004, 1.1], [0.35, 0.9]];
    let heights = [Some(5.0f64), Some(4.0), Some(3.0), None].map(|up| up.map(|up| axis + up * 1e-3));
    let points: usize = drawn(&cloth, 0).iter().map(|fiber| fiber.points.len()).sum();
    for (shape, lost) in [("linearcurve", 1), ("bsplinecurve", 3)] {
        let (pieces, met) = trace(shape, &place.path("net.txt"), &rays);
        assert_eq!(pieces, 4 * (points - lost * cloth.threads().len()), "{shape}");
        for (met, height) in met.iter().zip(heights) {
            let near = match (met, height) {
                (Some(met), Some(height)) => (met - height).abs() < 2e-5,
                (met, height) => met.is_none() && height.is_none(),
            };
            assert!(near, "{shape}: {met:?} and {height:?}");
        }
    }
    // Hairs of two points get more of them.
    std::fs::write(place.path("hairy.toml"), self::woven().text()).expect("it can be written");
    let outcome = place.run(&["curves", "hairy.toml", "--to", "mitsuba"]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (Some(0), ""));
    let text = std::fs::read_to_string(place.path("hairy.txt")).expect("it is there");
    let curves = read_mitsuba(&text);
    for (shape, lost) in [("linearcurve", 1), ("bsplinecurve", 3)] {
        let pieces: usize = curves.iter().map(|curve| curve.len() - lost).sum();
        assert_eq!(trace(shape, &place.path("hairy.txt"), &[]).0, pieces, "{shape}");
    }
}
