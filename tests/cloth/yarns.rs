//! The fibers of a yarn: twist, plies, blends, radial density, pieces.

use crate::common::stats::{GATE, chi2_z, mean_error};
use crate::common::woven::{Woven, Yarn, crossing, fibers};
use fiberwalk::cloth::{Cloth, Primitive, System};
use fiberwalk::scene::{RadialProfile, Scene, Source};
use std::f64::consts::TAU;

const PLAIN: &[&str] = &[".X", "X."];
/// Radius of seven equal circles that touch each other and the rim of the unit disc.
const PLY: f64 = 0.302_6;
/// Kolmogorov–Smirnov: √n D above this has a probability of 10⁻³ (2 exp(−2 x²)).
const KOLMOGOROV: f64 = 1.95;

/// A plain weave of one round yarn 0.3 mm thick whose warp is straight.
fn straight(yarn: Yarn) -> Cloth {
    let yarn = Yarn { width_um: 300.0, height_um: 300.0, ..yarn };
    Woven { warp_crimp_share: 0.0, ..Woven::of(PLAIN, yarn, 20.0) }.cloth()
}

fn turns(per_m: &'static str, fibers: u32) -> Yarn {
    Yarn::new(fibers, 0.0, 0.0, per_m)
}

/// Largest distance of a sample from the uniform distribution, times √n.
fn kolmogorov(mut sample: Vec<f64>) -> f64 {
    sample.sort_by(f64::total_cmp);
    let n = sample.len() as f64;
    let far = sample.iter().enumerate().map(|(i, u)| (u - i as f64 / n).abs().max((u - (i + 1) as f64 / n).abs()));
    n.sqrt() * far.fold(0.0, f64::max)
}

/// The fibers of the ends of several draws, all different.
fn ends(cloth: &Cloth, draws: u64) -> Vec<Vec<Primitive>> {
    (0..draws).flat_map(|draw| (0..2).flat_map(move |end| fibers(cloth, 7, draw, end))).collect()
}

#[test]
fn helix_angles_of_a_straight_yarn_have_their_distribution() {
    // A fiber at distance r from the axis has tan θ = 2π r T. It lies anywhere in the disc, so r² is uniform up to R², and
    // with it tan² θ.
    let sample = |turns_per_mm: f64, cloth: &Cloth| -> Vec<f64> {
        let most = TAU * (0.15 - 0.005) * turns_per_mm;
        let tangent = |fiber: &Vec<Primitive>| {
            let p = fiber[fiber.len() / 2].direction;
            p.x.hypot(p.z) / p.y
        };
        ends(cloth, 20).iter().map(|fiber| (tangent(fiber) / most).powi(2)).collect()
    };
    let cloth = straight(turns("ply_twist_per_m = 600", 300));
    let found = kolmogorov(sample(0.6, &cloth));
    assert!(found < KOLMOGOROV, "{found}");
    // A twist that is 2.5 % larger moves the distribution by 0.05 / (0.5 / √12000), 11 standard errors.
    let bent = kolmogorov(sample(0.6, &straight(turns("ply_twist_per_m = 615", 300))));
    assert!(bent > 2.0 * KOLMOGOROV, "{bent}");
}

#[test]
fn twist_takes_up_length() {
    // ⟨1 / cos θ⟩ = ∫ √(1 + k² u) du = ((1 + k²)^(3/2) − 1) · 2 / (3 k²) with k = 2π R T, u = r²/R² uniform.
    let k: f64 = TAU * 0.145 * 0.6;
    let closed = ((1.0 + k * k).powf(1.5) - 1.0) * 2.0 / (3.0 * k * k);
    let z = |cloth: &Cloth| {
        let lengths: Vec<f64> =
            ends(cloth, 20).iter().map(|fiber| fiber.iter().map(|piece| piece.length).sum::<f64>()).collect();
        let square = lengths.iter().map(|length| length * length).sum();
        let (mean, error) = mean_error(lengths.iter().sum(), square, lengths.len() as f64);
        (mean - closed * cloth.period().y) / error
    };
    let found = z(&straight(turns("ply_twist_per_m = -600", 300)));
    assert!(found.abs() < GATE, "{found}");
    let bent = z(&straight(turns("ply_twist_per_m = 615", 300)));
    assert!(bent > 2.0 * GATE, "{bent}");
}

