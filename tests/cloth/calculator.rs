//! The distribution calculator: length is conserved, symmetric cloths have symmetric tables, directions have their closed
//! form, and the tables do not depend on how the work was done.

use crate::common::SplitMix;
use crate::common::counted::{Counted, realization, vectors_z};
use crate::common::stats::GATE;
use crate::common::woven::{Woven, Yarn};
use fiberwalk::cloth::{Cloth, Primitive, System};
use fiberwalk::distribution::{Effort, SpecificLength};
use fiberwalk::error::Result;
use fiberwalk::measure::prepare;
use fiberwalk::scene::{Model, Scene, Source};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

const PLAIN: &[&str] = &[".X", "X."];

/// A twill of a twisted blend and of a filament yarn.
fn blend() -> Cloth {
    let blend = Yarn { fiber: "{ thin = 3, thick = 1 }", ..Yarn::new(24, 320.0, 220.0, "ply_twist_per_m = 700") };
    let yarns = vec![blend, Yarn::new(20, 300.0, 150.0, "")];
    Woven { yarns, weft: vec![1], ends_per_cm: 22.0, ..Woven::of(&["XX.", "X.X", ".XX"], yarn(), 20.0) }.cloth()
}

fn yarn() -> Yarn {
    Yarn::new(20, 300.0, 200.0, "ply_twist_per_m = 600")
}

// ---- Length ----

#[test]
fn the_length_of_each_kind_is_that_of_the_pieces_whatever_the_cells() {
    let cloth = blend();
    let mut stated = vec![0.0; cloth.kinds().len()];
    for number in 0..4 {
        cloth.realize(5, number).iter().for_each(|piece| stated[piece.kind] += piece.length / 4.0);
    }
    assert!(stated.iter().all(|length| *length > 10.0), "{stated:?}");
    for counts in [[1, 1, 1], [7, 5, 3], [40, 30, 12], [256, 1, 2], [3, 256, 1]] {
        for list_width in [DVec3::ZERO, DVec3::splat(0.12)] {
            let counted = Counted { list_width, cone_deg: 3.0, ..Counted::of(&cloth, counts) };
            let lengths = counted.lengths(&counted.count(Effort::Realizations(4)));
            for (kind, stated) in stated.iter().enumerate() {
                let sum: f64 = lengths.iter().map(|lengths| lengths[kind]).sum();
                // A unit of the count is 2⁻³² mm² of R·length.
                assert!((sum / stated - 1.0).abs() < 1e-7, "{counts:?}, kind {kind}: {sum} and {stated} mm");
            }
        }
    }
}

/// Length by cell from points along the pieces, one at random in each of 64 parts, and the variance of that: where a piece
/// passes a face, a part of length s is given to one side or the other, with a variance of s²/6.
fn sampled(counted: &Counted, pieces: &[Primitive]) -> Vec<(f64, f64)> {
    let (grid, edges) = (counted.cells, counted.cells.edges());
    let mut random = SplitMix(61);
    let mut lengths = vec![(0.0, 0.0); grid.len()];
    for piece in pieces {
        let part = piece.length / 64.0;
        let mut last: Option<usize> = None;
        for step in 0..64 {
            let along = (f64::from(step) + random.uniform()) * part - piece.length / 2.0;
            let point = piece.centre + piece.direction * along + DVec3::Z * grid.thickness;
            let place = [0, 1, 2].map(|axis| {
                let at = (point[axis] / edges[axis]).floor() as i64;
                at.rem_euclid(i64::from(grid.counts[axis])) as u32
            });
            let cell = grid.index(place);
            lengths[cell].0 += part;
            if let Some(last) = last.filter(|last| *last != cell) {
                // One part, or two, hold the face.
                lengths[cell].1 += part * part / 6.0;
                lengths[last].1 += part * part / 6.0;
            }
            last = Some(cell);
        }
    }
    lengths
}

