//! The picture of a weave: what it shows is the draft, the sections and the openness of the cloth.

use crate::common::program::Place;
use crate::common::woven::{Woven, Yarn, preset};
use fiberwalk::cloth::{Cloth, System};
use fiberwalk::measure::prepare;
use fiberwalk::reference::Reference;
use fiberwalk::report::{Depth, Face, Picture, cloth_picture, pile};
use fiberwalk::scene::{Absorption, Fiber, Scene, Source};
use fiberwalk::walk::{Engine, WalkPlan};
use glam::DVec2;
use std::f64::consts::PI;

/// A draft that no mirror and no turn leaves alone.
const DRAFT: [&str; 3] = ["XX..", ".XXX", "X..X"];
const COLOURS: &str = "absorption_per_mm = { rgb = [1, 90, 90] }";

fn woven(draft: &[&str]) -> Woven {
    let warp = Yarn::new(420, 300.0, 240.0, "ply_twist_per_m = 500");
    let weft = Yarn { fiber: "\"thick\"", ..Yarn::new(150, 330.0, 200.0, "") };
    Woven { yarns: vec![warp.clone(), weft], weft: vec![1], picks_per_cm: 22.0, ..Woven::of(draft, warp, 26.0) }
}

/// The scene of a weave with red warp and blue weft.
fn scene(draft: &[&str]) -> Scene {
    let text = woven(draft).text();
    let text = text.replacen("ior = 1.5\n", &format!("ior = 1.5\n{COLOURS}\n"), 1);
    let blue = "[fiber.thick]\nabsorption_per_mm = { rgb = [90, 60, 1] }\n";
    let text = text.replacen("[fiber.thick]\n", blue, 1);
    let source = Source { file: "cloth.toml".into(), stem: "cloth".into(), text, folder: None };
    Scene::parse(&source).unwrap_or_else(|error| panic!("{error}\n{}", source.text))
}

fn pictured(draft: &[&str]) -> (Cloth, Picture) {
    let scene = scene(draft);
    let cloth = Cloth::new(&scene).expect("it can be laid out");
    let picture = cloth_picture(&cloth, &scene, 900);
    (cloth, picture)
}

/// One realization seen from a face.
fn seen(cloth: &Cloth, face: Face, size: [usize; 2], number: u64) -> Depth {
    let mut depth = Depth::face(cloth, face, size);
    cloth.realize(4, number).iter().for_each(|piece| depth.draw(piece));
    depth
}

/// Crossings (end, pick) where a face does not show what the draft says, by 49 points round the middle of each.
fn faults(cloth: &Cloth, draft: &[&str], face: Face) -> Vec<(usize, usize)> {
    let depth = seen(cloth, face, [400, 360], 0);
    let (ends, picks) = cloth.threads().split_at(draft[0].len());
    let mut faults = Vec::new();
    for end in ends {
        for pick in picks {
            let x = if face == Face::Front { end.at } else { -end.at };
            let points = (0..49).map(|place| DVec2::new(f64::from(place % 7 - 3), f64::from(place / 7 - 3)) * 0.01);
            let threads = points.map(|off| depth.at_point(DVec2::new(x, pick.at) + off));
            let shown: Vec<usize> =
                threads.filter(|seen| !seen.is_nothing()).map(|seen| seen.thread as usize).collect();
            let over = draft[draft.len() - 1 - pick.index].as_bytes()[end.index] == b'X';
            // The warp is seen on the front where it lies over, on the back where it lies under.
            let wanted = if over == (face == Face::Front) { end.index } else { ends.len() + pick.index };
            if shown.iter().filter(|thread| **thread == wanted).count() < 40 {
                faults.push((end.index, pick.index));
            }
        }
    }
    faults
}