/// ⟨(r × p) · t⟩ of the pieces of a system, r from its axis and t along it: above 0 for a right-handed helix.
fn handedness(cloth: &Cloth, system: System) -> f64 {
    let threads = cloth.threads().iter().enumerate().filter(|(_, thread)| thread.system == system);
    let mut sum = 0.0;
    for (index, thread) in threads {
        cloth.realize_thread(5, 0, index, &mut |piece| {
            let p = piece.direction;
            sum += match system {
                // y · (r × p) = r_z p_x − r_x p_z, x · (r × p) = r_y p_z − r_z p_y.
                System::Warp => {
                    let (x, z) =
                        (piece.centre.x - thread.at, piece.centre.z - cloth.axis_height(thread, piece.centre.y));
                    z * p.x - x * p.z
                }
                System::Weft => {
                    let (y, z) =
                        (piece.centre.y - thread.at, piece.centre.z - cloth.axis_height(thread, piece.centre.x));
                    y * p.z - z * p.y
                }
            };
        });
    }
    sum
}

#[test]
fn z_twist_is_right_handed_and_climbs_to_the_right_on_the_front() {
    let (z, s) = ("ply_twist_per_m = 600", "ply_twist_per_m = -600");
    for system in [System::Warp, System::Weft] {
        assert!(handedness(&straight(turns(z, 200)), system) > 0.0, "{system:?}");
        assert!(handedness(&straight(turns(s, 200)), system) < 0.0, "{system:?}");
    }
    // The middle stroke of the letter Z: on the front of an end, x rises with y. A pick is the end turned by a quarter, so
    // there y falls with x.
    for (lines, sign) in [(z, 1.0), (s, -1.0)] {
        let cloth = straight(turns(lines, 300));
        let mut front = 0;
        for piece in cloth.realize(5, 0) {
            let thread = &cloth.threads()[piece.thread];
            let warp = thread.system == System::Warp;
            let along = if warp { piece.centre.y } else { piece.centre.x };
            if piece.centre.z - cloth.axis_height(thread, along) < 0.1 {
                continue;
            }
            front += 1;
            let slope = sign * piece.direction.x * piece.direction.y;
            assert!(if warp { slope > 0.0 } else { slope < 0.0 }, "{piece:?}");
        }
        assert!(front > 1000);
    }
}

#[test]
fn mirrored_twist_gives_the_mirrored_distribution() {
    // x → −x turns Z into S: compare the mean tilt of fibers of the right half of an end.
    let tilt = |lines: &'static str| {
        let cloth = straight(turns(lines, 300));
        let right = |fiber: &&Vec<Primitive>| {
            let piece = fiber[fiber.len() / 2];
            piece.centre.x > cloth.threads()[piece.thread].at
        };
        let tilts: Vec<f64> =
            ends(&cloth, 10).iter().filter(right).map(|fiber| fiber[fiber.len() / 2].direction.z).collect();
        mean_error(tilts.iter().sum(), tilts.iter().map(|tilt| tilt * tilt).sum(), tilts.len() as f64)
    };
    let (z, s) = (tilt("ply_twist_per_m = 600"), tilt("ply_twist_per_m = -600"));
    let error = z.1.hypot(s.1);
    assert!(((z.0 + s.0) / error).abs() < GATE, "{z:?} {s:?}");
    assert!(((z.0 - s.0) / error).abs() > 2.0 * GATE, "{z:?} {s:?}");
}

