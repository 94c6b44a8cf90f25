//! Migration, loops and hairs: fibers that do not keep their distance from the middle of their yarn.

mod common;

use common::stats::{GATE, binomial_z, mean_error};
use common::woven::{Woven, Yarn, crossing, fibers};
use fiberwalk::cloth::{Cloth, Curve};
use glam::DVec3;
use statrs::distribution::{ContinuousCDF, Normal};
use std::f64::consts::{PI, TAU};

const PLAIN: &[&str] = &[".X", "X."];
/// Kolmogorov–Smirnov: √n D above this has a probability of 10⁻³ (2 exp(−2 x²)).
const KOLMOGOROV: f64 = 1.95;
/// Radius of the axes of the outermost fibers of [`straight`] yarns in mm.
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
    left.hypot(up) - RIM
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
    // The rise does not change on the way: 25° ± 10° where the file does not say.
    let rise = |hair: &Curve| {
        let end = height(&cloth, hair, hair.points.last().expect("it has points"));
        (end / length(hair)).asin().to_degrees()
    };
    let rises: Vec<f64> = hairs.iter().map(rise).collect();
    let found = kolmogorov(&rises, cut_normal(25.0, 10.0, [0.0, 55.0]));
    let bent = kolmogorov(&rises, cut_normal(27.0, 10.0, [0.0, 57.0]));
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
    for (lines, twist) in [(HAIRY, 0.6), ("twist_per_m = -600\nflyaways = { hairs_per_mm = 9, hair_length_um = [200, 0] }", -0.6)] {
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
        let [[x, z], [u, w]] = [&hair.points[0], hair.points.last().expect("it has points")].map(|p| off(&cloth, &hair, p));
        assert!((x * w - z * u).abs() < 1e-12);
        let rise = (u.hypot(w) - RIM) / length(&hair);
        assert!((rise - 40f64.to_radians().sin()).abs() < 1e-9, "{rise}");
    }
}

#[test]
fn the_kinds_of_hairs_and_loops_are_those_of_the_blend() {
    let yarn = Yarn {
        fiber: "{ thin = 0.7, thick = 0.3 }",
        ..Yarn::new(40, 300.0, 300.0, "ply_twist_per_m = 900\nflyaways = { hairs_per_mm = 5, hair_length_um = [200, 50], loops_per_mm = 4, loop_height_um = [80, 20] }")
    };
    let cloth = Woven { warp_crimp_share: 0.0, ..Woven::of(PLAIN, yarn, 20.0) }.cloth();
    let (mut hair, mut looped) = ([0, 0], [0, 0]);
    for curve in (0..200).flat_map(|draw| curves(&cloth, draw, 0)) {
        let top = curve.points.iter().map(|point| height(&cloth, &curve, point)).fold(0.0, f64::max);
        if curve.hair {
            hair[curve.kind - 1 + usize::from(curve.kind == 0)] += 1;
        } else if top > 0.01 {
            looped[curve.kind - 1 + usize::from(curve.kind == 0)] += 1;
        }
    }
    let _ = (hair, looped);
}
