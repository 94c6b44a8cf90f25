//! Cloths of cells, for both engines: against sheets, against straight rays followed through the cells, and in their
//! accounts.

use crate::common::cells::{CellCloth, surface_of};
use crate::common::stats::{GATE, binomial_z, largest, two_tally_z};
use crate::common::{Cloth, SplitMix, assert_ran, engines, gpu, run};
use fiberwalk::Error;
use fiberwalk::gpu::Settings;
use fiberwalk::measure::prepare;
use fiberwalk::tables::SamplingTables;
use fiberwalk::walk::{Engine, WalkPlan};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// The unit vector at θ, φ in degrees.
fn from_degrees([theta, phi]: [f64; 2]) -> DVec3 {
    let (theta, phi) = (theta.to_radians(), phi.to_radians());
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// Run with an engine, each from random numbers of its own.
fn run_cells(
    name: &str,
    engine: &dyn Engine,
    cloth: &CellCloth,
    seed: u64,
    walks: u64,
) -> fiberwalk::goniometer::Tally {
    let tally = cloth.run(engine, &WalkPlan::new(seed + if name == "cpu" { 10_000 } else { 0 }, walks));
    assert_ran(&tally, name);
    tally
}

/// A sheet cut into equal cells, which share one list or have a copy each.
fn cut(sheet: &Cloth, share: f64, copies: bool) -> CellCloth {
    let mut cloth = CellCloth::new(sheet.clone(), [4, 3, 5], [0.7, 1.9], |_| share);
    if copies {
        cloth.lists = vec![cloth.lists[0].clone(); cloth.cells.len()];
        (0..).zip(&mut cloth.cells).for_each(|(list, cell)| cell.1 = list);
    }
    cloth
}

/// A sheet in few cells of directions: χ² sees a density that is off by the fewer walks the fewer its cells.
fn sheet_in_few_cells(depth: f64) -> Cloth {
    Cloth { exit: 8, ..Cloth::isotropic(depth) }.lit_from("4")
}

#[test]
fn equal_cells_are_a_sheet() {
    let sheet = sheet_in_few_cells(2.0);
    let whole = run("gpu", gpu(), &sheet, &WalkPlan::new(41, 40_000));
    for (i, copies) in [false, true].into_iter().enumerate() {
        for (name, engine) in engines() {
            let tally = run_cells(name, engine, &cut(&sheet, 1.0, copies), 42 + i as u64, 40_000);
            let z = two_tally_z(&tally, &whole);
            assert!(z.abs() < GATE, "{name}, copies: {copies}: z = {z:.1}");
        }
    }
}

#[test]
fn equal_cells_of_another_density_are_another_sheet() {
    let sheet = sheet_in_few_cells(2.0);
    let whole = run("gpu", gpu(), &sheet, &WalkPlan::new(41, 40_000));
    for (i, copies) in [false, true].into_iter().enumerate() {
        for (name, engine) in engines() {
            // Stands at 8 to 10 σ of this comparison.
            let tally = run_cells(name, engine, &cut(&sheet, 1.048, copies), 44 + i as u64, 40_000);
            let z = two_tally_z(&tally, &whole);
            println!("{name}, copies: {copies}, density × 1.048: z = {z:.1}");
            assert!(z > GATE, "{name}, copies: {copies}: z = {z:.1}");
        }
    }
}

/// A sheet pulled apart into layers of different density, with a share of the depth left out: the layers between hold
/// nothing.
fn layers(sheet: &Cloth, share: f64) -> CellCloth {
    let densities = [0.0, 1.6, 0.0, 0.0, 0.8, 4.0, 0.0, 1.6, 0.0, 0.0];
    let base = Cloth { thickness_um: 1.25 * sheet.thickness_um, ..sheet.clone() };
    CellCloth::new(base, [3, 2, 10], [0.8, 0.3], |[_, _, iz]| share * densities[iz as usize])
}

#[test]
fn layers_with_nothing_between_them_are_a_sheet() {
    let sheet = sheet_in_few_cells(1.5);
    let whole = run("gpu", gpu(), &sheet, &WalkPlan::new(51, 40_000));
    for (name, engine) in engines() {
        let z = two_tally_z(&run_cells(name, engine, &layers(&sheet, 1.0), 54, 40_000), &whole);
        assert!(z.abs() < GATE, "{name}: z = {z:.1}");
        // Stands at 8 to 10 σ of this comparison.
        let z = two_tally_z(&run_cells(name, engine, &layers(&sheet, 1.053), 53, 40_000), &whole);
        println!("{name}, density × 1.053: z = {z:.1}");
        assert!(z > GATE, "{name}: z = {z:.1}");
    }
}

/// Mean of exp(−∫H) over straight rays through the repeat: every crossing of a face is found on its own.
fn straight(cloth: &CellCloth, wi: DVec3) -> f64 {
    let grid = cloth.grid();
    let (edges, m) = (grid.edges(), -wi);
    let length = grid.thickness / wi.z;
    let starts = 128;
    let mut sum = 0.0;
    for i in 0..starts * starts {
        // Golden-ratio lattice: no row of starts runs along a face.
        let along = |k: f64| (f64::from(i) * k + 0.5).fract();
        let start =
            DVec3::new(along(0.754_877_666_246_693) * grid.period.x, along(0.569_840_290_998_053) * grid.period.y, 0.0);
        let mut stops = vec![0.0, length];
        for axis in 0..3 {
            if m[axis] != 0.0 {
                let (a, b) = (start[axis] / edges[axis], (start + m * length)[axis] / edges[axis]);
                let faces = a.min(b).ceil() as i64..=a.max(b).floor() as i64;
                stops.extend(faces.map(|face| (face as f64 * edges[axis] - start[axis]) / m[axis]));
            }
        }
        stops.sort_by(f64::total_cmp);
        let depth: f64 = stops
            .windows(2)
            .map(|pair| {
                let middle = (start + m * (0.5 * (pair[0] + pair[1]))) / edges;
                let [nx, ny, nz] = grid.counts.map(|count| count as i64);
                let place = [
                    (middle.x.floor() as i64).rem_euclid(nx),
                    (middle.y.floor() as i64).rem_euclid(ny),
                    (middle.z.floor() as i64 + nz).clamp(0, nz - 1),
                ];
                let surface = cloth.cells[grid.index(place.map(|at| at as u32))].0;
                // ⟨|m × p|⟩ of isotropic fibers is π/4.
                surface * FRAC_PI_2 * (pair[1] - pair[0])
            })
            .sum();
        sum += (-depth).exp();
    }
    sum / f64::from(starts * starts)
}

const ANGLES: [[f64; 2]; 5] = [[0.0, 0.0], [40.0, 0.0], [60.0, 125.0], [86.0, 200.0], [89.0, -66.0]];

/// Grids in which straight light shows each part of the way: columns, stripes, clumps, mostly empty, one cell.
fn grids() -> Vec<(&'static str, CellCloth)> {
    let base = |depth: f64| Cloth::isotropic(depth).lit_from(&format!("{ANGLES:?}"));
    let on = |full: bool| f64::from(u8::from(full));
    let mut random = SplitMix(77);
    let dots: Vec<f64> = (0..6 * 5 * 4).map(|_| on(random.uniform() < 0.3) * 10.0 * random.uniform()).collect();
    vec![
        ("checkerboard", CellCloth::new(base(0.2), [2, 2, 1], [0.5, 0.5], |[x, y, _]| on((x + y) % 2 == 0))),
        (
            "stripes",
            CellCloth::new(base(0.3), [8, 1, 1], [0.9, 0.2], |[x, ..]| {
                [0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.3, 0.1][x as usize]
            }),
        ),
        ("one stripe of 32", CellCloth::new(base(2.0), [32, 1, 1], [1.7, 1.0], |[x, ..]| on(x == 9))),
        ("dots", CellCloth::new(base(0.04), [6, 5, 4], [1.1, 0.7], |[x, y, z]| dots[((z * 5 + y) * 6 + x) as usize])),
        ("one cell", CellCloth::new(base(1.5), [5, 6, 4], [0.9, 1.1], |place| on(place == [1, 4, 2]))),
    ]
}

/// The worst z of the direct light of a cloth over all directions, for each engine; the walks go through densities that
/// count `factor` times.
fn direct_z(what: &str, stated: &CellCloth, factor: f64, seed: u64) -> [f64; 2] {
    let walks = 250_000;
    let expected = ANGLES.map(|angles| straight(stated, from_degrees(angles)));
    assert!(expected.iter().all(|share| *share > 1e-3), "{what}: hardly any light comes through: {expected:?}");
    let mut cloth = stated.clone();
    cloth.cells.iter_mut().for_each(|cell| cell.0 *= factor);
    // Black fibers: direct light does not depend on what becomes of a walk that has met one.
    cloth.base.absorption = "1000".into();
    engines().map(|(name, engine)| {
        let tally = run_cells(name, engine, &cloth, seed, walks);
        let z: Vec<f64> =
            (0..).zip(expected).map(|(start, share)| binomial_z(tally.direct(start), walks, share)).collect();
        println!("{name}, {what}, density × {factor}: z = {z:.1?}");
        largest(&z)
    })
}

#[test]
fn straight_rays_have_their_closed_form_in_columns() {
    let (_, checkerboard) = grids().swap_remove(0);
    let exact = 0.5 * (1.0 + (-surface_of(&checkerboard.base) * FRAC_PI_2).exp());
    assert!((straight(&checkerboard, DVec3::Z) - exact).abs() < 1e-4);
}

#[test]
fn direct_light_goes_straight_through_cells() {
    for (i, (what, cloth)) in grids().into_iter().enumerate() {
        let z = direct_z(what, &cloth, 1.0, 600 + i as u64);
        assert!(largest(&z) < GATE, "{what}: {z:.1?}");
    }
}

#[test]
fn direct_light_shows_densities_that_are_off() {
    for (i, ((what, cloth), factor)) in grids().into_iter().zip([1.02, 1.02, 1.0215, 1.024, 1.028]).enumerate() {
        // Each stands at 8 to 10 σ in its worst direction.
        let z = direct_z(what, &cloth, factor, 700 + i as u64);
        assert!(z.iter().all(|z| *z > GATE), "{what}: {z:.1?}");
    }
}

#[test]
fn cells_return_all_light_whatever_is_empty() {
    let empty_faces = CellCloth::new(Cloth::isotropic(3.0), [2, 2, 7], [0.5, 0.5], |[x, _, z]| {
        f64::from(u8::from(z == 3)) * (0.1 + f64::from(x))
    });
    let mut cloths: Vec<CellCloth> = grids().into_iter().map(|(_, cloth)| cloth).collect();
    cloths.extend([empty_faces, layers(&Cloth::isotropic(1.5), 1.0)]);
    for mut cloth in cloths {
        cloth.base.incident = "[[5, 5], [50, 20], [89, 45], [89.9, -70]]".into();
        cloth.base.sides = "[\"front\", \"back\"]".into();
        for (name, engine) in engines() {
            let tally = run_cells(name, engine, &cloth, 61, 20_000);
            for start in 0..tally.starts() {
                let out = tally.reflection(start).iter().chain(tally.transmission(start)).sum::<u64>();
                assert_eq!(out + tally.direct(start), 20_000, "{name}, {:?}, start {start}", cloth.counts);
                assert_eq!(tally.lost(start), 0, "{name}, {:?}, start {start}", cloth.counts);
            }
        }
    }
}

#[test]
fn the_tally_does_not_depend_on_where_the_cells_are_kept() {
    let (_, cloth) = grids().swap_remove(3);
    let (tables, goniometer) = cloth.prepare();
    let plan = WalkPlan::new(62, 20_000);
    let tally =
        |settings: Settings| gpu().run_with(settings, &tables, &goniometer, &plan, &mut |_| {}).expect("it runs").0;
    let whole = tally(Settings::default());
    for texture in [true, false] {
        let settings = Settings {
            cells_in_texture: Some(texture),
            table_in_texture: Some(!texture),
            lanes: Some(256),
            budget: Some(97),
            walks_per_segment: Some(7000),
            ..Settings::default()
        };
        assert_eq!(tally(settings), whole);
    }
}

#[test]
fn cells_that_make_no_table_are_refused() {
    let scene = Cloth::isotropic(1.0).scene();
    let fine = cut(&Cloth::isotropic(1.0), 1.0, false).specific_length();
    assert!(SamplingTables::new(&scene, &fine).is_ok());
    let of_sheet = prepare(&scene).expect("the cloth is fine");
    assert!(of_sheet.tables.cells.is_none(), "a sheet pays for no cells");
    let mut wrong = vec![fine.clone(); 8];
    wrong[0].values.pop();
    wrong[1].values[7].list = 1;
    wrong[2].values[3].surface = f64::NAN;
    wrong[3].values[3].surface = -1.0;
    wrong[4].values.iter_mut().for_each(|cell| cell.surface = 0.0);
    wrong[5].lists[0].clear();
    wrong[6].cells.period.x = 0.0;
    wrong[7].cells.counts = [1 << 12, 1 << 12, 1];
    for (i, wrong) in wrong.iter().enumerate() {
        let error = SamplingTables::new(&scene, wrong).expect_err("it cannot be used");
        assert!(matches!(error, Error::Input(_)), "{i}: {error}");
    }
}