#[test]
fn blends_have_their_counts_and_are_mixed() {
    let yarn = Yarn { fiber: "{ thin = 0.7, thick = 0.3 }", ..turns("", 101) };
    let cloth = straight(yarn);
    let (mut thin, mut thick) = (Vec::new(), Vec::new());
    for draw in 0..40 {
        let fibers = fibers(&cloth, 2, draw, 0);
        // 70.7 and 30.3 of 101.
        assert_eq!(
            fibers.iter().filter(|fiber| fiber[0].kind == 1).count(),
            71,
            "kinds are in the order of their names"
        );
        for fiber in &fibers {
            let [a, b] = crossing(&cloth, &cloth.threads()[0], fiber, 0.3);
            let (kind, room) = if fiber[0].kind == 1 { (&mut thin, 0.145) } else { (&mut thick, 0.142) };
            kind.push((a * a + b * b) / (room * room));
        }
    }
    // Both fill the disc: r² is uniform.
    assert!(kolmogorov(thin) < KOLMOGOROV && kolmogorov(thick) < KOLMOGOROV);
}

#[test]
fn a_radial_profile_has_its_density() {
    let cloth = straight(turns("radial_profile = { eps = 0.1, beta = 0.8 }", 300));
    let squares: Vec<f64> = ends(&cloth, 20)
        .iter()
        .map(|fiber| crossing(&cloth, &cloth.threads()[fiber[0].thread], fiber, 0.2))
        .map(|[a, b]| (a * a + b * b) / (0.145 * 0.145))
        .collect();
    // Ten rings of equal area, with the density integrated by 200 midpoints; u = r².
    let z = |density: &dyn Fn(f64) -> f64| {
        let ring = |ring: usize| {
            (0..200).map(|step| density(((ring as f64 + (f64::from(step) + 0.5) / 200.0) / 10.0).sqrt())).sum::<f64>()
        };
        let total: f64 = (0..10).map(ring).sum();
        let n = squares.len() as f64;
        let chi2: f64 = (0..10)
            .map(|index| {
                let found = squares.iter().filter(|u| ((**u * 10.0) as usize).min(9) == index).count() as f64;
                let expected = n * ring(index) / total;
                (found - expected).powi(2) / expected
            })
            .sum();
        chi2_z(chi2, 9.0)
    };
    // Zhao, Luan, Bala 2016, section 3.
    let e = std::f64::consts::E;
    let profile = |eps: f64, beta: f64| move |r: f64| (1.0 - 2.0 * eps) * ((e - r.exp()) / (e - 1.0)).powf(beta) + eps;
    let found = z(&profile(0.1, 0.8));
    assert!(found < GATE, "{found}");
    let bent = z(&profile(0.1, 0.5));
    assert!(bent > 2.0 * GATE, "{bent}");
    for r in [0.0, 0.3, 1.0] {
        let stated = RadialProfile { eps: 0.1, beta: 0.8 };
        assert!((stated.density(r) - profile(0.1, 0.8)(r)).abs() < 1e-12);
    }
}

#[test]
fn plies_lie_at_their_radius_and_turn_with_the_twist_of_the_yarn() {
    // Of three plies at c e^{iφ}: the mean of q³ is c³ e^{3iφ}, since a fiber's place in its ply has no third moment.
    let yarn = Yarn { plies: 3, ..turns("twist_per_m = 400\nply_twist_per_m = -500", 100) };
    let cloth = straight(yarn);
    let thread = cloth.threads()[0];
    let third = |draw: u64, plane: f64| {
        let mut sum = [0.0; 2];
        for fiber in fibers(&cloth, 4, draw, 0) {
            let [a, b] = crossing(&cloth, &thread, &fiber, plane).map(|x| x / 0.15);
            sum = [sum[0] + a * a * a - 3.0 * a * b * b, sum[1] + 3.0 * a * a * b - b * b * b];
        }
        (sum[0].hypot(sum[1]) / 300.0, sum[1].atan2(sum[0]) / 3.0)
    };
    // Three circles that touch: radius 1 / (1 + 2/√3), so c = 1 less that.
    let centre = 1.0 - 1.0 / (1.0 + 2.0 / 3f64.sqrt());
    let draws = 30;
    let cubes: Vec<f64> = (0..draws).map(|draw| third(draw, 0.3).0).collect();
    let (mean, error) = mean_error(cubes.iter().sum(), cubes.iter().map(|x| x * x).sum(), draws as f64);
    assert!(((mean - centre.powi(3)) / error).abs() < GATE, "{mean} ± {error}, {}", centre.powi(3));
    // Left, up and the direction of the thread are right-handed, so a right-handed helix turns from left to up.
    let angles: Vec<f64> = (0..draws).map(|draw| third(draw, 0.6).1 - third(draw, 0.3).1).collect();
    let turned = |turns_per_mm: f64| {
        // Thirds of a turn look alike. An angle has a standard deviation of 0.04 (300 fibers).
        let off = |angle: &f64| (angle - TAU * turns_per_mm * 0.3 + TAU / 6.0).rem_euclid(TAU / 3.0) - TAU / 6.0;
        angles.iter().filter(|angle| off(angle).abs() < 0.15).count()
    };
    // The planes are 0.3 of 1 mm apart: the thread is cut between them in three of ten draws. By chance one in seven fits.
    assert!(turned(0.4) >= 16 && turned(-0.4) < 10 && turned(-0.5) < 10, "{angles:?}");
}