/// z of the lengths of cells against sampled ones: mean and spread of z² over the cells with many crossings.
fn cells_z(lengths: &[f64], sampled: &[(f64, f64)]) -> f64 {
    let z = |(length, (value, variance)): (&f64, &(f64, f64))| {
        (*variance > 0.0).then(|| (length - value) / variance.sqrt())
    };
    let squares: Vec<f64> = lengths.iter().zip(sampled).filter_map(z).map(|z| z * z).collect();
    let n = squares.len() as f64;
    assert!(n > 300.0, "{n} cells");
    // What one cell gains another loses, so the squares of two cells go together: twice the variance of independent ones.
    (squares.iter().sum::<f64>() / n - 1.0) / (4.0 / n).sqrt()
}

#[test]
fn pieces_are_cut_at_the_faces_of_cells() {
    let cloth = blend();
    let counted = Counted::of(&cloth, [11, 13, 5]);
    let pieces = cloth.realize(5, 0);
    let one = Counted { realize: Box::new(|_| pieces.clone()), ..Counted::of(&cloth, [11, 13, 5]) };
    let f = one.count(Effort::Realizations(2));
    let lengths: Vec<f64> = one.lengths(&f).iter().map(|kinds| kinds.iter().sum()).collect();
    let sampled = sampled(&counted, &pieces);
    let total: f64 = pieces.iter().map(|piece| piece.length).sum();
    assert!((sampled.iter().map(|(length, _)| length).sum::<f64>() / total - 1.0).abs() < 1e-9);
    let clipped = cells_z(&lengths, &sampled);
    // Give each piece wholly to the cell of its middle.
    let edges = counted.cells.edges();
    let mut whole = vec![0.0; counted.cells.len()];
    for piece in &pieces {
        let at = (piece.centre + DVec3::Z * counted.cells.thickness) / edges;
        whole[counted.cells.index([at.x as u32, at.y as u32, at.z as u32])] += piece.length;
    }
    let misplaced = cells_z(&whole, &sampled);
    let moved = whole.iter().zip(&lengths).map(|(a, b)| (a - b).abs()).sum::<f64>() / 2.0 / total;
    println!(
        "clipped: z = {clipped:.1}; by the middle: z = {misplaced:.1}, {:.1} % of the length moves",
        100.0 * moved
    );
    assert!(clipped.abs() < GATE, "{clipped}");
    assert!(misplaced > 2.0 * GATE && moved > 0.01, "{misplaced}, {moved}");
}

// ---- Symmetry ----

/// Counts of 24 batches of 4 realizations as vectors of one order: lengths by cell, then by blocks of 4 × 4 × 2 cells and
/// direction; `place` and `turn` bring cells and directions to those of the cloth that it is compared with.
fn batches(
    cloth: &Cloth,
    counts: [u32; 3],
    first: u64,
    place: impl Fn([u32; 3]) -> [u32; 3],
    turn: impl Fn(u32, u32, u32) -> [u32; 2],
) -> [Vec<Vec<f64>>; 2] {
    let mut found = [Vec::new(), Vec::new()];
    for batch in 0..24 {
        let realize = move |number| cloth.realize(5, first + 4 * batch + number);
        let counted = Counted { directions: 256, realize: Box::new(realize), ..Counted::of(cloth, counts) };
        let f = counted.count(Effort::Realizations(4));
        let edges = counts.map(|count| count as usize);
        let across = edges[0].max(edges[1]);
        let index = |[x, y, z]: [u32; 3]| (z as usize * across + y as usize) * across + x as usize;
        let mut densities = vec![0.0; across * across * edges[2]];
        for (lengths, at) in counted.lengths(&f).iter().zip(f.cells.places()) {
            densities[index(place(at))] = lengths.iter().sum();
        }
        let mut directions = vec![0.0; 8 * 8 * 4 * 256];
        let block = |at: [u32; 3]| {
            let [x, y, z] = place(at);
            ((z / 2 * 8 + y / 4) * 8 + x / 4) as usize
        };
        for ((block, column, row), length) in counted.directions(&f, block) {
            let [column, row] = turn(column, row, f.grid.n - 1);
            directions[block * 256 + (row * f.grid.n + column) as usize] += length;
        }
        found[0].push(densities);
        found[1].push(directions);
    }
    found
}

