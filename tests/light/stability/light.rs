//! Where light and fibers stand in degenerate directions.

use super::table::{
    Found, METHODS, NULL, TABULATED, beyond, direct, fails, right, said, section, setup, track, walks, within,
};
use crate::common::program::Place;
use crate::common::{Cloth, ISOTROPIC, PLANAR, SplitMix, aligned, engines};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The unit vector at θ, φ in degrees.
pub fn from_degrees([theta, phi]: [f64; 2]) -> DVec3 {
    let ((sin, cos), (y, x)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    DVec3::new(sin * x, sin * y, cos)
}

/// Fibers of 10 µm in a sheet of 1 mm lit from θ, φ, and the share of the volume that they fill.
fn lit(length_density: f64, orientation: &str, [theta, phi]: [f64; 2]) -> (Cloth, f64) {
    let cloth = Cloth::new(length_density, orientation).lit_from(&format!("[[{theta}, {phi}]]"));
    (cloth, PI * 1e-4 * length_density)
}

#[test]
fn grazing_light() {
    section("Grazing light");
    for (i, theta) in (0..).zip([85.0f64, 89.0, 89.9]) {
        let cosine = theta.to_radians().cos();
        // H d / cos θ = 1.
        let (cloth, v) = lit(cosine / (0.02 * PI / 4.0), ISOTROPIC, [theta, 30.0]);
        direct(&format!("light from {theta}°"), &cloth, 1.0, v, 1000 + 10 * i, &METHODS);
    }
    // The height of a direction from what its projection leaves, in f32, where rounding is worst.
    let naive = |phi: f64| {
        let wi = from_degrees([89.9, phi]).as_vec3();
        f64::from((1.0 - wi.x * wi.x - wi.y * wi.y).sqrt())
    };
    let cosine = 89.9f64.to_radians().cos();
    let phi = (0..360).map(f64::from).max_by(|a, b| naive(*a).total_cmp(&naive(*b))).unwrap_or_default();
    let (cloth, _) = lit(cosine / (0.02 * PI / 4.0), ISOTROPIC, [89.9, phi]);
    let (n, weak) = (walks(1_600_000), (-cosine / naive(phi)).exp());
    let found = Found::share(track("gpu", engines()[0].1, &setup(&cloth), 1040, n).direct(0), n, weak);
    fails("light from 89.9°", "z = √(1 − x² − y²) in f32", (-1f64).exp(), Found { value: weak, ..found });
}

#[test]
fn rays_along_the_fibers() {
    section("Light along the fibers");
    for (i, tilt) in (0..).zip([0.0f64, 30.0]) {
        let axis = from_degrees([tilt, 0.0]);
        // H of the sheet across the fibers is 6 / mm.
        let (along, _) = lit(300.0, &aligned(axis.to_array()), [tilt, 0.0]);
        let (beside, v) = lit(300.0, &aligned(axis.to_array()), [tilt + 1.0, 0.0]);
        let depth = 6.0 * 1f64.to_radians().sin() / (tilt + 1.0).to_radians().cos();
        direct(&format!("1° off fibers at {tilt}°"), &beside, depth, v, 1100 + 20 * i, &METHODS[..1]);
        direct(&format!("1° off fibers at {tilt}°"), &beside, depth, v, 1102 + 20 * i, &METHODS[2..]);
        for (method, seed) in METHODS.iter().zip(1110 + 20 * i..) {
            let setup = setup(&method.of(&along));
            let error = setup.0.visible.as_ref().map_or(0.0, |visible| visible.error);
            // The table says how far it is off.
            let bound = 1.0 - (-error * 6.0 / tilt.to_radians().cos()).exp() + 1e-4;
            let missed = engines().map(|(name, engine)| {
                let n = walks(40_000);
                Some((n - track(name, engine, &setup, seed, n).direct(0)) as f64 / n as f64)
            });
            within(&format!("light along fibers at {tilt}°: what meets one"), method.name, missed, bound);
        }
    }
    // The same look-up as if it were exact; the program says that it is not.
    let (cloth, _) = lit(300.0, &aligned(from_degrees([30.0, 0.0]).to_array()), [30.1, 0.0]);
    let expected = (-6.0 * 0.1f64.to_radians().sin() / 30.1f64.to_radians().cos()).exp();
    let n = walks(40_000);
    let tally = track("cpu", engines()[1].1, &setup(&TABULATED.of(&cloth)), 1150, n);
    fails(
        "0.1° off fibers at 30°",
        "tabulated, as if its table were exact",
        expected,
        Found::share(tally.direct(0), n, expected),
    );
    let place = Place::new();
    place.write("beside.toml", Cloth { exit: 2, ..TABULATED.of(&cloth) }.toml());
    let outcome = place.run(&["measure", "beside.toml", "--walks", "16", "--engine", "cpu"]);
    let line = outcome.stderr.lines().find(|line| line.starts_with("tracking")).unwrap_or_default();
    said("0.1° off fibers at 30°", TABULATED.name, line, "the largest error of H found is");
    // A normal that is divided by |m × p| has no direction there.
    let mut random = SplitMix(1160);
    let lost = (0..1000).filter(|_| {
        let m = random.direction().as_vec3();
        let across = m.cross(m);
        !((m * m.dot(m) - m) / across.length()).is_finite()
    });
    let share = lost.count() as f64 / 1e3;
    beyond("light along fibers: hits without a direction", "a normal over |m × p| in f32", share, 1e-4);
}

#[test]
fn exactly_aligned_fibers() {
    section("Exactly aligned, planar and upright fibers");
    let wi = from_degrees([40.0, 100.0]);
    let oblique = DVec3::new(0.48, -0.6, 0.64);
    let horizontal = DVec3::new(0.6, 0.8, 0.0);
    for (i, (name, axis)) in
        (0..).zip([("along an axis", oblique), ("in the plane", horizontal), ("upright", DVec3::Z)])
    {
        let (cloth, v) = lit(40.0, &aligned(axis.to_array()), [40.0, 100.0]);
        let depth = 0.02 * 40.0 * wi.cross(axis).length() / wi.z;
        direct(&format!("fibers exactly {name}"), &cloth, depth, v, 1200 + 10 * i, &METHODS);
    }
    // Fibers of all directions of the plane, seen by an oblique ray.
    let (cloth, v) = lit(40.0, PLANAR, [40.0, 100.0]);
    let sine = |i: i32| {
        let (sin, cos) = (f64::from(i) * PI / 4096.0).sin_cos();
        wi.cross(DVec3::new(cos, sin, 0.0)).length()
    };
    let depth = 0.02 * 40.0 * (0..4096).map(sine).sum::<f64>() / 4096.0 / wi.z;
    direct("fibers exactly planar", &cloth, depth, v, 1240, &METHODS);
    // The cell of a grid of 1024 directions that holds upright fibers, for light at 5°.
    let (cloth, _) = lit(400.0, &aligned([0.0, 0.0, 1.0]), [5.0, 45.0]);
    let grid = fiberwalk::distribution::DirectionGrid { n: 32 };
    let cell = grid.cells().nth(grid.cell_of(DVec3::Z)).expect("there is one");
    let snapped = fiberwalk::distribution::direction_of(cell.centre());
    let wi = from_degrees([5.0, 45.0]);
    let [exact, weak] = [DVec3::Z, snapped].map(|p| (-8.0 * wi.cross(p).length() / wi.z).exp());
    let n = walks(40_000);
    let tally = track("gpu", engines()[0].1, &setup(&cloth), 1250, n);
    right("upright fibers, light from 5°", NULL.name, exact, Some(Found::share(tally.direct(0), n, exact)), None);
    let found = Found::share(tally.direct(0), n, weak);
    fails(
        "upright fibers, light from 5°",
        "the middle of a cell of 1024 directions",
        exact,
        Found { value: weak, ..found },
    );
}

/// ⟨|m × p|⟩ over the cone of `spread` degrees about an axis; `fold` brings directions to where they are kept.
pub fn cone_sine(axis: DVec3, spread: f64, m: DVec3, fold: impl Fn(DVec3) -> DVec3) -> f64 {
    let (e1, e2) = axis.any_orthonormal_pair();
    let steps = 400;
    let middle = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
    let sine = |i: i32| {
        let cosine = 1.0 - middle(i / steps) * (1.0 - spread.to_radians().cos());
        let (sin, cos) = (middle(i % steps) * TAU).sin_cos();
        let p = axis * cosine + (e1 * cos + e2 * sin) * (1.0 - cosine * cosine).sqrt();
        m.cross(fold(p)).length()
    };
    (0..steps * steps).map(sine).sum::<f64>() / f64::from(steps * steps)
}

#[test]
fn the_seam_of_the_half_sphere_of_directions() {
    section("The seam of the half-sphere of directions");
    let m = from_degrees([50.0, 180.0]);
    // Just above and below the seam, and on it in either sense.
    let axes = [[0.6, -0.8, 1e-9], [0.6, -0.8, -1e-9], [-0.6, 0.8, 0.0], [0.6, -0.8, 0.0]];
    let all: Vec<DVec3> = axes.iter().map(|axis| DVec3::from(*axis)).collect();
    let (exact, _) = lit(40.0, "", [50.0, 180.0]);
    let fibers = axes.map(|axis| (10.0, aligned(axis))).to_vec();
    let depth = all.iter().map(|axis| 0.2 * m.cross(axis.normalize()).length()).sum::<f64>() / m.z;
    direct("four bundles at the seam", &Cloth { fibers, ..exact.clone() }, depth, PI * 40e-4, 1310, &METHODS);
    // A cone that lies across it.
    let axis = from_degrees([85.0, 0.0]);
    let spread = format!("{}\nspread_deg = 20", aligned(axis.to_array()));
    let cloth = Cloth { fibers: vec![(40.0, spread)], directions: 65536, ..exact };
    let depth = |sine: f64| 0.02 * 40.0 * sine / m.z;
    let exact_depth = depth(cone_sine(axis, 20.0, m, |p| p));
    let exact_light = (-exact_depth).exp();
    direct("a cone across the seam", &cloth, exact_depth, PI * 40e-4, 1320, &METHODS);
    let mirrored = (-depth(cone_sine(axis, 20.0, m, |p| p.with_z(p.z.abs())))).exp();
    let n = walks(400_000);
    let tally = track("gpu", engines()[0].1, &setup(&cloth), 1330, n);
    let found = Found::share(tally.direct(0), n, mirrored);
    fails("a cone across the seam", "|z| in the place of −p", exact_light, Found { value: mirrored, ..found });
}
