//! Migration, loops and hairs: fibers that do not keep their distance from the middle of their yarn.

use crate::common::stats::{GATE, binomial_z, mean_error};
use crate::common::woven::{Woven, Yarn, crossing, fibers};
use fiberwalk::cloth::{Cloth, Curve};
use glam::DVec3;
use statrs::distribution::{ContinuousCDF, Normal};
use std::f64::consts::{PI, TAU};

const PLAIN: &[&str] = &[".X", "X."];
/// Kolmogorov–Smirnov: √n D above this has a probability of 10⁻³ (2 exp(−2 x²)).
const KOLMOGOROV: f64 = 1.95;
/// Radius of [`straight`] yarns, and of the axes of their outermost fibers of 10 µm, in mm.
const YARN: f64 = 0.15;
const RIM: f64 = 0.145;

/// A plain weave of one round yarn 0.3 mm thick whose warp is straight; its repeat is 1 mm.
fn straight(fibers: u32, lines: &'static str) -> Cloth {
    Woven { warp_crimp_share: 0.0, ..Woven::of(PLAIN, Yarn::new(fibers, 300.0, 300.0, lines), 20.0) }.cloth()
}

/// The fibers of a thread.
fn curves(cloth: &Cloth, draw: u64, thread: usize) -> Vec<Curve> {
    let mut curves = Vec::new();
    cloth.draw_thread(7, draw, thread, &mut |curve| curves.push(curve.clone()));
    curves
}

/// The hairs of the ends of several draws.
fn hairs(cloth: &Cloth, draws: u64) -> Vec<Curve> {
    let of = |draw| (0..2).flat_map(move |end| curves(cloth, draw, end)).filter(|curve| curve.hair);
    (0..draws).flat_map(of).collect()
}

/// Where a point lies off the axis of its end: (left, up).
fn off(cloth: &Cloth, curve: &Curve, point: &DVec3) -> [f64; 2] {
    let thread = &cloth.threads()[curve.thread];
    [thread.at - point.x, point.z - cloth.axis_height(thread, point.y)]
}

/// Height over the surface of a round yarn.
fn height(cloth: &Cloth, curve: &Curve, point: &DVec3) -> f64 {
    let [left, up] = off(cloth, curve, point);
    left.hypot(up) + curve.radius - YARN
}

fn length(curve: &Curve) -> f64 {
    curve.points.windows(2).map(|ends| ends[0].distance(ends[1])).sum()
}

/// Largest distance of a sample from a distribution, times √n.
fn kolmogorov(sample: &[f64], distribution: impl Fn(f64) -> f64) -> f64 {
    let mut shares: Vec<f64> = sample.iter().map(|x| distribution(*x)).collect();
    shares.sort_by(f64::total_cmp);
    let n = shares.len() as f64;
    let far = shares.iter().enumerate().map(|(i, u)| (u - i as f64 / n).abs().max((u - (i + 1) as f64 / n).abs()));
    n.sqrt() * far.fold(0.0, f64::max)
}

/// The distribution function of a normal variable that is drawn anew outside of low to high.
fn cut_normal(mean: f64, deviation: f64, [low, high]: [f64; 2]) -> impl Fn(f64) -> f64 {
    let normal = Normal::new(mean, deviation).expect("it is a distribution");
    let (below, above) = (normal.cdf(low), normal.cdf(high));
    move |x| ((normal.cdf(x) - below) / (above - below)).clamp(0.0, 1.0)
}

const HAIRY: &str = "ply_twist_per_m = 600\nflyaways = { hairs_per_mm = 3.3, hair_length_um = [600, 200] }";