fn symmetry_z(a: &[Vec<Vec<f64>>; 2], b: &[Vec<Vec<f64>>; 2]) -> [f64; 2] {
    [0, 1].map(|part| vectors_z(&a[part], &b[part]))
}

#[test]
fn a_turned_cloth_has_turned_tables() {
    // By a quarter counter-clockwise: (x, y) becomes (−y, x). Ends become picks, and the draft its complement.
    let twill = |width_um: f64| {
        let yarns = vec![yarn(), Yarn::new(16, width_um, 160.0, "ply_twist_per_m = -300")];
        Woven {
            yarns,
            weft: vec![1],
            ends_per_cm: 24.0,
            warp_crimp_share: 0.3,
            ..Woven::of(&["XX.", "X.X", ".XX"], yarn(), 20.0)
        }
    };
    let turned = |woven: &Woven| {
        let over = |end: usize, pick: usize| woven.draft[2 - pick].as_bytes()[end] == b'X';
        // The new end i is the old pick 2 − i, the new pick j the old end j.
        let mark = |end: usize, pick: usize| if over(pick, 2 - end) { '.' } else { 'X' };
        Woven {
            draft: (0..3).rev().map(|pick| (0..3).map(|end| mark(end, pick)).collect()).collect(),
            warp: woven.weft.clone(),
            weft: woven.warp.clone(),
            ends_per_cm: woven.picks_per_cm,
            picks_per_cm: woven.ends_per_cm,
            warp_crimp_share: 1.0 - woven.warp_crimp_share,
            ..woven.clone()
        }
    };
    let (nx, ny) = (24, 32);
    let cloth = twill(260.0).cloth();
    let of =
        |woven: &Woven| batches(&turned(woven).cloth(), [ny, nx, 8], 1000, |at| at, |column, row, _| [column, row]);
    let place = |[x, y, z]: [u32; 3]| [ny - 1 - y, x, z];
    let a = batches(&cloth, [nx, ny, 8], 0, place, |column, row, last| [last - row, column]);
    let z = symmetry_z(&a, &of(&twill(260.0)));
    // A weft that is wider by 15 %, and tables that were not turned.
    let bent = symmetry_z(&a, &of(&twill(300.0)));
    let still = batches(&cloth, [nx, ny, 8], 0, place, |column, row, _| [column, row]);
    let still = symmetry_z(&still, &of(&twill(260.0)));
    println!("densities and directions: z = {z:.1?}, bent {bent:.1?}, not turned {still:.1?}");
    assert!(z.iter().all(|z| z.abs() < GATE), "{z:?}");
    assert!(bent.iter().all(|z| *z > 2.0 * GATE) && still[1] > 2.0 * GATE, "{bent:?}, {still:?}");
}

#[test]
fn s_yarns_are_the_mirror_image_of_z_yarns() {
    // In a mirror across x: (x, y) becomes (−x, y), the draft's columns are reversed, and a right-handed helix is a left-handed one.
    let woven =
        |lines: &'static str, draft: &[&str]| Woven::of(draft, Yarn::new(20, 300.0, 200.0, lines), 20.0).cloth();
    let (straight, mirrored) = (["XX.", "X.X", ".XX"], [".XX", "X.X", "XX."]);
    let of = |cloth: &Cloth, first| batches(cloth, [24, 24, 8], first, |at| at, |column, row, _| [column, row]);
    let cloth = woven("ply_twist_per_m = 300", &straight);
    let place = |[x, y, z]: [u32; 3]| [23 - x, y, z];
    let a = batches(&cloth, [24, 24, 8], 0, place, |column, row, last| [last - column, row]);
    let z = symmetry_z(&a, &of(&woven("ply_twist_per_m = -300", &mirrored), 1000));
    // S yarns with a little less twist; and Z yarns, whose densities are the same.
    let bent = symmetry_z(&a, &of(&woven("ply_twist_per_m = -270", &mirrored), 1000));
    let same = symmetry_z(&a, &of(&woven("ply_twist_per_m = 300", &mirrored), 1000));
    println!("densities and directions: z = {z:.1?}, bent {bent:.1?}, not mirrored {same:.1?}");
    assert!(z.iter().all(|z| z.abs() < GATE), "{z:?}");
    assert!(bent[1] > 2.0 * GATE && same[1] > 2.0 * GATE, "{bent:?}, {same:?}");
}

