//! Fibers as chains of corners in one array.

use super::cut::planes;
use glam::{DVec2, DVec3};

/// Longest piece in radii of its fiber.
pub const LONGEST: f64 = 6.0;
/// Corners nearer to each other than this, in radii, are left out where the fiber is straight.
const SHORTEST: f64 = 1.5;
/// It is straight where the corners that are left out lie this near to it, in radii.
const STRAIGHT: f64 = 0.02;
/// A point this near a face, in shares of the thickness, lies on it.
const ON_FACE: f64 = 1e-9;
/// A fiber goes on where it started, some periods on, when it ends this near to there, in radii.
const JOINED: f64 = 1e-6;

/// A fiber as it was laid.
#[derive(Clone, Copy, Debug)]
pub struct Laid<'a> {
    /// Its corners in mm.
    pub points: &'a [DVec3],
    /// Its radius in mm.
    pub radius: f64,
    /// The thread that it was cut with; none of a fiber with ends of its own.
    pub thread: Option<usize>,
}

/// All fibers of an element; piece k of a chain runs from corner k to corner k + 1. Lengths in mm.
pub struct Chains {
    pub points: Vec<DVec3>,
    /// Number of the fiber of a corner.
    pub fiber: Vec<u32>,
    /// Length of the fiber up to a corner, when it was last measured.
    pub along: Vec<f64>,
    /// Radius of each fiber.
    pub radius: Vec<f64>,
    /// The thread that each fiber was cut with.
    pub thread: Vec<Option<usize>>,
    /// Whole periods from the start of each fiber to its end.
    pub onward: Vec<[i32; 2]>,
    /// Whether a fiber goes on at its end as its own image.
    pub joined: Vec<bool>,
    /// Normals of the planes that fibers are cut in, of those that are cut with others.
    cut: Vec<Option<DVec3>>,
    /// First corner of each fiber, and the number of all.
    pub first: Vec<u32>,
    pub period: DVec2,
    /// Lowest and highest z of each fiber's corners.
    bounds: Vec<[f64; 2]>,
    /// Corners whose z stays.
    held: Vec<bool>,
}