#[test]
fn hairs_have_their_number_lengths_rises_and_places() {
    let cloth = straight(5, HAIRY);
    let draws = 500;
    // 3.3 hairs on a mm are 3 or 4.
    let numbers: Vec<usize> =
        (0..draws).map(|draw| curves(&cloth, draw, 0).iter().filter(|curve| curve.hair).count()).collect();
    assert!(numbers.iter().all(|number| [3, 4].contains(number)));
    let fours = numbers.iter().filter(|number| **number == 4).count() as u64;
    let z = |share: f64| binomial_z(fours, draws, share);
    assert!(z(0.3).abs() < GATE && z(0.5).abs() > 2.0 * GATE, "{fours}");

    let hairs = hairs(&cloth, draws);
    let lengths: Vec<f64> = hairs.iter().map(|hair| 1e3 * length(hair)).collect();
    let found = kolmogorov(&lengths, cut_normal(600.0, 200.0, [0.0, 1200.0]));
    let bent = kolmogorov(&lengths, cut_normal(640.0, 200.0, [40.0, 1240.0]));
    assert!(found < KOLMOGOROV && bent > 2.0 * KOLMOGOROV, "{found} {bent}");
    // The rise does not change on the way: 25° ± 15° where the file does not say.
    let rise = |hair: &Curve| {
        let end = height(&cloth, hair, hair.points.last().expect("it has points"));
        (end / length(hair)).asin().to_degrees()
    };
    let rises: Vec<f64> = hairs.iter().map(rise).collect();
    let found = kolmogorov(&rises, cut_normal(25.0, 15.0, [0.0, 70.0]));
    let bent = kolmogorov(&rises, cut_normal(28.0, 15.0, [0.0, 73.0]));
    assert!(found < KOLMOGOROV && bent > 2.0 * KOLMOGOROV, "{found} {bent}");
    // They start anywhere on the surface.
    let roots: Vec<[f64; 2]> = hairs.iter().map(|hair| off(&cloth, hair, &hair.points[0])).collect();
    assert!(hairs.iter().all(|hair| height(&cloth, hair, &hair.points[0]).abs() < 1e-12));
    let azimuths: Vec<f64> = roots.iter().map(|[left, up]| up.atan2(*left) / TAU + 0.5).collect();
    let places: Vec<f64> = hairs.iter().map(|hair| hair.points[0].y.rem_euclid(1.0)).collect();
    for sample in [azimuths, places] {
        let found = kolmogorov(&sample, |x| x);
        let bent = kolmogorov(&sample, |x| x.powf(1.25));
        assert!(found < KOLMOGOROV && bent > 2.0 * KOLMOGOROV, "{found} {bent}");
    }
}

#[test]
fn hairs_go_the_way_of_the_outermost_fibers_forwards_or_backwards() {
    // Unrolled from the yarn a hair climbs at the angle of the twist: along : round = 1 : 2π R T.
    for (lines, twist) in
        [(HAIRY, 0.6), ("twist_per_m = -600\nflyaways = { hairs_per_mm = 9, hair_length_um = [200, 0] }", -0.6)]
    {
        let cloth = straight(5, lines);
        let hairs = hairs(&cloth, 300);
        let mut forwards = 0;
        for hair in &hairs {
            let [[x, z], [u, w]] = [off(&cloth, hair, &hair.points[0]), off(&cloth, hair, &hair.points[1])];
            let round = (x * w - z * u).atan2(x * u + z * w) * (RIM + x.hypot(z).max(u.hypot(w))) / 2.0;
            let along = hair.points[1].y - hair.points[0].y;
            assert!((round / along / (TAU * RIM * twist) - 1.0).abs() < 0.02, "{round} {along}");
            forwards += u64::from(along > 0.0);
        }
        assert!(binomial_z(forwards, hairs.len() as u64, 0.5).abs() < GATE, "{forwards} of {}", hairs.len());
    }
    // Without twist they lie in a plane with the axis.
    let cloth = straight(5, "flyaways = { hairs_per_mm = 9, hair_length_um = [200, 50], hair_rise_deg = [40, 0] }");
    for hair in hairs(&cloth, 20) {
        let [[x, z], [u, w]] =
            [&hair.points[0], hair.points.last().expect("it has points")].map(|p| off(&cloth, &hair, p));
        assert!((x * w - z * u).abs() < 1e-12);
        let rise = (u.hypot(w) - RIM) / length(&hair);
        assert!((rise - 40f64.to_radians().sin()).abs() < 1e-9, "{rise}");
    }
}

