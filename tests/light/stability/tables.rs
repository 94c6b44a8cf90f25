//! Grids of directions and of cells from one entry to very many, cones from narrow to all directions.

use super::light::{cone_sine, from_degrees};
use super::table::{
    Found, METHODS, NULL, TABULATED, beyond, direct, direct_share, fails, refused, right, section, setup, track, walks,
    within,
};
use crate::common::cells::CellCloth;
use crate::common::counted::Counted;
use crate::common::{Cloth, ISOTROPIC, SplitMix, aligned, engines};
use fiberwalk::cloth::Primitive;
use fiberwalk::concentric::Patch;
use fiberwalk::distribution::{DirectionGrid, Effort, SpecificLength, direction_of};
use fiberwalk::goniometer::{Goniometer, Tally};
use fiberwalk::scene::Structure;
use fiberwalk::tables::SamplingTables;
use fiberwalk::walk::WalkPlan;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_4, PI};

/// The specific length of a sheet on a grid of n × n directions, as no file may ask for.
fn on_grid(cloth: &Cloth, n: u32) -> (SamplingTables, Goniometer) {
    let scene = cloth.scene();
    let Structure::Sheet(sheet) = &scene.structure else { panic!("it is a sheet") };
    let radius = |kind: usize| scene.fibers[kind].radius;
    let mut length = SpecificLength::of_sheet(sheet, DirectionGrid { n }, radius);
    length.place(scene.model.placement, radius).expect("there is room");
    (SamplingTables::new(&scene, &length).expect("it makes tables"), setup(cloth).1)
}

#[test]
fn from_one_direction_to_very_many() {
    section("Grids of directions");
    let cloth = Cloth::isotropic(0.5).lit_from("[[60, 75]]");
    for (n, seed) in [1, 4, 128].into_iter().zip((6000..).step_by(10)) {
        for (method, seed) in METHODS.iter().zip(seed..) {
            let v: f64 = if method.separate() { PI * 1e-4 * 0.5 / (0.02 * FRAC_PI_4) } else { 0.0 };
            let expected = (-1.0 / (1.0 - v)).exp();
            let setup = on_grid(&method.of(&cloth), n);
            let [gpu, cpu] = engines().map(|(name, engine)| direct_share(name, engine, &setup, seed, expected));
            right(&format!("isotropic fibers of {n}² directions"), method.name, expected, Some(gpu), Some(cpu));
        }
    }
    // The look-up itself, and four points for all directions.
    let mut random = SplitMix(6060);
    let rays: Vec<DVec3> = (0..2000).map(|_| random.direction()).collect();
    let largest = |relative: &dyn Fn(DVec3) -> f64| {
        rays.iter().map(|m| (relative(*m) / FRAC_PI_4 - 1.0).abs()).fold(0.0, f64::max)
    };
    for n in [1, 2, 4, 8] {
        let (tables, _) = on_grid(&TABULATED.of(&cloth), n);
        let visible = tables.visible.expect("it has a table");
        let regime = format!("isotropic fibers of {n}² directions: H, relative");
        within(&regime, TABULATED.name, [None, Some(largest(&|m| visible.look_up(0, m)))], 5e-4);
    }
    let gauss = [-1.0, 1.0].map(|sign| 0.5 + sign * (1.0f64 / 12.0).sqrt());
    let points = gauss.map(|a| gauss.map(|b| direction_of(Patch::cell(1, 0, 0).at(DVec2::new(a, b))))).concat();
    let mean = |m: DVec3| points.iter().map(|p| m.cross(*p).length()).sum::<f64>() / 4.0;
    beyond("isotropic fibers of 1² directions: H, relative", "four points", largest(&mean), 5e-4);
    // The middles of 16 directions.
    let cloth = Cloth::isotropic(1.0).lit_from("[[0, 0]]");
    let (tables, goniometer) = on_grid(&cloth, 4);
    let n = walks(400_000);
    for (name, engine) in engines() {
        let plan = WalkPlan { jitter: false, ..WalkPlan::new(6050, n) };
        let tally = engine.run(&tables, &goniometer, &plan, &mut |_| {}).expect("it runs");
        let weak = format!("without jitter ({name})");
        fails(
            "isotropic fibers of 4² directions, light from 0°",
            &weak,
            (-1f64).exp(),
            Found::share(tally.direct(0), n, (-1f64).exp()),
        );
    }
}

