//! Straight rays through explicit fibers: the judge has its closed forms, and the direct light of the medium tends to what
//! the judge sees as cells get finer.

use crate::common::counted::scattered_pieces;
use crate::common::stats::{GATE, largest, means_z};
use crate::common::straight::{missed, openness, ray};
use crate::common::woven::preset;
use crate::common::{SplitMix, gpu};
use fiberwalk::cloth::Primitive;
use fiberwalk::distribution::{Effort, SpecificLength};
use fiberwalk::goniometer::Goniometer;
use fiberwalk::scene::{Memory, Placement, Scene, Source};
use fiberwalk::tables::SamplingTables;
use fiberwalk::walk::{Engine, WalkPlan};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

const RADIUS: f64 = 0.01;

fn fiber(centre: DVec3, direction: DVec3, length: f64) -> Primitive {
    Primitive { centre, direction, length, radius: RADIUS, kind: 0, thread: 0 }
}

/// Share of 512 × 512 rays that miss, at 16 random shifts of the lattice.
fn mean_missed(pieces: &[Primitive], period: DVec2, m: DVec3) -> (f64, f64) {
    let realize = |_| pieces.to_vec();
    openness(&realize, 16, period, m, 512)
}

#[test]
fn a_level_fiber_hides_its_shadow() {
    // Seen along m, a fiber along p hides 2 R L |m × p| of the area A |m_z|, and its ends are flat in projection.
    let period = DVec2::new(1.0, 0.7);
    for (p, m) in [
        (DVec3::X, ray(0.0, 0.0)),
        (DVec3::X, ray(60.0, 90.0)),
        (DVec3::X, ray(60.0, 0.0)),
        (DVec3::new(0.6, 0.8, 0.0), ray(40.0, 10.0)),
        (DVec3::new(0.6, 0.0, 0.8), ray(70.0, 200.0)),
        (DVec3::new(0.0, 0.96, -0.28), ray(50.0, 100.0)),
    ] {
        let (value, error) = mean_missed(&[fiber(DVec3::new(0.95, 0.02, -0.3), p, 0.5)], period, m);
        let hidden = 2.0 * RADIUS * 0.5 * m.cross(p).length() / (period.x * period.y * m.z.abs());
        println!("{p}, {m}: {:.6} ± {error:.6}, closed {hidden:.6}", 1.0 - value);
        assert!((1.0 - value - hidden).abs() < GATE * error, "{p} along {m}: {value} ± {error}, {hidden}");
        // A radius that is a tenth larger.
        assert!((1.0 - value - 1.1 * hidden).abs() > 2.0 * GATE * error);
    }
}

#[test]
fn a_grid_of_parallel_fibers_leaves_its_gaps_open() {
    // 20 fibers along y, 0.05 apart, through the whole repeat in four pieces each: at an angle θ across them a share of
    // 2 R / (0.05 cos θ) is hidden; fibers that lie at any height are the same grid along the normal only.
    let piece = |index: u32| {
        let (x, y) = (f64::from(index / 4) * 0.05, (f64::from(index % 4) + 0.5) / 4.0);
        fiber(DVec3::new(x, y, -0.2), DVec3::Y, 0.25)
    };
    let grid: Vec<Primitive> = (0..80).map(piece).collect();
    for theta in [0.0, 30.0, 60.0] {
        let (value, error) = mean_missed(&grid, DVec2::ONE, ray(theta, 0.0));
        let closed = 1.0 - 2.0 * RADIUS / (0.05 * f64::to_radians(theta).cos());
        assert!((value - closed).abs() < GATE * error + 1e-9, "{theta}°: {value} ± {error}, {closed}");
        let along = mean_missed(&grid, DVec2::ONE, ray(theta, 90.0));
        assert!((along.0 - (1.0 - 0.4)).abs() < GATE * along.1 + 1e-9, "{theta}° along the fibers: {along:?}");
    }
    let exact = missed(&grid, DVec2::ONE, ray(0.0, 0.0), 500, DVec2::splat(0.5));
    assert!((exact - 0.6).abs() < 1e-12, "{exact}");
}

