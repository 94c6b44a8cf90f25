//! Fibers that end, and cloths lit from both sides, in both engines.

use crate::common::sheet::disc_cell;
use crate::common::stats::{GATE, chi2_z, largest, mean_error, means_z, two_sample_chi2};
use crate::common::tracer::Trace;
use crate::common::{Cloth, Kind, SplitMix, aligned, assert_ran, engines, gpu, rgb, run};
use fiberwalk::goniometer::{Moments, Tally};
use fiberwalk::gpu::{Probe, ProbeInput};
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::optics::Encounter;
use fiberwalk::walk::{Engine, WalkPlan};
use glam::DVec3;
use std::sync::{LazyLock, OnceLock};

// ---- Bases ----

/// Index and cosine between ray and fiber: light that leaves through bases, and that is turned round by them.
const SHORT: [(f64, f64); 6] = [(1.33, 0.9), (1.33, 0.985), (1.1, -0.6), (1.0, 0.8), (1.5, 0.9), (1.33, -0.5)];

/// A ray at a cosine to fibers along z.
fn slanted(axial: f64) -> DVec3 {
    DVec3::new(0.6 * (1.0 - axial * axial).sqrt(), -0.8 * (1.0 - axial * axial).sqrt(), axial)
}

/// z of exit directions (χ²), of the share of base exits and of the mean path: closed form against the tracer.
fn short_z((ior, axial): (f64, f64), bent_half_length: f64) -> [f64; 3] {
    let (n, m, half_length) = (200_000, slanted(axial), 2.0);
    let mut random = [SplitMix(120), SplitMix(121)];
    let mut counts = [vec![0; 4 * 144], vec![0; 4 * 144]];
    let mut sums = [[0.0; 3]; 2];
    for _ in 0..n {
        let [closed, traced] = &mut random;
        let offset = |random: &mut SplitMix| 2.0 * random.uniform() - 1.0;
        let passage = Encounter::new(m, DVec3::Z, offset(closed), ior).pass(closed.uniform(), bent_half_length);
        let (trace, through_base) =
            Trace::hit(m, DVec3::Z, offset(traced), ior).leave_short_at_random(half_length, traced);
        let both =
            [(passage.direction, passage.path, passage.through_base), (trace.direction, trace.path, through_base)];
        for (i, (direction, path, through_base)) in both.into_iter().enumerate() {
            assert!((direction.length() - 1.0).abs() < 1e-9);
            let half = usize::from(direction.z > 0.0) + 2 * usize::from(through_base);
            counts[i][144 * half + disc_cell(direction.x, direction.y, 12)] += 1;
            sums[i] = [sums[i][0] + f64::from(u8::from(through_base)), sums[i][1] + path, sums[i][2] + path * path];
        }
    }
    let (chi2, freedom) = two_sample_chi2(&counts[0], n, &counts[1], n);
    let total = n as f64;
    let bases = sums.map(|sum| mean_error(sum[0], sum[0], total));
    let paths = sums.map(|sum| mean_error(sum[1], sum[2], total));
    [chi2_z(chi2, freedom), means_z(bases[0], bases[1]), means_z(paths[0], paths[1])]
}

#[test]
fn light_leaves_short_fibers_where_the_tracer_does() {
    for case in SHORT {
        let z = short_z(case, 2.0);
        println!("{case:?}: z = {z:.1?}");
        assert!(largest(&z) < GATE, "{case:?}: z = {z:.1?}");
    }
}

#[test]
fn a_bent_length_over_radius_shows() {
    // Half lengths that stand at 8 to 10 σ.
    for (case, half_length) in SHORT.into_iter().zip([2.23, 2.055, 2.1, 2.015, 1.8, 2.4]) {
        let z = short_z(case, half_length);
        println!("{case:?}: z = {z:.1?}");
        assert!(largest(&z) > GATE, "{case:?}: z = {z:.1?}");
    }
}

