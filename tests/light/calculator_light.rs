//! Light through counted fibers: a cell with everything in it is the sheet of the same fibers, both engines agree on woven
//! cloths, and light takes the same way back.

use crate::common::cells::{CellCloth, surface_of};
use crate::common::counted::{Counted, scattered_pieces};
use crate::common::sheet::disc_cell;
use crate::common::stats::{GATE, chi2_z, mean_error, two_tally_z};
use crate::common::{Cloth as Sheet, SplitMix, aligned, engines, gpu};
use fiberwalk::bsdf::{Component, reciprocity};
use fiberwalk::cloth::Primitive;
use fiberwalk::concentric::Patch;
use fiberwalk::distribution::{Bundle, Effort, SpecificLength};
use fiberwalk::goniometer::Tally;
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::reference::Reference;
use fiberwalk::scene::{Scene, Side, Source};
use fiberwalk::tables::SamplingTables;
use fiberwalk::walk::{Engine, WalkPlan};
use glam::DVec3;

/// The fibers of the sheets: radius 10 µm in 1 mm, as [`Sheet::new`] has them.
const RADIUS: f64 = 0.01;

/// Measure counted fibers in the place of a sheet's own.
fn light(engine: &dyn Engine, sheet: &Sheet, f: &SpecificLength, plan: &WalkPlan) -> Tally {
    let scene = sheet.scene();
    let tables = SamplingTables::new(&scene, f).unwrap_or_else(|error| panic!("{error}"));
    let Prepared { goniometer, .. } = prepare(&scene).expect("the sheet is fine");
    let tally = engine.run(&tables, &goniometer, plan, &mut |_| {}).unwrap_or_else(|error| panic!("{error}"));
    tally.check(plan.walks_per_incident).unwrap_or_else(|error| panic!("{error}"));
    tally
}

/// Pieces of 0.05 mm at random places in an element of 1 mm, as long in all as L = `length_density` says.
fn pieces(length_density: f64, seed: u64, draw: impl FnMut(&mut SplitMix) -> DVec3) -> Vec<Primitive> {
    scattered_pieces(length_density, RADIUS, [1.0, 1.0], 0.05, &mut SplitMix(seed), draw)
}

#[test]
fn aligned_fibers_in_one_cell_are_the_aligned_sheet() {
    let axis = [0.48, 0.6, 0.64];
    let sheet = |density| Sheet::new(density, &aligned(axis)).lit_from("[[0, 0], [50, 30], [70, 200]]");
    let laid =
        pieces(150.0, 81, |random| DVec3::from(axis).normalize() * if random.uniform() < 0.5 { 1.0 } else { -1.0 });
    // A cone does not blur what has one direction.
    let counted = Counted { cone_deg: 5.0, ..Counted::pieces(&laid, 1.0, 1.0) };
    let f = counted.count(Effort::Realizations(2));
    assert_eq!((f.lists.len(), f.lists[0].len()), (1, 1));
    assert!(f.spread_error < 1e-12, "{}", f.spread_error);
    assert_eq!(f.lists[0][0].patch.extent, glam::DVec2::ZERO);
    assert!((f.values[0].surface / surface_of(&sheet(150.0)) - 1.0).abs() < 1e-6);
    for (name, engine) in engines() {
        let plan = WalkPlan::new(82, 60_000);
        let z = |density| {
            let stated = crate::common::run(name, engine, &sheet(density), &WalkPlan::new(83, 60_000));
            two_tally_z(&light(engine, &sheet(150.0), &f, &plan), &stated)
        };
        let (found, bent) = (z(150.0), z(161.0));
        println!("{name}: z = {found:.1}, 7 % more fiber {bent:.1}");
        assert!(found.abs() < GATE && bent > 2.0 * GATE, "{name}: {found}, {bent}");
    }
}