#[test]
fn every_crossing_shows_the_thread_that_the_draft_says() {
    let cloth = woven(&DRAFT).cloth();
    for face in [Face::Front, Face::Back] {
        assert_eq!(faults(&cloth, &DRAFT, face), [], "{face:?}");
        // Flip the crossing of the second end with the third pick.
        assert_eq!(faults(&cloth, &["X...", ".XXX", "X..X"], face), [(1, 2)], "{face:?}");
    }
    // A back that is not turned, or turned about the weft, would show another draft.
    let rows: Vec<String> = DRAFT.iter().map(|row| row.chars().rev().collect()).collect();
    let mirrored: Vec<&str> = rows.iter().map(String::as_str).collect();
    assert!(!faults(&cloth, &mirrored, Face::Back).is_empty());
}

/// Whether the picture is red or blue about a pixel, in a square of 2 reach + 1 pixels; none when it is neither.
fn red(picture: &Picture, [column, row]: [usize; 2], reach: usize) -> Option<bool> {
    let side = 2 * reach + 1;
    let pixels =
        (0..side * side).map(|place| picture.image.pixel(column + place % side - reach, row + place / side - reach));
    let count = |more: fn([u8; 3]) -> bool| pixels.clone().filter(|pixel| more(*pixel)).count();
    let warp = count(|[red, _, blue]| red > blue.saturating_add(20));
    let weft = count(|[red, _, blue]| blue > red.saturating_add(20));
    (warp.max(weft) > 3 * warp.min(weft) && warp.max(weft) > side * side / 4).then_some(warp > weft)
}

#[test]
fn the_image_shows_the_draft_on_both_faces() {
    let check = |picture: &Picture| {
        let mut faults = 0;
        for end in 0..4 {
            for pick in 0..3 {
                let over = DRAFT[2 - pick].as_bytes()[end] == b'X';
                let share = |index: usize, count: usize| (index as f64 + 0.5) / count as f64;
                // Look at the second repeat as well.
                for repeat in [0.0, 1.0] {
                    let point = DVec2::new(share(end, 4), share(pick, 3)) + repeat;
                    if red(picture, picture.front.pixel(point), 2) != Some(over) {
                        faults += 1;
                    }
                    let [_, row] = picture.back.pixel(point);
                    let [column, _] = picture.back.pixel(DVec2::new(point.x, 0.0));
                    let mirrored = 2 * picture.back.left + picture.back.width - 1 - column;
                    if red(picture, [mirrored, row], 2) != Some(!over) {
                        faults += 1;
                    }
                }
            }
        }
        faults
    };
    assert_eq!(check(&pictured(&DRAFT).1), 0);
    // Two repeats on two faces of one flipped crossing.
    assert_eq!(check(&pictured(&["X...", ".XXX", "X..X"]).1), 4);
}

#[test]
fn the_cuts_show_their_threads_at_their_heights() {
    let (cloth, picture) = pictured(&DRAFT);
    let (ends, picks) = cloth.threads().split_at(4);
    for (panel, system) in picture.cuts.iter().zip([System::Warp, System::Weft]) {
        let (own, crossed) = if system == System::Warp { (&ends[0], picks) } else { (&picks[0], ends) };
        let top = panel.top as f64 + 0.5 * (panel.height as f64 - cloth.thickness() * panel.per_mm);
        let place = |along: f64, z: f64| {
            [panel.left + (along * panel.per_mm) as usize, (top - z * panel.per_mm).round() as usize]
        };
        for other in crossed {
            let along = place(other.at, cloth.axis_height(own, other.at));
            assert_eq!(red(&picture, along, 6), Some(system == System::Warp), "{system:?} {other:?}");
            let across = place(other.at, cloth.axis_height(other, own.at));
            assert_eq!(red(&picture, across, 6), Some(system == System::Weft), "{system:?} {other:?}");
        }
    }
}

