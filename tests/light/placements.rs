//! Flights that start where light leaves a fiber: exit points, rates, the cells that hits belong to.

use crate::common::cells::{CellCloth, random_cells};
use crate::common::probes::{CALLS, ULP, bits, rounded, vector};
use crate::common::sheet::disc_cell;
use crate::common::stats::{GATE, binomial_z, chi2_z, largest, mean_error, means_z, two_sample_chi2, two_tally_z};
use crate::common::tracer::Trace;
use crate::common::{Cloth, ISOTROPIC, Kind, SplitMix, aligned, assert_ran, engines, gpu, mean_light, rgb};
use fiberwalk::goniometer::{Goniometer, Tally};
use fiberwalk::gpu::{Probe, ProbeInput};
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::optics::Encounter;
use fiberwalk::scene::{Scene, Source};
use fiberwalk::tables::SamplingTables;
use fiberwalk::walk::{Engine, WalkPlan};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_4, PI};

const CARRIED: [&str; 3] = ["carried", "carried-dense", "carried-void"];

fn setup(cloth: &Cloth) -> (SamplingTables, Goniometer) {
    let Prepared { tables, goniometer, .. } = prepare(&cloth.scene()).unwrap_or_else(|error| panic!("{error}"));
    (tables, goniometer)
}

/// Run an engine, each from random numbers of its own, without roulette, whose ends depend on numbers of events.
fn track(name: &str, engine: &dyn Engine, setup: &(SamplingTables, Goniometer), seed: u64, walks: u64) -> Tally {
    let seed = seed + if name == "cpu" { 10_000 } else { 0 };
    let plan = WalkPlan { roulette: false, ..WalkPlan::new(seed, walks) };
    let tally = engine.run(&setup.0, &setup.1, &plan, &mut |_| {}).unwrap_or_else(|error| panic!("{error}"));
    tally.check(walks).unwrap_or_else(|error| panic!("{error}"));
    assert_ran(&tally, name);
    assert!((0..tally.starts()).all(|start| tally.lost(start) == 0), "{name}: walks were lost");
    tally
}

/// Rays at random that hit fibers at random, away from grazing hits and from chords that are hard to draw in f32.
fn encounters(random: &mut SplitMix, ior: f64) -> (DVec3, DVec3, f64, f64, u32) {
    loop {
        let (m, p) = (rounded(random.direction()), rounded(random.direction()));
        let offset = f64::from((2.0 * random.uniform() - 1.0) as f32);
        if m.cross(p).length() < 0.05 || offset.abs() > 0.999 {
            continue;
        }
        let f = Trace::hit(m.normalize(), p.normalize(), offset, ior).reflectance();
        // Put the number in the middle of the interval that draws k chords.
        let chords = (random.word() % 7) as i32;
        let number = if chords == 0 { 0.5 * f } else { 1.0 - 0.5 * (1.0 - f) * f.powi(chords - 1) * (1.0 + f) };
        if number > 1e-3 && 1.0 - number > 1e-3 {
            return (m, p, offset, number, chords as u32);
        }
    }
}

#[test]
fn light_leaves_a_fiber_where_the_tracer_does() {
    for ior in [1.0, 1.33, 1.55, 2.5] {
        let (tables, goniometer) = setup(&Cloth { ior, ..Cloth::isotropic(1.0) }.placed("carried"));
        let mut random = SplitMix(8);
        let drawn: Vec<_> = (0..CALLS).map(|_| encounters(&mut random, ior)).collect();
        let input = |&(m, p, offset, number, _): &(DVec3, DVec3, f64, f64, u32)| ProbeInput {
            a: bits(m, offset as f32),
            b: bits(p, number as f32),
            c: [0; 4],
        };
        let inputs: Vec<ProbeInput> = drawn.iter().map(input).collect();
        let outputs = Probe::new(gpu(), &tables, &goniometer).call("probe_displacement", &inputs).expect("it works");
        let mut bent_far = 0;
        for ((m, p, offset, number, chords), output) in drawn.into_iter().zip(outputs) {
            let (m, p) = (m.normalize(), p.normalize());
            let way = |ior| {
                let hit = Trace::hit(m, p, offset, ior);
                hit.leave_after(chords).point - hit.point
            };
            let f64_way = Encounter::new(m, p, offset, ior).pass(number, f64::INFINITY).displacement;
            let error = (f64_way - way(ior)).length();
            assert!(error < 1e-10 * f64::from(chords + 1), "η = {ior}, k = {chords}: {error:e}");
            let error = (vector(output) - way(ior)).length();
            // As the direction, and the way along the fiber is up to 40 radii long.
            let bound = ULP * 60.0 * f64::from(chords + 1).powi(2);
            assert!(error < bound, "η = {ior}, k = {chords}: off by {error:e}");
            bent_far += u32::from(chords > 0 && (vector(output) - way(1.003 * ior)).length() > bound);
        }
        assert!(bent_far > CALLS as u32 / 2, "an index 0.3 % off shows in {bent_far} of {CALLS} calls");
    }
}

