//! The table of H(m): against closed forms and dense midpoints, and in the kernel against f64.

use crate::common::cells::{CellCloth, random_cells};
use crate::common::probes::{CALLS, ULP, bits, rounded, vector};
use crate::common::{Cloth, ISOTROPIC, PLANAR, SplitMix, aligned, gpu};
use fiberwalk::distribution::{Bundle, direction_of};
use fiberwalk::goniometer::Goniometer;
use fiberwalk::gpu::{Probe, ProbeInput};
use fiberwalk::tables::{SamplingTables, VisibleArea};
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_PI_4;

/// ⟨|m × p|⟩ of bundles by 12 × 12 midpoints of each patch; all fibers have one radius.
fn mean_sine(bundles: &[Bundle], m: DVec3) -> f64 {
    let middle = |i: i32| (f64::from(i) + 0.5) / 12.0;
    let (mut sum, mut all) = (0.0, 0.0);
    for bundle in bundles {
        let sine = |i: i32| {
            let p = direction_of(bundle.patch.at(DVec2::new(middle(i % 12), middle(i / 12))));
            (1.0 - m.dot(p).powi(2)).max(0.0).sqrt()
        };
        sum += bundle.length_density * (0..144).map(sine).sum::<f64>() / 144.0;
        all += bundle.length_density;
    }
    sum / all
}

/// Three lists: a bundle that is spread, planar with isotropic, exactly aligned.
fn lists() -> CellCloth {
    let spread = "orientation = \"aligned\"\naxis = [0.3, 0.8, 0.2]\nspread_deg = 10";
    let list = |fibers: &[&str]| {
        let fibers = fibers.iter().map(|fiber| (60.0, (*fiber).to_owned())).collect();
        crate::common::cells::list_of(&Cloth { fibers, ..Cloth::isotropic(1.0) })
    };
    let base = Cloth::isotropic(1.0).tabulated();
    let mut cells = CellCloth::new(base, [3, 1, 1], [1.0, 1.0], |_| 1.0);
    cells.lists = vec![list(&[spread]), list(&[ISOTROPIC, PLANAR]), list(&[&aligned([0.48, -0.6, 0.64])])];
    (0..).zip(&mut cells.cells).for_each(|(list, cell)| cell.1 = list);
    cells
}

fn visible(tables: &SamplingTables) -> &VisibleArea {
    tables.visible.as_ref().expect("the scene asks for the table")
}

/// The largest error found of any list relative to its largest value, over rays at random, near fibers and along them.
fn largest_error(cells: &CellCloth, visible: &VisibleArea) -> f64 {
    let mut random = SplitMix(31);
    let mut worst: f64 = 0.0;
    for (index, bundles) in (0..).zip(&cells.lists) {
        let (mut error, mut largest): (f64, f64) = (0.0, 0.0);
        for ray in 0..600 {
            let bundle = &bundles[(random.word() % bundles.len() as u64) as usize];
            let p = direction_of(bundle.patch.at(DVec2::new(random.uniform(), random.uniform())));
            let m = match ray % 3 {
                0 => random.direction(),
                1 => (p + 0.05 * random.direction()).normalize(),
                _ => -p,
            };
            let truth = mean_sine(bundles, m);
            error = error.max((visible.look_up(index, m) - truth).abs());
            largest = largest.max(truth);
        }
        println!("list {index}: error {:.4}", error / largest);
        worst = worst.max(error / largest);
    }
    worst
}

#[test]
fn the_table_is_as_good_as_it_says() {
    let cells = lists();
    let (tables, _) = cells.prepare();
    let stated = visible(&tables).error;
    let found = largest_error(&cells, visible(&tables));
    println!("found {found:.4}, stated {stated:.4}");
    assert!(found < 1.2 * stated && found > 0.5 * stated, "found {found}, stated {stated}");
    // Bundles that lie 5° off are noticed.
    let mut bent = cells.clone();
    let (sin, cos) = 5f64.to_radians().sin_cos();
    let turned = aligned([0.48 * cos + 0.6 * sin, -0.6 * cos + 0.48 * sin, 0.64]);
    bent.lists[2] = crate::common::cells::list_of(&Cloth { fibers: vec![(60.0, turned)], ..Cloth::isotropic(1.0) });
    let found = largest_error(&bent, visible(&tables));
    assert!(found > 2.0 * stated, "found {found}, stated {stated}");
}

