//! Slices in OpenEXR, read by OpenEXR's own library.

use super::made::{COMPONENTS, SIDES, lobes, path, written};
use super::python::run;
use fiberwalk::bsdf::Component;
use fiberwalk::export::Format;
use fiberwalk::scene::BasisChoice;
use glam::DVec2;
use serde_json::json;

#[test]
fn slices_have_every_cell_where_it_is_seen() {
    let table = lobes(BasisChoice::Disc(8), BasisChoice::Disc(8));
    let (folder, _) = written(&table, Format::SpectralExr);
    for (side, component) in SIDES.into_iter().flat_map(|side| COMPONENTS.map(|component| (side, component))) {
        let what = if component == Component::Reflection { "reflection" } else { "transmission" };
        let file = path(&folder, &format!("made_{}_{what}.exr", side.name()));
        let parts = run("slices.py", &json!({ "file": file }));
        let parts = parts.as_array().expect("a list of parts");
        assert!(parts.len() > 6, "{} parts", parts.len());
        let part = table.table(side, component).expect("it is there");
        let basis = table.goniometer.incident_basis().expect("it has cells");
        for slice in parts {
            assert_eq!(slice["version"], "1.0");
            let name = slice["name"].as_str().expect("a name");
            let words: Vec<f64> = name.split(' ').filter_map(|word| word.parse().ok()).collect();
            let [theta, phi] = [words[1], words[2]].map(f64::to_radians);
            let cell = words[0] as usize;
            assert_eq!(basis.cell_of(DVec2::from_angle(phi) * theta.sin()), cell, "{name}");
            for (k, channel) in ["R", "G", "B"].into_iter().enumerate() {
                let rows: Vec<Vec<f64>> = serde_json::from_value(slice["channels"][channel].clone()).expect("rows");
                let edge = rows.len();
                let mut off = [0; 2];
                for (y, x) in (0..edge).flat_map(|y| (0..edge).map(move |x| (y, x))) {
                    let at = |i: usize| (2 * i + 1) as f64 / edge as f64 - 1.0;
                    // The first row is the upper one.
                    for (flip, wo) in [DVec2::new(at(x), -at(y)), DVec2::new(at(x), at(y))].into_iter().enumerate() {
                        let inside = wo.length() < 1.0;
                        let exit = if inside { table.goniometer.exit.cell_of(wo) } else { 0 };
                        let expected = if inside { part.f[(cell * 64 + exit) * 3 + k].value } else { 0.0 };
                        off[flip] += usize::from((rows[y][x] - expected).abs() > 1e-6);
                    }
                }
                assert!(off[0] == 0 && off[1] > 1000, "{name} {channel}: {off:?} pixels are off");
            }
        }
    }
}