#[test]
fn from_narrow_to_wide_cones() {
    section("Cones");
    let (m, axis) = (from_degrees([50.0, 100.0]), DVec3::new(0.48, -0.6, 0.64));
    for (spread, seed) in [0.5, 20.0, 90.0].into_iter().zip((6100..).step_by(10)) {
        let depth = 0.02 * 40.0 * cone_sine(axis, spread, m, |p| p) / m.z;
        let orientation = format!("{}\nspread_deg = {spread}", aligned(axis.to_array()));
        let cloth = Cloth { directions: 16384, ..Cloth::new(40.0, &orientation) }.lit_from("[[50, 100]]");
        direct(&format!("a bundle spread by {spread}°"), &cloth, depth, PI * 40e-4, seed, &METHODS[..2]);
    }
    // One counted piece, gathered from a cone.
    let piece = |direction: DVec3| Primitive {
        centre: DVec3::new(0.5, 0.5, -0.5),
        direction: direction.normalize(),
        length: 0.4,
        radius: 0.01,
        kind: 0,
        thread: 0,
    };
    // Two directions: a single one would stay exact.
    let other = DVec3::new(0.48, -0.59, 0.65);
    let pieces = [piece(axis), piece(other)];
    for cone in [0.5, 2.0, 20.0, 90.0] {
        let counted = Counted { directions: 16384, cone_deg: cone, ..Counted::pieces(&pieces, 1.0, 1.0) };
        let length = counted.count(Effort::Realizations(2));
        let found = length.visible_area(0, m, |_| 0.01) / (2.0 * 0.01 * 0.8);
        let of = |axis: DVec3| cone_sine(axis.normalize(), cone, m, |p| p);
        let truth = (of(axis) + of(other)) / 2.0;
        let regime = format!("two pieces gathered from a cone of {cone}°: H, relative");
        within(&regime, "distribution calculator", [None, Some(found / truth - 1.0)], 5e-3);
        let total = length.total(0, |_| 0.01);
        within(&regime.replace("H", "length"), "distribution calculator", [None, Some(total / 0.8 - 1.0)], 1e-6);
        if cone > 10.0 {
            let own = (m.cross(axis).length() + m.cross(other.normalize()).length()) / 2.0;
            beyond(&regime, "the directions themselves", (own / truth - 1.0).abs(), 1e-3);
        }
    }
}

/// Cells with the fibers of a cloth, tracked by a method.
fn in_cells(
    method: usize,
    cloth: &Cloth,
    counts: [u32; 3],
    share: impl Fn([u32; 3]) -> f64,
) -> (SamplingTables, Goniometer) {
    let (base, v) = (METHODS[method].of(cloth), PI * (cloth.radius_um * 1e-3).powi(2) * cloth.fibers[0].0);
    let mut cells = CellCloth::new(base, counts, [1.0, 1.0], &share);
    if METHODS[method].separate() {
        cells.factors = cells.grid().places().map(|place| 1.0 / (1.0 - v * share(place))).collect();
    }
    cells.prepare()
}

#[test]
fn from_one_cell_to_very_many() {
    section("Grids of cells");
    let cloth = Cloth { radius_um: 1.0, ..Cloth::new(0.5 / (0.002 * FRAC_PI_4), ISOTROPIC) }.lit_from("[[60, 75]]");
    let v = PI * 1e-6 * cloth.fibers[0].0;
    for (n, seed) in [2, 64].into_iter().zip((6200..).step_by(20)) {
        for (i, method) in METHODS.iter().enumerate() {
            // Denser below: the depth of all layers together is 1, but that of separate fibers depends on each.
            let share = |[.., z]: [u32; 3]| 2.0 * (f64::from(n - z) - 0.5) / f64::from(n);
            let depth = |z: u32| share([0, 0, z]) / if method.separate() { 1.0 - v * share([0, 0, z]) } else { 1.0 };
            let expected = (-(0..n).map(depth).sum::<f64>() / f64::from(n)).exp();
            let setup = in_cells(i, &cloth, [n; 3], share);
            let [gpu, cpu] =
                engines().map(|(name, engine)| direct_share(name, engine, &setup, seed + i as u64, expected));
            right(&format!("{n}³ cells, denser below"), method.name, expected, Some(gpu), Some(cpu));
        }
    }
    // Steps from face to face that take the cell from the place alone: a place on a face is in the cell that was left.
    let wi = from_degrees([60.0, 75.0]).as_vec3();
    let mut stuck = 0;
    for start in 0..10_000 {
        let (mut z, mut steps) = ((f64::from(start) / 10_000.0) as f32 * 64.0, 0);
        while z > 0.0 && steps < 200 {
            let face = z.floor();
            z -= wi.z * ((z - face) / wi.z);
            steps += 1;
        }
        stuck += u32::from(steps == 200);
    }
    beyond("64³ cells: rays that never leave", "cells from rounded places alone", f64::from(stuck) / 1e4, 1e-4);
}