#[test]
fn random_fibers_let_an_exponential_through() {
    // Isotropic pieces at random places: a Poisson number would hide exp(−H d / cos θ); of N pieces that each hide a share
    // s the rays miss all with (1 − s)ᴺ.
    let (length_density, piece, period) = (40.0, 0.2, 1.0);
    let realize = |number: u64| {
        let draw = |random: &mut SplitMix| random.direction();
        scattered_pieces(length_density, RADIUS, [period, 0.8], piece, &mut SplitMix(900 + number), draw)
    };
    for (theta, phi) in [(0.0, 0.0), (45.0, 30.0), (65.0, 250.0)] {
        let cos = f64::to_radians(theta).cos();
        let count = (length_density * 0.8 / piece).round();
        let share = 2.0 * RADIUS * piece * TAU / 8.0 / cos;
        let closed = (1.0 - share).powf(count);
        let found = openness(&realize, 200, DVec2::splat(period), ray(theta, phi), 128);
        let exponential = (-2.0 * RADIUS * TAU / 8.0 * length_density * 0.8 / cos).exp();
        println!("{theta}°: {found:.4?}, closed {closed:.4}, exponential {exponential:.4}");
        assert!(means_z(found, (closed, 0.0)).abs() < GATE, "{theta}°: {found:?}, {closed}");
        // 4 % more fiber.
        assert!(means_z(found, (closed.powf(1.04), 0.0)).abs() > 2.0 * GATE);
        assert!((closed / exponential - 1.0).abs() < 0.02);
    }
}

#[test]
fn direct_light_tends_to_the_openness_as_cells_get_finer() {
    const DIRECTIONS: [[f64; 2]; 3] = [[0.0, 0.0], [30.0, 20.0], [60.0, 45.0]];
    let cloth = preset("voile");
    let mut scene = Scene::parse(&Source::find("voile").expect("it is a preset")).expect("it is right");
    scene.measure.set_from_flag("incident", &format!("{DIRECTIONS:?}")).expect("directions");
    (scene.model.directions, scene.model.placement) = (256, Placement::AtHit);
    scene.model.memory = Memory::None;
    let goniometer = Goniometer::new(&scene.measure);
    let open = DIRECTIONS
        .map(|[theta, phi]| openness(&|number| cloth.realize(3, number), 32, cloth.period(), ray(theta, phi), 384));
    let walks = 100_000;
    let direct: Vec<[(f64, f64); 3]> = [8u32, 16, 32, 64]
        .into_iter()
        .map(|n| {
            scene.model.cells = Some([n, n, n.div_ceil(4)]);
            let effort = Effort::Realizations(64);
            let (f, _) = SpecificLength::of_cloth(&cloth, &scene.model, effort, |_| {}).expect("it can be counted");
            let tables = SamplingTables::new(&scene, &f).expect("it is fine");
            let plan = WalkPlan::new(u64::from(n), walks);
            let tally = gpu().run(&tables, &goniometer, &plan, &mut |_| {}).expect("it runs");
            [0, 1, 2].map(|start| {
                let share = tally.direct(start) as f64 / walks as f64;
                (share, (share * (1.0 - share) / walks as f64).sqrt())
            })
        })
        .collect();
    println!("open {open:.4?}");
    direct.iter().for_each(|direct| println!("{direct:.4?}"));
    for start in 0..3 {
        // Each step takes the direct light nearer.
        let gaps: Vec<f64> = direct.iter().map(|direct| open[start].0 - direct[start].0).collect();
        assert!(gaps.windows(2).all(|pair| pair[1] < 0.8 * pair[0]), "{gaps:?}");
        let z: Vec<f64> = direct.windows(2).map(|pair| means_z(pair[1][start], pair[0][start])).collect();
        assert!(z.iter().all(|z| *z > GATE), "{z:?}");
        // What 64 cells leave: a tenth of the openness along the normal, a fifth at 60°.
        assert!(gaps[3].abs() < [0.02, 0.05, 0.2][start] * open[start].0, "{gaps:?}");
    }
    // The openness of another cloth is no limit: that of a yarn's section alone, whose fibers are not drawn.
    let sections = cloth.statistics().openness;
    assert!(largest(&[means_z(open[0], (sections, 0.0))]) > 2.0 * GATE, "{sections} and {open:?}");
}
