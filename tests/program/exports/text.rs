//! SSDD, DDR and CSV, read by a reader of their own that follows the formats' descriptions.

use super::made::{COMPONENTS, SIDES, lobe, lobes, path, written};
use fiberwalk::bsdf::Component;
use fiberwalk::export::Format;
use fiberwalk::scene::{BasisChoice, Side};
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

fn direction(theta: f64, phi: f64) -> DVec3 {
    let [theta, phi] = [theta, phi].map(f64::to_radians);
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

/// √Σ(difference)²/√Σf² of pairs of numbers.
fn off(pairs: &[(f64, f64)]) -> f64 {
    let sum = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    (sum(|(found, expected)| (found - expected).powi(2)) / sum(|(_, expected)| expected * expected)).sqrt()
}

/// Nodes farther from the normal than this, in degrees, are not judged: cells end at the horizon.
const JUDGED: f64 = 76.0;

#[test]
fn ssdd_has_f_at_its_nodes_in_its_order() {
    let (folder, _) = written(&lobes(BasisChoice::Disc(10), BasisChoice::Disc(16)), Format::Ssdd);
    for side in SIDES {
        let text = std::fs::read_to_string(path(&folder, &format!("made_{}.ssdd", side.name()))).expect("it is text");
        assert!(text.starts_with("VERSION 0.3\n"));
        let blocks: Vec<&str> = text.split("DATA_TYPE ").skip(1).collect();
        assert_eq!(blocks.len(), 3);
        for (component, block) in COMPONENTS.into_iter().zip(&blocks) {
            assert!(block.starts_with(if component == Component::Reflection { "brdf\n" } else { "btdf\n" }));
            let list = |k: usize| -> Vec<f64> {
                numbers(block.lines().find(|line| line.starts_with(&format!("PARAM{k}_LIST"))).expect("a list"))
            };
            let lists = [list(0), list(1), list(2), list(3)];
            let data: Vec<Vec<f64>> = block.split_once("DATA ascii\n").expect("data").1.lines().map(numbers).collect();
            let read = |order: [usize; 4], k: usize| {
                let mut pairs = Vec::new();
                let sizes = lists.each_ref().map(Vec::len);
                let all = (0..sizes[0]).flat_map(|a| (0..sizes[1]).map(move |b| (a, b)));
                for (a, b) in all {
                    for (c, d) in (0..sizes[2]).flat_map(|c| (0..sizes[3]).map(move |d| (c, d))) {
                        let at = [lists[0][a], lists[1][b], lists[2][c], lists[3][d]];
                        if at[0] > JUDGED || at[2] > JUDGED {
                            continue;
                        }
                        let places = [a, b, c, d];
                        let index = order.iter().rev().fold(0, |index, k| index * sizes[*k] + places[*k]);
                        let expected = lobe(side, component, direction(at[0], at[1]), direction(at[2], at[3]))[k];
                        pairs.push((data[index][k], expected));
                    }
                }
                off(&pairs)
            };
            for k in 0..3 {
                let right = read([0, 1, 2, 3], k);
                assert!(right < 0.05, "{}: off by {right}", side.name());
            }
            for wrong in [[1, 0, 2, 3], [2, 3, 0, 1], [0, 3, 2, 1]] {
                let wrongly = read(wrong, 0);
                assert!(wrongly > 0.1, "{wrong:?} is off by {wrongly} only");
            }
        }
        let straight = blocks[2].split_once("DATA ascii\n").expect("data").1;
        assert!(
            blocks[2].starts_with("specular_transmittance\n")
                && numbers(straight).iter().all(|d| (d - 0.05).abs() < 1e-6)
        );
    }
}

#[test]
fn ddr_has_f_about_the_mirror_direction() {
    let (folder, _) = written(&lobes(BasisChoice::Disc(10), BasisChoice::Disc(16)), Format::Ddr);
    for (side, component) in SIDES.into_iter().flat_map(|side| COMPONENTS.map(|component| (side, component))) {
        let extension = if component == Component::Reflection { "ddr" } else { "ddt" };
        let text =
            std::fs::read_to_string(path(&folder, &format!("made_{}.{extension}", side.name()))).expect("it is text");
        let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with(";;")).collect();
        assert_eq!(
            lines[..4],
            ["Source Generated", "TypeSym ASymmetrical 4D", "TypeColorModel RGB", "TypeData Luminance Absolute"]
        );
        let list = |name: &str| {
            let at = lines.iter().position(|line| line.starts_with(&format!("{name} "))).expect("the list is there");
            numbers(lines[at + 1])
        };
        let [psi, sigma, phi, theta] = ["psi", "sigma", "phi", "theta"].map(list);
        for (k, name) in ["red", "gre", "blu"].into_iter().enumerate() {
            let at = lines.iter().position(|line| *line == name).expect("the channel is there");
            assert_eq!([lines[at + 1], lines[at + 3]], [" kbdf", " def"]);
            let factors = numbers(lines[at + 2]);
            let rows: Vec<Vec<f64>> =
                lines[at + 4..].iter().take_while(|line| **line != " enddef").map(|line| numbers(line)).collect();
            assert_eq!((factors.len(), rows.len()), (psi.len() * sigma.len(), psi.len() * sigma.len() * phi.len()));
            // Turned by σ towards the mirror direction, or by mistake away from it.
            let read = |turn: f64| {
                let mut pairs = Vec::new();
                for (start, (p, s)) in psi.iter().flat_map(|p| sigma.iter().map(move |s| (*p, *s))).enumerate() {
                    for (azimuth, f) in phi.iter().enumerate() {
                        for (polar, t) in theta.iter().enumerate() {
                            let about = DMat3::from_rotation_y(-turn * s.to_radians());
                            let wo = DMat3::from_rotation_z(p.to_radians()) * about * direction(*t, *f);
                            if s > JUDGED || wo.z < JUDGED.to_radians().cos() {
                                continue;
                            }
                            let expected = lobe(side, component, direction(s, p), wo)[k];
                            pairs.push((rows[start * phi.len() + azimuth][polar] * factors[start] / PI, expected));
                        }
                    }
                }
                off(&pairs)
            };
            let right = read(1.0);
            assert!(right < 0.05, "{} {name}: off by {right}", side.name());
            let wrongly = if k == 0 { read(-1.0) } else { 1.0 };
            assert!(wrongly > 0.1, "turned the other way it is off by {wrongly} only");
        }
    }
}