/// Least distance of the axes of two fibers of one ply and of two plies over their diameter, at a plane across an end.
fn nearest(plies: u32, fibers_per_ply: u32, size: f64) -> [f64; 2] {
    let lines = if plies > 1 { "twist_per_m = 300\nply_twist_per_m = -200" } else { "twist_per_m = 300" };
    let yarn = Yarn { plies, ..Yarn::new(fibers_per_ply, size, size, lines) };
    let cloth = Woven { warp_crimp_share: 0.0, ..Woven::of(PLAIN, yarn, 20.0) }.cloth();
    let mut nearest = [f64::INFINITY; 2];
    for draw in 0..50 {
        let all = fibers(&cloth, 3, draw, 0);
        let places: Vec<[f64; 2]> = all.iter().map(|fiber| crossing(&cloth, &cloth.threads()[0], fiber, 0.3)).collect();
        for (index, a) in places.iter().enumerate() {
            for (other, b) in places[..index].iter().enumerate() {
                let two = usize::from(index as u32 / fibers_per_ply != other as u32 / fibers_per_ply);
                nearest[two] = nearest[two].min((a[0] - b[0]).hypot(a[1] - b[1]) / 0.01);
            }
        }
    }
    nearest
}

#[test]
fn fibers_of_two_plies_are_a_diameter_apart_however_few_they_are() {
    // Pieces are a tenth of the radius off the fiber at most, both together a tenth of the diameter.
    for [plies, fibers] in [[7, 1], [2, 1], [2, 11], [4, 3]] {
        let found = nearest(plies, fibers, 76.0)[1];
        assert!(found > 0.9, "{plies} plies of {fibers}: {found}");
    }
    // Within a ply fibers may overlap, and so may fibers of one yarn without plies.
    assert!(nearest(2, 11, 76.0)[0] < 0.3 && nearest(1, 7, 76.0)[0] < 0.3);
    // Plies that are as thin as their fibers lay them where they touch.
    let touching = nearest(7, 1, 10.001 / PLY)[1];
    assert!((touching - 1.0).abs() < 0.1, "{touching}");
}

#[test]
fn a_ply_thinner_than_its_fiber_is_refused_and_each_cure_works() {
    let read = |plies: u32, height_um: f64| {
        let text = Woven::of(PLAIN, Yarn { plies, ..Yarn::new(9, 400.0, height_um, "") }, 20.0).text();
        Scene::parse(&Source { file: "test.toml".into(), stem: "test".into(), text, folder: None }).map(|_| ())
    };
    // Of three plies each is 1 / (1 + 2/√3) = 0.464 of the yarn.
    let message = read(3, 20.0).expect_err("9.3 µm is less than 10").to_string();
    for part in ["`thin` is 10 µm thick, but each of 3 plies is only 9.282 µm", "to 21.6 or take fewer plies"] {
        assert!(message.contains(part), "{message}");
    }
    assert!(read(3, 21.6).is_ok() && read(2, 20.0).is_ok() && read(3, 21.5).is_err());
}

