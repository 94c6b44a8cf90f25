//! Straight rays through explicit fibers: which share of them touches none. Nothing of the program but the pieces is used.

use super::SplitMix;
use super::stats::mean_error;
use fiberwalk::cloth::Primitive;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Share of rays along `m` that miss all pieces of an element that is periodic in x and y: a lattice of `n` × `n` rays at
/// z = 0, moved by `shift` ∈ [0, 1)² of its step. Lengths in mm.
///
/// A ray meets a piece when its line passes the axis within the radius, and nearest to it between the ends.
pub fn missed(pieces: &[Primitive], period: DVec2, m: DVec3, n: u32, shift: DVec2) -> f64 {
    let step = period / f64::from(n);
    let across = |v: DVec3| v - m * m.dot(v);
    let mut touched = vec![false; (n * n) as usize];
    for piece in pieces {
        // Move the piece along the ray, its ends to z = 0.
        let half = piece.direction * (piece.length / 2.0);
        let [from, to] = [-half, half].map(|end| {
            let end = piece.centre + end;
            end.truncate() - m.truncate() * (end.z / m.z)
        });
        let axis = across((to - from).extend(0.0));
        let reach = DVec2::splat(piece.radius / m.z.abs());
        let low = ((from.min(to) - reach) / step - shift).ceil().as_i64vec2();
        let high = ((from.max(to) + reach) / step - shift).floor().as_i64vec2();
        for row in low.y..=high.y {
            for column in low.x..=high.x {
                let ray = (DVec2::new(column as f64, row as f64) + shift) * step;
                let offset = across((ray - from).extend(0.0));
                let along = offset.dot(axis) / axis.length_squared();
                if (0.0..=1.0).contains(&along) && (offset - axis * along).length() < piece.radius {
                    let place = |number: i64| number.rem_euclid(i64::from(n)) as usize;
                    touched[place(row) * n as usize + place(column)] = true;
                }
            }
        }
    }
    touched.iter().filter(|touched| !**touched).count() as f64 / touched.len() as f64
}

/// Mean of [`missed`] over realizations and its standard error.
pub fn openness(
    realize: &(dyn Fn(u64) -> Vec<Primitive> + Sync),
    realizations: u64,
    period: DVec2,
    m: DVec3,
    n: u32,
) -> (f64, f64) {
    let one = |number: u64| {
        let mut random = SplitMix(number ^ 0x0057_7261_6967_6874);
        missed(&realize(number), period, m, n, DVec2::new(random.uniform(), random.uniform()))
    };
    let shares: Vec<f64> = (0..realizations).into_par_iter().map(one).collect();
    mean_error(shares.iter().sum(), shares.iter().map(|share| share * share).sum(), realizations as f64)
}

/// The direction of light from an angle to the normal and an azimuth in degrees.
pub fn ray(theta: f64, phi: f64) -> DVec3 {
    let ((sin, cos), (y, x)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    -DVec3::new(sin * x, sin * y, cos)
}
