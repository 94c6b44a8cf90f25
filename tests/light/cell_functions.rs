//! Each function of the kernel that knows of cells, through a probe, against f64.

use crate::common::cells::CellCloth;
use crate::common::probes::{CALLS, ULP, bits, rounded, vector, words};
use crate::common::{Cloth, SplitMix, gpu};
use fiberwalk::gpu::{Probe, ProbeInput};
use fiberwalk::walk::EventDraws;
use glam::DVec3;

/// Cells whose table needs a texture, or fits a uniform buffer: nine of ten empty, and a layer with nothing in it.
fn sparse(counts: [u32; 3]) -> CellCloth {
    CellCloth::new(Cloth::isotropic(1.0), counts, [1.7, 0.9], |[x, y, z]| {
        if z == 2 || (7 * x + 5 * y + 3 * z) % 11 > 0 { 0.0 } else { 1.0 }
    })
}

const COUNTS: [([u32; 3], bool); 4] =
    [([13, 9, 7], false), ([13, 9, 7], true), ([100, 80, 20], true), ([1, 1, 5], false)];

#[test]
fn come_back_stays_inside_the_repeat_and_finds_the_cell() {
    for (counts, in_texture) in COUNTS {
        let cells = sparse(counts);
        let (tables, goniometer) = cells.prepare();
        let mut random = SplitMix(9);
        let edge = [f32::EPSILON, -f32::EPSILON, -1e-30, 0.0, -0.0, counts[0] as f32, 1e9, -1e9, 3e12, -7.0];
        let mut places: Vec<[f32; 3]> = edge.map(|x| [x, -x, counts[2] as f32]).to_vec();
        places.extend((0..CALLS).map(|i| {
            // From far away too.
            let spread = 10f64.powi(i as i32 % 4);
            [0, 1, 2].map(|axis| {
                let far = if axis == 2 { 1.0 } else { spread };
                (f64::from(counts[axis]) * (0.5 + far * (random.uniform() - 0.5))) as f32
            })
        }));
        let inputs: Vec<ProbeInput> = places
            .iter()
            .map(|[x, y, z]| ProbeInput { a: [x.to_bits(), y.to_bits(), z.to_bits(), 0], ..Default::default() })
            .collect();
        let mut probe = Probe::new(gpu(), &tables, &goniometer);
        probe.in_texture = in_texture;
        for (place, output) in places.iter().zip(probe.call("probe_come_back", &inputs).expect("the device works")) {
            let there = vector(output);
            let mut cell = [0; 3];
            for axis in 0..3 {
                let (count, from) = (f64::from(counts[axis]), f64::from(place[axis]));
                let expected = if axis < 2 { from.rem_euclid(count) } else { from };
                assert!(axis == 2 || (0.0..count).contains(&there[axis]), "{place:?} came to {there}");
                // Repeats are counted in f32: an error of some roundings of where the place was.
                let error = (there[axis] - expected).abs();
                let error = if axis < 2 { error.min(count - error) } else { error };
                assert!(error <= 2.0 * ULP * from.abs().max(count), "{place:?}: {there} for {expected}");
                cell[axis] = (there[axis].floor() as u32).min(counts[axis] - 1);
            }
            assert_eq!(output[3] as usize, cells.grid().index(cell), "{place:?}");
        }
    }
}

#[test]
fn skip_empty_goes_to_the_face_of_the_block() {
    for (counts, in_texture) in COUNTS {
        let cells = sparse(counts);
        let (tables, goniometer) = cells.prepare();
        let grid = cells.grid();
        let entries = &tables.cells.as_ref().expect("there are cells").entries;
        let mut random = SplitMix(10);
        let mut calls = Vec::new();
        for i in 0..CALLS {
            let mut place = [0, 1, 2].map(|axis| f64::from(counts[axis]) * random.uniform());
            let mut m = random.direction();
            match i % 8 {
                // Along an axis, near the horizon, on a face, on the front.
                0 => m = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z][i / 8 % 6],
                1 => m.z *= 1e-6,
                2 => place[i / 8 % 2] = place[i / 8 % 2].floor(),
                3 => place[2] = f64::from(counts[2]),
                _ => {}
            }
            calls.push((DVec3::from(place).as_vec3().as_dvec3(), rounded(m.normalize())));
        }
        let inputs: Vec<ProbeInput> =
            calls.iter().map(|(place, m)| ProbeInput { a: bits(*place, 0.0), b: bits(*m, 0.0), c: [0; 4] }).collect();
        let mut probe = Probe::new(gpu(), &tables, &goniometer);
        probe.in_texture = in_texture;
        let mut jumps = 0;
        for ((place, m), output) in calls.iter().zip(probe.call("probe_skip_empty", &inputs).expect("the device works"))
        {
            let there = vector(output);
            let cell = [0, 1, 2].map(|axis| (place[axis].floor() as u32).min(counts[axis] - 1));
            let reach = entries[grid.index(cell)].reach;
            if reach.across == 0 {
                assert_eq!(there, *place, "a cell with fibers is not jumped over");
                continue;
            }
            jumps += 1;
            // Slabs: the nearest of the far faces.
            let speed = *m / grid.edges();
            let mut distance = f64::INFINITY;
            let mut flat: f64 = 1.0;
            for axis in 0..3 {
                let reach = f64::from([reach.across, reach.across, reach.along][axis]);
                let (low, high) = (f64::from(cell[axis]) - reach + 1.0, f64::from(cell[axis]) + reach);
                let far = ((low - place[axis]) / speed[axis]).max((high - place[axis]) / speed[axis]);
                if far < distance {
                    (distance, flat) = (far, speed[axis].abs() / speed.length());
                }
            }
            let expected = *place + speed * distance;
            // An error of the way to a face grows with the way, and where the ray meets it at a flat angle.
            let bound = 4.0 * ULP * (place.length() + speed.length() * distance / flat);
            assert!((there - expected).length() <= bound, "{place} along {m}: {there} for {expected}");
        }
        assert!(jumps > CALLS / 3, "only {jumps} jumps");
    }
}

#[test]
fn draw_fiber_takes_the_list_that_it_is_given() {
    let mut cells = sparse([3, 3, 3]);
    let list = cells.lists[0].clone();
    cells.lists = [1, 2, 3, 700, 1024].map(|count| list[list.len() - count..].to_vec()).to_vec();
    let (tables, goniometer) = cells.prepare();
    let mut random = SplitMix(11);
    let packed = |i: usize| tables.lists[i].first | tables.lists[i].alias.index_bits() << 24;
    let inputs: Vec<ProbeInput> =
        (0..CALLS).map(|i| ProbeInput { a: words(&mut random), b: [packed(i % 5), 0, 0, 0], c: [0; 4] }).collect();
    let outputs = Probe::new(gpu(), &tables, &goniometer).call("probe_draw_fiber", &inputs).expect("the device works");
    for (i, (input, output)) in inputs.iter().zip(outputs).enumerate() {
        let entry = tables.draw_entry((i % 5) as u32, input.a[1]);
        assert_eq!(output[3] as usize, entry);
        let p = fiberwalk::distribution::direction_of(tables.patches[entry].at(EventDraws::new(input.a).jitter));
        assert!((vector(output) - p).length() < 8.0 * ULP);
    }
}