#[test]
fn the_kinds_of_hairs_and_loops_are_those_of_the_blend() {
    let lines = "ply_twist_per_m = 900\nflyaways = { hairs_per_mm = 5, hair_length_um = [200, 50], loops_per_mm = 4, loop_height_um = [80, 20] }";
    let yarn = Yarn { fiber: "{ thin = 0.7, thick = 0.3 }", ..Yarn::new(40, 300.0, 300.0, lines) };
    let cloth = Woven { warp_crimp_share: 0.0, ..Woven::of(PLAIN, yarn, 20.0) }.cloth();
    // All and those of the kind `thin`, of hairs and of loops.
    let mut counts = [[0; 2]; 2];
    for curve in (0..400).flat_map(|draw| curves(&cloth, draw, 0)) {
        if curve.hair || top(&cloth, &curve) > 0.01 {
            let count = &mut counts[usize::from(curve.hair)];
            *count = [count[0] + 1, count[1] + u64::from(curve.kind == 1)];
        }
    }
    for [all, thin] in counts {
        let z = |share: f64| binomial_z(thin, all, share);
        assert!(all > 1000 && z(0.7).abs() < GATE && z(0.5) > 2.0 * GATE, "{thin} of {all}");
    }
}

/// Height of the highest point of a fiber over the surface of its yarn.
fn top(cloth: &Cloth, curve: &Curve) -> f64 {
    curve.points.iter().map(|point| height(cloth, curve, point)).fold(f64::NEG_INFINITY, f64::max)
}

fn near(a: &DVec3, b: &DVec3) -> bool {
    a.distance(*b) < 1e-12
}

fn same(a: &Curve, b: &Curve) -> bool {
    a.points.len() == b.points.len() && a.points.iter().zip(&b.points).all(|(a, b)| near(a, b))
}

/// The fibers of an end of a cloth, as far below z = 0 as those of a thicker one.
fn lower(cloth: &Cloth, thicker: &Cloth, draw: u64) -> Vec<Curve> {
    let mut curves = curves(cloth, draw, 0);
    let depth = (thicker.thickness() - cloth.thickness()) / 2.0;
    curves.iter_mut().flat_map(|curve| &mut curve.points).for_each(|point| point.z -= depth);
    curves
}

const LOOPY: &str = "ply_twist_per_m = 1250\nflyaways = { loops_per_mm = 2.4, loop_height_um = [80, 30] }";

#[test]
fn loops_have_their_number_and_heights_and_move_no_other_fiber() {
    let (cloth, plain) = (straight(60, LOOPY), straight(60, "ply_twist_per_m = 1250"));
    let draws = 500;
    let (mut heights, mut threes, mut widths) = (Vec::new(), 0, Vec::new());
    for draw in 0..draws {
        let (with, without) = (curves(&cloth, draw, 0), lower(&plain, &cloth, draw));
        // They add no fiber.
        assert_eq!(with.len(), without.len());
        let looped: Vec<usize> = (0..60).filter(|index| !same(&with[*index], &without[*index])).collect();
        // 2.4 loops of 0.8 mm on a mm are 2 or 3; no fiber of this repeat has room for a second one.
        assert!([2, 3].contains(&looped.len()), "{looped:?}");
        threes += u64::from(looped.len() == 3);
        for index in looped {
            heights.push(1e3 * top(&cloth, &with[index]));
            // The rest of the fiber lies where it lay.
            let kept = |point: &&DVec3| without[index].points.iter().any(|other| near(point, other));
            let moved = with[index].points.iter().filter(|point| !kept(point));
            let along: Vec<f64> = moved.map(|point| point.y).collect();
            widths.push(
                along.iter().copied().fold(f64::NEG_INFINITY, f64::max)
                    - along.iter().copied().fold(f64::INFINITY, f64::min),
            );
            assert!(length(&with[index]) > 0.99 * length(&without[index]));
        }
    }
    let z = |share: f64| binomial_z(threes, draws, share);
    assert!(z(0.4).abs() < GATE && z(0.2) > 2.0 * GATE, "{threes}");
    let found = kolmogorov(&heights, cut_normal(80.0, 30.0, [0.0, 170.0]));
    let bent = kolmogorov(&heights, cut_normal(92.0, 30.0, [2.0, 182.0]));
    assert!(found < KOLMOGOROV && bent > 2.0 * KOLMOGOROV, "{found} {bent}");
    // A loop that the cut does not part is one turn long.
    let whole = widths.iter().filter(|width| **width < 0.86).count();
    assert!(widths.iter().all(|width| *width < 1.0 + 1e-9) && whole * 10 > widths.len(), "{whole} of {}", widths.len());
}