#[test]
fn empty_cells_and_a_single_primitive() {
    section("Empty cells, and a cell with a single piece");
    // One cell of 16³ holds all fibers, with a depth of 5 through it: the light of one column of 256 is darkened.
    let cloth = Cloth { radius_um: 0.1, ..Cloth::new(80.0 / (2e-4 * FRAC_PI_4), ISOTROPIC) }.lit_from("[[0, 0]]");
    let share = |place: [u32; 3]| if place == [5, 0, 15] { 1.0 } else { 0.0 };
    let v = PI * 1e-8 * cloth.fibers[0].0;
    let n = walks(200_000);
    for (i, method) in METHODS.iter().enumerate() {
        let depth = 5.0 / if method.separate() { 1.0 - v } else { 1.0 };
        let expected = 1.0 - (1.0 - f64::exp(-depth)) / 256.0;
        let setup = in_cells(i, &cloth, [16; 3], share);
        let [gpu, cpu] = engines().map(|(name, engine)| {
            let tally: Tally = track(name, engine, &setup, 6300 + i as u64, n);
            let touched = Found::share(n - tally.direct(0), n, 1.0 - expected);
            Found { value: 1.0 - touched.value, z: -touched.z }
        });
        right("one of 4096 cells holds all fibers", method.name, expected, Some(gpu), Some(cpu));
    }
    let mean = (-5.0 / 256.0f64).exp();
    let missing = Found::share(n - (mean * n as f64) as u64, n, 1.0 / 256.0);
    let exact = 1.0 - (1.0 - f64::exp(-5.0)) / 256.0;
    fails("one of 4096 cells holds all fibers", "the mean of the column", exact, Found { value: mean, ..missing });

    // A single piece in one of 8 cells.
    let direction = DVec3::new(0.6, 0.0, 0.8);
    let piece =
        Primitive { centre: DVec3::new(0.2, 0.7, -0.6), direction, length: 0.05, radius: 0.01, kind: 0, thread: 0 };
    let pieces = [piece];
    let mut counted = Counted::pieces(&pieces, 1.0, 1.0);
    counted.cells.counts = [2; 3];
    let length = counted.count(Effort::Realizations(2));
    let filled = length.values.iter().filter(|cell| cell.surface > 0.0).count();
    assert_eq!((filled, length.lists.len(), length.lists[0].len()), (1, 1, 1));
    // L = 0.05/0.125 over a height of ½, seen at right angles to y: fibers a thousand times as thick, to be seen at all.
    let base = Cloth { radius_um: 500.0, ..Cloth::new(0.4, &aligned([0.6, 0.0, 0.8])) }.lit_from("[[0, 0]]");
    let depth = 2.0 * 0.5 * 0.4 * 0.6 * 0.5;
    let expected = 0.75 + 0.25 * f64::exp(-depth);
    for (method, seed) in [NULL, METHODS[1]].iter().zip(6320..) {
        let scene = method.of(&base).scene();
        let mut scaled = length.clone();
        scaled.values.iter_mut().for_each(|cell| cell.surface *= 50.0);
        let tables = SamplingTables::new(&scene, &scaled).expect("it makes tables");
        let setup = (tables, setup(&base).1);
        let [gpu, cpu] = engines().map(|(name, engine)| direct_share(name, engine, &setup, seed, expected));
        right("a single piece in one of 8 cells", method.name, expected, Some(gpu), Some(cpu));
    }
    // Nothing at all.
    let empty = CellCloth::new(base.clone(), [4; 3], [1.0, 1.0], |_| 0.0);
    let message =
        SamplingTables::new(&empty.base.scene(), &empty.specific_length()).expect_err("it is empty").to_string();
    refused("64 empty cells", "all", &message, "the cells hold no fiber at all");
}
