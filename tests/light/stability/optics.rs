//! Indices from 1 to 4, long trains of reflections inside a fiber, absorption.

use super::brute::{Brute, EXIT, place_of, sheets_of};
use super::light::from_degrees;
use super::table::{Found, METHODS, beyond, fails, note, right, scattered, section, setup, track, walks, within};
use crate::common::probes::{ULP, bits, vector};
use crate::common::stats::{chi2_z, mean_error, means_z, two_sample_chi2};
use crate::common::tracer::Trace;
use crate::common::{Cloth, aligned, engines, gpu, rgb};
use fiberwalk::goniometer::{Moments, Tally};
use fiberwalk::gpu::{Probe, ProbeInput};
use fiberwalk::optics::Encounter;
use fiberwalk::reference::replay;
use fiberwalk::walk::WalkPlan;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;

const AXIS: DVec3 = DVec3::new(0.48, -0.6, 0.64);
/// v = 0.113.
const SHEET: Brute = Brute {
    radius: 0.03,
    length_density: 40.0,
    thickness: 1.0,
    ior: 1.5,
    axis: AXIS,
    absorption: [0.0; 3],
    carried: None,
    most_chords: u32::MAX,
};

#[test]
fn indices_from_one_to_four() {
    section("Indices from 1 to 4");
    let wi = from_degrees([35.0, 20.0]);
    let n = walks(20_000);
    for (ior, seed) in [1.0, 1.0001, 1.33, 2f64.sqrt(), 4.0].into_iter().zip((2000..).step_by(100)) {
        let regime = format!("index {ior:.4}: light by exit cell, share reflected");
        let compare = |a: &[u64], b: &[u64]| {
            let (chi2, k) = two_sample_chi2(a, a.iter().sum(), b, b.iter().sum());
            chi2_z(chi2, k)
        };
        let sheet = Brute { ior, ..SHEET };
        let expected = sheets_of(sheet).map(|sheet| sheet.measure(wi, 4 * n, seed));
        let cloth = Cloth { radius_um: 30.0, ior, ..Cloth::new(40.0, &aligned(AXIS.to_array())) };
        let cloth = cloth.lit_from("[[35, 20]]");
        for (method, seed) in METHODS.iter().zip(seed + 10..) {
            let expected = &expected[place_of(method)];
            let setup = setup(&method.of(&cloth));
            let [gpu, cpu] = engines().map(|(name, engine)| {
                let tally = track(name, engine, &setup, seed, n);
                let found = [tally.reflection(0), tally.transmission(0), &[tally.direct(0)]].concat();
                Found { value: scattered(&tally, 0)[0] as f64 / n as f64, z: compare(&found, &expected.counts) }
            });
            right(&regime, method.name, expected.reflected(), Some(gpu), Some(cpu));
        }
        if ior > 1.1 && ior < 2.0 {
            let weak = Brute { most_chords: 1, ..sheet }.measure(wi, n, seed + 20);
            let found = Found { value: weak.reflected(), z: compare(&weak.counts, &expected[0].counts) };
            fails(&regime, "at most one chord", expected[0].reflected(), found);
        }
    }
}

/// Reflectance by angles in f32, from the sine and tangent laws.
fn by_angles(cosine: f32, ior: f32) -> f32 {
    let i = cosine.acos();
    let t = (i.sin() / ior).asin();
    0.5 * (((i - t).sin() / (i + t).sin()).powi(2) + ((i - t).tan() / (i + t).tan()).powi(2))
}