/// Share of encounters in which the kernel's cylinder and the closed form in f64 part, and share of base exits.
fn short_probe(ior: f64, bent_half_length: f64) -> (f64, f64) {
    let cloth = Cloth { ior, length_over_radius: 4.0, ..Cloth::isotropic(1.0) };
    let Prepared { tables, goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
    let mut random = SplitMix(130);
    let (mut inputs, mut expected) = (Vec::new(), Vec::new());
    while inputs.len() < 1 << 15 {
        let (m, p) = (random.direction().as_vec3(), random.direction().as_vec3());
        let [offset, number] = [2.0 * random.uniform() - 1.0, random.uniform()].map(|number| number as f32);
        let (m64, p64) = (m.as_dvec3().normalize(), p.as_dvec3().normalize());
        // Stay away from grazing hits, where f32 sees less.
        if m64.cross(p64).length() < 0.05 || offset.abs() > 0.999 || number >= 1.0 {
            continue;
        }
        let bits = |v: glam::Vec3, w: f32| [v.x, v.y, v.z, w].map(f32::to_bits);
        inputs.push(ProbeInput { a: bits(m, offset), b: bits(p, number), c: [0; 4] });
        let encounter = Encounter::new(m64, p64, f64::from(offset), ior);
        expected.push(encounter.pass(f64::from(number), bent_half_length));
    }
    let outputs = Probe::new(gpu(), &tables, &goniometer).call("probe_scatter", &inputs).expect("the device works");
    let apart = expected.iter().zip(outputs).filter(|(passage, output)| {
        let [x, y, z, path] = output.map(|word| f64::from(f32::from_bits(word)));
        let same_way = (passage.path - path.abs()).abs() < 1e-4 * (1.0 + passage.path);
        let same = (DVec3::new(x, y, z) - passage.direction).length() < 1e-3 && passage.through_base == (path < 0.0);
        !(same && same_way)
    });
    let count = inputs.len() as f64;
    let bases = expected.iter().filter(|passage| passage.through_base).count();
    (apart.count() as f64 / count, bases as f64 / count)
}

#[test]
fn the_kernel_leaves_short_fibers_as_the_closed_form_does() {
    for ior in [1.0, 1.1, 1.33, 1.5] {
        let (apart, bases) = short_probe(ior, 2.0);
        println!("η = {ior}: {apart:.1e} part, {bases:.3} leave through a base");
        assert!(apart < 2e-4 && (bases > 0.01) == (ior < 1.4), "η = {ior}: {apart:.1e} part, bases {bases}");
        let (apart, _) = short_probe(ior, 2.1);
        assert!(apart > 1e-3, "η = {ior}: a bent length is seen in {apart:.1e}");
    }
}

#[test]
fn bases_of_an_index_above_the_square_root_of_two_let_no_light_out() {
    let count = |ior: f64| {
        let cloth = Cloth { ior, length_over_radius: 4.0, ..Cloth::isotropic(3.0) };
        engines().map(|(name, engine)| {
            let tally = cloth.run(engine, &WalkPlan::new(140, 2000));
            assert_ran(&tally, name);
            tally.counts.base_exits
        })
    };
    assert_eq!(count(1.5), [0, 0]);
    assert_eq!(count(1.4143), [0, 0]);
    let [on_gpu, on_cpu] = count(1.33);
    println!("{on_gpu} and {on_cpu} base exits");
    // The same walks.
    assert!(on_cpu > 1000 && on_gpu.abs_diff(on_cpu) < 10 + on_cpu / 500, "{on_gpu} and {on_cpu} base exits");
}

// ---- Both sides ----

/// Two oblique, spread bundles of two kinds; front and back differ.
fn oblique(second_axis: [f64; 3], second_ior: f64, turned: bool) -> Cloth {
    let part = |axis: [f64; 3]| {
        let [x, y, z] = axis;
        aligned(if turned { [x, -y, -z] } else { axis }) + "\nspread_deg = 15"
    };
    let second = Kind {
        radius_um: 6.0,
        ior: second_ior,
        absorption: rgb([0.0, 8.0, 25.0]),
        length_density: 80.0,
        orientation: part(second_axis),
    };
    Cloth {
        absorption: rgb([0.0, 20.0, 2.0]),
        more_kinds: vec![second],
        sides: "[\"front\", \"back\"]".into(),
        exit: 8,
        directions: 4096,
        ..Cloth::new(40.0, &part([1.0, 0.2, 0.8]))
    }
}

const SECOND: [f64; 3] = [0.2, 1.0, 0.5];

/// χ² of light between pairs (start, bin) of two tallies in a channel, as z; and χ² per degree of freedom.
fn pairs_z(a: &Tally, b: &Tally, pairs: impl Iterator<Item = [(usize, usize); 2]>) -> [f64; 2] {
    let (mut chi2, mut freedom) = (0.0, 0.0);
    for [(a_start, a_bin), (b_start, b_bin)] in pairs {
        if a.of_start(a_start)[a_bin] + b.of_start(b_start)[b_bin] < 50 {
            continue;
        }
        let light = |tally: &Tally, start, bin| {
            let (Moments { sum, square }, unit) = (tally.light(start, bin, 1), tally.unit() as f64);
            mean_error(sum as f64 / unit, square as f64 / unit / unit, tally.walks_per_incident() as f64)
        };
        chi2 += means_z(light(a, a_start, a_bin), light(b, b_start, b_bin)).powi(2);
        freedom += 1.0;
    }
    assert!(freedom > 300.0, "only {freedom} pairs have enough light");
    [chi2_z(chi2, freedom), chi2 / freedom]
}

/// All pairs of incident and exit cells.
fn cells() -> impl Iterator<Item = (usize, usize)> {
    (0..64).flat_map(|i| (0..64).map(move |o| (i, o)))
}

/// z of front.R against its transpose, back.R likewise, and front.T against the transpose of back.T; starts of the back
/// follow those of the front, transmission bins those of reflection.
fn reciprocity_z(a: &Tally, b: &Tally) -> [[f64; 2]; 3] {
    [
        pairs_z(a, b, cells().map(|(i, o)| [(i, o), (o, i)])),
        pairs_z(a, b, cells().map(|(i, o)| [(64 + i, o), (64 + o, i)])),
        pairs_z(a, b, cells().map(|(i, o)| [(i, 64 + o), (64 + o, 64 + i)])),
    ]
}

/// Both sides of the cloth with a second index.
fn both_sides(second_ior: f64, seed: u64) -> Tally {
    run("gpu", gpu(), &oblique(SECOND, second_ior, false), &WalkPlan::new(seed, 40_000))
}

/// Of the stated cloth.
static STATED: LazyLock<Tally> = LazyLock::new(|| both_sides(1.5, 150));

#[test]
fn light_and_sight_may_change_places() {
    let (a, b) = (&*STATED, both_sides(1.5, 151));
    let z = reciprocity_z(a, &b);
    println!("z and χ² per degree of freedom: {z:.2?}");
    assert!(z.iter().all(|[z, _]| z.abs() < GATE), "{z:.2?}");
    // Front and back do differ, and so do T and its own transpose.
    let sides = pairs_z(a, &b, cells().map(|(i, o)| [(i, o), (64 + i, o)]));
    let transposed = pairs_z(a, &b, cells().map(|(i, o)| [(i, 64 + o), (o, 64 + i)]));
    println!("front against back: {sides:.2?}, T against its transpose: {transposed:.2?}");
    assert!(sides[0] > GATE && transposed[0] > GATE, "{sides:.2?}, {transposed:.2?}");
}

#[test]
fn another_cloth_is_not_the_reciprocal_one() {
    let z = reciprocity_z(&STATED, &both_sides(1.543, 151));
    println!("z and χ² per degree of freedom: {z:.2?}");
    assert!(z.iter().all(|[z, _]| *z > GATE), "{z:.2?}");
}

/// z of a cloth's back against the front of the cloth turned over about x, R and T, and of its front against that back.
/// The fibers of the second kind are short.
fn turned_z(name: &str, engine: &dyn Engine, axis: [f64; 3], walks: u64) -> Vec<f64> {
    let short = |cloth| Cloth { length_over_radius: 4.0, ..cloth };
    static STATED: [OnceLock<Tally>; 2] = [const { OnceLock::new() }; 2];
    let stated = &STATED[usize::from(name == "cpu")];
    let a = stated.get_or_init(|| run(name, engine, &short(oblique(SECOND, 1.3, false)), &WalkPlan::new(160, walks)));
    let b = run(name, engine, &short(oblique(axis, 1.3, true)), &WalkPlan::new(161, walks));
    // (x, y) becomes (x, −y).
    let flip = |cell: usize| (7 - cell / 8) * 8 + cell % 8;
    let of = |a_start: usize, b_start: usize, bin: usize| {
        pairs_z(a, &b, cells().map(move |(i, o)| [(a_start + flip(i), bin + flip(o)), (b_start + i, bin + o)]))[0]
    };
    vec![of(64, 0, 0), of(64, 0, 64), of(0, 64, 0), of(0, 64, 64)]
}

#[test]
fn a_sheet_turned_over_swaps_front_and_back() {
    for (name, engine) in engines() {
        let z = turned_z(name, engine, SECOND, 10_000);
        println!("{name}: z = {z:.1?}");
        assert!(largest(&z) < GATE, "{name}: z = {z:.1?}");
    }
}

#[test]
fn another_sheet_turned_over_does_not() {
    for (name, engine) in engines() {
        let z = turned_z(name, engine, [0.2, 1.0, 0.6], 10_000);
        println!("{name}: z = {z:.1?}");
        assert!(largest(&z) > GATE, "{name}: z = {z:.1?}");
    }
}
