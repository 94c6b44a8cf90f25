//! The explicit engine: rays among real fibers against a search of all fibers, against a tracer that shares nothing with it,
//! and against closed forms.

use crate::common::stats::{GATE, binomial_z, chi2_z, two_sample_chi2};
use crate::common::tracer::Trace;
use crate::common::{Cloth, SplitMix, aligned};
use fiberwalk::cloth::{Curve, DrawnFor, FiberGrid, Realizer, Way, Work};
use fiberwalk::explicit::{Bodies, Explicit, walk};
use fiberwalk::goniometer::{Goniometer, Outcome};
use fiberwalk::scene::{Packing, Scene, Source};
use fiberwalk::tables::Kind;
use fiberwalk::walk::{WalkPlan, Walker};
use glam::{DVec2, DVec3};

fn preset(name: &str) -> Scene {
    let source = Source::find(name).expect("there is such a preset");
    Scene::parse(&source).expect("presets are right")
}

fn fiber(points: Vec<DVec3>, radius: f64) -> Curve {
    Curve { points, radius, kind: 0, thread: 0, hair: false }
}

/// Walks lead to the same end whether the fibers ahead are found by the grid or by a search of all of them.
#[test]
fn the_grid_finds_what_a_search_of_all_fibers_finds() {
    let mut scene = preset("voile");
    scene.measure.set_from_flag("incident", "[[10, 20], [70, 200], [89, 45]]").expect("it is a list");
    let goniometer = Goniometer::new(&scene.measure);
    let realization = Realizer::new(&scene, Packing::Random, DrawnFor::Medium)
        .and_then(|realizer| realizer.draw(7))
        .expect("it is laid");
    let kinds = Kind::of_scene(&scene);
    let walks = |counts: [u8; 3], keep: usize| {
        let fibers = &realization.fibers[..keep];
        let grid = FiberGrid::with_cells(fibers, realization.period, counts).expect("they are sorted");
        let bodies = Bodies { grid: &grid, anew: &[], kinds: &kinds, places: &[0], half_length: f64::INFINITY };
        let plan = WalkPlan::new(5, 0);
        let mut found = Vec::new();
        for start in 0..goniometer.starts() {
            for i in 0..150 {
                let mut walked = walk(&bodies, &goniometer, &plan, start, i);
                // The work differs, and nothing else.
                walked.record.events = 0;
                found.push(walked);
            }
        }
        found
    };
    let all = realization.fibers.len();
    let searched = walks([1, 1, 1], all);
    for counts in [[31, 17, 9], [3, 200, 1], [60, 60, 40]] {
        assert!(walks(counts, all) == searched, "cells {counts:?}");
    }
    assert!(searched.iter().map(|walked| walked.record.hits).sum::<u32>() > 1000);
    // Without one fiber in a hundred some walk goes another way.
    assert!(walks([31, 17, 9], all - all / 100) != searched);
}

/// Straight fibers along x and y, and walks among them by a search of all their images, the segment tracer at every hit and
/// bins of the test's own.
struct Crossed {
    /// Place across, height, whether it runs along x.
    fibers: Vec<(f64, f64, bool)>,
    radius: f64,
    period: f64,
    ior: f64,
}

impl Crossed {
    fn new(overlap: bool) -> Crossed {
        let place = |i: usize| (i as f64 * 0.381_966).fract();
        // Layers lie apart, or in each other.
        let height = |i: usize| if overlap { -0.4 * place(3 * i + 1) } else { -0.021 * i as f64 - 0.005 };
        let fibers = (0..14).map(|i| (0.1 * place(i), height(i), i % 2 == 0)).collect();
        Crossed { fibers, radius: 0.01, period: 0.1, ior: 1.5 }
    }