#[test]
fn fresnel_near_index_one() {
    section("Reflectance at the ends of the indices");
    for ior in [1.0, 1.0001, 4.0] {
        let cloth = Cloth { ior, ..Cloth::isotropic(1.0) };
        let (tables, goniometer) = setup(&cloth);
        let (m, p) = (-DVec3::Z, DVec3::X);
        let steps = 1 << 12;
        // Light enters when its number is above the reflectance: ask the kernel a little below and a little above.
        let reflectance = |offset: f64| Trace::hit(m, p, offset, ior).reflectance();
        let offsets: Vec<f64> =
            (0..steps).map(|i| f64::from(((f64::from(i) + 0.5) / f64::from(steps)) as f32)).collect();
        let margin = 4.0 * ULP;
        let input = |offset: f64, number: f64| ProbeInput {
            a: bits(m, offset as f32),
            b: bits(p, number.clamp(0.0, 1.0) as f32),
            c: [0; 4],
        };
        let inputs: Vec<ProbeInput> = offsets
            .iter()
            .flat_map(|&offset| {
                [input(offset, reflectance(offset) - margin), input(offset, reflectance(offset) + margin)]
            })
            .collect();
        let outputs = Probe::new(gpu(), &tables, &goniometer).call("probe_scatter", &inputs).expect("it works");
        let length = |output: &[u32; 4]| f64::from(f32::from_bits(output[3]));
        let wrong = outputs.chunks(2).zip(&offsets).filter(|(pair, offset)| {
            let (below, above) = (length(&pair[0]) > 0.0, length(&pair[1]) > 0.0);
            // Reflectances below the margin have no number below them.
            !above || (below && reflectance(**offset) > margin)
        });
        let regime = format!("reflectance at index {ior:.4}, 4096 offsets");
        within(&regime, "wrong by four roundings of f32", [Some(wrong.count() as f64 / f64::from(steps)), None], 0.0);
        let closed = |offset: &f64| {
            let f = Encounter::new(m, p, *offset, ior).reflectance;
            (f - reflectance(*offset)).abs()
        };
        within(&regime, "closed form", [None, Some(offsets.iter().map(closed).fold(0.0, f64::max))], 1e-9);
        if ior == 1.0001 {
            let naive = |offset: &f64| {
                let cosine = (1.0 - offset * offset).sqrt() as f32;
                (f64::from(by_angles(cosine, ior as f32)) - reflectance(*offset)).abs()
            };
            let worst = offsets.iter().map(naive).fold(0.0, |a: f64, b| if b.is_nan() { f64::NAN } else { a.max(b) });
            beyond(&regime, "sines and tangents of angles in f32", worst, 4.0 * ULP);
        }
    }
}

/// Reflections inside a circle, one after the other, as they are written down first: the normal is the point itself.
struct Stepped {
    point: DVec2,
    direction: DVec2,
    single: bool,
}

impl Stepped {
    fn bounce(&mut self) {
        let normal = self.point;
        let direction = self.direction - 2.0 * self.direction.dot(normal) * normal;
        let point = self.point - 2.0 * self.point.dot(direction) * direction;
        let kept = |v: DVec2| if self.single { v.as_vec2().as_dvec2() } else { v };
        (self.point, self.direction) = (kept(point), kept(direction));
    }
}

#[test]
fn a_train_of_a_hundred_thousand_reflections() {
    section("Trains of reflections");
    const CHORDS: u32 = 100_000;
    // Chords that pass over a two-hundredth of a turn: after 500 turns the light is where it came in.
    let (ior, part) = (1.0001, PI / 200.0);
    let offset = ior * part.cos();
    let (m, p) = (-DVec3::X, DVec3::Z);
    let mirrored = -m * (1.0 - 2.0 * offset * offset) + m.cross(p) * (2.0 * offset * (1.0 - offset * offset).sqrt());
    let length = 2.0 * part.sin() * f64::from(CHORDS);
    let encounter = Encounter::new(m, p, offset, ior);
    let regime = format!("{CHORDS} reflections inside");
    let error = (encounter.exit_direction(u64::from(CHORDS), 1.0) - mirrored).length();
    within(&regime, "closed form: direction", [None, Some(error)], 1e-9);
    let error = encounter.path_length(u64::from(CHORDS)) / length - 1.0;
    within(&regime, "closed form: length of the way", [None, Some(error)], 1e-11);
    let hit = Trace::hit(m, p, offset, ior);
    let traced = hit.leave_after(CHORDS);
    // The tracer brings its normals to unit length at every interface.
    let error = (traced.direction - mirrored).length();
    within(&regime, "step by step, normals mended: direction", [None, Some(error)], 1e-6);
    let mut notes = Vec::new();
    for (name, single, bound) in [("step by step in f32", true, 1e-4), ("step by step in f64", false, 1e-6)] {
        let mut inside = hit;
        inside.refract();
        let start = inside.point.truncate();
        let mut stepped = Stepped { point: start, direction: inside.direction.truncate().normalize(), single };
        let mut drift = Vec::new();
        for bounce in 1..CHORDS {
            stepped.bounce();
            if [100, 1000, 10_000, 30_000, CHORDS - 1].contains(&bounce) {
                let [p, d] = [stepped.point, stepped.direction].map(|v| v.length() - 1.0);
                drift.push(format!("{p:.0e}, {d:.0e}"));
            }
        }
        beyond(&regime, &format!("{name}: |p|"), (stepped.point.length() - 1.0).abs(), bound);
        notes.push(format!("{name}: {}", drift.join("; ")));
    }
    note(&format!("|p| − 1, |d| − 1 after 10², 10³, 10⁴, 3·10⁴, 10⁵ reflections {}", notes.join("; ")));
}