#[test]
fn light_leaves_a_short_fiber_where_the_tracer_does() {
    let (m, p) = (DVec3::new(0.36, -0.48, -0.8), DVec3::new(0.0, 0.6, 0.8));
    for (ior, half_length) in [(1.2, 1.4), (1.5, 0.9), (1.3, 2.0)] {
        let mut random = SplitMix(9);
        let encounter = |offset| Encounter::new(m, p, offset, ior);
        let mut means = |draw: &mut dyn FnMut(f64, &mut SplitMix) -> DVec3| {
            let ways: Vec<DVec3> = (0..400_000).map(|_| draw(2.0 * random.uniform() - 1.0, &mut random)).collect();
            let mean = |of: fn(&DVec3) -> f64| {
                let values = ways.iter().map(of);
                mean_error(values.clone().sum(), values.map(|value| value * value).sum(), ways.len() as f64)
            };
            [mean(|way| way.x), mean(|way| way.y), mean(|way| way.z), mean(|way| way.length())]
        };
        let traced = means(&mut |offset, random| {
            let hit = Trace::hit(m, p, offset, ior);
            hit.leave_short_at_random(half_length, random).0.point - hit.point
        });
        for (factor, fits) in [(1.0, true), (1.05, false)] {
            let way = |offset, random: &mut SplitMix| {
                encounter(offset).pass(random.uniform(), factor * half_length).displacement
            };
            let z =
                largest(&means(&mut { way }).into_iter().zip(traced).map(|(a, b)| means_z(a, b)).collect::<Vec<_>>());
            println!("η = {ior}, half length {half_length} × {factor}: z = {z:.1}");
            assert_eq!(z < GATE, fits, "η = {ior}, half length {half_length} × {factor}: z = {z:.1}");
        }
        // The device against f64, call by call; what lies near a decision may differ.
        let cloth = Cloth { ior, length_over_radius: 2.0 * half_length, ..Cloth::isotropic(1.0) }.placed("carried");
        let (tables, goniometer) = setup(&cloth);
        let mut random = SplitMix(10);
        let drawn: Vec<_> = (0..CALLS).map(|_| encounters(&mut random, ior)).collect();
        let input = |&(m, p, offset, _, _): &(DVec3, DVec3, f64, f64, u32), number: f64| ProbeInput {
            a: bits(m, offset as f32),
            b: bits(p, number as f32),
            c: [0; 4],
        };
        let numbers: Vec<f64> = (0..CALLS).map(|_| f64::from(random.uniform() as f32).clamp(1e-3, 0.999)).collect();
        let inputs: Vec<ProbeInput> = drawn.iter().zip(&numbers).map(|(drawn, number)| input(drawn, *number)).collect();
        let outputs = Probe::new(gpu(), &tables, &goniometer).call("probe_displacement", &inputs).expect("it works");
        let mut counts = [0; 3];
        for (((m, p, offset, ..), number), output) in drawn.into_iter().zip(numbers).zip(outputs) {
            let pass = Encounter::new(m.normalize(), p.normalize(), offset, ior).pass(number, half_length);
            let same = (vector(output) - pass.displacement).length() < 1e-3;
            counts[if same { usize::from(pass.through_base) } else { 2 }] += 1;
        }
        println!("η = {ior}: {counts:?} through the side, through a base, elsewhere");
        assert!(counts[0] > 1000 && counts[2] < 20, "η = {ior}: {counts:?}");
        assert!(ior > 1.4 || counts[1] > 500, "η = {ior}: {counts:?}");
    }
}

