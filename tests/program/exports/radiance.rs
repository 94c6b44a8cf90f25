//! Both kinds of XML, loaded by Radiance.

use super::made::{COMPONENTS, SIDES, lobe, lobes, path, table, written};
use super::python::{radiance, run};
use crate::common::program::Place;
use fiberwalk::bsdf::{Bsdf, Component};
use fiberwalk::export::Format;
use fiberwalk::goniometer::Goniometer;
use fiberwalk::scene::{BasisChoice, Side};
use glam::DVec3;
use serde_json::json;
use std::path::Path;
use std::process::Command;

const FORMATS: [(Format, &str, BasisChoice); 2] = [
    (Format::Klems, "made_klems.xml", BasisChoice::Klems),
    (Format::TensorTree, "made_tensor-tree.xml", BasisChoice::Disc(8)),
];
/// Radiance disturbs what it loads by up to 0.03 %, and files round.
const LOADED: f64 = 1e-3;

/// wi and wo as Radiance has them, for light of a side and component.
fn pair(side: Side, component: Component, wi: DVec3, wo: DVec3) -> [f64; 4] {
    let sign = if side == Side::Front { 1.0 } else { -1.0 };
    let out = if component == Component::Reflection { sign } else { -sign };
    let angles = |v: DVec3| [v.z.clamp(-1.0, 1.0).acos().to_degrees(), v.y.atan2(v.x).to_degrees()];
    let ([ti, pi], [to, po]) = (angles(wi.with_z(sign * wi.z)), angles(wo.with_z(out * wo.z)));
    [ti, pi, to, po]
}

/// Y of pairs of directions by Radiance's loader.
fn evaluate(file: &Path, pairs: &[[f64; 4]]) -> Vec<f64> {
    let found = run("radiance.py", &json!({ "file": file, "pairs": pairs }));
    found.as_array().expect("a list").iter().map(|xyz| xyz[1].as_f64().expect("a number")).collect()
}

/// Y of a colour.
fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

/// A table with light from one cell to one other alone in each component.
fn marked(basis: BasisChoice) -> (Bsdf, Vec<(Side, Component, usize, usize)>) {
    let marks: Vec<_> = SIDES.into_iter().flat_map(|side| COMPONENTS.map(|component| (side, component))).collect();
    // Cells that no swap, turn, mirror or transposition brings to one another.
    let cells = match basis {
        BasisChoice::Klems => [(30, 80), (52, 101), (12, 61), (74, 27)],
        _ => [(17, 43), (13, 50), (25, 6), (38, 29)],
    };
    let marks: Vec<_> =
        marks.into_iter().zip(cells).map(|((side, component), (i, o))| (side, component, i, o)).collect();
    let light = |_: &Goniometer, side: Side, component: Component, cell: usize, bin: usize| {
        let here = marks.contains(&(side, component, cell, bin));
        if here { [0.2, 0.4, 0.3] } else { [0.0; 3] }
    };
    (table(basis, basis, &light, &|_| 0.0), marks)
}

#[test]
fn one_bright_pair_of_cells_lies_where_radiance_looks_for_it_and_nowhere_else() {
    for (format, name, basis) in FORMATS {
        let (table, marks) = marked(basis);
        let (folder, _) = written(&table, format);
        let cells = table.goniometer.incident_basis().expect("it has cells");
        // What a swap of sides, axes, directions or of the order of bits would read.
        let mirrors: [fn(DVec3) -> DVec3; 6] = [
            |v| v,
            |v| DVec3::new(-v.x, -v.y, v.z),
            |v| DVec3::new(-v.x, v.y, v.z),
            |v| DVec3::new(v.x, -v.y, v.z),
            |v| DVec3::new(v.y, v.x, v.z),
            |v| DVec3::new(-v.y, v.x, v.z),
        ];
        let mut asked = Vec::new();
        for &(_, _, i, o) in &marks {
            for (side, component) in SIDES.into_iter().flat_map(|side| COMPONENTS.map(|component| (side, component))) {
                for (a, b) in mirrors.iter().flat_map(|a| mirrors.map(|b| (*a, b))) {
                    for (wi, wo) in [(a(cells.centre(i)), b(cells.centre(o))), (b(cells.centre(o)), a(cells.centre(i)))]
                    {
                        asked.push((side, component, wi, wo));
                    }
                }
            }
        }
        let pairs: Vec<_> = asked.iter().map(|&(side, component, wi, wo)| pair(side, component, wi, wo)).collect();
        let mut bright = 0;
        for (&(side, component, wi, wo), y) in asked.iter().zip(evaluate(&path(&folder, name), &pairs)) {
            let at = (side, component, cells.cell_of(wi.truncate()), cells.cell_of(wo.truncate()));
            let lit = marks.contains(&at);
            let solid_angle = cells.projected_solid_angle(at.3);
            let expected = if lit { luminance([0.2, 0.4, 0.3]) / solid_angle } else { 0.0 };
            bright += usize::from(lit);
            assert!((y - expected).abs() <= LOADED * expected.max(1e-3), "{name} {at:?}: {y} for {expected}");
        }
        assert!(bright >= marks.len() && asked.len() > 1000, "{bright} of {}", asked.len());
    }
}