#[test]
fn the_longest_train_of_the_kernel() {
    section("The longest train of the kernel");
    // Grazing light is reflected inside; what still goes on after 1024 chords is let out.
    let (ior, offset) = (1.5, 1.0 - f64::from(f32::EPSILON));
    let (m, p) = (-DVec3::X, DVec3::Z);
    let (tables, goniometer) = setup(&Cloth { ior, ..Cloth::isotropic(1.0) });
    let encounter = Encounter::new(m, p, offset, ior);
    let input = ProbeInput { a: bits(m, offset as f32), b: bits(p, 1.0), c: [0; 4] };
    let output = Probe::new(gpu(), &tables, &goniometer).call("probe_scatter", &[input]).expect("it works")[0];
    let chords = f64::from(f32::from_bits(output[3])) / encounter.path_length(1);
    assert!((chords - 1024.0).abs() < 1.0, "{chords}");
    let out = vector(output);
    let error = (out - encounter.exit_direction(1024, 1.0)).length();
    let regime = "1024 reflections inside";
    within(regime, "length of the direction", [Some(out.length() - 1.0), None], 4.0 * ULP);
    // Each chord turns by an angle that is right to two roundings.
    within(regime, "direction", [Some(error), None], 1024.0 * 2.0 * ULP);
    // A light that may pass 16 chords only.
    let [exact, weak] = [1024, 16].map(|chords| encounter.exit_direction(chords, 1.0));
    beyond(regime, "at most 16 chords", (weak - exact).length(), 1024.0 * 2.0 * ULP);
}

#[test]
fn absorption_from_none_to_the_most_that_is_allowed() {
    section("Absorption");
    let wi = from_degrees([35.0, 20.0]);
    let n = walks(20_000);
    for (absorption, seed) in [[0.0, 1e-3, 1.0], [30.0, 2e3, 1e5]].into_iter().zip((3000..).step_by(100)) {
        let sheet = Brute { absorption, ..SHEET };
        let expected = sheets_of(sheet).map(|sheet| sheet.measure(wi, 8 * n, seed));
        let cloth =
            Cloth { radius_um: 30.0, absorption: rgb(absorption), ..Cloth::new(40.0, &aligned(AXIS.to_array())) };
        let cloth = cloth.lit_from("[[35, 20]]");
        for (method, seed) in METHODS.iter().zip(seed + 10..) {
            let expected = &expected[place_of(method)];
            let setup = setup(&method.of(&cloth));
            let tallies = engines().map(|(name, engine)| track(name, engine, &setup, seed, n));
            for (channel, sigma) in absorption.into_iter().enumerate() {
                let found = |tally: &Tally| {
                    let Moments { sum, square } = tally.absorbed(0, channel);
                    let unit = tally.unit() as f64;
                    let mean = mean_error(sum as f64 / unit, square as f64 / (unit * unit), n as f64);
                    Found { value: mean.0, z: means_z(mean, expected.absorbed(channel)) }
                };
                let [gpu, cpu] = [&tallies[0], &tallies[1]].map(found);
                let regime = format!("absorption of {sigma}/mm: share absorbed");
                right(&regime, method.name, expected.absorbed(channel).0, Some(gpu), Some(cpu));
            }
        }
    }
    // Weights in units of 2⁻¹² that are rounded down lose light where little is left.
    let (tables, goniometer) = {
        let cloth = Cloth { radius_um: 30.0, absorption: "30".into(), ..Cloth::new(160.0, &aligned(AXIS.to_array())) };
        setup(&cloth.lit_from("[[35, 20]]"))
    };
    let plan = WalkPlan { roulette: false, ..WalkPlan::new(3300, 0) };
    let weights: Vec<f64> = (0..n)
        .into_par_iter()
        .map(|i| replay(&tables, &goniometer, &plan, 0, i).walked)
        .filter(|walked| (walked.record.bin as usize) >= EXIT * EXIT && walked.record.hits > 0)
        .map(|walked| walked.weight(&tables.kinds, 0))
        .collect();
    let moments = |weight: &dyn Fn(f64) -> f64| {
        let values = weights.iter().map(|w| weight(*w));
        mean_error(values.clone().sum(), values.map(|w| w * w).sum(), n as f64)
    };
    let (exact, floored) = (moments(&|w| w), moments(&|w| (w * 4096.0).floor() / 4096.0));
    let rest = moments(&|w| w - (w * 4096.0).floor() / 4096.0);
    let found = Found { value: floored.0, z: rest.0 / rest.1 };
    fails("absorption of 30/mm in a deep sheet: share transmitted", "weights rounded down", exact.0, found);
}