/// Fibers of 60 µm in a sheet of 1 mm: H = 1.88/mm, v = 0.226.
fn thick() -> Cloth {
    Cloth { radius_um: 60.0, ..Cloth::new(20.0, ISOTROPIC) }
}

#[test]
fn direct_light_has_its_closed_form() {
    let walks = 260_000;
    let (h, v) = (2.0 * 0.06 * 20.0 * FRAC_PI_4, PI * 0.06f64.powi(2) * 20.0);
    for (i, placement) in (0..).zip(["at-hit", "carried", "carried-dense", "carried-void"]) {
        let rate = if i < 2 { h } else { h / (1.0 - v) };
        let (tables, goniometer) = setup(&thick().placed(placement).lit_from("[[0, 0], [60, 75]]"));
        for (name, engine) in engines() {
            // A density of 1.025 stands at 8 to 10 σ.
            for (factor, seed) in [(1.0, 10 + i), (1.025, 20 + i)] {
                let tables = SamplingTables { majorant: factor * tables.majorant, ..tables.clone() };
                let tally = track(name, engine, &(tables, goniometer.clone()), seed, walks);
                let z = [(0, rate), (1, 2.0 * rate)]
                    .map(|(start, depth)| binomial_z(tally.direct(start), walks, (-depth).exp()));
                println!("{name}, {placement}, density × {factor}: z = {z:.1?}");
                assert_eq!(largest(&z) < GATE, factor == 1.0, "{name}, {placement}, density × {factor}: {z:.1?}");
            }
        }
    }
}

/// Hits and reflected light of a walk with their errors, straight on, in a sheet of H d = 2 of fibers of a radius in mm.
fn hits_and_reflectance(radius: f64, placement: &'static str, seed: u64) -> [(f64, f64); 2] {
    let length_density = 2.0 / (2.0 * radius * FRAC_PI_4);
    let cloth = Cloth { radius_um: 1e3 * radius, ..Cloth::new(length_density, ISOTROPIC) }.placed(placement);
    let walks = 4_000_000;
    let parts: Vec<Tally> = (0..8)
        .map(|part| track("gpu", gpu(), &setup(&cloth.clone().lit_from("[[0, 0]]")), 8 * seed + part, walks / 8))
        .collect();
    let n = parts.len() as f64;
    let mean = |of: &dyn Fn(&Tally) -> f64| {
        let values = parts.iter().map(|tally| of(tally) / tally.walks_per_incident() as f64);
        mean_error(values.clone().sum(), values.map(|value| value * value).sum(), n)
    };
    [mean(&|tally| tally.counts.collisions as f64), mean(&|tally| tally.reflection(0).iter().sum::<u64>() as f64)]
}

#[test]
fn carried_light_tends_to_that_from_hits_as_fibers_get_thin() {
    let [thick, middle, thin] =
        [0.04, 0.02, 0.01].map(|radius| hits_and_reflectance(radius, "carried", (1e3 * radius) as u64));
    let at_hit = hits_and_reflectance(0.01, "at-hit", 3);
    for (i, what) in ["hits", "reflectance"].into_iter().enumerate() {
        let ([thick, middle, thin], at_hit) = ([thick, middle, thin].map(|of| of[i]), at_hit[i]);
        // a + bR + cR² through the three, at R = 0.
        let value = (8.0 * thin.0 - 6.0 * middle.0 + thick.0) / 3.0;
        let error = ((8.0 * thin.1).powi(2) + (6.0 * middle.1).powi(2) + thick.1.powi(2)).sqrt() / 3.0;
        let z = means_z((value, error), at_hit);
        // The difference halves with the radius.
        let order = (thick.0 - middle.0) / (middle.0 - thin.0);
        let off = means_z(thin, at_hit);
        println!(
            "{what}: {value:.5} ± {error:.5} for {:.5}, z = {z:.1}; thinnest fibers z = {off:.1}; ratio {order:.2}",
            at_hit.0
        );
        assert!(z.abs() < 5.4, "{what}: z = {z:.1}");
        assert!(off.abs() > 10.0, "{what}: z = {off:.1}");
        assert!((order - 2.0).abs() < 0.5, "{what}: ratio {order:.2}");
    }
}