#[test]
fn the_table_has_its_closed_forms() {
    let axis = DVec3::new(0.48, -0.6, 0.64);
    let table = |orientation: &str| {
        let scene = Cloth::new(100.0, orientation).tabulated().scene();
        fiberwalk::measure::prepare(&scene).expect("the cloth is fine").tables
    };
    let (isotropic, planar, sine) = (table(ISOTROPIC), table(PLANAR), table(&aligned(axis.to_array())));
    let mut random = SplitMix(32);
    for _ in 0..2000 {
        let error = visible(&isotropic).look_up(0, random.direction()) - FRAC_PI_4;
        // The largest error that is stated is one of quadrature and interpolation: some 10⁻⁵.
        assert!(error.abs() < 1e-4, "isotropic: off by {error:e}");
    }
    // All fibers of a plane are seen at their full width along its normal.
    assert!((visible(&planar).look_up(0, DVec3::Z) - 1.0).abs() < 1e-6);
    let n = visible(&sine).n;
    for (column, row) in (0..=n).flat_map(|row| (0..=n).map(move |column| (column, row))) {
        // Corners of the octahedral map, by its definition.
        let [a, b] = [column, row].map(|at| 2.0 * f64::from(at) / f64::from(n) - 1.0);
        let (x, y) = (0.5 * (a + b), 0.5 * (a - b));
        let m = DVec3::new(x, y, 1.0 - x.abs() - y.abs()).normalize();
        let truth = m.cross(axis).length();
        assert!((f64::from(visible(&sine).node(0, column, row)) - truth).abs() < 1e-6);
        assert!((visible(&sine).look_up(0, -m) - truth).abs() < 1e-5, "{m}");
    }
}

/// Rays at random, along axes, in the horizon.
fn rays(random: &mut SplitMix) -> Vec<DVec3> {
    let ray = |i: usize| {
        let mut m = random.direction();
        match i % 8 {
            0 => m = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z][i / 8 % 6],
            1 => m.z = if i % 16 == 1 { 0.0 } else { m.z * 1e-6 },
            2 => m[i / 8 % 2] = 0.0,
            _ => {}
        }
        rounded(m.normalize())
    };
    (0..CALLS).map(ray).collect()
}

fn call(setup: &(SamplingTables, Goniometer), entry: &str, inputs: &[ProbeInput]) -> Vec<[u32; 4]> {
    let mut probe = Probe::new(gpu(), &setup.0, &setup.1);
    probe.in_texture = true;
    probe.call(entry, inputs).expect("the device works")
}

#[test]
fn visible_area_is_the_look_up() {
    let cells = lists().prepare();
    let sheet = fiberwalk::measure::prepare(&Cloth { directions: 16, ..Cloth::new(50.0, PLANAR) }.tabulated().scene());
    let sheet = sheet.map(|prepared| (prepared.tables, prepared.goniometer)).expect("the cloth is fine");
    for setup in [cells, sheet] {
        let tables = &setup.0;
        let cells = visible(tables).n.pow(2);
        let list = |i: usize| (i % tables.lists.len()) as u32;
        let packed = |list: u32| {
            let of = &tables.lists[list as usize];
            (of.first + list * cells) | of.alias.index_bits() << 24
        };
        let mut random = SplitMix(33);
        let rays = rays(&mut random);
        let input = |(i, m): (usize, &DVec3)| ProbeInput { a: bits(*m, 0.0), b: [packed(list(i)), 0, 0, 0], c: [0; 4] };
        let inputs: Vec<ProbeInput> = rays.iter().enumerate().map(input).collect();
        let mut far = 0;
        for (i, (m, output)) in rays.iter().zip(call(&setup, "probe_visible_area", &inputs)).enumerate() {
            let area = f64::from(f32::from_bits(output[0]));
            let expected = visible(tables).look_up(list(i), *m);
            // A place on the square is off by some roundings, a cell 2/n wide, and neighbours differ by a slope of 3.
            assert!((area - expected).abs() < 20.0 * ULP, "{m}: {area} for {expected}");
            let other = visible(tables).look_up(list(i), (*m + DVec3::new(1e-4, 0.0, 1e-4)).normalize());
            far += usize::from((other - expected).abs() > 20.0 * ULP);
        }
        assert!(far > CALLS / 2, "only {far} rays would show a direction that is off by 10⁻⁴");
    }
}