#[test]
fn rays_along_aligned_fibers_pass() {
    let upright = pieces(400.0, 84, |_| DVec3::Z);
    let f = Counted::pieces(&upright, 1.0, 1.0).count(Effort::Realizations(2));
    let slanted = pieces(400.0, 85, |_| DVec3::new(0.6, 0.0, 0.8));
    let g = Counted::pieces(&slanted, 1.0, 1.0).count(Effort::Realizations(2));
    for (name, engine) in engines() {
        for (f, incident, along) in
            [(&f, "[[0, 0]]", true), (&g, "[[36.86989764584402, 0]]", true), (&g, "[[0, 0]]", false)]
        {
            let sheet = Sheet::new(1.0, crate::common::PLANAR).lit_from(incident);
            let tally = light(engine, &sheet, f, &WalkPlan::new(86, 10_000));
            let share = tally.direct(0) as f64 / 1e4;
            // Rays are in f32, so a direction is off by 10⁻⁷ and meets 8·10⁻⁷ fibers.
            assert!(if along { share > 0.999 } else { share < 0.05 }, "{name}, {incident}: {share}");
        }
    }
}

#[test]
fn many_directions_in_one_cell_are_the_sheet_with_their_distribution() {
    // Helices of all radii and azimuths about an axis, of a tangent up to 0.7.
    let draw = |random: &mut SplitMix| {
        let (tangent, phi) = (0.7 * random.uniform().sqrt(), std::f64::consts::TAU * random.uniform());
        DVec3::new(0.3 + tangent * phi.cos(), 1.0, tangent * phi.sin()).normalize()
    };
    let laid = pieces(120.0, 87, draw);
    let counted = Counted::pieces(&laid, 1.0, 1.0);
    let f = counted.count(Effort::Realizations(2));
    // Sort the pieces into the cells of the grid by the map's four sectors.
    let sheet = |turn: f64| {
        let n = 32;
        let mut densities = vec![0.0; (n * n) as usize];
        for piece in &laid {
            let p = glam::DQuat::from_rotation_z(turn) * piece.direction;
            let p = if p.z < 0.0 { -p } else { p };
            let scale = 1.0 / (1.0 + p.z).sqrt();
            densities[disc_cell(p.x * scale, p.y * scale, n as usize)] += piece.length;
        }
        let base = Sheet::new(120.0, crate::common::PLANAR).lit_from("[[0, 0], [50, 30], [70, 100]]");
        let bundle = |(index, density): (usize, &f64)| {
            let (column, row) = (index as u32 % n, index as u32 / n);
            Bundle { kind: 0, patch: Patch::cell(n, column, row), length_density: *density }
        };
        let list = densities.iter().enumerate().filter(|(_, density)| **density > 0.0).map(bundle).collect();
        CellCloth { lists: vec![list], ..CellCloth::new(base, [1; 3], [1.0; 2], |_| 1.0) }
    };
    assert_eq!(f.lists[0].len(), sheet(0.0).lists[0].len());
    for (name, engine) in engines() {
        let z = |turn: f64| {
            let stated = sheet(turn).run(engine, &WalkPlan::new(88, 60_000));
            two_tally_z(&light(engine, &sheet(0.0).base, &f, &WalkPlan::new(89, 60_000)), &stated)
        };
        let (found, bent) = (z(0.0), z(3.5f64.to_radians()));
        println!("{name}: z = {found:.1}, turned by 3.5° {bent:.1}");
        assert!(found.abs() < GATE && bent > 2.0 * GATE, "{name}: {found}, {bent}");
    }
}

/// A preset with few directions and more lines of its model. Walks take no rays through fibers, so none are made.
fn coarse(name: &str, model: &str, measure: &str) -> (Scene, Prepared) {
    let source = Source::find(name).expect("it is a preset");
    let model = format!("{model}\ndirections = 256\ndirect = \"walks\"\nfirst_hit = \"medium\"");
    let text = format!("{}\n[model]\n{model}\n[measure]\n{measure}\n", source.text);
    let scene = Scene::parse(&Source { text, ..source }).unwrap_or_else(|error| panic!("{error}"));
    let prepared = prepare(&scene).unwrap_or_else(|error| panic!("{error}"));
    (scene, prepared)
}