// ---- Directions ----

/// H/(2 R F) of the helices of a straight yarn along y, of k = 2π R T at its rim: the mean of |m × p| by length over the
/// disc, u = r²/R² uniform, tan θ = k √u, and its variance over fibers.
fn helices(k: f64, m: DVec3) -> (f64, f64) {
    let n = 400;
    let (mut length, mut seen, mut square) = (0.0, 0.0, 0.0);
    for i in 0..n {
        let tangent = k * ((f64::from(i) + 0.5) / f64::from(n)).sqrt();
        let around = |j: i32| {
            let (sin, cos) = (TAU * (f64::from(j) + 0.5) / f64::from(n)).sin_cos();
            m.cross(DVec3::new(tangent * cos, 1.0, tangent * sin).normalize()).length()
        };
        let mean = (0..n).map(around).sum::<f64>() / f64::from(n);
        let weight = tangent.hypot(1.0);
        (length, seen, square) = (length + weight, seen + weight * mean, square + weight * mean * mean);
    }
    (seen / length, square / length - (seen / length).powi(2))
}

#[test]
fn the_fibers_of_a_twisted_yarn_are_seen_as_their_closed_form_says() {
    let rays = [DVec3::Y, DVec3::X, DVec3::new(0.0, 0.98, 0.2), DVec3::new(0.3, 0.8, -0.5), DVec3::new(0.0, 0.6, 0.8)];
    // The ends of a plain weave are straight when the picks take all of the crimp.
    let errors = |lines: &'static str, cone_deg: f64, spread: Option<f64>| -> (Vec<f64>, f64) {
        let yarn = Yarn::new(300, 300.0, 300.0, lines);
        let cloth = Woven { warp_crimp_share: 0.0, ..Woven::of(PLAIN, yarn, 20.0) }.cloth();
        let warp = |piece: &Primitive| cloth.threads()[piece.thread].system == System::Warp;
        let realize = |number| cloth.realize(5, number).into_iter().filter(warp).collect();
        let counted =
            Counted { directions: 4096, cone_deg, realize: Box::new(realize), ..Counted::of(&cloth, [1, 1, 1]) };
        let f = counted.count(Effort::Realizations(40));
        let fibers: f64 = 40.0 * 2.0 * 300.0;
        let largest = helices(TAU * 0.145 * 0.6, DVec3::X).0;
        let error = |m: &DVec3| {
            let m = m.normalize();
            let (closed, variance) = helices(TAU * 0.145 * 0.6, m);
            let radius = |kind: usize| counted.radii[kind];
            let found = f.visible_area(0, m, radius) / (2.0 * f.values[0].surface);
            (found - closed).abs() / (largest * spread.unwrap_or(f.spread_error) + GATE * (variance / fibers).sqrt())
        };
        (rays.iter().map(error).collect(), f.spread_error)
    };
    let (found, spread) = errors("ply_twist_per_m = 600", 0.0, None);
    let (bent, _) = errors("ply_twist_per_m = 630", 0.0, Some(spread));
    // A cone of 10° blurs directions: seen along the yarn, its fibers are wider.
    let (blurred, told) = errors("ply_twist_per_m = 600", 10.0, Some(spread));
    println!("in gates: {found:.2?}, more twist {bent:.2?}, a cone {blurred:.2?}");
    assert!(found.iter().all(|error| *error < 1.0), "{found:?}");
    assert!(bent[0] > 2.0 && blurred[0] > 2.0 && told > 2.0 * spread, "{bent:?}, {blurred:?}, {told}");
}