#[test]
fn loops_with_a_twist_turn_as_the_fiber_does() {
    // The azimuth of a fiber that loops is the one that it would have.
    let (cloth, plain) = (straight(60, LOOPY), straight(60, "ply_twist_per_m = 1250"));
    let depth = (cloth.thickness() - plain.thickness()) / 2.0;
    let azimuth = |curve: &Curve, plane: f64| {
        let place = curve.points.windows(2).find(|ends| ends[0].y <= plane && ends[1].y > plane);
        let ends = place.expect("the fiber passes");
        let [left, up] = off(&cloth, curve, &ends[0].lerp(ends[1], (plane - ends[0].y) / (ends[1].y - ends[0].y)));
        up.atan2(left)
    };
    let mut looked = 0;
    for draw in 0..20 {
        for (with, without) in curves(&cloth, draw, 0).iter().zip(&lower(&plain, &cloth, draw)) {
            // At the middle of the yarn there is no azimuth.
            let central = height(&plain, without, &(without.points[0] + DVec3::Z * depth)) < 0.05 - YARN;
            if central || same(with, without) {
                continue;
            }
            let start = with.points[0].y;
            for step in 1..20 {
                let plane = start + f64::from(step) / 20.0;
                let off = azimuth(with, plane) - azimuth(without, plane);
                assert!(((off + PI).rem_euclid(TAU) - PI).abs() < 0.01, "{off}");
                looked += 1;
            }
        }
    }
    assert!(looked > 500);
}

#[test]
fn hairs_and_loops_add_their_length_to_the_mass() {
    let lines = "flyaways = { hairs_per_mm = 3.3, hair_length_um = [600, 200] }";
    let cloth = straight(5, lines);
    let draws = 400;
    let of_draw = |draw| curves(&cloth, draw, 0).iter().filter(|curve| curve.hair).map(length).sum::<f64>();
    let added: Vec<f64> = (0..draws).map(of_draw).collect();
    let square = added.iter().map(|x| x * x).sum();
    let (mean, error) = mean_error(added.iter().sum(), square, draws as f64);
    // The cut is as far on both sides, so the mean stays 600 µm.
    let z = |closed: f64| (mean - closed) / error;
    assert!(z(3.3 * 0.6).abs() < GATE && z(3.3 * 0.65).abs() > 2.0 * GATE, "{mean} ± {error}");
    // The stated mass is that of all pieces of the first draw: π R² ρ of fibers of 10 µm, 1.5 g/cm³, on 1 mm².
    let total: f64 = cloth.realize(0, 0).iter().map(|piece| piece.length).sum();
    let mass = cloth.statistics().areal_mass.expect("densities are known");
    assert!((mass / (PI * 25e-6 * 1.5e3 * total) - 1.0).abs() < 1e-12);
    let without = straight(5, "").statistics().areal_mass.expect("densities are known");
    assert!(mass > without * 1.2, "{mass} and {without}");
}

/// A tight weave of yarns of three sizes, all with hairs, loops, migration and plies.
fn wild() -> Woven {
    let lines = "twist_per_m = -400\nply_twist_per_m = 700\nmigration = { radius = [0.6, 1.0], periods_per_turn = 1.3 }\n\
                 flyaways = { hairs_per_mm = 8, hair_length_um = [300, 150], hair_rise_deg = [40, 40], \
                 loops_per_mm = 4, loop_height_um = [90, 60] }";
    let yarn = |width: f64, height: f64| Yarn {
        plies: 2,
        fiber: "{ thin = 0.5, thick = 0.5 }",
        ..Yarn::new(20, width, height, lines)
    };
    Woven {
        yarns: vec![yarn(450.0, 300.0), yarn(280.0, 120.0), yarn(550.0, 330.0)],
        warp: vec![0, 1, 2, 1],
        weft: vec![2, 1, 0, 1],
        ..Woven::of(&["XXX.", "X.X.", ".XXX", "..XX", ".X.."], yarn(1.0, 300.0), 20.0)
    }
}