fn run(engine: &dyn Engine, tables: &SamplingTables, prepared: &Prepared, plan: &WalkPlan) -> Tally {
    let tally = engine.run(tables, &prepared.goniometer, plan, &mut |_| {}).unwrap_or_else(|error| panic!("{error}"));
    tally.check(plan.walks_per_incident).unwrap_or_else(|error| panic!("{error}"));
    tally
}

#[test]
fn both_engines_agree_on_woven_cloths() {
    for (name, cells, more) in
        [("voile", "[16, 16, 6]", 1.3), ("denim", "[16, 24, 6]", 1.1), ("charmeuse", "[10, 20, 5]", 1.16)]
    {
        let (scene, prepared) = coarse(name, &format!("cells = {cells}"), "incident = [[20, 10], [60, 130]]\nexit = 8");
        let bent = {
            let mut f = prepared.specific_length.clone();
            f.values.iter_mut().for_each(|cell| cell.surface *= more);
            SamplingTables::new(&scene, &f).expect("it is fine")
        };
        let on_cpu = run(&Reference, &prepared.tables, &prepared, &WalkPlan::new(91, 60_000));
        let z = |tables| two_tally_z(&run(gpu(), tables, &prepared, &WalkPlan::new(90, 120_000)), &on_cpu);
        let (found, bent) = (z(&prepared.tables), z(&bent));
        println!("{name}: z = {found:.1}, more fiber {bent:.1}");
        assert!(found.abs() < GATE && bent > 2.0 * GATE, "{name}: {found}, {bent}");
    }
}

#[test]
fn light_through_a_woven_cloth_takes_the_same_way_back() {
    // Denim has two faces; without its dye all light comes out and is counted.
    let (mut scene, mut prepared) = coarse(
        "denim",
        "cells = [12, 16, 5]\nplacement = \"at-hit\"",
        "incident = 4\nexit = 8\nsides = [\"front\", \"back\"]",
    );
    scene.channels.absorption.iter_mut().for_each(|channels| channels.fill(0.0));
    prepared.tables = SamplingTables::new(&scene, &prepared.specific_length).expect("it is fine");
    let tally = run(gpu(), &prepared.tables, &prepared, &WalkPlan::new(92, 60_000));
    let residual = |tally: &Tally, component, side| {
        let residual = reciprocity(tally, &prepared.goniometer, component, side, 0).expect("both sides are lit");
        assert!(residual.pairs > 60, "{residual:?}");
        chi2_z(residual.chi_square, residual.pairs as f64)
    };
    let all = |tally: &Tally| {
        let of = |component, side| residual(tally, component, side);
        [
            of(Component::Reflection, Side::Front),
            of(Component::Reflection, Side::Back),
            of(Component::Transmission, Side::Front),
        ]
    };
    let z = all(&tally);
    // Fibers of 4 radii, through whose bases light comes out, are not reciprocal.
    let mut short = prepared.tables.clone();
    short.half_length = 2.0;
    short.kinds.iter_mut().for_each(|kind| kind.ior = 1.2);
    let bent = all(&run(gpu(), &short, &prepared, &WalkPlan::new(93, 10_000)));
    // The two faces are not alike.
    let totals = [0, 16].map(|start| {
        let count: u64 = (start..start + 16).map(|start| tally.reflection(start).iter().sum::<u64>()).sum();
        mean_error(count as f64, count as f64, 16.0 * 60_000.0)
    });
    println!("R front, R back, T: z = {z:.1?}, bent {bent:.1?}; reflected {totals:.4?}");
    assert!(z.iter().all(|z| z.abs() < GATE), "{z:?}");
    assert!(bent.iter().any(|z| *z > 2.0 * GATE), "{bent:?}");
}
