//! Each function of the kernel alone, through a probe, against f64; and the closed form of the cylinder against a tracer
//! that follows each ray segment by segment.

use crate::common::probes::{CALLS, ULP, bits, rounded, vector, words};
use crate::common::tracer::Trace;
use crate::common::{Cloth, ISOTROPIC, PLANAR, SplitMix, aligned, gpu};
use fiberwalk::goniometer::Outcome;
use fiberwalk::gpu::{Probe, ProbeInput};
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::optics::{Encounter, reflectance};
use fiberwalk::scene::Side;
use fiberwalk::walk::{EventDraws, Purpose, draw, start_draws, threefry};
use glam::{DVec2, DVec3};

/// Call a probe on a cloth.
fn probe(cloth: &Cloth, in_texture: bool, entry: &str, inputs: &[ProbeInput]) -> Vec<[u32; 4]> {
    let Prepared { tables, goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
    let mut probe = Probe::new(gpu(), &tables, &goniometer);
    probe.in_texture = in_texture;
    probe.call(entry, inputs).expect("the device works")
}

#[test]
fn random_words_are_bit_exact() {
    let mut random = SplitMix(1);
    let inputs: Vec<ProbeInput> =
        (0..CALLS).map(|_| ProbeInput { a: words(&mut random), b: words(&mut random), c: [0; 4] }).collect();
    let outputs = probe(&Cloth::isotropic(1.0), false, "probe_threefry", &inputs);
    for (input, output) in inputs.iter().zip(outputs) {
        assert_eq!(output, threefry([input.b[0], input.b[1], 0, 0], input.a));
    }
    // Walk, event and purpose stand where the draw contract puts them.
    let input = ProbeInput { a: [7, 8, 9, Purpose::Start as u32], b: [5, 6, 0, 0], c: [0; 4] };
    let output = probe(&Cloth::isotropic(1.0), false, "probe_threefry", &[input]);
    assert_eq!(output[0], draw(6 << 32 | 5, 8 << 32 | 7, 9, Purpose::Start));
    assert_ne!(output[0], draw(6 << 32 | 5, 8 << 32 | 7, 9, Purpose::Event));
}

#[test]
fn free_path_is_the_exponential_of_the_contract() {
    let cloth = Cloth::isotropic(4.0);
    let Prepared { tables, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
    let mut random = SplitMix(2);
    let mut inputs: Vec<ProbeInput> =
        (0..CALLS).map(|_| ProbeInput { a: words(&mut random), ..Default::default() }).collect();
    for (input, word) in inputs.iter_mut().zip([0, 1, 255, u32::MAX, u32::MAX - 1, 1 << 31]) {
        input.a[0] = word;
    }
    let outputs = probe(&cloth, false, "probe_free_path", &inputs);
    for (input, output) in inputs.iter().zip(outputs) {
        let path = f64::from(f32::from_bits(output[0]));
        let expected = EventDraws::new(input.a).free_path / tables.majorant;
        // Words near 2³² are rounded to 24 bits before the logarithm, which adds its own error near 1.
        let bound = 2.0 * ULP / tables.majorant + 8.0 * ULP * expected;
        assert!(path >= 0.0 && (path - expected).abs() <= bound, "{}: {path} for {expected}", input.a[0]);
    }
}

#[test]
fn draw_fiber_takes_the_same_entry_and_direction_from_uniforms_and_textures() {
    let mixed = Cloth {
        fibers: vec![(100.0, ISOTROPIC.into()), (70.0, PLANAR.into()), (50.0, aligned([0.48, -0.6, 0.64]))],
        ..Cloth::isotropic(1.0)
    };
    let odd_grid = Cloth { directions: 900, ..Cloth::isotropic(1.0) };
    let large = Cloth { directions: 16384, ..Cloth::isotropic(1.0) };
    let mut random = SplitMix(3);
    let inputs: Vec<ProbeInput> =
        (0..CALLS).map(|_| ProbeInput { a: words(&mut random), ..Default::default() }).collect();
    for (cloth, in_texture) in [(&mixed, false), (&mixed, true), (&odd_grid, false), (&large, true)] {
        let Prepared { tables, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
        for (input, output) in inputs.iter().zip(probe(cloth, in_texture, "probe_draw_fiber", &inputs)) {
            let draws = EventDraws::new(input.a);
            let entry = tables.draw_entry(0, draws.entry);
            assert_eq!(output[3] as usize, entry, "the entry is drawn in integers and must be the same");
            let p = fiberwalk::distribution::direction_of(tables.patches[entry].at(draws.jitter));
            let error = (vector(output) - p).length();
            assert!(error < 8.0 * ULP, "{:?}: off by {error:e}", tables.patches[entry]);
        }
    }
}

#[test]
fn start_direction_is_where_the_goniometer_says() {
    let mut random = SplitMix(4);
    for incident in ["8", "7", "[[30, 20], [60, 100], [89.9, -75]]", "\"klems\"", "\"polar:11x7\"", "\"polar:3x1\""] {
        let cloth = Cloth { sides: "[\"front\", \"back\"]".into(), ..Cloth::isotropic(1.0).lit_from(incident) };
        let Prepared { goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
        let cells = goniometer.starts();
        let inputs: Vec<ProbeInput> = (0..CALLS)
            .map(|i| ProbeInput { a: words(&mut random), b: [(i % cells) as u32, 0, 0, 0], c: [0; 4] })
            .collect();
        for (input, output) in inputs.iter().zip(probe(&cloth, false, "probe_start_direction", &inputs)) {
            let expected = -goniometer.start_direction(input.b[0] as usize, start_draws(input.a));
            let error = vector(output) - expected;
            // z = √(1 − r²) takes the error of r in proportion to 1/z.
            assert!(error.truncate().length() < 4.0 * ULP, "{error}");
            assert!(error.z.abs() < 4.0 * ULP / expected.z.abs(), "{error} at z = {}", expected.z);
        }
    }
}

#[test]
fn exit_bin_is_the_cell_of_the_goniometer() {
    let plain = Cloth { exit: 13, ..Cloth::isotropic(1.0) };
    let rings = |name| plain.clone().counted_in(name);
    let (klems, polar, degrees) = (rings("klems"), rings("polar:18x36"), rings("polar:90x360"));
    for (cloth, cells) in
        [(&plain, [13.0, 13.0]), (&klems, [24.0, 9.0]), (&polar, [36.0, 18.0]), (&degrees, [360.0, 90.0])]
    {
        let edges = bins_at_edges(cloth, cells);
        // Few directions come as near to an edge as f32 may be off, of 4·10³ edges a few more.
        assert!(edges < if cells[0] > 100.0 { 40 } else { 10 }, "{cells:?}: {edges} directions were not judged");
    }
}

/// Hold the bins of random directions against the goniometer; those that lie nearer to an edge than f32 tells are counted.
fn bins_at_edges(cloth: &Cloth, cells: [f64; 2]) -> usize {
    let mut random = SplitMix(5);
    let Prepared { goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
    let directions: Vec<DVec3> = (0..CALLS).map(|_| rounded(random.direction())).collect();
    let input = |(i, m): (usize, &DVec3)| ProbeInput { a: bits(*m, 0.0), b: [(i % 3) as u32, 0, 0, 0], c: [0; 4] };
    let inputs: Vec<ProbeInput> = directions.iter().enumerate().map(input).collect();
    let mut at_edges = 0;
    for (i, (m, output)) in directions.iter().zip(probe(cloth, false, "probe_exit_bin", &inputs)).enumerate() {
        let expected = goniometer.exit_bin(Side::Front, *m, i % 3 > 0);
        let place = goniometer.exit.place(m.truncate());
        // Of a place, in cells, f32 keeps half the cells along an edge times the map's error of 3e-7.
        let near = |t: f64, n: f64| (t - t.round()).abs() < 3e-7 * cells[0] && t.round() > 0.0 && t.round() < n;
        let at_edge = near(place.x, cells[0]) || near(place.y, cells[1]);
        at_edges += usize::from(at_edge);
        assert!(at_edge || output[0] as usize == expected, "{m}: bin {} for {expected}", output[0]);
    }
    at_edges
}

#[test]
fn what_is_not_a_unit_vector_is_lost() {
    let cloth = Cloth::isotropic(1.0);
    let Prepared { goniometer, .. } = prepare(&cloth.scene()).expect("the cloth is fine");
    let vectors =
        [[f32::NAN; 3], [0.0; 3], [f32::INFINITY, 0.0, 0.0], [0.0, 0.0, 1.1], [0.5, f32::NAN, 0.5], [0.0, 0.0, 1.0]];
    let inputs = vectors.map(|[x, y, z]| ProbeInput {
        a: [x.to_bits(), y.to_bits(), z.to_bits(), 0],
        b: [1, 0, 0, 0],
        c: [0; 4],
    });
    let outputs = probe(&cloth, false, "probe_exit_bin", &inputs);
    let lost = goniometer.layout().outcome(Outcome::Lost);
    for (vector, output) in vectors.iter().zip(&outputs).take(5) {
        assert_eq!(output[0] as usize, lost, "{vector:?}");
    }
    assert_ne!(outputs[5][0] as usize, lost, "a unit vector is not lost");
}

/// Rays, fibers, offsets and indices over the whole range.
fn encounters(seed: u64) -> impl Iterator<Item = (DVec3, DVec3, f64, f64)> {
    let mut random = SplitMix(seed);
    (0..4000).filter_map(move |i| {
        let (m, p) = (rounded(random.direction()), rounded(random.direction()));
        let offset = f64::from((2.0 * random.uniform() - 1.0) as f32);
        let ior = [1.0, 1.2, 1.33, 1.5, 1.8, 2.5][i % 6];
        (m.cross(p).length() > 0.02).then_some((m.normalize(), p.normalize(), offset, ior))
    })
}

#[test]
fn the_cylinder_in_closed_form_is_the_path_of_the_ray() {
    for (m, p, offset, ior) in encounters(6) {
        let encounter = Encounter::new(m, p, offset, ior);
        for chords in 0..6 {
            let start = Trace::hit(m, p, offset, ior);
            let traced = start.leave_after(chords);
            let k = u64::from(chords);
            assert_eq!(traced.chords, chords);
            let error = (encounter.exit_direction(k, 1.0) - traced.direction).length();
            assert!(error < 1e-7, "direction off by {error:e} at k = {k}, α = {offset}, η = {ior}");
            let error = (encounter.path_length(k) - traced.path).abs();
            assert!(error < 1e-7 * (1.0 + traced.path), "path off by {error:e}");
            // Rebuild the exit point from azimuth and shift.
            let (azimuth, shift) = encounter.exit_point(k);
            let (e1, e2) = (start_normal(m, p, 0.0), m.cross(p).normalize());
            let point = e1 * azimuth.cos() + e2 * azimuth.sin() + p * shift;
            assert!((point - traced.point).length() < 1e-6 * (1.0 + shift.abs()), "point {point} for {}", traced.point);
        }
    }
}

fn start_normal(m: DVec3, p: DVec3, offset: f64) -> DVec3 {
    Trace::hit(m, p, offset, 1.0).point
}

#[test]
fn one_reflectance_serves_every_interface() {
    for (m, p, offset, ior) in encounters(7) {
        let encounter = Encounter::new(m, p, offset, ior);
        let mut ray = Trace::hit(m, p, offset, ior);
        assert!((ray.reflectance() - encounter.reflectance).abs() < 1e-8, "from outside, α = {offset}, η = {ior}");
        ray.refract();
        for bounce in 0..4 {
            let error = (ray.reflectance() - encounter.reflectance).abs();
            assert!(error < 1e-6, "inside, bounce {bounce}: off by {error:e}, α = {offset}, η = {ior}");
            ray.reflect();
        }
    }
}

#[test]
fn a_bent_index_does_not_follow_the_ray() {
    let far = encounters(6).filter(|(m, p, offset, ior)| {
        let encounter = Encounter::new(*m, *p, *offset, ior * 1.001);
        (encounter.exit_direction(1, 1.0) - Trace::hit(*m, *p, *offset, *ior).leave_after(1).direction).length() > 1e-5
    });
    assert!(far.count() > 3000);
    assert!((reflectance(0.5, 1.5) - reflectance(0.5, 1.5015)).abs() > 1e-5);
}

#[test]
fn scatter_sends_light_where_the_tracer_does() {
    for ior in [1.0, 1.33, 1.55, 2.5] {
        let cloth = Cloth { ior, ..Cloth::isotropic(1.0) };
        let mut random = SplitMix(8);
        let mut inputs = Vec::new();
        let mut expected = Vec::new();
        while inputs.len() < CALLS {
            let (m, p) = (rounded(random.direction()), rounded(random.direction()));
            let offset = f64::from((2.0 * random.uniform() - 1.0) as f32);
            let visible = m.cross(p).length();
            // Stay away from grazing hits, where the exit direction is not continuous in f32.
            if visible < 0.05 || offset.abs() > 0.999 {
                continue;
            }
            let f = Trace::hit(m.normalize(), p.normalize(), offset, ior).reflectance();
            // Put the number in the middle of the interval that draws k chords.
            let chords = (random.word() % 7) as i32;
            let number = if chords == 0 { 0.5 * f } else { 1.0 - 0.5 * (1.0 - f) * f.powi(chords - 1) * (1.0 + f) };
            // Stay away from intervals that f32 can hardly see.
            if number < 1e-3 || (1.0 - number) < 1e-3 {
                continue;
            }
            inputs.push(ProbeInput { a: bits(m, offset as f32), b: bits(p, number as f32), c: [0; 4] });
            let traced = Trace::hit(m.normalize(), p.normalize(), offset, ior).leave_after(chords as u32);
            expected.push((traced.direction, chords));
        }
        for ((expected, chords), output) in expected.iter().zip(probe(&cloth, false, "probe_scatter", &inputs)) {
            let error = (vector(output) - *expected).length();
            // Each chord turns by an angle whose error grows towards grazing offsets as 1/√(1 − α²) ≤ 23.
            let bound = ULP * 40.0 * f64::from(chords + 1);
            assert!(error < bound, "η = {ior}, k = {chords}: off by {error:e}");
        }
    }
}

#[test]
fn the_middle_of_the_disc_has_a_cell() {
    let goniometer = prepare(&Cloth::isotropic(1.0).scene()).expect("the cloth is fine").goniometer;
    assert_eq!(goniometer.exit.cell_of(DVec2::ZERO), 8 * 16 + 8);
    let input = ProbeInput { a: bits(DVec3::Z, 0.0), b: [1, 0, 0, 0], c: [0; 4] };
    assert_eq!(probe(&Cloth::isotropic(1.0), false, "probe_exit_bin", &[input])[0][0], 8 * 16 + 8);
}
