//! The half vector as a place of the unit square, for one direction of wi.

use super::warp::Warp;
use crate::goniometer::DiscBasis;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Density where wo is below the horizon, as a share of the mean: the inverse warp must exist there.
const FLOOR: f64 = 1e-4;

/// One direction of wi.
pub struct Half {
    wi: DVec3,
}

/// The place of a half vector: u = √(2θ/π), v = (φ + π)/2π.
pub fn place(m: DVec3) -> [f64; 2] {
    let theta = m.truncate().length().atan2(m.z);
    let v = (m.y.atan2(m.x) + PI) / (2.0 * PI);
    [(2.0 * theta / PI).sqrt(), v - v.floor()]
}

impl Half {
    pub fn new(wi: DVec3) -> Half {
        Half { wi }
    }

    /// The half vector at a place, and sin θ of it.
    fn vector([u, v]: [f64; 2]) -> (DVec3, f64) {
        let (theta, phi) = (u * u * FRAC_PI_2, (2.0 * v - 1.0) * PI);
        let sine = theta.sin();
        (DVec3::new(sine * phi.cos(), sine * phi.sin(), theta.cos()), sine)
    }

    /// wo for a half vector at a place.
    pub fn exit(&self, place: [f64; 2]) -> DVec3 {
        let (m, _) = Half::vector(place);
        2.0 * self.wi.dot(m) * m - self.wi
    }

    /// The density of the place when wo is cosine-distributed, up to its scale: cos θo/π · 4 (wi·m) · 2π² u sin θm, from dωo =
    /// 4 (wi·m) dωm and dωm = 2π² u sin θm du dv. n × n nodes, φ the row.
    pub fn density(&self, n: usize) -> Vec<f32> {
        let node = |k: usize| k as f64 / (n - 1) as f64;
        let at = |i: usize| {
            let place = [node(i % n), node(i / n)];
            let (m, sine) = Half::vector(place);
            let cosine = self.wi.dot(m);
            let wo = 2.0 * cosine * m - self.wi;
            if cosine > 0.0 { (wo.z.max(0.0) * cosine * place[0] * sine).max(0.0) } else { 0.0 }
        };
        let density: Vec<f64> = (0..n * n).map(at).collect();
        let floor = FLOOR * density.iter().sum::<f64>() / (n * n) as f64;
        // Grazing light has no such density at all.
        density.iter().map(|value| if floor > 0.0 { (value + floor) as f32 } else { 1.0 }).collect()
    }

    /// Where a loader reads the values of `places` × `places` directions wo that are even over the projected disc, and what each weighs in
    /// ∫ S dωo of stored values S = f cos θo.
    pub fn reads(&self, warp: &Warp, places: u32) -> Vec<([f64; 2], f64)> {
        let disc = DiscBasis { n: places };
        let blend = [(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];
        let at = |cell: usize| {
            let wo = disc.direction(cell, DVec2::splat(0.5));
            let (sample, _) = warp.invert(&blend, place((self.wi + wo).normalize()));
            (sample, disc.projected_solid_angle() / wo.z)
        };
        (0..disc.cells()).map(at).collect()
    }
}

/// Bilinear between n × n nodes, the row by the second coordinate.
pub fn bilinear(n: usize, [x, y]: [f64; 2], at: &dyn Fn(usize) -> f64) -> f64 {
    let split = |t: f64| {
        let scaled = t.clamp(0.0, 1.0) * (n - 1) as f64;
        let low = (scaled as usize).min(n - 2);
        (low, scaled - low as f64)
    };
    let ((column, x), (row, y)) = (split(x), split(y));
    let mix = |row: usize| at(row * n + column) + x * (at(row * n + column + 1) - at(row * n + column));
    mix(row) + y * (mix(row + 1) - mix(row))
}
