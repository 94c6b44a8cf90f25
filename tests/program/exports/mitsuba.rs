//! Files of the RGL loaded by Mitsuba's `measured`, and the plugin that reads `bsdf.exr`.

use super::made::{lobe, lobes, path, written};
use super::python::run;
use crate::common::program::Place;
use fiberwalk::bsdf::Component;
use fiberwalk::colour::Channels;
use fiberwalk::export::Format;
use fiberwalk::goniometer::DiscBasis;
use fiberwalk::scene::{BasisChoice, Side};
use glam::{DVec2, DVec3};
use serde_json::{Value, json};
use std::path::Path;

/// wi and wo, evenly spread over the projected discs: a sequence with the steps of the golden ratio's relatives.
fn pairs(count: usize) -> Vec<(DVec3, DVec3)> {
    let root = 1.167_303_978_261_418_7_f64;
    let fraction = |i: usize, power: i32| (0.5 + (i + 1) as f64 * root.powi(-power)).fract();
    let direction = |a: f64, b: f64| {
        let disc = DVec2::from_angle(std::f64::consts::TAU * a) * (0.98 * b).sqrt();
        disc.extend((1.0 - disc.length_squared()).sqrt())
    };
    (0..count).map(|i| (direction(fraction(i, 1), fraction(i, 2)), direction(fraction(i, 3), fraction(i, 4)))).collect()
}

/// f by Mitsuba, by channel.
fn measured(file: &Path, variant: &str, pairs: &[(DVec3, DVec3)], wavelengths: Value) -> Vec<Vec<f64>> {
    let list: Vec<_> = pairs.iter().map(|(wi, wo)| [wi.to_array(), wo.to_array()]).collect();
    let input = json!({ "file": file, "variant": variant, "pairs": list, "wavelengths": wavelengths });
    let found: Vec<Vec<f64>> = serde_json::from_value(run("measured.py", &input)).expect("lists of numbers");
    found.into_iter().zip(pairs).map(|(f, (_, wo))| f.into_iter().map(|f| f / wo.z).collect()).collect()
}

/// √Σ(difference)²/√Σf² of f against the lobe of a side, looked at through a mirror.
fn off(found: &[Vec<f64>], pairs: &[(DVec3, DVec3)], side: Side, mirror: fn(DVec3) -> DVec3) -> f64 {
    let (mut square, mut all) = (0.0, 0.0);
    for (found, (wi, wo)) in found.iter().zip(pairs) {
        let expected = lobe(side, Component::Reflection, mirror(*wi), mirror(*wo));
        square += found.iter().zip(expected).map(|(f, e)| (f - e).powi(2)).sum::<f64>();
        all += expected.iter().map(|e| e * e).sum::<f64>();
    }
    (square / all).sqrt()
}

#[test]
fn measured_has_the_cloth_at_ten_thousand_pairs_of_directions() {
    let (folder, _) = written(&lobes(BasisChoice::Disc(10), BasisChoice::Disc(18)), Format::Rgl);
    let asked = pairs(10_000);
    for (side, other) in [(Side::Front, Side::Back), (Side::Back, Side::Front)] {
        let file = path(&folder, &format!("made_{}_rgb.bsdf", side.name()));
        let found = measured(&file, "scalar_rgb", &asked, json!([]));
        let error = off(&found, &asked, side, |v| v);
        println!("{}: off by {:.2} % of f", side.name(), 100.0 * error);
        // Nodes of wi are 7.5° by 11° apart, and light near the horizon is divided by its cosine.
        assert!(error < 0.06, "{error}");
        for mirror in [|v: DVec3| DVec3::new(-v.x, v.y, v.z), |v: DVec3| DVec3::new(v.y, v.x, v.z)] {
            assert!(
                off(&found, &asked, side, mirror) > 0.15,
                "a mirror image is off by {}",
                off(&found, &asked, side, mirror)
            );
        }
        assert!(off(&found, &asked, other, |v| v) > 0.2);
    }
}

#[test]
fn spectral_files_have_the_colours_of_the_cloth() {
    let (folder, _) = written(&lobes(BasisChoice::Disc(8), BasisChoice::Disc(16)), Format::Rgl);
    let asked = pairs(40);
    let rgb = measured(&path(&folder, "made_front_rgb.bsdf"), "scalar_rgb", &asked, json!([]));
    let file = path(&folder, "made_front_spectral.bsdf");
    let wavelengths: Vec<f64> = (0..80).map(|i| 380.0 + 5.0 * f64::from(i)).collect();
    let spectra = measured(&file, "scalar_spectral", &asked, json!(wavelengths));
    let columns = Channels::Spectral(wavelengths).to_rgb();
    let mut most: f64 = 0.0;
    for (spectrum, rgb) in spectra.iter().zip(&rgb) {
        for k in 0..3 {
            let seen: f64 = spectrum.iter().zip(&columns).map(|(f, column)| f * column[k]).sum();
            most = most.max((seen - rgb[k]).abs() / rgb.iter().fold(0.0, |a: f64, b| a.max(*b)));
        }
    }
    println!("colours off by {:.2} % at most", 100.0 * most);
    assert!(most < 0.02, "{most}");
    assert!(spectra.iter().all(|spectrum| spectrum[0] > 3.0 * spectrum[75]), "the front is blue");
}

