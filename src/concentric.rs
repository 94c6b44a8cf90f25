//! The concentric map between the square [−1, 1]² and the unit disc, and patches of the square.
//!
//! Shirley and Chiu, "A Low Distortion Map Between Disk and Square", Journal of Graphics Tools 2(3), 1997.
//! The map keeps ratios of areas. Two hemispheres are laid on the disc: the goniometer's, by *projected* solid angle
//! (disc radius sin θ), and the fiber directions', by solid angle (disc radius √(1 − cos θ)).

use glam::DVec2;
use std::f64::consts::FRAC_PI_4;

/// Map a point of the square to the unit disc.
pub fn square_to_disc(square: DVec2) -> DVec2 {
    let DVec2 { x: a, y: b } = square;
    if a == 0.0 && b == 0.0 {
        DVec2::ZERO
    } else if a.abs() >= b.abs() {
        let angle = FRAC_PI_4 * b / a;
        DVec2::new(a * angle.cos(), a * angle.sin())
    } else {
        let angle = FRAC_PI_4 * a / b;
        DVec2::new(b * angle.sin(), b * angle.cos())
    }
}

/// Map a point of the unit disc to the square; the inverse of [`square_to_disc`].
pub fn disc_to_square(disc: DVec2) -> DVec2 {
    let radius = disc.length();
    if radius == 0.0 {
        DVec2::ZERO
    } else if disc.x.abs() >= disc.y.abs() {
        let a = radius.copysign(disc.x);
        DVec2::new(a, a * (disc.y / disc.x).atan() / FRAC_PI_4)
    } else {
        let b = radius.copysign(disc.y);
        DVec2::new(b * (disc.x / disc.y).atan() / FRAC_PI_4, b)
    }
}

/// A rectangle of the square; an extent of 0 makes it a segment or a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// The corner of smallest coordinates, in [−1, 1]².
    pub corner: DVec2,
    /// The edges, each ≥ 0.
    pub extent: DVec2,
}

impl Patch {
    /// One cell of the square cut into `n` × `n`; column along the first coordinate.
    pub fn cell(n: u32, column: u32, row: u32) -> Patch {
        let edge = 2.0 / f64::from(n);
        Patch {
            corner: DVec2::new(f64::from(column) * edge - 1.0, f64::from(row) * edge - 1.0),
            extent: DVec2::splat(edge),
        }
    }

    /// The point at `fraction` ∈ [0, 1]² of the patch.
    pub fn at(&self, fraction: DVec2) -> DVec2 {
        self.corner + self.extent * fraction
    }

    /// The bits of the four numbers: equal patches have equal keys.
    pub fn key(&self) -> [u64; 4] {
        [self.corner.x, self.corner.y, self.extent.x, self.extent.y].map(f64::to_bits)
    }

    /// The middle of the patch.
    pub fn centre(&self) -> DVec2 {
        self.at(DVec2::splat(0.5))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_maps_are_inverse_to_each_other() {
        for i in 0..41 {
            for j in 0..41 {
                let square = DVec2::new(f64::from(i), f64::from(j)) / 20.0 - 1.0;
                let back = disc_to_square(square_to_disc(square));
                assert!((back - square).length() < 1e-14, "{square} came back as {back}");
            }
        }
    }

    #[test]
    fn equal_areas_of_the_square_are_equal_areas_of_the_disc() {
        // The Jacobian by central differences must be π/4 everywhere off the diagonals.
        let step = 1e-5;
        for (a, b) in [(0.3, 0.1), (0.1, -0.7), (-0.9, 0.2), (-0.05, 0.4), (0.99, -0.98)] {
            let at = |da: f64, db: f64| square_to_disc(DVec2::new(a + da, b + db));
            let da = (at(step, 0.0) - at(-step, 0.0)) / (2.0 * step);
            let db = (at(0.0, step) - at(0.0, -step)) / (2.0 * step);
            let jacobian = da.perp_dot(db);
            assert!((jacobian - FRAC_PI_4).abs() < 1e-8, "({a}, {b}): {jacobian}");
        }
    }
}