#[test]
fn a_lobe_is_evaluated_as_it_is_and_no_mirror_image_of_it_is() {
    for (format, name, basis) in FORMATS {
        let table = lobes(basis, basis);
        let (folder, _) = written(&table, format);
        let cells = table.goniometer.incident_basis().expect("it has cells");
        let mut asked = Vec::new();
        for (side, component) in SIDES.into_iter().flat_map(|side| COMPONENTS.map(|component| (side, component))) {
            for k in 0..200 {
                asked.push((side, component, (k * 37 + 5) % cells.cells(), (k * 61 + 11) % cells.cells()));
            }
        }
        let centre = |cell: usize| cells.centre(cell);
        let pairs: Vec<_> =
            asked.iter().map(|&(side, component, i, o)| pair(side, component, centre(i), centre(o))).collect();
        let found = evaluate(&path(&folder, name), &pairs);
        let off = |mirror: fn(DVec3) -> DVec3| {
            let term = |(&(side, component, i, o), y): (&(Side, Component, usize, usize), &f64)| {
                let table = table.table(side, component).expect("it is there");
                let mirrored = cells.cell_of(mirror(centre(i)).truncate());
                let exits = cells.cells();
                let rgb = [0, 1, 2].map(|channel| table.f[(mirrored * exits + o) * 3 + channel].value);
                let mut expected = luminance(rgb);
                // Where light that touches no fiber leaves, the matrix has it too.
                if format == Format::Klems
                    && component == Component::Transmission
                    && cells.cell_of(-centre(i).truncate()) == o
                {
                    expected += 0.05 / cells.projected_solid_angle(o);
                }
                (y / expected - 1.0).abs()
            };
            asked.iter().zip(&found).map(term).fold(0.0, f64::max)
        };
        // A node of the tree may stand half an error off, and these tables have next to none.
        assert!(off(|v| v) < LOADED, "{name}: off by {}", off(|v| v));
        for mirror in [
            |v: DVec3| DVec3::new(-v.x, v.y, v.z),
            |v: DVec3| DVec3::new(v.x, -v.y, v.z),
            |v: DVec3| DVec3::new(v.y, v.x, v.z),
        ] {
            assert!(off(mirror) > 50.0 * LOADED, "{name}: a mirror image is off by {} only", off(mirror));
        }
        // The cloth itself, at the middles: cells are means.
        let (side, component, i, o) = asked[3];
        let exact = luminance(lobe(side, component, centre(i), centre(o)));
        assert!((found[3] / exact - 1.0).abs() < 0.05, "{} for {exact}", found[3]);
    }
}

/// Largest totals and mean reciprocity errors in percent as checkBSDF prints them: reflection front and back, transmission both.
fn check_bsdf(file: &Path) -> (Vec<f64>, Vec<f64>) {
    let output = Command::new(radiance("checkBSDF")).arg(file).output().expect("checkBSDF runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let (totals, reciprocity) = text.split_once("Reciprocity Error").expect("checkBSDF prints both tables");
    let number = |text: &str| text.trim().trim_end_matches('%').trim().parse::<f64>().expect("a number");
    let total = |name: &str| {
        let line = totals.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("no {name} in {text}"));
        number(line.split('\t').rfind(|part| part.contains('%')).expect("a total"))
    };
    let error = |name: &str| {
        let line =
            reciprocity.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("no {name} in {text}"));
        number(line.split('\t').filter(|part| !part.trim().is_empty()).nth(2).expect("a mean"))
    };
    let names = ["Interior Refl", "Exterior Refl", "Int->Ext Trans", "Ext->Int Trans"];
    (names.map(total).to_vec(), ["Interior Refl", "Exterior Refl", "Transmission"].map(error).to_vec())
}

#[test]
fn check_bsdf_finds_the_totals_and_that_light_takes_the_same_way_back() {
    for (format, name, basis) in FORMATS {
        let table = lobes(basis, basis);
        let (folder, _) = written(&table, format);
        let (totals, reciprocity) = check_bsdf(&path(&folder, name));
        let most = |side, component| {
            let part = table.table(side, component).expect("it is there");
            let channels = [0, 1, 2].map(|channel| table.shares(part, channel));
            let light = (0..channels[0].len()).map(|cell| luminance([0, 1, 2].map(|k| channels[k][cell])));
            let direct = if format == Format::Klems && component == Component::Transmission { 0.05 } else { 0.0 };
            100.0 * (light.fold(0.0, f64::max) + direct)
        };
        let expected = [
            most(Side::Front, Component::Reflection),
            most(Side::Back, Component::Reflection),
            most(Side::Front, Component::Transmission),
            most(Side::Back, Component::Transmission),
        ];
        println!("{name}: {totals:?} for {expected:.2?}, reciprocal to {reciprocity:?} %");
        for (total, expected) in totals.iter().zip(expected) {
            // Printed to a tenth of a percent.
            assert!((total - expected).abs() < 0.05 + 100.0 * LOADED * 1.0, "{name}: {totals:?} for {expected:?}");
        }
        assert!(reciprocity.iter().all(|error| *error < 0.5), "{name}: {reciprocity:?}");
    }
    // Light that does not go back shows.
    let one_way = |goniometer: &Goniometer, side: Side, component: Component, cell: usize, bin: usize| {
        let (wi, wo) = (goniometer.centre(cell), goniometer.exit.centre(bin));
        let factor = (1.0 + 0.3 * wi.x) * goniometer.exit.projected_solid_angle(bin);
        lobe(side, component, wi.with_z(wi.z.abs()), wo).map(|f| f * factor)
    };
    let (folder, _) = written(&table(BasisChoice::Klems, BasisChoice::Klems, &one_way, &|_| 0.05), Format::Klems);
    let (_, errors) = check_bsdf(&path(&folder, "made_klems.xml"));
    assert!(errors.iter().all(|error| *error > 5.0), "{errors:?}");
}