// ---- The work ----

#[test]
fn tables_do_not_depend_on_threads_or_on_the_order_of_the_work() {
    let cloth = blend();
    let counted = Counted { list_width: DVec3::splat(0.1), cone_deg: 2.0, ..Counted::of(&cloth, [20, 20, 8]) };
    let on = |threads: usize, effort| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| counted.count(effort))
    };
    let one: SpecificLength = on(1, Effort::Realizations(37));
    assert!(one == on(5, Effort::Realizations(37)));
    assert!(one != on(1, Effort::Realizations(36)), "one realization less makes other tables");
    // A precision that is reached in two goes gives what so many realizations give at once.
    let mut scene = Scene::parse(&Source::find("charmeuse").expect("it is a preset")).expect("it is right");
    scene.model.cells = Some([11, 26, 5]);
    let cloth = Cloth::new(&scene).expect("it can be laid out");
    let count = |effort| SpecificLength::of_cloth(&cloth, &scene.model, effort, |_| {}).expect("it can be counted");
    let (by_precision, gathering) = count(Effort::Precision(0.03));
    assert!(gathering.realizations > 32 && gathering.error < 0.035, "{gathering:?}");
    let (at_once, _) = count(Effort::Realizations(gathering.realizations));
    assert!(by_precision == at_once);
}

#[test]
fn a_precision_that_cannot_be_reached_ends_at_the_most_realizations() {
    let pieces = |number: u64| {
        let piece = Primitive {
            centre: DVec3::new(0.5, 0.5, -0.5),
            direction: DVec3::X,
            length: 0.1 + 0.8 * SplitMix(number).uniform(),
            radius: 1e-3,
            kind: 0,
            thread: 0,
        };
        vec![piece]
    };
    let one = [piece_of_length(0.5)];
    let counted = |precision| {
        let counted = Counted { realize: Box::new(pieces), ..Counted::pieces(&one, 1.0, 1.0) };
        counted.count(Effort::Precision(precision)).values[0].surface
    };
    // (0.1 + 0.8 u) has a mean of 0.5 and a standard deviation of 0.8/√12: 4096 of them to 0.72 %.
    let error = 0.8 / 12f64.sqrt() / 64.0;
    for precision in [0.0, 0.0072, 0.0073, 0.007_25, 0.01] {
        assert!((counted(precision) / 1e-3 - 0.5).abs() < GATE * error * (precision / 0.0072).max(1.0));
    }
}

fn piece_of_length(length: f64) -> Primitive {
    Primitive { centre: DVec3::ZERO, direction: DVec3::X, length, radius: 1e-3, kind: 0, thread: 0 }
}

#[test]
fn the_error_of_thin_fibers_is_not_rounded_away() {
    // Fibers of 20 nm in one of two cells at random: the density of a cell is off by 1/√n of itself.
    let cells = fiberwalk::distribution::CellGrid { counts: [2, 1, 1], period: glam::DVec2::ONE, thickness: 1.0 };
    let pieces = |number: u64| {
        let centre = DVec3::new(if SplitMix(number).uniform() < 0.5 { 0.25 } else { 0.75 }, 0.5, -0.5);
        let piece = Primitive { centre, direction: DVec3::Y, length: 1e-4, radius: 2e-5, kind: 0, thread: 0 };
        Ok(realization(&[piece], &cells))
    };
    let element = fiberwalk::distribution::Element { cells, list_width: DVec3::ZERO, radii: &[2e-5], realize: &pieces };
    let model = Model::default();
    let (_, gathering) =
        SpecificLength::of_pieces(&element, &model, Effort::Precision(0.05), |_| {}).expect("it can be counted");
    let error = 1.0 / (gathering.realizations as f64).sqrt();
    assert!((gathering.error / error - 1.0).abs() < 0.1, "{gathering:?}");
    assert!((300..500).contains(&gathering.realizations), "{gathering:?}");
}

// ---- Bad input and odd settings ----