/// Aligned fibers of 30 µm in cells of 0.6 to 4 radii, half of them empty, with factors at random.
fn stripes(placement: &'static str) -> CellCloth {
    let mut random = SplitMix(21);
    let base = Cloth { radius_um: 30.0, ..Cloth::new(40.0, &aligned([0.48, -0.6, 0.64])) };
    let base = Cloth { thickness_um: 400.0, exit: 8, ..base }.lit_from("[[40, 100]]").placed(placement);
    let mut cells = CellCloth::new(base, [6, 20, 4], [0.7, 0.35], |_| 0.0);
    for ([x, y, z], cell) in cells.grid().places().zip(&mut cells.cells) {
        let full = (x + y / 4 + z) % 3 == 0 && z != 3;
        cell.0 = if full { 0.5 + 4.5 * random.uniform() } else { 0.0 };
    }
    cells.factors = cells.cells.iter().map(|_| 1.0 + random.uniform()).collect();
    cells
}

/// Where walks through aligned fibers end, by exit cell: reflected, transmitted, then direct. Nothing is jumped over, and
/// light is followed segment by segment.
fn followed(cloth: &CellCloth, walks: u64, seed: u64) -> Vec<u64> {
    let (grid, placement) = (cloth.grid(), cloth.base.placement);
    let radius = cloth.base.radius_um * 1e-3;
    let axis = DVec3::new(0.48, -0.6, 0.64).normalize();
    let cell = |place: DVec3| {
        let [nx, ny, nz] = grid.counts.map(i64::from);
        let at = ((place + DVec3::Z * grid.thickness) / grid.edges()).floor().as_i64vec3();
        let place = [at.x.rem_euclid(nx), at.y.rem_euclid(ny), at.z.clamp(0, nz - 1)].map(|at| at as u32);
        grid.index(place)
    };
    let factor = |place, of: &str| if placement == of { cloth.factors[cell(place)] } else { 1.0 };
    let rate = 2.0 * 5.0 * if placement == "carried" { 1.0 } else { 2.0 };
    let (n, mut random) = (cloth.base.exit as usize, SplitMix(seed));
    let mut counts = vec![0; 2 * n * n + 1];
    let (sine, cosine) = (40f64.to_radians().sin(), 40f64.to_radians().cos());
    let wi = DVec3::new(sine * 100f64.to_radians().cos(), sine * 100f64.to_radians().sin(), cosine);
    for _ in 0..walks {
        let (mut m, mut touched) = (-wi, false);
        let mut place = DVec3::new(random.uniform() * grid.period.x, random.uniform() * grid.period.y, radius);
        loop {
            // Beyond a radius above the faces there is nothing.
            let face = if m.z < 0.0 { radius } else { -grid.thickness - radius };
            if (face - place.z) * m.z > 0.0 {
                place += m * ((face - place.z) / m.z);
            }
            place += m * (-random.uniform().ln() / rate);
            if place.z > radius + 1e-12 || place.z < -grid.thickness - radius - 1e-12 {
                break;
            }
            let hit = Trace::hit(m, axis, 2.0 * random.uniform() - 1.0, cloth.base.ior);
            let owner = place - hit.normal() * radius;
            let inside = owner.z <= 0.0 && owner.z >= -grid.thickness;
            let density = if inside { cloth.cells[cell(owner)].0 * factor(owner, "carried-dense") } else { 0.0 };
            if random.uniform() * rate < 2.0 * density * factor(place, "carried-void") * m.cross(axis).length() {
                let left = hit.leave_at_random(&mut random);
                place += (left.point - hit.point) * radius;
                (m, touched) = (left.direction, true);
            }
        }
        let side = if m.z > 0.0 { 0 } else { n * n };
        counts[if touched { side + disc_cell(m.x, m.y, n) } else { 2 * n * n }] += 1;
    }
    counts
}

