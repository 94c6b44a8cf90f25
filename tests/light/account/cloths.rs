//! Sheets of dyed fibers.

use crate::common::sheet::{DyedBundle, DyedSheet};
use crate::common::{Cloth, ISOTROPIC, Kind, aligned, rgb};
use glam::DVec3;
use std::f64::consts::FRAC_PI_4;

/// The unit vector at θ, φ in degrees.
pub fn from_degrees([theta, phi]: [f64; 2]) -> DVec3 {
    let (theta, phi) = (theta.to_radians(), phi.to_radians());
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// The same isotropic, lossless kind again: radius, length density.
pub fn isotropic_kind(radius_um: f64, length_density: f64, absorption: &str) -> Kind {
    Kind { radius_um, ior: 1.5, absorption: absorption.into(), length_density, orientation: ISOTROPIC.into() }
}

/// A sheet as a brute-force simulation sees it, its light, and the cloth file that says the same.
pub fn dyed_cloth(sheet: &DyedSheet, angles: [f64; 2]) -> Cloth {
    let orientation = |bundle: &DyedBundle| aligned(bundle.axis.to_array());
    let kind = |bundle: &DyedBundle| Kind {
        radius_um: bundle.radius * 1e3,
        ior: bundle.ior,
        absorption: rgb(bundle.absorption),
        length_density: bundle.length_density,
        orientation: orientation(bundle),
    };
    let first = kind(&sheet.bundles[0]);
    Cloth {
        radius_um: first.radius_um,
        ior: first.ior,
        absorption: first.absorption,
        more_kinds: sheet.bundles[1..].iter().map(kind).collect(),
        length_over_radius: 2.0 * sheet.half_length,
        ..Cloth::new(first.length_density, &first.orientation)
    }
    .lit_from(&format!("[{angles:?}]"))
}

pub fn bundle(radius: f64, depth: f64, ior: f64, axis: [f64; 3], absorption: [f64; 3]) -> DyedBundle {
    let axis = DVec3::from(axis).normalize();
    DyedBundle { radius, length_density: depth / (2.0 * radius), ior, axis, absorption }
}

pub const INFINITE: f64 = f64::INFINITY;

/// A sheet of two dyed, isotropic kinds: mean weights from order 1 down to 10⁻³ and 10⁻⁶ of what is transmitted.
pub fn two_dyes(dyes: [[f64; 3]; 2], depth: f64) -> Cloth {
    let density = depth / (2.0 * 0.015 * FRAC_PI_4);
    let second = isotropic_kind(5.0, density, &rgb(dyes[1]));
    let first = Cloth { absorption: rgb(dyes[0]), exit: 8, ..Cloth::new(density, ISOTROPIC) };
    Cloth { more_kinds: vec![second], ..first }.lit_from("[[30, 50]]")
}

/// Dyes of two kinds, depth, walks of an engine and of the f64 run.
pub const DYES: [([[f64; 3]; 2], f64, u64); 3] = [
    ([[0.1, 5.0, 60.0], [30.0, 1.0, 200.0]], 3.0, 150_000),
    ([[0.2, 60.0, 400.0], [0.1, 100.0, 800.0]], 6.0, 150_000),
    ([[25.0, 30.0, 60.0], [40.0, 20.0, 100.0]], 4.0, 300_000),
];