#[test]
fn draws_are_functions_of_the_seed_and_the_number() {
    let cloth = Woven::of(PLAIN, Yarn::new(50, 400.0, 300.0, "ply_twist_per_m = 500"), 20.0).cloth();
    assert_eq!(cloth.realize(1, 2), cloth.realize(1, 2));
    let mut threads = Vec::new();
    for thread in (0..4).rev() {
        let mut pieces = Vec::new();
        cloth.realize_thread(1, 2, thread, &mut |piece| pieces.push(piece));
        threads.splice(0..0, pieces);
    }
    assert_eq!(cloth.realize(1, 2), threads, "threads can be drawn alone");
    for other in [cloth.realize(2, 2), cloth.realize(1, 3), cloth.realize(2, 1)] {
        assert_ne!(cloth.realize(1, 2)[0], other[0]);
    }
    let (expected, found) = (cloth.expected_pieces() as f64, cloth.realize(1, 2).len() as f64);
    assert!((found / expected - 1.0).abs() < 0.02, "{found} and {expected}");
}

#[test]
fn middles_of_pieces_fill_a_yarn_evenly() {
    // Count the length of pieces by their middles in 40 slices of an end, as the distribution calculator does. Slices are
    // shorter than pieces.
    let cloth = straight(turns("ply_twist_per_m = 300", 100));
    let slices = |fiber: &Vec<Primitive>| {
        let mut slices = [0.0; 40];
        for piece in fiber {
            slices[(piece.centre.y / cloth.period().y * 40.0) as usize] += 40.0 * piece.length * piece.direction.y;
        }
        slices
    };
    let all: Vec<[f64; 40]> = ends(&cloth, 40).iter().map(slices).collect();
    let z = |slice: usize| {
        let of = || all.iter().map(|slices| slices[slice] / cloth.period().y);
        let (mean, error) = mean_error(of().sum(), of().map(|x| x * x).sum(), all.len() as f64);
        (mean - 1.0) / error
    };
    let worst = (0..40).map(|slice| z(slice).abs()).fold(0.0, f64::max);
    assert!(worst < GATE, "{worst}");
    // One fiber has its own corners: alone it fills some slices twice and others not at all.
    let spread = all[0].iter().map(|length| (length / cloth.period().y - 1.0).powi(2)).sum::<f64>() / 40.0;
    assert!(spread > 0.1, "{spread}");
}

#[test]
fn pieces_follow_their_fiber_within_a_tenth_of_its_radius() {
    // A fiber without twist lies beside its axis: compare eleven points of each piece with the axis.
    let woven = Woven {
        ends_per_cm: 22.0,
        ..Woven::of(&["XXX.", "XX.X", "X.XX", ".XXX"], Yarn::new(20, 430.0, 120.0, ""), 20.0)
    };
    let cloth = woven.cloth();
    let mut worst: f64 = 0.0;
    for piece in cloth.realize(1, 0) {
        let thread = &cloth.threads()[piece.thread];
        let off = |share: f64| {
            let point = piece.centre + piece.direction * (share * piece.length);
            point.z - cloth.axis_height(thread, if thread.system == System::Warp { point.y } else { point.x })
        };
        let slope = (1.0 - piece.direction.z.powi(2)).sqrt();
        for step in -5..=5 {
            worst = worst.max((off(f64::from(step) / 10.0) - off(-0.5)).abs() * slope / piece.radius);
        }
    }
    assert!(worst < 0.1 && worst > 0.005, "{worst} radii");
    // A fiber of a straight yarn is a helix: the middle of its chord lies nearer to the axis than its ends.
    let cloth = straight(turns("ply_twist_per_m = 2000", 100));
    let mut worst: f64 = 0.0;
    for fiber in ends(&cloth, 1) {
        let at = cloth.threads()[fiber[0].thread].at;
        let height = cloth.axis_height(&cloth.threads()[fiber[0].thread], 0.0);
        for piece in &fiber {
            let away = |share: f64| {
                let point = piece.centre + piece.direction * (share * piece.length);
                (point.x - at).hypot(point.z - height)
            };
            worst = worst.max((away(0.5) - away(0.0)) / piece.radius);
        }
    }
    assert!(worst < 0.1 && worst > 0.01, "{worst} radii");
}
