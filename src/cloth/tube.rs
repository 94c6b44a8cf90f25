//! A straight piece of a fiber, as a body.

use super::curves::Curve;
use glam::DVec3;

/// Cosine of the sharpest bend whose pieces meet in the plane between them.
const SHARPEST: f64 = -0.5;

/// A straight piece of a fiber: a circular cylinder between the planes in which it meets the next pieces. Two cylinders of
/// one radius meet in the plane that halves the angle between them, so the pieces of a fiber make one closed surface, and
/// no point lies in two of them. An end of a fiber is cut straight across and open: no ray enters through it.
///
/// Lengths in mm. Numbers are kept in f32, to some 10⁻⁵ of a fiber's radius, in 64 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Tube {
    start: [f32; 3],
    radius: f32,
    direction: [f32; 3],
    length: f32,
    before: [f32; 3],
    fiber: u32,
    after: [f32; 3],
    kind: u32,
}

/// Where a ray enters a tube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Way along the ray, positive, in mm.
    pub distance: f64,
    /// Offset α of the ray from the axis in radii, from −1 to 1: that of the normal along m × p (paper §4).
    pub offset: f64,
}

impl Tube {
    /// The pieces of a fiber, each moved by `shift` of its own start.
    pub(super) fn of_curve(curve: &Curve, fiber: u32, shift: impl Fn(DVec3) -> DVec3, mut take: impl FnMut(Tube)) {
        let mut corners = curve.points.clone();
        corners.dedup();
        let ways: Vec<DVec3> = corners.windows(2).map(|ends| (ends[1] - ends[0]).normalize()).collect();
        for (i, &direction) in ways.iter().enumerate() {
            let between = |other: Option<&DVec3>| match other {
                Some(other) if other.dot(direction) > SHARPEST => (*other + direction).normalize(),
                _ => direction,
            };
            let before = between(i.checked_sub(1).and_then(|i| ways.get(i)));
            take(Tube {
                start: shift(corners[i]).as_vec3().to_array(),
                radius: curve.radius as f32,
                direction: direction.as_vec3().to_array(),
                length: corners[i + 1].distance(corners[i]) as f32,
                before: before.as_vec3().to_array(),
                fiber,
                after: between(ways.get(i + 1)).as_vec3().to_array(),
                kind: curve.kind as u32,
            });
        }
    }

    /// Where its axis begins.
    pub fn start(&self) -> DVec3 {
        vector(self.start)
    }

    /// Unit vector along its axis.
    pub fn direction(&self) -> DVec3 {
        vector(self.direction)
    }

    /// Length of its axis.
    pub fn length(&self) -> f64 {
        f64::from(self.length)
    }

    /// Its radius.
    pub fn radius(&self) -> f64 {
        f64::from(self.radius)
    }

    /// Index of the kind of fiber in the scene.
    pub fn kind(&self) -> usize {
        self.kind as usize
    }

    /// Index of its fiber in the realization.
    pub fn fiber(&self) -> u32 {
        self.fiber
    }

    /// How far its surface goes beyond the ends of its axis, at its start and at its end.
    pub(super) fn overhang(&self) -> [f64; 2] {
        [self.before, self.after].map(|plane| {
            let cosine = vector(plane).dot(self.direction());
            self.radius() * (1.0 / (cosine * cosine) - 1.0).max(0.0).sqrt()
        })
    }

    /// Where the ray from `origin` along the unit vector `m` enters from outside, ahead of its origin.
    pub fn meet(&self, origin: DVec3, m: DVec3) -> Option<Meeting> {
        let (p, radius) = (self.direction(), self.radius());
        let from = origin - self.start();
        let across = m.cross(p);
        let square = across.length_squared();
        let side = from.dot(across);
        // Half the chord inside the unbounded cylinder, times |m × p|², squared.
        let inside = radius * radius * square - side * side;
        if inside <= 0.0 {
            return None;
        }
        let distance = (m.dot(p) * from.dot(p) - from.dot(m) - inside.sqrt()) / square;
        let place = from + m * distance;
        let between =
            place.dot(vector(self.before)) >= 0.0 && (place - p * self.length()).dot(vector(self.after)) < 0.0;
        (distance > 0.0 && between).then(|| Meeting { distance, offset: side / (radius * square.sqrt()) })
    }

    /// Whether it holds a point.
    pub fn holds(&self, point: DVec3) -> bool {
        let (p, radius) = (self.direction(), self.radius());
        let from = point - self.start();
        let between = from.dot(vector(self.before)) >= 0.0 && (from - p * self.length()).dot(vector(self.after)) < 0.0;
        between && from.length_squared() - from.dot(p).powi(2) < radius * radius
    }
}

fn vector(numbers: [f32; 3]) -> DVec3 {
    DVec3::from_array(numbers.map(f64::from))
}