    fn curves(&self) -> Vec<Curve> {
        let along = |at: f64, z: f64, x: bool, s: f64| if x { DVec3::new(s, at, z) } else { DVec3::new(at, s, z) };
        let curve = |&(at, z, x): &(f64, f64, bool)| {
            let corners = [0.3, 0.55, 0.9, 1.3].map(|s| along(at, z, x, s * self.period));
            fiber(corners.to_vec(), self.radius)
        };
        self.fibers.iter().map(curve).collect()
    }

    /// The nearest entry: distance, axis, offset.
    fn next(&self, o: DVec3, m: DVec3) -> Option<(f64, DVec3, f64)> {
        let mut nearest: Option<(f64, DVec3, f64)> = None;
        for &(at, z, x) in &self.fibers {
            let (p, across, speed) = if x { (DVec3::X, o.y - at, m.y) } else { (DVec3::Y, o.x - at, m.x) };
            for image in -60..=60 {
                let (u, v) = (across - f64::from(image) * self.period, o.z - z);
                // |(u, v) + t (speed, m.z)| = radius.
                let (a, b) = (speed * speed + m.z * m.z, u * speed + v * m.z);
                let root = b * b - a * (u * u + v * v - self.radius * self.radius);
                if root <= 0.0 {
                    continue;
                }
                let t = (-b - root.sqrt()) / a;
                if t > 1e-9 && nearest.is_none_or(|(known, ..)| t < known) {
                    let (nu, nv) = ((u + t * speed) / self.radius, (v + t * m.z) / self.radius);
                    let n = if x { DVec3::new(0.0, nu, nv) } else { DVec3::new(nu, 0.0, nv) };
                    nearest = Some((t, p, n.dot(m.cross(p)) / m.cross(p).length()));
                }
            }
        }
        nearest
    }

    /// Counts of reflected, transmitted and direct light, by quadrant of the exit, and of the hits.
    fn measure(&self, m: DVec3, walks: u64, seed: u64) -> (Vec<u64>, u64) {
        let (mut counts, mut hits) = (vec![0; 9], 0);
        let mut random = SplitMix(seed);
        for _ in 0..walks {
            let mut o = DVec3::new(random.uniform() * self.period, random.uniform() * self.period, 0.05);
            let (mut m, mut touched) = (m, false);
            while let Some((t, p, offset)) = self.next(o, m) {
                let hit = o + m * t;
                let trace = Trace::hit(m, p, offset, self.ior);
                let before = trace.point;
                let left = trace.leave_at_random(&mut random);
                o = hit + (left.point - before) * self.radius;
                (o.x, o.y) = (o.x.rem_euclid(self.period), o.y.rem_euclid(self.period));
                (m, touched) = (left.direction, true);
                hits += 1;
            }
            counts[bin(m, touched)] += 1;
        }
        (counts, hits)
    }
}

fn bin(m: DVec3, touched: bool) -> usize {
    let quadrant = usize::from(m.x > 0.2) + 2 * usize::from(m.y > 0.1);
    match (touched, m.z > 0.0) {
        (false, _) => 8,
        (true, true) => quadrant,
        (true, false) => 4 + quadrant,
    }
}