#[test]
fn nothing_sticks_out_of_the_cloth_and_the_cloth_is_no_thicker_than_it_needs_to_be() {
    let cloth = wild().cloth();
    let mut highest = [f64::NEG_INFINITY; 2];
    for draw in 0..30 {
        for piece in cloth.realize(3, draw) {
            let reach = piece.direction.z.abs() * piece.length / 2.0;
            let reach = reach + piece.radius * (1.0 - piece.direction.z.powi(2)).sqrt();
            assert!(piece.centre.z + reach < 1e-12, "{piece:?}");
            assert!(piece.centre.z - reach > -cloth.thickness() - 1e-12, "{piece:?}");
            highest =
                [highest[0].max(piece.centre.z + reach), highest[1].max(-cloth.thickness() - piece.centre.z + reach)];
        }
    }
    // The steepest and longest of thousands of hairs come near.
    assert!(highest.iter().all(|room| *room > -0.3), "{highest:?}");
    // Three standard deviations of the length, straight up, above and below.
    let mut plain = wild();
    plain.yarns.iter_mut().for_each(|yarn| yarn.lines = "");
    let thickness = plain.cloth().thickness();
    assert!((cloth.thickness() - thickness - 2.0 * 0.75).abs() < 1e-9, "{} and {thickness}", cloth.thickness());
    // Of hairs that rise by 30° half as much, of loops three standard deviations of their height.
    for (lines, reach) in [
        ("flyaways = { hairs_per_mm = 8, hair_length_um = [300, 150], hair_rise_deg = [30, 0] }", 0.375),
        ("flyaways = { loops_per_mm = 2, loop_height_um = [90, 60], loop_span_um = 500 }", 0.27),
    ] {
        plain.yarns.iter_mut().for_each(|yarn| yarn.lines = lines);
        assert!((plain.cloth().thickness() - thickness - 2.0 * reach).abs() < 1e-9, "{lines}");
    }
}

#[test]
fn pieces_of_wild_fibers_follow_them() {
    // The sagitta of a piece is its length times the turn at its end over eight; the turn is shared by two pieces.
    let sagitta = |cloth: &Cloth, threads: usize| {
        let mut worst = [0.0f64; 2];
        for curve in (0..2).flat_map(|draw| (0..threads).flat_map(move |thread| curves(cloth, draw, thread))) {
            for corner in curve.points.windows(3) {
                let [a, b] = [corner[1] - corner[0], corner[2] - corner[1]];
                let turn = a.angle_between(b);
                worst = [worst[0].max(turn * (a.length() + b.length()) / 16.0 / curve.radius), worst[1].max(turn)];
            }
        }
        worst
    };
    // A piece turns by 0.15 at most, and the axis is a polyline of a quarter of that.
    let cloth = wild().cloth();
    let found = sagitta(&cloth, cloth.threads().len());
    assert!(found[0] < 0.1 && found[1] < 0.25, "{found:?}");
    let migrating = straight(20, "ply_twist_per_m = 500\nmigration = { radius = [0.1, 1.0], periods_per_turn = 2 }");
    let found = sagitta(&migrating, 2);
    assert!(found[0] < 0.1 && found[0] > 0.001 && found[1] < 0.25, "{found:?}");
}

#[test]
fn a_fiber_that_migrates_swings_between_its_shares_with_its_period() {
    let cloth = straight(100, "ply_twist_per_m = 1000\nmigration = { radius = [0.3, 0.9], periods_per_turn = 2 }");
    let away = |fiber: &[_], plane: f64| {
        let [left, up] = crossing(&cloth, &cloth.threads()[0], fiber, plane);
        left.hypot(up) / RIM
    };
    let mut radii = Vec::new();
    for draw in 0..40 {
        // A mm of yarn is two swings: the cut of a thread is not seen.
        for fiber in fibers(&cloth, 7, draw, 0) {
            let at = [0.1, 0.225, 0.35, 0.475, 0.6].map(|plane| away(&fiber, plane));
            // Half a period apart, the distances add up to (0.3 + 0.9) r; a quarter further they do so too.
            let [sum, other] = [at[0] + at[2], at[1] + at[3]];
            assert!((sum - other).abs() < 0.01 && (at[0] - at[4]).abs() < 0.01, "{at:?}");
            let own = sum / 1.2;
            assert!(own < 1.01 && at.iter().all(|x| *x > 0.3 * own - 0.01 && *x < 0.9 * own + 0.01), "{at:?}");
            radii.push(at[0]);
        }
    }
    // r² is uniform and the phase as well: P(r g < x) = ⟨min(1, x²/g²)⟩ with g = 0.6 + 0.3 cos φ.
    let law = |middle: f64, swing: f64| {
        move |x: f64| {
            let part =
                |step: i32| (x / (middle + swing * (PI * (f64::from(step) + 0.5) / 500.0).cos())).powi(2).min(1.0);
            (0..500).map(part).sum::<f64>() / 500.0
        }
    };
    let found = kolmogorov(&radii, law(0.6, 0.3));
    let bent = kolmogorov(&radii, law(0.65, 0.25));
    assert!(found < KOLMOGOROV && bent > 2.0 * KOLMOGOROV, "{found} {bent}");
}

