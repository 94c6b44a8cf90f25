//! The geometry of knits: loops of the stated length, hooked into each other, that do not run through each other.

use crate::common::woven::fibers;
use fiberwalk::cloth::{Cloth, Shape};
use fiberwalk::scene::{Scene, Source};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// A knit as its file describes it; lengths in mm, stitches per cm.
#[derive(Clone, Copy, Debug)]
struct Knitted {
    structure: &'static str,
    courses: f64,
    wales: f64,
    length: f64,
    diameter_um: f64,
    twist: f64,
}

const JERSEY: Knitted =
    Knitted { structure: "jersey", courses: 13.0, wales: 10.5, length: 4.0, diameter_um: 210.0, twist: 0.0 };
const RIB: Knitted =
    Knitted { structure: "rib", courses: 13.5, wales: 20.0, length: 4.0, diameter_um: 200.0, twist: 0.0 };
/// A rib of long loops, which is made by lengthening shorter ones.
const LONG: Knitted =
    Knitted { structure: "rib", courses: 15.99, wales: 24.4, length: 3.44, diameter_um: 186.0, twist: 0.0 };
/// A rib that is pulled wide: its wales lie side by side.
const WIDE: Knitted =
    Knitted { structure: "rib", courses: 35.0, wales: 14.0, length: 2.0, diameter_um: 60.0, twist: 0.0 };

impl Knitted {
    fn text(&self) -> String {
        let Knitted { structure, courses, wales, length, diameter_um, twist } = self;
        format!(
            "[fiber.wool]\nradius_um = 5\nior = 1.5\ndensity_g_per_cm3 = 1.31\n[yarn.wool]\nfiber = \"wool\"\n\
             fibers_per_ply = 18\nwidth_um = {diameter_um}\nheight_um = {diameter_um}\nply_twist_per_m = {twist}\n\
             [knit]\nstructure = \"{structure}\"\nyarn = \"wool\"\ncourses_per_cm = {courses}\nwales_per_cm = {wales}\n\
             loop_length_mm = {length}\n"
        )
    }

    fn cloth(&self) -> Cloth {
        Cloth::new(&parse(&self.text()).expect("it is right")).expect("it fits")
    }
}

fn parse(text: &str) -> fiberwalk::Result<Scene> {
    Scene::parse(&Source { file: "cloth.toml".into(), stem: "cloth".into(), text: text.into(), folder: None })
}

/// So many points of the axis at equal lengths over a repeat, and the first of the next.
fn axis(cloth: &Cloth, count: usize) -> Vec<DVec3> {
    let thread = cloth.threads()[0];
    (0..=count).map(|place| cloth.axis_point(&thread, place as f64 / count as f64)).collect()
}

#[test]
fn density_and_loop_length_are_those_of_the_file() {
    for knitted in [JERSEY, RIB, WIDE, LONG, Knitted { courses: 18.0, length: 3.4, diameter_um: 150.0, ..JERSEY }] {
        let cloth = knitted.cloth();
        let wales = if knitted.structure == "rib" { 2.0 } else { 1.0 };
        assert!(cloth.period().abs_diff_eq(DVec2::new(10.0 * wales / knitted.wales, 10.0 / knitted.courses), 1e-12));
        let length: f64 = axis(&cloth, 40_000).windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        assert!((length / (wales * knitted.length) - 1.0).abs() < 1e-6, "{knitted:?}: {length}");
        let Shape::Knitted { loop_length, stitch_density, .. } = cloth.statistics().shape else {
            panic!("it is knitted")
        };
        assert_eq!(loop_length, knitted.length);
        assert!((100.0 * stitch_density / (knitted.courses * knitted.wales) - 1.0).abs() < 1e-12);
    }
}

/// How a course crosses another in the view of the front, along the upper from head to head: whether it lies over it.
fn crossings(upper: &[DVec3], lower: &[DVec3]) -> Vec<bool> {
    let mut found = Vec::new();
    for own in upper.windows(2) {
        for other in lower.windows(2) {
            let (along, across) = ((own[1] - own[0]).truncate(), (other[1] - other[0]).truncate());
            let gap = (other[0] - own[0]).truncate();
            let turn = along.perp_dot(across);
            let [s, t] = [gap.perp_dot(across) / turn, gap.perp_dot(along) / turn];
            if (0.0..1.0).contains(&s) && (0.0..1.0).contains(&t) {
                found.push(own[0].lerp(own[1], s).z > other[0].lerp(other[1], t).z);
            }
        }
    }
    found
}

