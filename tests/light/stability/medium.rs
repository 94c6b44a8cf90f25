//! Sheets from nearly empty to nearly full, of thin and thick fibers, thin and thick.

use super::light::from_degrees;
use super::table::{Found, METHODS, direct, direct_share, fails, number, refused, section, setup};
use crate::common::{Cloth, ISOTROPIC, SplitMix, aligned, engines};
use fiberwalk::scene::{Scene, Source};
use glam::DVec3;
use std::f64::consts::PI;

/// Isotropic fibers of a radius in mm that fill v of a sheet through which light from 60° has an optical depth, and the
/// sheet's thickness.
fn filled(radius: f64, v: f64, depth: f64) -> (Cloth, f64) {
    // H = 2 R L π/4 with v = π R² L.
    let thickness = 0.5 * depth * 2.0 * radius / v;
    let cloth = Cloth::new(v / (PI * radius * radius), ISOTROPIC).lit_from("[[60, 75]]");
    (Cloth { radius_um: 1e3 * radius, thickness_um: 1e3 * thickness, ..cloth }, thickness)
}

#[test]
fn from_nearly_empty_to_nearly_full() {
    section("Shares of the volume");
    let cases = [(1e-4, 1e-6, 1.0), (1e-2, 1e-3, 1.0), (1e-2, 0.3, 1.0), (1e-2, 0.9, 0.2)];
    for (i, (radius, v, depth)) in (0..).zip(cases) {
        let regime = format!("fibers fill {}", number(v));
        direct(&regime, &filled(radius, v, depth).0, depth, v, 4000 + 10 * i, &METHODS);
    }
    let (full, _) = filled(1e-2, 0.9, 0.2);
    let setup = setup(&METHODS[3].of(&full));
    let found = direct_share("cpu", engines()[1].1, &setup, 4040, (-0.2f64).exp());
    fails(
        "fibers fill 0.9000",
        "carried-dense without 1/(1 − v)",
        (-2f64).exp(),
        Found { value: (-0.2f64).exp(), ..found },
    );
    // More than there is room for.
    let text = filled(1e-2, 0.95, 1.0).0.toml();
    let source = Source { file: "full.toml".into(), stem: "full".into(), text, folder: None };
    let message = Scene::parse(&source).expect_err("it is too full").to_string();
    refused("fibers fill 0.95", "all", &message, "fibers fill 0.95 of the sheet, but at most 0.9 is possible");
}

#[test]
fn from_thin_to_thick_fibers() {
    section("Radii");
    for (i, (radius, v)) in (0..).zip([(1e-4, 0.1), (1.0, 0.25)]) {
        direct(&format!("radius {} mm", number(radius)), &filled(radius, v, 1.0).0, 1.0, v, 4100 + 10 * i, &METHODS);
    }
    // Hits that are only looked for between the faces: of those at z a part |n_z| R / d has its axis beyond a face.
    let (cloth, thickness) = filled(1.0, 0.25, 1.0);
    let m = -from_degrees([60.0, 75.0]);
    let mut random = SplitMix(4120);
    let (mut sum, mut all) = (0.0, 0.0);
    for _ in 0..400_000 {
        let (p, offset) = (random.direction(), 2.0 * random.uniform() - 1.0);
        let across: DVec3 = m.cross(p);
        let visible = across.length();
        let normal = ((1.0 - offset * offset).sqrt() * (p * m.dot(p) - m) + offset * across) / visible;
        sum += visible * (1.0 - (normal.z.abs() / thickness).min(1.0));
        all += visible;
    }
    let weak = (-sum / all).exp();
    let found = direct_share("gpu", engines()[0].1, &setup(&METHODS[2].of(&cloth)), 4130, weak);
    fails("radius 1 mm", "carried, between the faces only", (-1f64).exp(), Found { value: weak, ..found });
}

#[test]
fn from_thin_to_thick_sheets() {
    section("Thicknesses");
    for (i, (radius, thickness)) in (0..).zip([(1e-4, 1e-3), (1e-2, 1.0), (1e-2, 1e3)]) {
        let v = 0.5 * 2.0 * radius / thickness;
        let (cloth, thickness) = filled(radius, v, 1.0);
        direct(&format!("a sheet of {} mm", number(thickness)), &cloth, 1.0, v, 4200 + 10 * i, &METHODS);
    }
    // Exactly aligned fibers of one sheet, cut out of a plane that the light runs along nearly.
    let axis = DVec3::new(0.6, 0.8, 0.0);
    let wi = from_degrees([89.0, 75.0]);
    let (radius, thickness) = (1e-4, 1e-3);
    let length_density = wi.z / (2.0 * radius * thickness * wi.cross(axis).length());
    let cloth = Cloth::new(length_density, &aligned(axis.to_array())).lit_from("[[89, 75]]");
    let cloth = Cloth { radius_um: 1e3 * radius, thickness_um: 1e3 * thickness, ..cloth };
    direct("a sheet of 0.001 mm, light from 89°", &cloth, 1.0, PI * radius * radius * length_density, 4240, &METHODS);
}
