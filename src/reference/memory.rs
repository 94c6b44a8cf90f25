//! What a walk remembers: its last flight met nothing on its way, and the fiber where that flight set out is still there.
//!
//! A medium draws all fibers anew after each hit. Light that comes back from a fiber flies through a corridor that it knows to be
//! free, as leaves of a canopy do not shade what they let the sun shine on (the hot spot: Kuusk 1985), and may meet the fiber that
//! sent it. For straight fibers laid independently both are exact: a fiber that the last flight would have met is not there,
//! and all others are as likely as before.

use super::carried::Touch;
use super::walk::Witness;
use crate::walk::STRAIGHT;
use glam::DVec3;

/// A fiber that light went through.
#[derive(Clone, Copy, Debug)]
struct Body {
    /// A point of its axis, from where the present flight set out, in mm.
    axis: DVec3,
    p: DVec3,
    radius: f64,
    kind: usize,
}

/// Where a flight meets a fiber that is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    /// Way from where the flight set out, in mm.
    distance: f64,
    /// By how much errors grow at a hit whose offset is not drawn but found.
    pub growth: f64,
    pub p: DVec3,
    pub offset: f64,
    pub kind: usize,
}

/// What a walk remembers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Memory {
    /// Thickness of the cloth in mm, and half the length of a fiber in radii that may be taken for straight.
    thickness: f64,
    reach: f64,
    /// Way flown since the last fiber was left.
    flown: f64,
    /// From where to where the last flight went, seen from where the present one set out; none before the first hit.
    last: Option<[DVec3; 2]>,
    /// The fiber that was left last.
    left: Option<Body>,
    /// The one that was left before, where the present flight meets it.
    known: Option<Known>,
}

impl Memory {
    /// Of a walk that sets out; bases lie `half_length` radii from a hit.
    pub fn new(thickness: f64, half_length: f64) -> Memory {
        let reach = half_length.min(STRAIGHT);
        Memory { thickness, reach, flown: 0.0, last: None, left: None, known: None }
    }

    /// Fly on for `path` mm, or as far as a fiber that is known: how far, and that fiber.
    pub fn fly(&mut self, path: f64, blur: f64, witness: &mut impl Witness) -> (f64, Option<Known>) {
        let there = self.flown + path;
        let known = self.known.filter(|known| {
            witness.decide(|| (there - known.distance) / blur);
            known.distance <= there
        });
        let there = known.map_or(there, |known| known.distance);
        let path = there - self.flown;
        self.flown = there;
        (path, known)
    }

    /// Whether a fiber that the ray touches here cannot be: the last flight would have met it.
    pub fn rules_out(&self, touch: &Touch, witness: &mut impl Witness) -> bool {
        let (Some([from, to]), Some(normal)) = (self.last, touch.normal()) else { return false };
        let Touch { m, p, radius, .. } = *touch;
        let axis = m * self.flown - normal;
        let (from, to) = (from - axis, to - axis);
        let [start, end] = [from, to].map(|place| place - p * p.dot(place));
        let scale = from.length().max(to.length()).max(radius);
        // Fibers that held the start of the flight were not met.
        witness.decide(|| (start.length() - radius) / scale);
        if start.length() < radius {
            return false;
        }
        // Keep to where the fiber may be taken for straight.
        let (begin, way) = (p.dot(from), p.dot(to - from));
        let [one, other] = [-1.0, 1.0].map(|side| (side * self.reach * radius - begin) / way);
        let (low, high) = (one.min(other).max(0.0), one.max(other).min(1.0));
        witness.decide(|| (high - low) * way / scale);
        if low > high || low.is_nan() || high.is_nan() {
            return false;
        }
        let across = end - start;
        let nearest = (-start.dot(across) / across.length_squared()).clamp(low, high);
        let distance = (start + across * nearest).length();
        witness.decide(|| (distance - radius) / scale);
        distance < radius
    }

    /// The light went through a fiber of a kind, is now `displacement` mm from the hit, at the height `z`, and goes on along `out`.
    pub fn hit(
        &mut self,
        touch: &Touch,
        kind: usize,
        displacement: DVec3,
        (z, out): (f64, DVec3),
        witness: &mut impl Witness,
    ) {
        let Touch { m, p, radius, .. } = *touch;
        let back = -displacement;
        let before = self.left.map(|body| Body { axis: body.axis - m * self.flown + back, ..body });
        self.known = before.and_then(|body| self.meet(&body, z, out, witness));
        self.last = Some([back - m * self.flown, back]);
        let normal = touch.normal().unwrap_or_default();
        self.left = Some(Body { axis: back - normal, p, radius, kind });
        self.flown = 0.0;
    }

    /// Where a ray along `out` enters a fiber from outside.
    fn meet(&self, body: &Body, z: f64, out: DVec3, witness: &mut impl Witness) -> Option<Known> {
        let Body { axis, p, radius, kind } = *body;
        let across = out.cross(p);
        let visible = across.length();
        let offset = -axis.dot(across) / (visible * radius);
        let scale = axis.length().max(radius) / (radius * visible);
        witness.decide(|| (offset.abs() - 1.0) / scale);
        if offset.is_nan() || offset.abs() >= 1.0 {
            return None;
        }
        // From the axis to the hit, and from the ray's start to it.
        let normal = Touch { m: out, p, offset, radius }.normal()?;
        let facing = (p * out.dot(p) - out) / visible;
        let distance = (facing.dot(-axis) - facing.dot(normal)) / visible;
        let along = out * distance - axis;
        let height = z + (out * distance - normal).z;
        witness.decide(|| distance / (radius * scale));
        witness.decide(|| (p.dot(along).abs() / radius - self.reach) / scale);
        witness.decide(|| height.abs().min((height + self.thickness).abs()) / self.thickness);
        let near = p.dot(along).abs() <= self.reach * radius;
        let inside = (-self.thickness..=0.0).contains(&height);
        let growth = scale / (visible * (1.0 - offset * offset).sqrt());
        (distance > 0.0 && near && inside).then_some(Known { distance, growth, p, offset, kind })
    }
}