#[test]
fn csv_has_every_pair_of_cells_with_its_error() {
    let table = lobes(BasisChoice::Polar { rings: 3, sectors: 4 }, BasisChoice::Klems);
    let (folder, made) = written(&table, Format::Csv);
    let text = std::fs::read_to_string(path(&folder, "made.csv")).expect("it is text");
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
    assert_eq!(head[9..], ["R", "stderr R", "G", "stderr G", "B", "stderr B"]);
    let mut seen = [0; 2];
    for line in lines {
        let words: Vec<&str> = line.split(',').collect();
        let number = |k: usize| words[k].parse::<f64>().expect("a number");
        let side = if words[0] == "front" { Side::Front } else { Side::Back };
        if words[1] == "direct" {
            assert!((number(9) - 0.05).abs() < 1e-6);
            seen[1] += 1;
            continue;
        }
        let component = if words[1] == "reflection" { Component::Reflection } else { Component::Transmission };
        let part = table.table(side, component).expect("it is there");
        let (cell, exit) = (number(2) as usize, number(5) as usize);
        let wo = direction(number(6), number(7));
        assert_eq!(table.goniometer.exit.cell_of(wo.truncate()), exit);
        for k in 0..3 {
            let estimate = part.f[(cell * 145 + exit) * 3 + k];
            assert!((number(9 + 2 * k) - estimate.value).abs() < 1e-6 * estimate.value);
            assert!((number(10 + 2 * k) - estimate.stderr).abs() < 1e-3 * estimate.stderr);
        }
        seen[0] += 1;
    }
    assert_eq!(seen, [2 * 2 * 12 * 145, 2 * 12]);
    let (_, check) = &made.checks[0];
    assert!(check.most < 0.1 && check.cells == 3 * seen[0], "{check:?}");
}
