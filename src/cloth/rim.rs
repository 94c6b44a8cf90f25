//! The surface of a yarn, in its section.

use glam::DVec2;

/// Points of the ellipse that are looked at for a bound.
const LOOKED_AT: u32 = 256;
/// What the bounds are raised by, since the ellipse is looked at in points.
const SLACK: f64 = 1.05;

/// The ellipse on which the axes of the outermost fibers of a yarn lie, and the curves at a distance from it.
#[derive(Clone, Copy, Debug)]
pub struct Rim {
    /// Semi-axes in mm, above 0.
    pub half: DVec2,
}

impl Rim {
    /// The point over the eccentric angle `angle` at a distance outside of the ellipse in mm.
    pub fn point(&self, angle: f64, height: f64) -> DVec2 {
        let DVec2 { x: a, y: b } = self.half;
        let (sin, cos) = angle.sin_cos();
        DVec2::new(a * cos, b * sin) + height * DVec2::new(b * cos, a * sin).normalize_or_zero()
    }

    /// |d(point)/d(angle)| in mm.
    pub fn speed(&self, angle: f64, height: f64) -> f64 {
        self.length(angle) + height * self.turn(angle)
    }

    /// Curvature of the curve at that distance in 1/mm.
    pub fn curvature(&self, angle: f64, height: f64) -> f64 {
        self.turn(angle) / self.speed(angle, height)
    }

    /// Largest first and second derivative of the point by the angle, in mm.
    pub fn bounds(&self, height: f64) -> [f64; 2] {
        let DVec2 { x: a, y: b } = self.half;
        let mut bounds = [0.0f64; 2];
        for point in 0..LOOKED_AT {
            let angle = f64::from(point) / f64::from(LOOKED_AT) * std::f64::consts::TAU;
            // The normal turns by θ; |n″| ≤ |θ″| + θ′².
            let turn = self.turn(angle);
            let faster = a * b * (a * a - b * b).abs() * (2.0 * angle).sin().abs() / self.length(angle).powi(4);
            let second = self.half.max_element() + height * (faster + turn * turn);
            bounds = [bounds[0].max(self.speed(angle, height)), bounds[1].max(second)];
        }
        bounds.map(|bound| SLACK * bound)
    }

    /// |d(ellipse)/d(angle)| in mm.
    fn length(&self, angle: f64) -> f64 {
        let (sin, cos) = angle.sin_cos();
        (self.half.x * sin).hypot(self.half.y * cos)
    }

    /// How fast the normal turns: dθ/d(angle) with tan θ = (a/b) tan(angle).
    fn turn(&self, angle: f64) -> f64 {
        self.half.x * self.half.y / self.length(angle).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_differences_and_stay_below_the_bounds() {
        let rim = Rim { half: DVec2::new(0.3, 0.1) };
        for height in [0.0, 0.2] {
            let [first, second] = rim.bounds(height);
            for step in 0..100 {
                let angle = 0.063 * f64::from(step);
                let e = 1e-4;
                let [a, b, c] = [-e, 0.0, e].map(|off| rim.point(angle + off, height));
                let speed = (c - a).length() / (2.0 * e);
                assert!((speed - rim.speed(angle, height)).abs() < 1e-6 * speed, "{angle}");
                let (along, bend) = ((c - a) / (2.0 * e), (a - 2.0 * b + c) / (e * e));
                let curvature = along.perp_dot(bend) / speed.powi(3);
                assert!((curvature / rim.curvature(angle, height) - 1.0).abs() < 1e-4, "{angle}: {curvature}");
                assert!(speed <= first && bend.length() <= second);
            }
        }
    }
}