impl Chains {
    /// Cut fibers into short pieces.
    pub fn new<'a>(fibers: impl Iterator<Item = Laid<'a>> + Clone, period: DVec2, thickness: f64) -> Chains {
        // Where no fiber sticks out none shall.
        let inside = |laid: Laid| {
            let slack = laid.radius - ON_FACE * thickness;
            laid.points.iter().all(|point| point.z <= -slack && point.z >= slack - thickness)
        };
        let margin = if fibers.clone().all(inside) { 1.0 } else { 0.0 };
        let mut chains = Chains {
            points: Vec::new(),
            fiber: Vec::new(),
            along: Vec::new(),
            radius: Vec::new(),
            thread: Vec::new(),
            onward: Vec::new(),
            joined: Vec::new(),
            cut: Vec::new(),
            first: vec![0],
            period,
            bounds: Vec::new(),
            held: Vec::new(),
        };
        for Laid { points, radius, thread } in fibers {
            let start = chains.points.len();
            let corners = without_crumbs(points, SHORTEST * radius, STRAIGHT * radius);
            chains.points.push(corners[0]);
            for ends in corners.windows(2) {
                let length = ends[0].distance(ends[1]);
                let parts = (length / (LONGEST * radius)).ceil().max(1.0) as u32;
                for part in 1..=parts {
                    let share = f64::from(part) / f64::from(parts);
                    chains.points.push(ends[0].lerp(ends[1], share));
                }
            }
            let end = chains.points.len();
            chains.fiber.resize(end, chains.radius.len() as u32);
            let way = chains.points[end - 1] - chains.points[start];
            let turns = (way.truncate() / period).round();
            let joined = turns != DVec2::ZERO && way.distance((turns * period).extend(0.0)) < JOINED * radius;
            chains.held.resize(end, false);
            for corner in [start, end - 1] {
                let z = chains.points[corner].z;
                let on_face = z.min(thickness + z).abs() < ON_FACE * thickness
                    || z.max(-thickness - z).abs() < ON_FACE * thickness;
                chains.held[corner] = on_face && !joined;
            }
            chains.radius.push(radius);
            chains.thread.push(thread);
            chains.onward.push([turns.x as i32, turns.y as i32]);
            chains.joined.push(joined);
            chains.bounds.push([margin * radius - thickness, -margin * radius]);
            chains.first.push(end as u32);
        }
        chains.cut = planes(&chains);
        chains.along = vec![0.0; chains.len()];
        chains.measure();
        chains
    }

    /// Measure lengths along the fibers anew.
    pub fn measure(&mut self) {
        for corner in 1..self.len() {
            let piece = corner - 1;
            let reached = self.along[piece] + self.points[piece].distance(self.points[corner]);
            self.along[corner] = if self.starts(piece) { reached } else { 0.0 };
        }
    }

    /// Number of corners.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether a piece starts at this corner.
    pub fn starts(&self, corner: usize) -> bool {
        corner + 1 < self.len() && self.fiber[corner] == self.fiber[corner + 1]
    }

    /// The piece that ends at a corner and the one that starts there; where a fiber goes on as its image, that of its other end.
    pub fn pieces_at(&self, corner: usize) -> [Option<usize>; 2] {
        let fiber = self.fiber[corner] as usize;
        let (first, last) = (self.first[fiber] as usize, self.first[fiber + 1] as usize - 1);
        let round = |piece: usize| self.joined[fiber].then_some(piece);
        let before = if corner > first { Some(corner - 1) } else { round(last - 1) };
        let after = if corner < last { Some(corner) } else { round(first) };
        [before, after]
    }

    /// Radius of the fiber of a corner.
    pub fn radius_at(&self, corner: usize) -> f64 {
        self.radius[self.fiber[corner] as usize]
    }

    /// Both corners of a piece.
    pub fn ends(&self, piece: usize) -> [DVec3; 2] {
        [self.points[piece], self.points[piece + 1]]
    }

    /// The corners of a fiber.
    pub fn of(&self, fiber: usize) -> &[DVec3] {
        &self.points[self.first[fiber] as usize..self.first[fiber + 1] as usize]
    }

    /// Length of a fiber.
    pub fn length(&self, fiber: usize) -> f64 {
        self.along[self.first[fiber + 1] as usize - 1]
    }

    /// Where a corner comes to lie when it moves: inside the slab, on a face if it lies there, and where its thread is cut in
    /// the plane of the cut.
    pub fn moved(&self, corner: usize, by: DVec3) -> DVec3 {
        let fiber = self.fiber[corner] as usize;
        let [low, high] = self.bounds[fiber];
        let is_end = corner == self.first[fiber] as usize || corner + 1 == self.first[fiber + 1] as usize;
        let by = match self.cut[fiber] {
            Some(normal) if is_end => by - normal * by.dot(normal),
            _ => by,
        };
        let to = self.points[corner] + by;
        let z = if self.held[corner] { self.points[corner].z } else { to.z.clamp(low, high) };
        to.truncate().extend(z)
    }
}

/// Leave corners out that are nearer than this to the one before or to the end, and lie so near to the chord that is left.
fn without_crumbs(points: &[DVec3], least: f64, off: f64) -> Vec<DVec3> {
    let ends = points.len() - 1;
    let (mut kept, mut from) = (vec![points[0]], 0);
    for at in 1..ends {
        let short = points[at].distance(points[from]) < least || points[at].distance(points[ends]) < least;
        if !(short && points[from + 1..=at].iter().all(|&point| beside(point, [points[from], points[at + 1]]) <= off)) {
            kept.push(points[at]);
            from = at;
        }
    }
    kept.push(points[ends]);
    kept
}

/// Distance of a point from a chord.
fn beside(point: DVec3, [from, to]: [DVec3; 2]) -> f64 {
    let along = to - from;
    let share = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    point.distance(from + along * share)
}