#[test]
fn block_ahead_is_the_block_that_the_ray_goes_through() {
    for seed in [1, 2] {
        let mut cells = random_cells(seed);
        // Layers that hold nothing reach 4096 cells across.
        let grid = cells.grid();
        for (place, cell) in grid.places().zip(&mut cells.cells) {
            cell.0 *= f64::from(u8::from(place[2] != 1 && place[2] != 4));
        }
        let setup = CellCloth { base: cells.base.clone().tabulated(), ..cells }.prepare();
        let counts = grid.counts.map(i64::from);
        let entries = &setup.0.cells.as_ref().expect("there are cells").entries;
        let mut random = SplitMix(34 + seed);
        let mut calls = Vec::new();
        for (i, m) in rays(&mut random).into_iter().enumerate() {
            // From far away in x and y; on faces, on edges, in corners, and on the faces of the cloth.
            let spread = [1.0, 1.0, 10.0, 1000.0][i / 8 % 4];
            let mut place = [0, 1, 2].map(|axis| {
                counts[axis] as f64 * (0.5 + if axis < 2 { spread } else { 1.0 } * (random.uniform() - 0.5))
            });
            let on_faces = [0, 1, 2, 4, 3, 5, 6, 7][i / 32 % 8];
            (0..3).filter(|axis| on_faces >> axis & 1 == 1).for_each(|axis| place[axis] = place[axis].round());
            calls.push((rounded(DVec3::from(place)), m));
        }
        let input =
            |(place, m): &(DVec3, DVec3), c| ProbeInput { a: bits(*place, 0.0), b: bits(*m, 0.0), c: [c, 0, 0, 0] };
        let [first, second] = [0, 1].map(|c| {
            let inputs: Vec<ProbeInput> = calls.iter().map(|one| input(one, c)).collect();
            call(&setup, "probe_block_ahead", &inputs)
        });
        let mut jumps = 0;
        for ((place, m), (first, second)) in calls.iter().zip(first.iter().zip(&second)) {
            // In whole numbers: the cell on whose side the ray is.
            let cell = [0, 1, 2].map(|axis| {
                let whole = place[axis].floor();
                let here = whole as i64 - i64::from(m[axis] < 0.0 && place[axis] == whole);
                if axis < 2 { here } else { here.clamp(0, counts[2] - 1) }
            });
            let home = [cell[0].rem_euclid(counts[0]), cell[1].rem_euclid(counts[1]), cell[2]];
            let entry = &entries[grid.index(home.map(|at| at as u32))];
            let reach =
                [entry.reach.across, entry.reach.across, entry.reach.along].map(|reach| i64::from(reach.max(1)));
            jumps += usize::from(reach[0] > 8);
            let brought = *place + DVec3::from([0, 1, 2].map(|axis| (home[axis] - cell[axis]) as f64));
            let near = (vector(*first) - brought).abs();
            assert!(near.max_element() <= 2.0 * ULP * place.length().max(1.0), "{place} came to {}", vector(*first));
            let face = [0, 1, 2].map(|axis| {
                let face = if m[axis] > 0.0 { home[axis] + reach[axis] } else { home[axis] + 1 - reach[axis] };
                (if axis < 2 { face } else { face.clamp(0, counts[2]) }) as f64
            });
            assert_eq!(vector(*second), DVec3::from(face), "{place} along {m}");
            let list = &setup.0.lists[entry.list as usize];
            assert_eq!(second[3] >> 24, list.alias.index_bits());
            assert_eq!(second[3] & 0xff_ffff, list.first + entry.list * visible(&setup.0).n.pow(2));
            let speed = *m / grid.edges();
            let way = |axis: usize| ((face[axis] - brought[axis]) / speed[axis]).max(0.0);
            let time = (0..3).filter(|axis| m[*axis] != 0.0).map(way).fold(f64::INFINITY, f64::min);
            let found = f64::from(f32::from_bits(first[3]));
            let flat = (0..3).map(|axis| speed[axis].abs()).filter(|speed| *speed > 1e-9).fold(f64::INFINITY, f64::min);
            let bound = 4.0 * ULP * (time + place.length().max(1.0) / flat);
            assert!((found - time).abs() <= bound, "{place} along {m}: {found} for {time}");
        }
        assert!(jumps > CALLS / 10, "only {jumps} blocks reach across a layer");
    }
}