/// A sheet that absorbs nothing and lets some light through, measured by the program.
fn lossless(place: &Place) -> Value {
    let text = "name = \"clear sheet\"\n[fiber.clear]\nradius_um = 10\nior = 1.5\nabsorption_per_mm = 0\n[sheet]\nthickness_um = 400\n\
                [[sheet.fibers]]\nfiber = \"clear\"\nlength_density_per_mm2 = 200\norientation = \"aligned\"\naxis = [1, 0.4, 0.2]\nspread_deg = 40\n";
    place.write("clear.toml", text);
    let arguments = [
        "measure",
        "clear.toml",
        "--sides",
        "front,back",
        "--walks",
        "6000",
        "--engine",
        "cpu",
        "--seed",
        "3",
        "--quiet",
    ];
    let outcome = place.run(&arguments);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    let summary = std::fs::read(place.path("clear/summary.json")).expect("there is a summary");
    serde_json::from_slice(&summary).expect("it is JSON")
}

#[test]
fn the_albedo_of_measured_is_that_of_the_summary() {
    let place = Place::new();
    let summary = lossless(&place);
    let outcome = place.run(&["export", "clear", "--to", "rgl"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("rgl: reflection only"), "{}", outcome.stderr);
    // Even places of the disc of wi and of wo: means of f times π are the light over the hemisphere.
    let disc = |n: u32| {
        let basis = DiscBasis { n };
        (0..basis.cells()).map(move |cell| basis.direction(cell, DVec2::splat(0.5))).collect::<Vec<_>>()
    };
    let (wis, wos) = (disc(12), disc(10));
    let asked: Vec<_> = wis.iter().flat_map(|wi| wos.iter().map(|wo| (*wi, *wo))).collect();
    for side in ["front", "back"] {
        let file = place.path(&format!("clear/export/clear_{side}_rgb.bsdf"));
        let found = measured(&file, "scalar_rgb", &asked, json!([]));
        let mean = found.iter().map(|f| f[1]).sum::<f64>() / found.len() as f64 * std::f64::consts::PI;
        let expected = summary["sides"][side]["hemispherical"]["reflectance"]["Y"]["value"].as_f64().expect("a number");
        println!("{side}: {mean:.4} for {expected:.4}");
        assert!((mean / expected - 1.0).abs() < 0.02, "{side}: {mean} for {expected}");
    }
}

#[test]
fn the_plugin_has_the_table_samples_its_density_and_loses_no_light() {
    let place = Place::new();
    let summary = lossless(&place);
    let ask = |variant: &str, tasks: &[&str]| {
        run("plugin.py", &json!({ "file": place.path("clear/bsdf.exr"), "variant": variant, "tasks": tasks }))
    };
    let found = ask("llvm_ad_rgb", &["eval", "scalar", "chi2", "furnace"]);
    let number = |value: &Value| value.as_f64().expect("a number");
    println!("{} {} {}", found["eval"], found["chi2"], found["furnace"]);
    assert!(number(&found["eval"]["most"]) < 1e-5 && found["eval"]["bright"].as_u64() > Some(300), "{}", found["eval"]);
    // Five tests at a level of 0.01 together (Šidák); a wi that is off by 4° shows.
    let level = 1.0 - 0.99f64.powf(0.2);
    let p: Vec<f64> = found["chi2"]["p"].as_array().expect("a list").iter().map(number).collect();
    assert!(p.len() == 5 && p.iter().all(|p| *p > level), "{p:?}");
    assert!(number(&found["chi2"]["bent"]) < 1e-6, "{}", found["chi2"]["bent"]);
    // A lossless cloth cannot be seen under an even sky; without the light that goes straight through it can.
    let [mean, error] = [0, 1].map(|k| number(&found["furnace"]["masked"][k]));
    assert!((mean - 1.0).abs() < 4.0 * error && error < 2e-3, "{mean} ± {error}");
    let [least, most] = [0, 1].map(|k| number(&found["furnace"]["weights"][k]));
    assert!(least > 1.0 - 1e-5 && most < 1.0 + 1e-5, "samples weigh {least} to {most}");
    let openness = number(&found["furnace"]["openness"]);
    let direct = number(&summary["sides"]["front"]["hemispherical"]["direct"]["Y"]["value"]);
    assert!((openness - direct).abs() < 0.01 && direct > 0.01, "{openness} for {direct}");
    let lost = 1.0 - number(&found["furnace"]["plain"][0]);
    assert!(lost > 10.0 * error, "without the mask {lost} of the light is missing");
    // The same numbers one by one, in a variant without a compiler.
    let scalar = ask("scalar_rgb", &["scalar"]);
    let lists = |value: &Value| -> Vec<Vec<f64>> { serde_json::from_value(value["scalar"].clone()).expect("lists") };
    let (vector, scalar) = (lists(&found), lists(&scalar));
    assert_eq!(vector.len(), scalar.len());
    for (a, b) in vector.iter().flatten().zip(scalar.iter().flatten()) {
        assert!((a - b).abs() < 2e-4 * a.abs().max(1.0), "{a} and {b}");
    }
}