#[test]
fn open_pixels_are_the_openness_less_the_rims_that_fibers_do_not_reach() {
    // Fibers fill the ellipse of a yarn at random. Of n fibers uniform in a disc none lies farther to one side than 1 − e
    // with the probability exp(−n c e^(3/2)), c = 4 √2 / (3 π) for a flat cap; so the outermost lies on average
    // Γ(5/3) (n c)^(−2/3) inside, in units of the half width less a fiber's radius, and covers its own radius beyond.
    let cloth = preset("voile");
    let figures = cloth.statistics();
    let yarn = &cloth.weave().expect("it is a weave").yarns[0];
    let caps = f64::from(yarn.fibers_per_ply) * 4.0 * 2f64.sqrt() / (3.0 * PI);
    let rim = 0.902_745 * caps.powf(-2.0 / 3.0) * (yarn.width / 2.0 - cloth.kinds()[0].radius);
    let seen_width = yarn.width - 2.0 * rim;
    let expected = (1.0 - seen_width / cloth.weave().expect("it is a weave").end_spacing).powi(2);
    let draws = 6;
    let size = [900, 900];
    let found = (0..draws).map(|draw| seen(&cloth, Face::Front, size, draw).openness()).sum::<f64>() / draws as f64;
    assert!((found - expected).abs() < 0.006, "{found}, expected {expected}");
    // The outlines of the yarns leave less open, by five times that.
    assert!(found > figures.openness + 0.025, "{found} and {}", figures.openness);
    let [front, back] = [Face::Front, Face::Back].map(|face| seen(&cloth, face, size, 0).openness());
    let scene = Scene::parse(&Source::find("voile").expect("it is a preset")).expect("it is right");
    let drawn = cloth_picture(&cloth, &scene, 900).openness;
    assert!((drawn - expected).abs() < 0.02, "a coarser buffer of one draw: {drawn}");
    assert!((front - back).abs() < 1e-3, "light goes through both ways: {front} and {back}");
}

#[test]
fn a_pile_has_the_colour_that_walks_through_one_find() {
    // 3 mm of planar fibers that fill 0.3 let nothing through.
    let (radius, rgb) = (0.0057, [70.0, 12.0, 0.5]);
    let length = 0.3 / (PI * radius * radius);
    let text = format!(
        "[fiber.f]\nradius_um = {}\nior = 1.55\nabsorption_per_mm = {{ rgb = {rgb:?} }}\n[sheet]\nthickness_um = 3000\n\
         [[sheet.fibers]]\nfiber = \"f\"\nlength_density_per_mm2 = {length}\norientation = \"planar\"\n\
         [measure]\nincident = 4\nexit = 4\n",
        radius * 1e3
    );
    let scene = Scene::parse(&Source { file: "f".into(), stem: "f".into(), text, folder: None }).expect("it is right");
    let prepared = prepare(&scene).expect("it can be measured");
    let plan = WalkPlan::new(3, 600);
    let tally = Reference.run(&prepared.tables, &prepared.goniometer, &plan, &mut |_| {}).expect("it runs");
    let fiber = Fiber { name: "f".into(), radius, ior: 1.55, density: None, absorption: Absorption::Rgb(rgb) };
    for (channel, shown) in pile(&fiber).into_iter().enumerate() {
        let walked = fiberwalk::bsdf::hemispherical(&tally, &prepared.goniometer, 0, channel)
            .expect("a disc has a mean")
            .reflectance;
        let off = f64::from(shown) / walked.value - 1.0;
        assert!(off.abs() < 0.1 + 3.0 * walked.stderr / walked.value, "{channel}: {shown} and {walked:?}");
    }
}