#[test]
fn a_measured_cloth_is_in_the_file_and_its_halves_agree() {
    let place = Place::new();
    let common = ["measure", "nonwoven", "--sides", "front,back", "--incident", "klems", "--exit", "klems"];
    let rest = ["--walks", "3000", "--engine", "cpu", "--seed", "5", "-o", "felt", "--quiet"];
    let outcome = place.run(&[&common[..], &rest[..]].concat());
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    let export = |more: &[&str]| {
        let outcome = place.run(&[&["export", "felt", "--to", "klems,tensor-tree"], more].concat());
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        outcome.stdout
    };
    let plain = export(&[]);
    assert!(plain.starts_with("felt/export/felt_klems.xml\n  read again: "), "{plain}");
    let file = place.path("felt/export/felt_klems.xml");
    let (totals, noisy) = check_bsdf(&file);
    let stored = fiberwalk::results::Stored::read(&place.path("felt")).expect("it is a result");
    let table = stored.bsdf().expect("it has a table");
    let cells = table.goniometer.incident_basis().expect("it has cells");
    let part = table.table(Side::Front, Component::Reflection).expect("it is there");
    let most = table.shares(part, 0).into_iter().fold(0.0, f64::max);
    assert!((totals[0] / 100.0 - most).abs() < 1.5e-3, "{totals:?} for {most}");
    let asked: Vec<[usize; 2]> = (0..100).map(|k| [(k * 31) % 145, (k * 57 + 3) % 145]).collect();
    let pairs: Vec<_> = asked
        .iter()
        .map(|[i, o]| pair(Side::Front, Component::Reflection, cells.centre(*i), cells.centre(*o)))
        .collect();
    for ([i, o], y) in asked.iter().zip(evaluate(&file, &pairs)) {
        let expected = part.f[i * 145 + o].value;
        assert!((y - expected).abs() < LOADED * expected.max(0.1), "{i} to {o}: {y} for {expected}");
    }
    // Averaged halves are reciprocal to what Radiance disturbs; as they were measured they differ by noise.
    let told = export(&["--reciprocal"]);
    assert!(told.starts_with("reciprocal: front reflection differed from its reverse by "), "{told}");
    let (_, averaged) = check_bsdf(&file);
    println!("reciprocity errors in percent: {noisy:?}, averaged {averaged:?}");
    assert!(
        averaged.iter().zip(&noisy).all(|(averaged, noisy)| *averaged < 0.2 && *noisy > 3.0),
        "{averaged:?} {noisy:?}"
    );
}

#[test]
fn the_scene_beside_the_file_is_read_by_radiance() {
    for (format, name, basis) in FORMATS {
        let (folder, _) = written(&lobes(basis, basis), format);
        let scene = name.replace(".xml", ".rad");
        let tree = folder.path().join("scene.oct");
        let octree = std::fs::File::create(&tree).expect("a file can be made");
        let run = |scene: &str| {
            let mut command = Command::new(radiance("oconv"));
            command
                .arg(scene)
                .current_dir(folder.path())
                .env("RAYPATH", ".")
                .stdout(octree.try_clone().expect("a file"));
            command.output().expect("oconv runs")
        };
        let output = run(&scene);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        // Look down on the piece under an even sky: the light is that of all directions, half of it from each side.
        let library = format!(".:{}", radiance("rtrace").with_file_name("../lib").display());
        let mut command = Command::new(radiance("rtrace"));
        command
            .args(["-h", "-w", "-ab", "0", "-av", "1", "1", "1"])
            .arg(&tree)
            .env("RAYPATH", &library)
            .current_dir(folder.path());
        command
            .stdin(std::process::Stdio::piped())
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped());
        let mut child = command.spawn().expect("rtrace runs");
        std::io::Write::write_all(&mut child.stdin.take().expect("an input"), b"0.5 0.5 1 0 0 -1\n").expect("it reads");
        let output = child.wait_with_output().expect("it ends");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let light: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        assert!(
            light.len() == 3 && light.iter().all(|light| *light > 0.05),
            "{text}{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
}
