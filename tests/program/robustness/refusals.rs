//! A cloth that is right, ways to spoil it, and what a refusal must be.

use crate::common::program::{Outcome, Place};

pub const CLOTH: &str = r#"name = "sheet"
[fiber.wool]
radius_um = 10
ior = 1.5
[sheet]
thickness_um = 500
[[sheet.fibers]]
fiber = "wool"
length_density_per_mm2 = 100
orientation = "isotropic"
"#;
pub const FEW: [&str; 4] = ["--walks", "10", "--engine", "cpu"];
/// What hides every Vulkan driver from the loader.
pub const NO_DRIVER: [(&str, &str); 2] = [("VK_DRIVER_FILES", "/nonexistent"), ("VK_ICD_FILENAMES", "/nonexistent")];
pub const NO_ADAPTER: &str = "the gpu engine needs a Vulkan, Metal or DX12 driver with the default limits of WebGPU, but no \
                          adapter was found; on Debian-like \
                          systems the packages mesa-vulkan-drivers and libvulkan1 bring a software adapter";
pub const INCIDENT: &str = "the N of an N×N disc basis, a whole number from 1 to 64, \"klems\", rings × sectors such as \"polar:18x36\", at most \
     4096 cells, or a list of directions [[theta, phi], …]";
pub const EXIT: &str = "the N of an N×N disc basis, a whole number from 1 to 256, \"klems\", or rings × sectors such as \"polar:18x36\", at \
     most 90 × 360";

/// A spectrum as a spreadsheet writes it.
pub const SPECTRUM: &str = "\u{feff}# Measured on a film.\r\nnm, 1/mm\r\n400, 0.5\r\n700, 20\r\n";
pub const MEASURE: [&str; 2] = ["measure", "cloth.toml"];

/// Run the program; it must end with a code and one line, and leave every file as it was.
pub fn refuse(place: &Place, arguments: &[&str], code: i32, message: &str) {
    let before = place.contents();
    let outcome = place.run(arguments);
    check_refusal(&outcome, code, message);
    assert!(place.contents() == before, "{arguments:?} changed files");
}

pub fn check_refusal(outcome: &Outcome, code: i32, message: &str) {
    let Outcome { code: found, stdout, stderr } = outcome;
    assert_eq!((stderr.as_str(), stdout.as_str(), *found), (format!("error: {message}\n").as_str(), "", Some(code)));
}

/// Texts of a cloth file, and what is said of each after the file's name.
pub fn refuse_texts(cases: &[(&str, &str)]) {
    for (text, message) in cases {
        let place = Place::new();
        place.write("cloth.toml", text);
        refuse(&place, &["measure", "cloth.toml"], 2, &format!("cloth.toml:{message}"));
    }
}

/// The cloth file with one thing replaced, and what is said of it.
pub fn refuse_edits(cases: &[(&str, &str, &str)]) {
    let edited = cases.iter().map(|(old, new, _)| {
        assert_eq!(CLOTH.matches(old).count(), 1, "`{old}` must be there once");
        CLOTH.replace(old, new)
    });
    let texts: Vec<String> = edited.collect();
    refuse_texts(&texts.iter().zip(cases).map(|(text, case)| (text.as_str(), case.2)).collect::<Vec<_>>());
}

/// Lines after the cloth file's ten, and what is said of them.
pub fn refuse_lines(cases: &[(&str, &str)]) {
    let texts: Vec<String> = cases.iter().map(|(lines, _)| format!("{CLOTH}{lines}\n")).collect();
    refuse_texts(&texts.iter().zip(cases).map(|(text, case)| (text.as_str(), case.1)).collect::<Vec<_>>());
}

/// Arguments after `measure nonwoven`, and what is said of them.
pub fn refuse_arguments(code: i32, cases: &[(&[&str], &str)]) {
    for (arguments, message) in cases {
        refuse(&Place::new(), &[&["measure", "nonwoven"], *arguments].concat(), code, message);
    }
}

/// A cloth file with the absorption in a spectrum's file on line 5, and more lines after its eleven.
pub fn spectral(spectrum: &str, lines: &str) -> Place {
    let place = Place::new();
    let absorption = format!("ior = 1.5\nabsorption_per_mm = {{ spectrum = \"{spectrum}\" }}");
    place.write("cloth.toml", format!("{}{lines}", CLOTH.replace("ior = 1.5", &absorption)));
    place
}

/// Another kind of fiber and its share of the sheet.
pub fn another(name: &str, line: &str) -> String {
    format!(
        "[fiber.{name}]\nradius_um = 5\nior = 1.5\n{line}[[sheet.fibers]]\nfiber = \"{name}\"\n\
         length_density_per_mm2 = 1\norientation = \"planar\"\n"
    )
}

/// Values of `absorption_per_mm`, and what is said of them.
pub fn refuse_absorption(cases: &[(&str, &str)]) {
    let edits: Vec<String> = cases.iter().map(|(value, _)| format!("ior = 1.5\nabsorption_per_mm = {value}")).collect();
    let edits: Vec<_> = edits.iter().zip(cases).map(|(new, case)| ("ior = 1.5", new.as_str(), case.1)).collect();
    refuse_edits(&edits);
}

pub fn summary(place: &Place) -> serde_json::Value {
    let text = std::fs::read(place.path("cloth/summary.json")).expect("the summary is there");
    serde_json::from_slice(&text).expect("the summary is JSON")
}

/// Measure `cloth.toml`; it must give that many channels and sides.
pub fn check_measured(place: &Place, channels: usize, sides: usize) {
    let outcome = place.run(&[&MEASURE[..], &FEW[..]].concat());
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    let summary = summary(place);
    let lit = summary["sides"].as_object().expect("sides by name");
    assert_eq!(lit.len(), sides);
    for side in lit.values() {
        assert_eq!(side["hemispherical"]["reflectance"].as_object().map(|found| found.len()), Some(channels));
    }
}
