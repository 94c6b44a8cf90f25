//! The grid of fiber directions: equal-area cells of the hemisphere E⁺ (p and −p are one fiber).

use crate::concentric::{Patch, disc_to_square, square_to_disc};
use glam::{DVec2, DVec3};

/// Number of segments in which each half of the horizon is held.
const SEGMENTS: u32 = 16;

/// Square cells of the concentric map of the hemisphere by solid angle, disc radius √(1 − z).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DirectionGrid {
    /// Cells along an edge of the square; `n²` directions in all.
    pub n: u32,
}

impl DirectionGrid {
    /// All cells; each holds the solid angle 2π/n².
    pub fn cells(&self) -> impl Iterator<Item = Patch> + use<> {
        let n = self.n;
        (0..n * n).map(move |index| Patch::cell(n, index % n, index / n))
    }

    /// The index of the cell that holds a direction of either sign.
    pub fn cell_of(&self, direction: DVec3) -> usize {
        let square = square_of(direction);
        let along = |t: f64| ((f64::from(self.n) * (t + 1.0) / 2.0) as u32).min(self.n - 1);
        (along(square.y) * self.n + along(square.x)) as usize
    }

    /// An angle that hardly any cell exceeds from edge to edge.
    pub fn cell_angle(&self) -> f64 {
        3.0 / f64::from(self.n)
    }

    /// The largest length of which the extents of cells and horizon segments are whole multiples.
    pub fn unit(&self) -> f64 {
        1.0 / f64::from(SEGMENTS * self.n)
    }
}

/// Half of the horizon (z = 0), cut into segments of equal azimuth; the other half holds the same fibers.
pub fn horizon() -> impl Iterator<Item = Patch> {
    let length = 2.0 / f64::from(SEGMENTS);
    let start = move |index: u32| f64::from(index) * length - 1.0;
    let right = (0..SEGMENTS)
        .map(move |index| Patch { corner: DVec2::new(1.0, start(index)), extent: DVec2::new(0.0, length) });
    let upper = (0..SEGMENTS)
        .map(move |index| Patch { corner: DVec2::new(start(index), 1.0), extent: DVec2::new(length, 0.0) });
    right.chain(upper)
}

/// The fiber direction p ∈ E⁺ at a point of the square.
pub fn direction_of(square: DVec2) -> DVec3 {
    let disc = square_to_disc(square);
    let area = disc.length_squared();
    // sin θ = √(1 − z²) = r √(2 − r²) with z = 1 − r².
    (disc * (2.0 - area).sqrt()).extend(1.0 - area)
}

/// The point of the square that holds a fiber direction of either sign.
pub fn square_of(direction: DVec3) -> DVec2 {
    let up = if direction.z < 0.0 { -direction } else { direction };
    disc_to_square(up.truncate() / (1.0 + up.z).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_come_back_from_the_square() {
        for (x, y, z) in [(0.0, 0.0, 1.0), (0.3, -0.4, 0.2), (-1.0, 0.2, 0.0), (0.0, 1.0, 1e-9), (-0.5, -0.5, 0.7)] {
            let direction = DVec3::new(x, y, z).normalize();
            let back = direction_of(square_of(direction));
            assert!((back - direction).length() < 1e-14, "{direction} came back as {back}");
            let same_fiber = direction_of(square_of(-direction)).cross(direction).length();
            assert!(same_fiber < 1e-14, "-p is not the fiber of p = {direction}");
        }
    }

    #[test]
    fn an_isotropic_grid_has_the_moments_of_the_hemisphere() {
        // ⟨z⟩ = 1/2, ⟨z²⟩ = ⟨x²⟩ = 1/3, with 64 midpoints a cell and edge.
        let (mut first, mut second, mut across, mut count) = (0.0, 0.0, 0.0, 0.0);
        for cell in (DirectionGrid { n: 4 }).cells() {
            for i in 0..64 {
                for j in 0..64 {
                    let p = direction_of(cell.at((DVec2::new(f64::from(i), f64::from(j)) + 0.5) / 64.0));
                    first += p.z;
                    second += p.z * p.z;
                    across += p.x * p.x;
                    count += 1.0;
                }
            }
        }
        assert!((first / count - 0.5).abs() < 1e-4);
        assert!((second / count - 1.0 / 3.0).abs() < 1e-4);
        assert!((across / count - 1.0 / 3.0).abs() < 1e-4);
    }

    #[test]
    fn the_horizon_covers_half_a_turn_evenly() {
        let segments: Vec<Patch> = horizon().collect();
        let mut azimuths: Vec<f64> =
            segments.iter().map(|s| direction_of(s.centre())).map(|p| p.y.atan2(p.x)).collect();
        azimuths.sort_by(f64::total_cmp);
        let step = std::f64::consts::PI / segments.len() as f64;
        for pair in azimuths.windows(2) {
            assert!((pair[1] - pair[0] - step).abs() < 1e-12);
        }
        assert!(segments.iter().all(|s| direction_of(s.centre()).z.abs() < 1e-15));
    }
}