/// The tables of a preset with further lines of `[model]`.
fn with(name: &str, lines: &str) -> Result<fiberwalk::measure::Prepared> {
    let source = Source::find(name).expect("it is a preset");
    let text = format!("{}\n[model]\n{lines}\n[measure]\nincident = [[0, 0]]\nexit = 4\n", source.text);
    prepare(&Scene::parse(&Source { text, ..source }).unwrap_or_else(|error| panic!("{error}")))
}

#[test]
fn a_cell_that_is_too_full_is_named_with_a_grid_that_cures_it() {
    // Yarns whose fibers crowd in their middle.
    let lines = "radial_profile = { eps = 0, beta = 10 }";
    let cloth = Woven::of(PLAIN, Yarn::new(200, 300.0, 200.0, lines), 20.0).cloth();
    let with = |cells| {
        let model = Model { cells: Some(cells), directions: 64, cone: Some(0.0), ..Model::default() };
        SpecificLength::of_cloth(&cloth, &model, Effort::Precision(0.05), |_| {})
    };
    let error = with([48, 48, 24]).expect_err("its cells are too full").to_string();
    println!("{error}");
    let place = error.strip_prefix("the fibers of cell [").expect("it names a cell");
    assert!(
        place.contains("] of 48 × 48 × 24 have ")
            && error.ends_with("], or give the yarns more room, or let them climb less steeply")
    );
    let cells = error.split("cells = [").nth(1).and_then(|rest| rest.split(']').next()).expect("it names a grid");
    let cells: Vec<u32> = cells.split(", ").map(|count| count.parse().expect("a number")).collect();
    let (cured, gathering) = with([cells[0], cells[1], cells[2]]).unwrap_or_else(|error| panic!("{error}"));
    assert!(cured.values.len() > 100 && gathering.largest_fraction > 0.5, "{cells:?}, {gathering:?}");
    // 64 fibers of π·0.11² mm² that fill all of an element in any cells: only the yarns can help.
    let piece = |i: u32| Primitive {
        centre: DVec3::new(0.5, (f64::from(i % 8) + 0.5) / 8.0, -(f64::from(i / 8) + 0.5) / 8.0),
        radius: 0.11,
        ..piece_of_length(1.0)
    };
    let pieces: Vec<Primitive> = (0..64).map(piece).collect();
    let error = Counted::pieces(&pieces, 1.0, 1.0).try_count(Effort::Realizations(32)).expect_err("they overlap");
    let message = "the fibers of cell [0, 0, 0] of 1 × 1 × 1 have 2.43 of its volume, allowed: 2.3 (fibers that overlap); \
                   give the yarns more room, or let them climb less steeply";
    assert_eq!(error.to_string(), message);
}

#[test]
fn odd_settings_make_tables() {
    let isotropic = |f: &SpecificLength| {
        let areas = [DVec3::X, DVec3::Y, DVec3::Z].map(|m| f.visible_area(0, m, |_| 1.0));
        areas.map(|area| area / f.total(0, |_| 1.0) / (PI / 2.0))
    };
    let one = with("voile", "cells = [1, 1, 1]\ncone_deg = 90\ndirections = 256").expect("it is right");
    assert!(one.tables.cells.is_none() && one.tables.lists.len() == 1);
    // In a cone of 90° every direction is every other.
    for ratio in isotropic(&one.specific_length) {
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    }
    let narrow = with("voile", "cells = [1, 1, 1]\ncone_deg = 0\ndirections = 256").expect("it is right");
    assert!(isotropic(&narrow.specific_length).iter().any(|ratio| (ratio - 1.0).abs() > 0.05));
    let f = &narrow.specific_length;
    assert!((f.total(0, |_| 1.0) / one.specific_length.total(0, |_| 1.0) - 1.0).abs() < 1e-9);
    for cells in ["[256, 1, 1]", "[1, 256, 1]", "[2, 2, 256]"] {
        let many = with("voile", &format!("cells = {cells}\ndirections = 64")).expect("it is right");
        assert!(many.specific_length.values.len() >= 256 && many.gathering.is_some());
    }
}