#[test]
fn loops_hang_in_the_loops_below() {
    for (knitted, expected) in [
        // The legs lie before the head below, the feet behind the legs below.
        (JERSEY, vec![true, false, false, true]),
        // The same in the first half, and turned over where the next wale begins; then backwards.
        (WIDE, vec![true, false, true, false, false, true, false, true]),
    ] {
        let cloth = knitted.cloth();
        let repeat = axis(&cloth, 600);
        let images = (-2..=2).flat_map(|image| {
            let shift = DVec3::X * (f64::from(image) * cloth.period().x);
            repeat[..600].iter().map(move |point| *point + shift)
        });
        let lower: Vec<DVec3> = images.collect();
        let shifted = |lift: f64| -> Vec<DVec3> {
            repeat.iter().map(|point| *point + DVec3::new(0.0, cloth.period().y, lift)).collect()
        };
        assert_eq!(crossings(&shifted(0.0), &lower), expected, "{knitted:?}");
        // A course that only lies on the other does not hang in it.
        assert!(crossings(&shifted(1.0), &lower).iter().all(|over| *over));
    }
}

/// Least distance of points of the axis, in mm, that lie more than half the rim of a yarn apart along it.
fn least_distance(cloth: &Cloth, diameter: f64) -> f64 {
    let count = 480;
    let points = axis(cloth, count);
    let knit = cloth.knit().expect("it is a knit");
    let length = knit.loop_length * knit.wales() as f64;
    let mut least = f64::INFINITY;
    for course in 0..=4 {
        for image in -3..=3i32 {
            let shift = DVec3::new(f64::from(image) * cloth.period().x, f64::from(course) * cloth.period().y, 0.0);
            for (i, a) in points.iter().enumerate() {
                for (j, b) in points.iter().enumerate() {
                    let along = ((j as f64 - i as f64) / count as f64 + f64::from(image)) * length;
                    if course > 0 || along.abs() > PI * diameter / 2.0 {
                        least = least.min((*b + shift - *a).length());
                    }
                }
            }
        }
    }
    least
}

#[test]
fn yarns_do_not_run_through_each_other() {
    for knitted in [JERSEY, RIB, WIDE, LONG] {
        let cloth = knitted.cloth();
        let diameter = knitted.diameter_um / 1e3;
        let least = least_distance(&cloth, diameter);
        assert!(least > 0.98 * diameter, "{knitted:?}: {least}");
        assert!((cloth.largest_penetration() - (diameter - least)).abs() < 0.01 * diameter);
        // They touch: a yarn that is a little thicker would be in its own way.
        assert!(least < 0.98 * (1.05 * diameter), "{knitted:?}: {least}");
    }
}

#[test]
fn loops_are_mirror_images_and_repeat() {
    for knitted in [JERSEY, RIB] {
        let cloth = knitted.cloth();
        let thread = cloth.threads()[0];
        let at = |periods: f64| cloth.axis_point(&thread, periods);
        let middle = at(0.0).x;
        assert!((middle - 5.0 / knitted.wales).abs() < 1e-12);
        for place in 0..100 {
            let share = f64::from(place) / 100.0;
            let point = at(share);
            assert!((at(share + 1.0) - point - DVec3::X * cloth.period().x).length() < 1e-9);
            let mirrored = DVec3::new(2.0 * middle - point.x, point.y, point.z);
            assert!((at(-share) - mirrored).length() < 1e-6, "{share}");
            // Straight through every seam.
            let step = 1e-4;
            let bend = (at(share + step) + at(share - step) - 2.0 * point).length() / step;
            assert!(bend < 0.03, "{share}: {bend}");
        }
    }
}

