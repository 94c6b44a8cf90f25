//! One random draw of all fibers, whole and as straight pieces.

use super::curves::Curve;
use super::repeat::Cloth;
use glam::{DVec2, DVec3};

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
    /// Index of the thread in [`Cloth::threads`], or of the population in [`Sheet::fibers`](crate::scene::Sheet::fibers).
    pub thread: usize,
}

/// One random draw of all fibers of a periodic element; lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Realization {
    /// The fibers, each once; they go on into neighbouring elements, and the element repeats along x and y.
    pub fibers: Vec<Curve>,
    /// Size of the element along x and y.
    pub period: DVec2,
    /// The cloth fills 0 ≥ z ≥ −thickness.
    pub thickness: f64,
}

impl Realization {
    /// The straight pieces of all fibers; those of a fiber follow each other.
    pub fn pieces(&self) -> Vec<Primitive> {
        self.fibers.iter().flat_map(|fiber| fiber.pieces(self.period)).collect()
    }
}

impl Curve {
    /// Its straight pieces in an element with this period in mm, in their order. A piece without length is left out.
    pub fn pieces(&self, period: DVec2) -> impl Iterator<Item = Primitive> {
        self.points.windows(2).filter_map(move |ends| {
            let [last, next] = [ends[0], ends[1]];
            let (along, length) = (next - last, next.distance(last));
            let (centre, direction) = (wrap((last + next) / 2.0, period), along / length);
            let Curve { radius, kind, thread, .. } = *self;
            (length > 0.0).then_some(Primitive { centre, direction, length, radius, kind, thread })
        })
    }
}

impl Cloth {
    /// Draw the places of all fibers of the repeat: a function of the seed and the number of the draw.
    pub fn draw(&self, seed: u64, number: u64) -> Realization {
        let mut fibers = Vec::new();
        for thread in 0..self.threads().len() {
            self.draw_thread(seed, number, thread, &mut |curve| fibers.push(curve.clone()));
        }
        Realization { fibers, period: self.period(), thickness: self.thickness() }
    }

    /// The pieces of [`Cloth::draw`], which need less memory than fibers and pieces.
    pub fn realize(&self, seed: u64, number: u64) -> Vec<Primitive> {
        let mut pieces = Vec::with_capacity(self.expected_pieces());
        for thread in 0..self.threads().len() {
            self.realize_thread(seed, number, thread, &mut |piece| pieces.push(piece));
        }
        pieces
    }

    /// Draw the pieces of one thread, the same as in [`Cloth::realize`]; pieces of a fiber follow each other.
    pub fn realize_thread(&self, seed: u64, number: u64, thread: usize, take: &mut dyn FnMut(Primitive)) {
        self.draw_thread(seed, number, thread, &mut |curve| curve.pieces(self.period()).for_each(&mut *take));
    }
}

/// The image of a point inside the element.
fn wrap(point: DVec3, period: DVec2) -> DVec3 {
    let wrap = |x: f64, period: f64| {
        let x = x.rem_euclid(period);
        if x < period { x } else { 0.0 }
    };
    DVec3::new(wrap(point.x, period.x), wrap(point.y, period.y), point.z)
}