#[test]
fn extreme_weaves_have_a_picture() {
    let narrow = Woven {
        ends_per_cm: 20.0,
        picks_per_cm: 900.0,
        ..Woven::of(&[".X", "X."], Yarn::new(1, 11.0, 11.0, ""), 20.0)
    };
    let high = Woven::of(&[".X", "X."], Yarn::new(20, 300.0, 8000.0, ""), 20.0);
    let touching = Woven::of(&["XXX.", "XX.X", "X.XX", ".XXX"], Yarn::new(5, 500.0, 300.0, ""), 20.0);
    let row =
        |lift: usize| (0..64).map(|end| if (end + lift).is_multiple_of(7) { '.' } else { 'X' }).collect::<String>();
    let rows: Vec<String> = (0..7).map(row).collect();
    let wide = Woven::of(&rows.iter().map(String::as_str).collect::<Vec<_>>(), Yarn::new(5, 400.0, 300.0, ""), 20.0);
    for woven in [narrow, high, touching, wide] {
        let source = Source { file: "f".into(), stem: "f".into(), text: woven.text(), folder: None };
        let scene = Scene { name: "名".repeat(200), ..Scene::parse(&source).expect("it is right") };
        for width in [0, 1000] {
            let picture = cloth_picture(&woven.cloth(), &scene, width);
            let [columns, rows] = picture.image.size();
            assert!(columns == width.max(600) && rows < 2 * columns, "{columns} × {rows}");
        }
    }
}

/// A place with the cloth in a file that says how it is modelled: then there is nothing to plan.
fn place_with_cloth() -> Place {
    let place = Place::new();
    place.write("cloth.toml", woven(&DRAFT).text() + "[model]\ncells = [24, 20, 12]\n");
    place
}

#[test]
fn inspect_writes_a_picture_that_can_be_read() {
    let place = place_with_cloth();
    let outcome = place.run(&["inspect", "cloth.toml", "--width", "700"]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    for line in ["repeat           4 ends × 3 picks, 1.5385 × 1.3636 mm\n", "yarns overlap    0 µm at most\n"] {
        assert!(outcome.stdout.contains(line), "{}", outcome.stdout);
    }
    let file = outcome.stdout.lines().last().expect("the last line names the picture");
    assert_eq!(file, "cloth/weave.png");
    let bytes = std::fs::read(place.path(file)).expect("it is there");
    let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().expect("it is a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("it is small")];
    let frame = reader.next_frame(&mut pixels).expect("it is whole");
    assert_eq!((frame.width, frame.color_type), (700, png::ColorType::Rgb));
    assert_eq!(pixels.len(), 3 * 700 * frame.height as usize);
    // The same again, into another folder that is made; what lies in a folder stays.
    let again = place.run(&["inspect", "cloth.toml", "--width", "700", "-o", "a/b"]);
    assert_eq!(again.stdout.lines().last(), Some("a/b/weave.png"));
    assert!(std::fs::read(place.path("a/b/weave.png")).expect("it is there") == bytes);
    place.write("a/b/notes.txt", "mine");
    place.write("a/b/weave.png", "old");
    assert_eq!(place.run(&["inspect", "cloth.toml", "--width", "700", "-o", "a/b"]).code, Some(0));
    assert!(std::fs::read(place.path("a/b/weave.png")).expect("it is there") == bytes);
    assert_eq!(std::fs::read_dir(place.path("a/b")).expect("it is there").count(), 2);
}

#[test]
fn a_picture_that_cannot_be_written_is_refused_in_one_sentence() {
    let place = place_with_cloth();
    place.write("taken", "a file");
    std::fs::create_dir_all(place.path("held/weave.png")).expect("a folder can be made");
    let before = place.contents();
    for (arguments, message) in [
        (&["cloth.toml", "-o", "taken"][..], "taken is not a folder: -o names the folder of the result"),
        (&["cloth.toml", "-o", "held"], "held holds a folder named weave.png: -o names another folder"),
        (&["cloth.toml", "-o", "taken/below"], "cannot write the result"),
        (&["cloth.toml", "--width", "30"], "must be a whole number from 600 to 3200"),
        (&["felt", "-o", "felt"], "a sheet has no yarns to draw: leave out -o and --width"),
    ] {
        let outcome = place.run(&[&["inspect"], arguments].concat());
        assert_eq!((outcome.code, outcome.stdout.as_str()), (Some(2), ""), "{outcome:?}");
        assert!(outcome.stderr.contains(message) && outcome.stderr.lines().count() == 1, "{outcome:?}");
        assert_eq!(place.contents(), before, "{arguments:?}");
    }
}