#[test]
fn a_plain_loop_has_feet_like_its_head_and_a_rib_a_back_like_its_front() {
    // Jersey: half a loop further on it is turned over in y. Rib: turned about y it is itself, a wale further on.
    let differences = |knitted: Knitted, turn: fn(DVec3) -> DVec3, backwards: f64| {
        let cloth = knitted.cloth();
        let thread = cloth.threads()[0];
        let middle = DVec3::new(cloth.axis_point(&thread, 0.0).x, 0.0, -cloth.thickness() / 2.0);
        let difference = |place: u32| {
            let share = f64::from(place) / 64.0;
            let point = turn(cloth.axis_point(&thread, share) - middle) + DVec3::X * (cloth.period().x / 2.0);
            (cloth.axis_point(&thread, 0.5 + backwards * share) - middle - point).length()
        };
        (0..64).map(difference).fold(0.0, f64::max)
    };
    let over = |point: DVec3| point * DVec3::new(1.0, -1.0, 1.0);
    let about = |point: DVec3| point * DVec3::new(-1.0, 1.0, -1.0);
    assert!(differences(JERSEY, over, 1.0) < 1e-6 && differences(RIB, about, -1.0) < 1e-6);
    assert!(differences(RIB, over, 1.0) > 0.1 && differences(JERSEY, about, -1.0) > 0.1);
}

#[test]
fn a_rib_is_about_twice_as_thick_as_jersey() {
    let thickness = |knitted: Knitted| knitted.cloth().thickness() / (knitted.diameter_um / 1e3);
    // The loops of the presets.
    let jersey = thickness(Knitted { courses: 12.39, wales: 9.46, length: 4.44, diameter_um: 240.0, ..JERSEY });
    let rib = thickness(Knitted { length: 3.2, ..LONG });
    assert!((2.0..3.0).contains(&jersey) && (1.7..2.8).contains(&(rib / jersey)), "{jersey} and {rib} diameters");
}

#[test]
fn mass_follows_from_the_loop_length_and_the_twist() {
    for knitted in [JERSEY, RIB, Knitted { twist: 600.0, ..JERSEY }] {
        let cloth = knitted.cloth();
        // Bends shorten the inside by as much as they lengthen the outside; a helix is longer by its slope, with the mean
        // over a disc of radius r of √(1 + (2π twist ρ)²).
        let twist = 2.0 * PI * knitted.twist / 1e3 * (knitted.diameter_um / 2e3 - 0.005);
        let helix =
            if twist > 0.0 { 2.0 / 3.0 * ((1.0 + twist * twist).powf(1.5) - 1.0) / (twist * twist) } else { 1.0 };
        let fiber = 18.0 * PI * 0.005f64.powi(2) * 1.31e3;
        let expected = fiber * knitted.length * helix * knitted.courses * knitted.wales / 100.0;
        let found = cloth.statistics().areal_mass.expect("the density is stated");
        assert!((found / expected - 1.0).abs() < 0.01, "{knitted:?}: {found} and {expected}");
    }
}

#[test]
fn fibers_without_twist_close_over_the_repeat() {
    let ends = |knitted: Knitted| {
        let cloth = knitted.cloth();
        let gap = |fiber: &Vec<fiberwalk::cloth::Primitive>| {
            let (first, last) = (fiber[0], fiber[fiber.len() - 1]);
            let gap = (last.centre + last.direction * last.length / 2.0)
                - (first.centre - first.direction * first.length / 2.0);
            let apart = |gap: f64, period: f64| gap - period * (gap / period).round();
            DVec3::new(apart(gap.x, cloth.period().x), apart(gap.y, cloth.period().y), gap.z).length()
        };
        let fibers = fibers(&cloth, 0, 0, 0);
        assert_eq!(fibers.len(), 18);
        fibers.iter().map(gap).fold(0.0, f64::max)
    };
    // The frame that only bends with the yarn comes back to itself; a twisted yarn does not.
    for knitted in [JERSEY, RIB] {
        assert!(ends(knitted) < 1e-4, "{}", ends(knitted));
        assert!(ends(Knitted { twist: 80.0, ..knitted }) > 0.02);
    }
}

#[test]
fn fibers_stay_in_their_yarn_and_twist_as_they_should() {
    for twist in [500.0, -500.0] {
        let knitted = Knitted { twist, ..JERSEY };
        let cloth = knitted.cloth();
        let points = axis(&cloth, 4000);
        let mut handed = 0.0;
        for piece in cloth.realize(1, 0) {
            assert!(
                (0.0..cloth.period().x).contains(&piece.centre.x) && (0.0..cloth.period().y).contains(&piece.centre.y)
            );
            assert!(piece.centre.z < 0.0 && piece.centre.z > -cloth.thickness());
            // The nearest point of the axis, of any image.
            let mut best = (f64::INFINITY, DVec3::ZERO, DVec3::ZERO);
            for pair in points.windows(2).step_by(4) {
                for (across, up) in (-1..=1).flat_map(|across| (-2..=2).map(move |up| (across, up))) {
                    let shift = DVec2::new(f64::from(across), f64::from(up)) * cloth.period();
                    let off = piece.centre - pair[0] - shift.extend(0.0);
                    if off.length() < best.0 {
                        best = (off.length(), off, (pair[1] - pair[0]).normalize());
                    }
                }
            }
            assert!(best.0 < knitted.diameter_um / 2e3, "{} {piece:?}", best.0);
            handed += best.1.cross(piece.direction).dot(best.2) * piece.length;
        }
        assert_eq!(handed.signum(), twist.signum());
    }
}