#[test]
fn hits_belong_to_the_cell_of_the_axis() {
    let walks = 200_000;
    for (i, placement) in (0..).zip(CARRIED) {
        let cloth = stripes(placement);
        let expected = followed(&cloth, walks, 30 + i);
        let (tables, goniometer) = cloth.prepare();
        for (name, engine) in engines() {
            for (factor, seed) in [(1.0, 40 + i), (1.042, 50 + i)] {
                let tables = SamplingTables { majorant: factor * tables.majorant, ..tables.clone() };
                let tally = track(name, engine, &(tables, goniometer.clone()), seed, walks);
                let counts = [tally.reflection(0), tally.transmission(0), &[tally.direct(0)]].concat();
                let (chi2, k) = two_sample_chi2(&counts, walks, &expected, walks);
                let z = chi2_z(chi2, k);
                let direct = means_z(share(tally.direct(0), walks), share(expected[expected.len() - 1], walks));
                println!("{name}, {placement}, density × {factor}: z = {z:.1}, direct {direct:.1}");
                assert_eq!(z < GATE && direct.abs() < GATE, factor == 1.0, "{name}, {placement}: z = {z:.1}");
            }
        }
    }
}

/// A share of walks and its standard error.
fn share(count: u64, walks: u64) -> (f64, f64) {
    mean_error(count as f64, count as f64, walks as f64)
}

/// Two kinds that absorb, in a sheet of a millimetre, from both sides.
fn dyed() -> Cloth {
    let sides = "[\"front\", \"back\"]".into();
    Cloth {
        absorption: rgb([4.0, 2.0, 0.4]),
        more_kinds: vec![Kind::dyed(90.0)],
        sides,
        radius_um: 30.0,
        ..Cloth::new(30.0, ISOTROPIC)
    }
    .lit_from("[[20, 30], [70, 200]]")
}

/// N of the exit disc where engines are compared: densities change the light of wide cells as well.
const EXIT: u32 = 4;

/// The preset voile in coarse cells.
fn voile(placement: &str) -> (SamplingTables, Goniometer) {
    let mut scene = Scene::parse(&Source::find("voile").expect("voile is a preset")).expect("the preset is fine");
    scene.model.set_from_flag("cells", "12x12x6").expect("the flag is fine");
    scene.model.set_from_flag("placement", placement).expect("the flag is fine");
    scene.model = scene.model.without_rays();
    scene.measure.set_from_flag("incident", "[[15, 30], [65, -50]]").expect("the flag is fine");
    scene.measure.set_from_flag("exit", &EXIT.to_string()).expect("the flag is fine");
    let Prepared { tables, goniometer, .. } = prepare(&scene).unwrap_or_else(|error| panic!("{error}"));
    (tables, goniometer)
}

#[test]
fn both_engines_give_the_same_light() {
    let walks = 40_000;
    for (i, placement) in (0..).zip(CARRIED) {
        let mut random = SplitMix(60 + i);
        let cells = random_cells(5);
        let factors = cells.cells.iter().map(|_| 1.0 + random.uniform()).collect();
        let cells = CellCloth { base: Cloth { exit: EXIT, ..cells.base.placed(placement) }, factors, ..cells };
        let cases = [
            ("dyed sheet", setup(&Cloth { exit: EXIT, ..dyed().placed(placement) }), 1.06),
            ("cells", cells.prepare(), 1.12),
            ("voile", voile(placement), 1.2),
        ];
        for (what, setup, factor) in cases {
            let cpu = track("cpu", engines()[1].1, &setup, 70 + i, walks);
            let bent = SamplingTables { majorant: factor * setup.0.majorant, ..setup.0.clone() };
            for (factor, setup, seed) in [(1.0, setup.clone(), 80 + i), (factor, (bent, setup.1.clone()), 90 + i)] {
                let gpu = track("gpu", gpu(), &setup, seed, walks);
                let z = two_tally_z(&gpu, &cpu);
                let light = (0..gpu.starts())
                    .flat_map(|start| mean_light(&gpu, start).into_iter().zip(mean_light(&cpu, start)));
                let light = largest(&light.map(|(a, b)| means_z(a, b)).collect::<Vec<_>>());
                println!("{what}, {placement}, density × {factor}: z = {z:.1}, light {light:.1}");
                assert_eq!(
                    z < GATE && light < GATE,
                    factor == 1.0,
                    "{what}, {placement}: z = {z:.1}, light {light:.1}"
                );
            }
        }
    }
}
