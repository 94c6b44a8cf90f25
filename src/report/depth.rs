//! The depth buffer: which fiber is seen where.

use super::view::{Face, View};
use crate::cloth::{Cloth, Primitive, System};
use glam::{DVec2, DVec3};

/// How far a piece is drawn over its ends, in radii: pieces that meet at an angle leave no gap.
const OVERLAP: f64 = 0.1;
/// Cosine of the angle to the picture below which the side of a fiber is not drawn.
const END_ON: f64 = 1e-3;

/// What is seen at a point of the buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// How near it is in mm, along the direction to the one who looks; −∞ where there is nothing.
    pub near: f32,
    /// Index of the thread in [`Cloth::threads`](crate::cloth::Cloth::threads).
    pub thread: u32,
    /// Index of the kind of fiber in the scene.
    pub kind: u16,
    /// Its outward normal in the frame of the picture in 1/127; of a fiber that is cut, the way from its axis in radii.
    normal: [i8; 3],
    /// Whether the fiber is cut open here.
    pub cut: bool,
}

impl Seen {
    const NOTHING: Seen = Seen { near: f32::NEG_INFINITY, thread: 0, kind: 0, normal: [0; 3], cut: false };

    /// Whether no fiber is seen.
    pub fn is_nothing(&self) -> bool {
        self.near == f32::NEG_INFINITY
    }

    /// The normal.
    pub fn normal(&self) -> [f32; 3] {
        self.normal.map(|part| f32::from(part) / 127.0)
    }
}

/// One repeat of the cloth as it is seen from one side. It goes on periodically to the right, and up in a view of a face.
#[derive(Clone, Debug)]
pub struct Depth {
    view: View,
    /// Columns and rows; the rows go up.
    size: [usize; 2],
    /// Height of the lowest row's lower edge in mm.
    bottom: f64,
    /// Columns and rows to a mm.
    per_mm: DVec2,
    seen: Vec<Seen>,
}

impl Depth {
    /// An empty buffer for one repeat of a face, of so many columns and rows.
    pub fn face(cloth: &Cloth, face: Face, size: [usize; 2]) -> Depth {
        Depth::of_face(cloth.period(), face, size)
    }

    /// The same for a cloth whose repeat has this size in mm.
    pub(super) fn of_face(period: DVec2, face: Face, size: [usize; 2]) -> Depth {
        let view = View::face(period, face);
        let per_mm = DVec2::new(size[0] as f64, size[1] as f64) / period;
        Depth { view, size, bottom: 0.0, per_mm, seen: vec![Seen::NOTHING; size[0] * size[1]] }
    }