/// Light goes through crossed fibers as it does in a tracer that goes from interface to interface, separate or overlapping.
#[test]
fn light_goes_through_fibers_as_the_tracer_says() {
    let wi = DVec3::new(0.45, -0.25, 0.0);
    let m = -wi.with_z((1.0 - wi.length_squared()).sqrt());
    let (theta, phi) = ((-m.z).acos().to_degrees(), wi.y.atan2(wi.x).to_degrees());
    let mut scene = Cloth::new(1.0, &aligned([1.0, 0.0, 0.0])).scene();
    scene.measure.set_from_flag("incident", &format!("[[{theta}, {phi}]]")).expect("it is a list");
    let goniometer = Goniometer::new(&scene.measure);
    let measure = |crossed: &Crossed, walks: u64| {
        let grid = FiberGrid::new(&crossed.curves(), DVec2::splat(crossed.period)).expect("they are sorted");
        let kinds = [Kind { radius: crossed.radius, ior: crossed.ior, absorption: vec![0.0] }];
        let bodies = Bodies { grid: &grid, anew: &[], kinds: &kinds, places: &[0], half_length: f64::INFINITY };
        let (mut light, mut direct, mut hits) = ([0u64; 2], 0, 0);
        let layout = goniometer.layout();
        for i in 0..walks {
            let record = walk(&bodies, &goniometer, &WalkPlan::new(9, 0), 0, i).record;
            let bin = record.bin as usize;
            hits += u64::from(record.hits);
            if bin == layout.outcome(Outcome::Direct) {
                direct += 1;
            } else {
                assert!(bin < 2 * layout.exit_cells, "walk {i} was lost");
                light[bin / layout.exit_cells] += 1;
            }
        }
        ([light[0], light[1], direct], hits)
    };
    let walks = 60_000;
    for overlap in [false, true] {
        let crossed = Crossed::new(overlap);
        let (traced, traced_hits) = crossed.measure(m, walks, 4);
        let sum = |bins: std::ops::Range<usize>| traced[bins].iter().sum::<u64>();
        let traced = [sum(0..4), sum(4..8), traced[8]];
        let (found, hits) = measure(&crossed, walks);
        let (chi2, k) = two_sample_chi2(&traced, walks, &found, walks);
        assert!(chi2_z(chi2, k) < GATE, "overlap {overlap}: {traced:?} and {found:?}");
        // Hits of a walk have a spread of about their mean.
        let difference = (hits as f64 - traced_hits as f64) / (traced_hits as f64 * (2.0 / walks as f64).sqrt());
        assert!(difference.abs() < 1.5 * GATE, "overlap {overlap}: {hits} and {traced_hits} hits");
        // A little more index is seen.
        let other = Crossed { ior: 1.6, ..Crossed::new(overlap) };
        let (chi2, k) = two_sample_chi2(&traced, walks, &measure(&other, walks).0, walks);
        assert!(chi2_z(chi2, k) > 2.0 * GATE, "overlap {overlap}: index 1.6 passes");
    }
}

/// A helix with sharp corners.
fn helix() -> Curve {
    let corner = |i: u32| {
        let (sin, cos) = (f64::from(i) * 0.5).sin_cos();
        DVec3::new(0.5 + 0.08 * cos, 0.5 + 0.08 * sin, -0.3 - 0.012 * f64::from(i))
    };
    fiber((0..40).map(corner).collect(), 0.02)
}

/// Rays at the inside of a bent fiber enter it once before they come there: its pieces leave neither gap nor overlap.
#[test]
fn bent_fibers_have_no_gaps() {
    // Count the entries less the exits on the way from far outside to a point inside: one.
    let misses = |curves: &[Curve]| {
        let grid = FiberGrid::new(curves, DVec2::ONE).expect("it is sorted");
        let mut random = SplitMix(11);
        let mut misses = 0;
        for _ in 0..20_000 {
            // Keep away from its open ends.
            let tube = &grid.tubes()[5 + (random.uniform() * (grid.tubes().len() - 10) as f64) as usize];
            let axis = tube.start() + tube.direction() * (tube.length() * random.uniform());
            let target = axis + random.direction().cross(tube.direction()) * (0.95 * tube.radius());
            let held = grid.holding(target).count();
            let m = random.direction();
            let entries = grid.tubes().iter().filter_map(|tube| tube.meet(target - m * 0.9, m));
            let entries = entries.filter(|meeting| meeting.distance < 0.9).count();
            let exits = grid.tubes().iter().filter_map(|tube| tube.meet(target + m * 0.9, -m));
            let beyond = exits.filter(|meeting| meeting.distance < 0.9).count();
            // Each body that holds the target is entered once more than it is left, from either side.
            misses += usize::from(held != 1 || entries == 0 || beyond == 0);
        }
        misses
    };
    assert_eq!(misses(&[helix()]), 0);
    // Pieces that are cut straight leave gaps and overlaps.
    let points = helix().points;
    let parts: Vec<Curve> = points.windows(2).map(|ends| fiber(ends.to_vec(), 0.02)).collect();
    assert!(misses(&parts) > 100, "{}", misses(&parts));
}

