//! A ray through a circular cylinder, followed segment by segment: intersections, vector Snell, Fresnel. It never uses
//! the closed form.

use super::SplitMix;
use glam::DVec3;

/// A ray inside or outside a cylinder of radius 1 about the line through the origin along `axis`.
#[derive(Clone, Copy, Debug)]
pub struct Trace {
    axis: DVec3,
    ior: f64,
    /// Where the ray meets the surface.
    pub point: DVec3,
    /// Its direction before the interface.
    pub direction: DVec3,
    inside: bool,
    /// Length of the way inside so far.
    pub path: f64,
    /// Straight pieces inside so far.
    pub chords: u32,
}

impl Trace {
    /// A ray along `m` that hits the cylinder at offset α: n = √(1−α²) ((m·p)p − m)/|m×p| + α m×p/|m×p|.
    pub fn hit(m: DVec3, axis: DVec3, offset: f64, ior: f64) -> Trace {
        let across = m.cross(axis);
        let normal = ((1.0 - offset * offset).sqrt() * (axis * m.dot(axis) - m) + offset * across) / across.length();
        Trace { axis, ior, point: normal, direction: m, inside: false, path: 0.0, chords: 0 }
    }

    /// Outward normal at the point.
    pub fn normal(&self) -> DVec3 {
        (self.point - self.axis * self.point.dot(self.axis)).normalize()
    }

    /// Unpolarised reflectance of the interface ahead.
    pub fn reflectance(&self) -> f64 {
        self.fresnel(self.normal())
    }

    /// Unpolarised reflectance of a plane with this normal, from the angles on both sides.
    fn fresnel(&self, normal: DVec3) -> f64 {
        let cos_i = self.direction.dot(normal).abs();
        let ratio = if self.inside { self.ior } else { 1.0 / self.ior };
        let sin_t = ratio * (1.0 - cos_i * cos_i).max(0.0).sqrt();
        if sin_t >= 1.0 {
            return 1.0;
        }
        let (i, t) = (cos_i.min(1.0).acos(), sin_t.asin());
        if i + t < 1e-6 {
            return ((self.ior - 1.0) / (self.ior + 1.0)).powi(2);
        }
        // Fresnel: sine and tangent laws.
        0.5 * (((i - t).sin() / (i + t).sin()).powi(2) + ((i - t).tan() / (i + t).tan()).powi(2))
    }

    /// Reflect at the interface.
    pub fn reflect(&mut self) {
        let normal = self.normal();
        self.direction -= 2.0 * self.direction.dot(normal) * normal;
        self.cross_if_inside();
    }

    /// Refract through the interface.
    pub fn refract(&mut self) {
        self.bend(self.normal());
        self.inside = !self.inside;
        self.cross_if_inside();
    }

    /// Snell's law at a plane with this normal, of either sign.
    fn bend(&mut self, normal: DVec3) {
        let normal = if self.direction.dot(normal) > 0.0 { -normal } else { normal };
        let ratio = if self.inside { self.ior } else { 1.0 / self.ior };
        let cos_i = -self.direction.dot(normal);
        let cos_t = (1.0 - ratio * ratio * (1.0 - cos_i * cos_i)).max(0.0).sqrt();
        self.direction = (ratio * self.direction + (ratio * cos_i - cos_t) * normal).normalize();
    }

    /// Go to the next intersection with the surface, if the ray runs inside.
    fn cross_if_inside(&mut self) {
        if !self.inside {
            return;
        }
        let flat = |v: DVec3| v - self.axis * v.dot(self.axis);
        let (o, d) = (flat(self.point), flat(self.direction));
        // |o + t d| = 1 with |o| = 1: the root that is not 0.
        let t = -2.0 * o.dot(d) / d.length_squared();
        self.point += self.direction * t;
        self.path += t;
        self.chords += 1;
    }

    /// Leave after exactly `chords` chords.
    pub fn leave_after(mut self, chords: u32) -> Trace {
        if chords == 0 {
            self.reflect();
            return self;
        }
        self.refract();
        for _ in 1..chords {
            self.reflect();
        }
        self.refract();
        self
    }

    /// Leave after a random number of chords: one decision at each interface.
    pub fn leave_at_random(mut self, random: &mut SplitMix) -> Trace {
        if random.uniform() < self.reflectance() {
            self.reflect();
            return self;
        }
        self.refract();
        while random.uniform() < self.reflectance() {
            self.reflect();
        }
        self.refract();
        self
    }

    /// Leave after a random number of chords a cylinder that ends at `half_length` from the hit on both sides: one
    /// decision at each interface, side or base. Also tells whether the light left through a base.
    pub fn leave_short_at_random(mut self, half_length: f64, random: &mut SplitMix) -> (Trace, bool) {
        let mut from = self.point;
        let middle = from.dot(self.axis);
        if random.uniform() < self.reflectance() {
            self.reflect();
            return (self, false);
        }
        self.refract();
        loop {
            let beyond = (self.point.dot(self.axis) - middle).abs() - half_length;
            if beyond > 0.0 {
                // Go back to the base.
                let back = beyond / self.direction.dot(self.axis).abs();
                self.point -= self.direction * back;
                self.path -= back;
                if random.uniform() >= self.fresnel(self.axis) {
                    self.bend(self.axis);
                    return (self, true);
                }
                from = self.point;
                self.direction -= 2.0 * self.direction.dot(self.axis) * self.axis;
                let flat = |v: DVec3| v - self.axis * v.dot(self.axis);
                let (o, d) = (flat(from), flat(self.direction));
                let (half, square) = (o.dot(d), d.length_squared());
                let t = ((half * half + square * (1.0 - o.length_squared()).max(0.0)).sqrt() - half) / square;
                self.point = from + self.direction * t;
                self.path += t;
            } else if random.uniform() < self.reflectance() {
                self.reflect();
            } else {
                self.refract();
                return (self, false);
            }
        }
    }
}