#[test]
fn migration_lengthens_a_fiber_by_its_way_in_and_out() {
    // ⟨√(1 + ṙ² + ω² r²)⟩ over u = r², φ and the yarn, with r = √u R (m + a cos φ) and φ̇ = k.
    let closed = |periods: f64| {
        let (omega, swing, middle) = (TAU, 0.4, 0.6);
        let part = |u: i32, phase: i32| {
            let own = RIM * ((f64::from(u) + 0.5) / 200.0).sqrt();
            let (sin, cos) = (TAU * (f64::from(phase) + 0.5) / 200.0).sin_cos();
            let (r, rate) = (own * (middle + swing * cos), own * swing * sin * periods * omega);
            (1.0 + rate * rate + (omega * r).powi(2)).sqrt()
        };
        (0..200).flat_map(|u| (0..200).map(move |phase| part(u, phase))).sum::<f64>() / 40_000.0
    };
    let cloth = straight(100, "ply_twist_per_m = 1000\nmigration = { radius = [0.2, 1], periods_per_turn = 2 }");
    let lengths: Vec<f64> = (0..80).flat_map(|draw| curves(&cloth, draw, 0)).map(|curve| length(&curve)).collect();
    let square = lengths.iter().map(|x| x * x).sum();
    let (mean, error) = mean_error(lengths.iter().sum(), square, lengths.len() as f64);
    let z = |periods: f64| (mean - closed(periods)) / error;
    assert!(z(2.0).abs() < GATE && z(2.4).abs() > 2.0 * GATE, "{} {} {mean} ± {error}", z(2.0), z(2.4));
}

#[test]
fn draws_are_functions_of_the_seed_and_the_number_and_pieces_are_those_of_the_polylines() {
    let cloth = wild().cloth();
    let pieces = cloth.realize(7, 2);
    assert_eq!(pieces, cloth.realize(7, 2));
    assert_ne!(pieces[0], cloth.realize(7, 3)[0]);
    let of_curves = (0..cloth.threads().len()).flat_map(|thread| curves(&cloth, 2, thread));
    let (mut count, mut total, mut hairs) = (0, 0.0, 0);
    for curve in of_curves {
        count += curve.points.len() - 1;
        total += length(&curve);
        hairs += usize::from(curve.hair);
    }
    let length: f64 = pieces.iter().map(|piece| piece.length).sum();
    assert!(count == pieces.len() && (total / length - 1.0).abs() < 1e-12, "{count} and {}", pieces.len());
    assert!(hairs > 50);
    let expected = cloth.expected_pieces() as f64;
    assert!((0.8..1.2).contains(&(count as f64 / expected)), "{count} and {expected}");
}

#[test]
fn a_yarn_without_these_keys_is_drawn_as_ever() {
    // Sums over all pieces of a draw that was recorded before there were such keys.
    let lines = "ply_twist_per_m = 500\nradial_profile = { eps = 0.1, beta = 0.8 }";
    let yarn = Yarn { fiber: "{ thin = 0.7, thick = 0.3 }", ..Yarn::new(62, 400.0, 300.0, lines) };
    let pieces = Woven::of(&["X..", ".X.", "..X"], yarn, 20.0).cloth().realize(3, 5);
    let weight = |index: usize| (index % 97) as f64 + 1.0;
    let place = |c: DVec3| c.x + 2.0 * c.y + 3.0 * c.z;
    let sum: f64 =
        pieces.iter().enumerate().map(|(i, p)| weight(i) * (place(p.centre) + p.direction.x * 0.1) * p.length).sum();
    assert_eq!(pieces.len(), 25_612);
    assert!((sum / 45_565.340_337_149_4 - 1.0).abs() < 1e-11, "{sum}");
}
