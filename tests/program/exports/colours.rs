//! Colours against Mitsuba's own tables of the observer and the illuminant, and of the cloths that come with the program.

use super::python::run;
use crate::common::program::Place;
use fiberwalk::colour::{Channels, linear_srgb, white};
use serde_json::{Value, json};

#[test]
fn the_observer_and_the_illuminant_are_those_of_mitsuba() {
    // Each wavelength alone, and what all of them give together.
    let wavelengths: Vec<f64> = (0..81).map(|i| 380.0 + 5.0 * f64::from(i)).collect();
    let found = run("observer.py", &json!({ "wavelengths": wavelengths }));
    let found: Vec<[f64; 3]> = serde_json::from_value(found).expect("X, Y, Z by wavelength");
    let all: f64 = found.iter().map(|xyz| xyz[1]).sum();
    let columns = Channels::Spectral(wavelengths).to_xyz();
    let off = |shift: usize| {
        let pairs = columns.iter().zip(found.iter().cycle().skip(shift));
        pairs.flat_map(|(a, b)| [0, 1, 2].map(|k| (a[k] - b[k] / all).abs())).fold(0.0, f64::max)
    };
    println!("off by {:.1e} of the light of a white at most", off(0));
    assert!(off(0) < 2e-5, "{}", off(0));
    assert!(off(1) > 1e-3, "the neighbours are off by {} only", off(1));
    // A white of XYZ is a white of sRGB.
    assert!(linear_srgb(white()).iter().all(|light| (light - 1.0).abs() < 2e-3), "{:?}", linear_srgb(white()));
}

#[test]
fn denim_is_blue_and_linen_is_cream() {
    let place = Place::new();
    let reflected = |cloth: &str| -> [f64; 3] {
        let arguments = [
            "measure",
            cloth,
            "--walks",
            "300",
            "--incident",
            "2",
            "--exit",
            "2",
            "--model",
            "explicit",
            "--engine",
            "cpu",
            "--quiet",
        ];
        let outcome = place.run(&arguments);
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        let summary = std::fs::read(place.path(&format!("{cloth}/summary.json"))).expect("there is a summary");
        let summary: Value = serde_json::from_slice(&summary).expect("it is JSON");
        ["R", "G", "B"].map(|name| {
            summary["sides"]["front"]["hemispherical"]["reflectance"][name]["value"].as_f64().expect("a number")
        })
    };
    let (denim, linen) = (reflected("denim"), reflected("linen"));
    println!("denim {denim:.3?}, linen {linen:.3?}");
    assert!(denim[2] > 1.3 * denim[1] && denim[1] > denim[0], "{denim:?}");
    assert!(linen[0] > linen[1] && linen[1] > 1.02 * linen[2] && linen[0] < 1.5 * linen[2], "{linen:?}");
}
