//! One random draw of all fibers, as straight pieces.

use super::curves::Curve;
use super::repeat::Cloth;
use glam::DVec3;

/// A straight piece of a fiber; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primitive {
    /// Its middle: 0 ≤ x, y < period. Its ends may lie in the next repeat.
    pub centre: DVec3,
    /// Unit vector along it; it points to where its thread goes.
    pub direction: DVec3,
    /// Its length.
    pub length: f64,
    /// Radius of the fiber.
    pub radius: f64,
    /// Index of the kind of fiber in the scene.
    pub kind: usize,
    /// Index of the thread in [`Cloth::threads`].
    pub thread: usize,
}

impl Cloth {
    /// Draw the places of all fibers of the repeat: a function of the seed and the number of the draw.
    pub fn realize(&self, seed: u64, number: u64) -> Vec<Primitive> {
        let mut pieces = Vec::with_capacity(self.expected_pieces());
        for thread in 0..self.threads().len() {
            self.realize_thread(seed, number, thread, &mut |piece| pieces.push(piece));
        }
        pieces
    }

    /// Draw the fibers of one thread, the same as in [`Cloth::realize`]; pieces of a fiber follow each other.
    pub fn realize_thread(&self, seed: u64, number: u64, thread: usize, take: &mut dyn FnMut(Primitive)) {
        self.draw_thread(seed, number, thread, &mut |curve: &Curve| {
            for ends in curve.points.windows(2) {
                let [last, next] = [ends[0], ends[1]];
                let (along, length) = (next - last, next.distance(last));
                if length > 0.0 {
                    let (centre, direction) = (self.wrap((last + next) / 2.0), along / length);
                    take(Primitive { centre, direction, length, radius: curve.radius, kind: curve.kind, thread });
                }
            }
        });
    }

    /// The image of a point inside the repeat.
    fn wrap(&self, point: DVec3) -> DVec3 {
        let wrap = |x: f64, period: f64| {
            let x = x.rem_euclid(period);
            if x < period { x } else { 0.0 }
        };
        DVec3::new(wrap(point.x, self.period().x), wrap(point.y, self.period().y), point.z)
    }
}