/// Straight light through fibers laid at random: exp(−H d / cos θ).
#[test]
fn straight_light_through_a_random_sheet_follows_the_closed_form() {
    let share = |cloth: &Cloth, walks: u64| {
        let scene = cloth.scene();
        let explicit = Explicit::new(&scene).expect("it is laid");
        let goniometer = Goniometer::new(&scene.measure);
        let tally = explicit.run(&goniometer, &WalkPlan::new(3, walks), &mut |_| {}).expect("it runs");
        let clustering = explicit.clustering(&tally).expect("there are many realizations");
        (tally.direct(0), clustering.direct.max(1.0).sqrt())
    };
    let walks = 100_000;
    for theta in [0.0, 60.0] {
        let incident = format!("[[{theta}, 30]]");
        // Depth 1 of fibers of 10 µm radius in 1 mm, 2 % of the volume; H = 2 R L π/4.
        let cloth = Cloth::isotropic(1.0).lit_from(&incident);
        let expected = (-1.0 / f64::to_radians(theta).cos()).exp();
        let (direct, spread) = share(&cloth, walks);
        let z = binomial_z(direct, walks, expected) / spread;
        assert!(z.abs() < GATE, "{theta}°: {direct} of {walks} for {expected}, z = {z}");
        // A depth of 1.05 stands at 8 to 10 σ.
        let bent = binomial_z(direct, walks, (-1.05 / f64::to_radians(theta).cos()).exp()) / spread;
        println!("{theta}°: z = {z:.1}, for depth 1.05 {bent:.1}, spread {spread:.2}");
        assert!(bent.abs() > 1.5 * GATE, "{theta}°: depth 1.05 passes with z = {bent}");
    }
}

/// A run that is cut into parts counts the same walks.
#[test]
fn cuts_of_a_run_do_not_matter() {
    let mut scene = preset("sheer");
    scene.measure.set_from_flag("incident", "2").expect("it is a number");
    let goniometer = Goniometer::new(&scene.measure);
    let explicit = Explicit::new(&scene).expect("it is laid");
    let run = |first: u64, walks: u64| {
        let plan = WalkPlan { first, ..WalkPlan::new(8, walks) };
        explicit.run(&goniometer, &plan, &mut |_| {}).expect("it runs")
    };
    let whole = run(0, 3000);
    let mut parts = run(0, 1111);
    parts.merge(&run(1111, 1889)).expect("they are disjoint");
    assert_eq!(parts, whole);
    assert_ne!(run(1, 3000).bins, whole.bins);
}

/// Rays come to the slab from outside, and leave it.
#[test]
fn rays_outside_of_the_slab_come_in_or_go() {
    let grid = FiberGrid::new(&[helix()], DVec2::ONE).expect("it is sorted");
    let mut work = Work::default();
    let up = DVec3::new(0.5, 0.5, 5.0);
    assert_eq!(grid.first_entry(up, DVec3::Z, None, &mut work), Way::Out);
    let corner = helix().points[7];
    let from = corner + DVec3::new(0.0, 0.0, 5.0);
    let Way::Fiber { point, .. } = grid.first_entry(from, -DVec3::Z, None, &mut work) else { panic!("it must hit") };
    assert!((point.truncate() - corner.truncate()).length() < 1e-6 && point.z > corner.z);
    // Along the plane of an empty layer there is no end.
    let level = DVec3::new(0.1, 0.1, (grid.span()[0] + grid.span()[1]) / 2.0);
    let along = DVec3::new(0.0, 1.0, 0.0);
    assert_eq!(grid.first_entry(level, along, None, &mut work), Way::Endless);
}
