//! The fibers themselves: straight light through sheets that are laid at random, at the ends of their ranges.

use super::light::from_degrees;
use super::table::{Found, fails, number, refused, right, scattered, section, walks, within};
use crate::common::{Cloth, ISOTROPIC, Kind, PLANAR, aligned};
use fiberwalk::explicit::Explicit;
use fiberwalk::goniometer::{Goniometer, Tally};
use fiberwalk::walk::{WalkPlan, Walker};
use glam::DVec3;
use std::f64::consts::PI;

/// Walks through fibers of a sheet, and by how much one realization counts as fewer walks.
fn through_fibers(cloth: &Cloth, seed: u64, walks: u64) -> (Tally, f64) {
    let scene = cloth.scene();
    let explicit = Explicit::new(&scene).unwrap_or_else(|error| panic!("{error}"));
    let goniometer = Goniometer::new(&scene.measure);
    let tally = explicit.run(&goniometer, &WalkPlan::new(seed, walks), &mut |_| {}).expect("it runs");
    for start in 0..tally.starts() {
        assert_eq!(tally.lost(start), 0);
        assert_eq!(scattered(&tally, start).iter().sum::<u64>() + tally.direct(start), walks, "light was lost");
    }
    let spread = explicit.clustering(&tally).map_or(1.0, |clustering| clustering.direct.max(1.0).sqrt());
    (tally, spread)
}

/// Azimuths of light in degrees: walks from each of them share the realizations, which take longer to draw than to walk through.
const AZIMUTHS: [f64; 4] = [37.0, 127.0, 217.0, 307.0];

/// A sheet that is lit from θ and all azimuths.
fn lit_around(cloth: Cloth, theta: f64) -> Cloth {
    Cloth { exit: 4, ..cloth }.lit_from(&format!("{:?}", AZIMUTHS.map(|phi| [theta, phi])))
}

/// Share of walks from all azimuths that go straight through, and z of it where the optical depth is that of each azimuth.
fn direct_share(cloth: &Cloth, depths: [f64; 4], seed: u64) -> (f64, Found) {
    let n = walks(30_000);
    let (tally, spread) = through_fibers(cloth, seed, n);
    let direct: u64 = (0..AZIMUTHS.len()).map(|start| tally.direct(start)).sum();
    let sum = |of: &dyn Fn(f64) -> f64| depths.map(|depth| of((-depth).exp())).iter().sum::<f64>();
    let (expected, variance) = (sum(&|p| p), sum(&|p| p * (1.0 - p)));
    let z = (direct as f64 - n as f64 * expected) / (n as f64 * variance).sqrt() / spread;
    let all = AZIMUTHS.len() as f64;
    (expected / all, Found { value: direct as f64 / n as f64 / all, z })
}

fn direct_through_fibers(regime: &str, cloth: &Cloth, depths: [f64; 4], seed: u64) {
    let (expected, found) = direct_share(cloth, depths, seed);
    right(regime, "explicit", expected, None, Some(found));
}

/// Isotropic fibers of a radius in mm that fill v of a sheet of depth 1 for light from θ.
fn filled(radius: f64, v: f64, theta: f64) -> Cloth {
    let thickness = theta.to_radians().cos() * 2.0 * radius / v;
    let cloth = Cloth::new(v / (PI * radius * radius), ISOTROPIC);
    lit_around(Cloth { radius_um: 1e3 * radius, thickness_um: 1e3 * thickness, ..cloth }, theta)
}

#[test]
fn straight_light_among_fibers() {
    section("Straight light among the fibers themselves");
    for (v, seed) in [1e-4, 0.05, 0.9].into_iter().zip(8000..) {
        direct_through_fibers(&format!("fibers fill {}", number(v)), &filled(0.01, v, 60.0), [1.0; 4], seed);
    }
    for (radius, seed) in [1e-4, 1.0].into_iter().zip(8010..) {
        direct_through_fibers(&format!("radius {} mm", number(radius)), &filled(radius, 0.05, 60.0), [1.0; 4], seed);
    }
    for (theta, seed) in [85.0, 89.0, 89.9].into_iter().zip(8020..) {
        direct_through_fibers(&format!("light from {theta}°"), &filled(0.01, 0.005, theta), [1.0; 4], seed);
    }
    for (name, axis, seed) in
        [("along an axis", DVec3::new(0.48, -0.6, 0.64), 8030), ("in the plane", DVec3::new(0.6, 0.8, 0.0), 8031)]
    {
        let cloth = lit_around(Cloth::new(25.0, &aligned(axis.to_array())), 60.0);
        let depths = AZIMUTHS.map(|phi| {
            let wi = from_degrees([60.0, phi]);
            0.5 * wi.cross(axis).length() / wi.z
        });
        direct_through_fibers(&format!("fibers exactly {name}"), &cloth, depths, seed);
    }
    let wi = from_degrees([60.0, 37.0]);
    let sine = |i: i32| {
        let (sin, cos) = (f64::from(i) * PI / 4096.0).sin_cos();
        wi.cross(DVec3::new(cos, sin, 0.0)).length()
    };
    let depth = 0.5 * (0..4096).map(sine).sum::<f64>() / 4096.0 / wi.z;
    direct_through_fibers("fibers exactly planar", &lit_around(Cloth::new(25.0, PLANAR), 60.0), [depth; 4], 8032);
    // As if fibers left no room to each other.
    let (value, found) = direct_share(&filled(0.01, 0.9, 60.0), [10.0; 4], 8040);
    let found = Found { value, ..found };
    fails("fibers fill 0.9000", "1/(1 − v) of separate fibers, for random ones", (-1f64).exp(), found);
}

#[test]
fn index_one_and_upright_fibers() {
    section("Index 1 and upright fibers, among the fibers themselves");
    let cloth = Cloth { ior: 1.0, exit: 16, ..filled(0.01, 0.1, 35.0) }.lit_from("[[35, 37]]");
    let n = walks(40_000);
    let (tally, _) = through_fibers(&cloth, 8100, n);
    let cell = Goniometer::new(&cloth.scene().measure).exit.cell_of(-from_degrees([35.0, 37.0]).truncate());
    let straight = tally.transmission(0)[cell] + tally.direct(0);
    let share = 1.0 - straight as f64 / n as f64;
    within("index 1: light that does not go straight on", "explicit", [None, Some(share)], 0.0);
    // Light exactly along fibers comes down beside them.
    let along = Cloth { exit: 4, ..Cloth::new(300.0, &aligned([0.0, 0.0, 1.0])) }.lit_from("[[0, 0]]");
    let (tally, _) = through_fibers(&along, 8110, n);
    let share = 1.0 - tally.direct(0) as f64 / n as f64;
    within("light along fibers at 0°: what meets one", "explicit", [None, Some(share)], 0.0);
    let thick = Kind {
        radius_um: 1000.0,
        ior: 1.5,
        absorption: "0".into(),
        length_density: 1e-3,
        orientation: ISOTROPIC.into(),
    };
    let endless = Cloth { radius_um: 0.1, more_kinds: vec![thick], ..Cloth::new(1e4, ISOTROPIC) };
    let message = Explicit::new(&endless.scene()).err().map(|error| error.to_string()).unwrap_or_default();
    refused("fibers of 0.1 µm and of 1 mm", "explicit", &message, "make the sheet thinner");
}