    /// An empty buffer for one repeat of a cut along the threads of a system, through the plane x = `at` (warp) or y = `at`
    /// (weft), from the height `bottom` up to `top`; z is up. Along the warp y runs to the right and one looks along −x;
    /// along the weft x runs to the right and one looks along y.
    pub fn along(cloth: &Cloth, system: System, at: f64, [bottom, top]: [f64; 2], size: [usize; 2]) -> Depth {
        let view = View::along(cloth, system, at);
        let per_mm = DVec2::new(size[0] as f64 / view.period.x, size[1] as f64 / (top - bottom));
        Depth { view, size, bottom, per_mm, seen: vec![Seen::NOTHING; size[0] * size[1]] }
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Where the cut lies in mm along the direction to the one who looks.
    pub(super) fn plane(&self) -> f64 {
        self.view.cut
    }

    /// What is seen at a column from the left and a row from below.
    pub fn at(&self, column: usize, row: usize) -> &Seen {
        &self.seen[row * self.size[0] + column]
    }

    /// What is seen at a point in mm to the right and up, of any repeat.
    pub fn at_point(&self, point: DVec2) -> &Seen {
        let place = (point - DVec2::new(0.0, self.bottom)) * self.per_mm;
        let index = |place: f64, size: usize| (place.floor() as i64).rem_euclid(size as i64) as usize;
        self.at(index(place.x, self.size[0]), index(place.y, self.size[1]))
    }

    /// Share of the buffer where nothing is seen.
    pub fn openness(&self) -> f64 {
        self.seen.iter().filter(|seen| seen.is_nothing()).count() as f64 / self.seen.len() as f64
    }

    /// Draw a piece of a fiber as a cylinder.
    pub fn draw(&mut self, piece: &Primitive) {
        let (p, half) = (self.view.turn(piece.direction), piece.length / 2.0 + OVERLAP * piece.radius);
        let reach = p.abs() * half + piece.radius;
        let mut centre = self.view.turn(piece.centre);
        if self.view.cut.is_finite() {
            // Of all images take the one that the plane cuts, or the nearest behind it.
            let (period, edge) = (self.view.period.z, self.view.cut + reach.z);
            centre.z = edge - (edge - centre.z).rem_euclid(period);
            if centre.z + reach.z < self.view.cut - self.view.reach {
                return;
            }
        }
        let cylinder = Cylinder { centre, p, half, radius: piece.radius, level: p.x.hypot(p.y) };
        let mark = Seen { thread: piece.thread as u32, kind: piece.kind as u16, ..Seen::NOTHING };
        let nearest = if self.view.cut.is_finite() { f32::INFINITY } else { (centre.z + reach.z) as f32 };
        // Go over the points that the piece can cover.
        let range = |axis: usize, offset: f64| {
            let (middle, reach) = ((centre[axis] - offset) * self.per_mm[axis], reach[axis] * self.per_mm[axis]);
            ((middle - reach - 0.5).ceil() as i64, (middle + reach - 0.5).floor() as i64)
        };
        let ((left, right), (low, high)) = (range(0, 0.0), range(1, self.bottom));
        let [columns, rows] = self.size.map(|size| size as i64);
        for row in low..=high {
            let inside = if self.view.period.y.is_finite() { row.rem_euclid(rows) } else { row };
            if !(0..rows).contains(&inside) {
                continue;
            }
            let start = inside as usize * self.size[0];
            let y = (row as f64 + 0.5) / self.per_mm.y + self.bottom - centre.y;
            for column in left..=right {
                let x = (column as f64 + 0.5) / self.per_mm.x - centre.x;
                let seen = &mut self.seen[start + column.rem_euclid(columns) as usize];
                // Pass by what is hidden.
                if nearest > seen.near {
                    cylinder.see(DVec2::new(x, y), self.view.cut, mark, seen);
                }
            }
        }
    }
}

/// A piece of a fiber in the frame of the picture.
struct Cylinder {
    centre: DVec3,
    /// Its direction.
    p: DVec3,
    /// Half its length.
    half: f64,
    radius: f64,
    /// Length of `p` in the picture.
    level: f64,
}

impl Cylinder {
    /// Let a point show this piece if it is nearer; the point is given from the middle of the piece.
    fn see(&self, point: DVec2, cut: f64, mark: Seen, seen: &mut Seen) {
        // Show the plane of the cut where it runs inside the fiber.
        if cut.is_finite() {
            let inside = point.extend(cut - self.centre.z);
            let along = inside.dot(self.p);
            let off = inside - along * self.p;
            if along.abs() <= self.half && off.length_squared() <= self.radius.powi(2) {
                // Of overlapping fibers show the one whose axis is nearest.
                let share = off.length() / self.radius;
                if !seen.cut || share < f64::from(seen.normal[0]) / 127.0 {
                    let normal = [(127.0 * share) as i8, 0, 0];
                    *seen = Seen { near: cut as f32, normal, cut: true, ..mark };
                }
                return;
            }
        }
        if seen.cut || self.level < END_ON {
            return;
        }
        let level = self.p.truncate() / self.level;
        let across = level.perp_dot(point);
        let square = self.radius.powi(2) - across * across;
        if square < 0.0 {
            return;
        }
        // The near side: point = t p + across n + rise (−p_z level, |p_xy|), n = the horizontal normal.
        let rise = square.sqrt();
        let along = level.dot(point);
        let t = (along + rise * self.p.z) / self.level;
        let near = (self.centre.z + t * self.p.z + rise * self.level) as f32;
        if t.abs() > self.half || near <= seen.near || f64::from(near) > cut {
            return;
        }
        let flat = level.perp() * across - level * (rise * self.p.z);
        let normal = flat.extend(rise * self.level) / self.radius * 127.0;
        *seen = Seen { near, normal: [normal.x as i8, normal.y as i8, normal.z as i8], ..mark };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, Source};