#[test]
fn what_does_not_fit_is_refused_with_what_would() {
    let refused = |knitted: Knitted| {
        let scene = parse(&knitted.text()).expect("the file is right");
        Cloth::new(&scene).map(|_| ()).expect_err("it does not fit").to_string()
    };
    let thick = refused(Knitted { diameter_um: 300.0, ..JERSEY });
    let start =
        "loops of 4.0000 mm of a yarn that is 300 µm thick do not fit at these courses and wales: at most a yarn of ";
    let largest: f64 = thick
        .strip_prefix(start)
        .and_then(|rest| rest.split(' ').next())
        .and_then(|number| number.parse().ok())
        .unwrap_or_else(|| panic!("{thick}"));
    assert!(Cloth::new(&parse(&Knitted { diameter_um: largest, ..JERSEY }.text()).expect("it is right")).is_ok());
    assert!((210.0..260.0).contains(&largest), "{largest}");
    let short = refused(Knitted { length: 2.0, ..JERSEY });
    assert!(short.contains("`loop_length_mm` can be from about 3."), "{short}");
}

#[test]
fn a_yarn_that_is_too_thin_for_its_loops_is_refused_for_that() {
    let thin = |diameter_um: f64| {
        let text = Knitted { diameter_um, ..JERSEY }.text().replace("fibers_per_ply = 18", "fibers_per_ply = 2");
        parse(&text).and_then(|scene| Cloth::new(&scene))
    };
    let error = thin(31.0).map(|_| ()).expect_err("it is too thin").to_string();
    let message = "cloth.toml:13:8: yarn `wool` is 31 µm thick, too thin for loops of 4 mm: it must be at least 1/128 of \
                   them, 31.25 µm; or lower `loop_length_mm` to 3.968";
    assert_eq!(error, message);
    assert!(thin(31.25).is_ok());
}

#[test]
fn bad_knits_are_refused_at_their_place() {
    let text = JERSEY.text();
    for (old, new, message) in [
        ("\"jersey\"", "\"interlock\"", "12:13: `knit.structure`: unknown value \"interlock\"; allowed: jersey, rib"),
        ("yarn = \"wool\"", "yarn = \"wol\"", "13:8: there is no [yarn.wol], did you mean `wool`?; yarns: wool"),
        ("yarn = \"wool\"", "yarn = 3", "13:8: `knit.yarn` is 3, but must be the name of a yarn"),
        ("loop_length_mm = 4\n", "", "11:1: [knit] needs `loop_length_mm`"),
        (
            "courses_per_cm = 13",
            "courses_per_cm = 0",
            "14:18: `knit.courses_per_cm` is 0, but must be a number from 0.1 to 1000",
        ),
        (
            "loop_length_mm = 4",
            "loop_length_mm = 1.5",
            "16:18: a loop of 1.5 mm cannot reach the next course: at these courses and wales it is longer than 1.809 mm",
        ),
        (
            "height_um = 210",
            "height_um = 150",
            "13:8: yarn `wool` is 210 µm wide and 150 µm high, but a knitted yarn must be nearly round: one at most 1.25 \
             times the other",
        ),
        ("[knit]", "[sheet]\n[knit]", "12:1: a cloth is one of [sheet], [weave] and [knit]"),
        (
            "[knit]",
            "[knit]\nrows = 3",
            "12:1: unknown key `rows` in [knit]; allowed: structure, yarn, courses_per_cm, wales_per_cm, loop_length_mm",
        ),
    ] {
        assert_eq!(text.matches(old).count(), 1, "`{old}` must be there once");
        let error = parse(&text.replace(old, new)).expect_err(new);
        assert_eq!(error.to_string(), format!("cloth.toml:{message}"), "{new}");
    }
}