    fn voile() -> Cloth {
        let scene = Scene::parse(&Source::find("voile").expect("it is a preset")).expect("it is right");
        Cloth::new(&scene).expect("it can be laid out")
    }

    fn piece(direction: DVec3) -> Primitive {
        let centre = DVec3::new(0.4, 0.3, -0.1);
        Primitive { centre, direction: direction.normalize(), length: 0.2, radius: 0.03, kind: 0, thread: 3 }
    }

    #[test]
    fn a_cylinder_is_seen_where_its_near_side_is() {
        let cloth = voile();
        for direction in [DVec3::X, DVec3::new(0.5, 0.7, 0.4), DVec3::new(-0.3, 0.2, -0.9)] {
            for (face, side) in [(Face::Front, 1.0), (Face::Back, -1.0)] {
                let mut depth = Depth::face(&cloth, face, [400, 400]);
                let piece = piece(direction);
                depth.draw(&piece);
                let mut found = 0;
                for place in 0..160_000 {
                    let (column, row) = (place % 400, place / 400);
                    let seen = depth.at(column, row);
                    if seen.is_nothing() {
                        continue;
                    }
                    found += 1;
                    let share = |index: usize| (index as f64 + 0.5) / 400.0;
                    let (x, y) = (share(column) * cloth.period().x, share(row) * cloth.period().y);
                    let x = if side > 0.0 { x } else { cloth.period().x - x };
                    // The point lies on the surface, and one nearer to the eye lies outside.
                    let off = |lift: f64| {
                        let point = DVec3::new(x, y, side * (f64::from(seen.near) + lift)) - piece.centre;
                        (point - point.dot(piece.direction) * piece.direction).length()
                    };
                    assert!((off(0.0) - piece.radius).abs() < 1e-6 && off(1e-3) > piece.radius, "{direction}");
                }
                // The side of a cylinder covers 2 R L |p_xy|, its length as it is drawn; 29 rows go to its width.
                let area = 2.0 * piece.radius * (piece.length + 2.0 * OVERLAP * piece.radius);
                let covered = f64::from(found) / 160_000.0 * cloth.period().x * cloth.period().y;
                let expected = area * piece.direction.truncate().length();
                assert!((covered / expected - 1.0).abs() < 0.04, "{covered} and {expected}");
            }
        }
    }

    #[test]
    fn a_cut_shows_the_section_of_a_fiber() {
        let cloth = voile();
        let piece = piece(DVec3::new(0.8, 0.6, 0.0));
        let cut = |at: f64| {
            let mut depth = Depth::along(&cloth, System::Warp, at, [-0.25, 0.0], [800, 240]);
            depth.draw(&piece);
            let cut = depth.seen.iter().filter(|seen| seen.cut).count() as f64;
            let all = depth.seen.iter().filter(|seen| !seen.is_nothing()).count() as f64;
            [cut, all].map(|count| count / (800.0 * 240.0) * cloth.period().y * 0.25)
        };
        // The plane across x cuts an ellipse of π R² / p_x; in a plane before the fiber it is whole, behind it is nothing.
        let section = std::f64::consts::PI * piece.radius.powi(2) / 0.8;
        assert!((cut(0.4)[0] / section - 1.0).abs() < 0.01 && cut(0.4)[1] > cut(0.4)[0]);
        assert!(cut(0.53)[0] == 0.0 && cut(0.53)[1] > section);
        assert_eq!(cut(0.27), [0.0; 2]);
    }
}
