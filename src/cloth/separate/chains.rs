//! Fibers as chains of corners in one array.

use glam::{DVec2, DVec3};

/// Longest piece in radii of its fiber.
const LONGEST: f64 = 6.0;
/// Shortest piece in radii, unless its fiber is shorter.
const SHORTEST: f64 = 1.5;
/// A point this near a face, in shares of the thickness, lies on it.
const ON_FACE: f64 = 1e-9;

/// All fibers of an element; piece k of a chain runs from corner k to corner k + 1. Lengths in mm.
pub struct Chains {
    pub points: Vec<DVec3>,
    /// Number of the fiber of a corner.
    pub fiber: Vec<u32>,
    /// Length of the fiber up to a corner, when it was last measured.
    pub along: Vec<f64>,
    /// Radius of each fiber.
    pub radius: Vec<f64>,
    /// First corner of each fiber, and the number of all.
    pub first: Vec<u32>,
    pub period: DVec2,
    /// Lowest and highest z of each fiber's corners.
    bounds: Vec<[f64; 2]>,
    /// Corners whose z stays.
    held: Vec<bool>,
}

impl Chains {
    /// Cut fibers, given by their corners and their radius, into short pieces.
    pub fn new<'a>(fibers: impl Iterator<Item = (&'a [DVec3], f64)> + Clone, period: DVec2, thickness: f64) -> Chains {
        // Where no fiber sticks out none shall.
        let inside = |(points, radius): (&[DVec3], f64)| {
            let slack = radius - ON_FACE * thickness;
            points.iter().all(|point| point.z <= -slack && point.z >= slack - thickness)
        };
        let margin = if fibers.clone().all(inside) { 1.0 } else { 0.0 };
        let mut chains = Chains {
            points: Vec::new(),
            fiber: Vec::new(),
            along: Vec::new(),
            radius: Vec::new(),
            first: vec![0],
            period,
            bounds: Vec::new(),
            held: Vec::new(),
        };
        for (points, radius) in fibers {
            let start = chains.points.len();
            let corners = without_crumbs(points, SHORTEST * radius);
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
            chains.held.resize(end, false);
            for corner in [start, end - 1] {
                let z = chains.points[corner].z;
                chains.held[corner] = z.min(thickness + z).abs() < ON_FACE * thickness
                    || z.max(-thickness - z).abs() < ON_FACE * thickness;
            }
            chains.radius.push(radius);
            chains.bounds.push([margin * radius - thickness, -margin * radius]);
            chains.first.push(end as u32);
        }
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
    fn length(&self, fiber: usize) -> f64 {
        self.along[self.first[fiber + 1] as usize - 1]
    }

    /// Length from a point of a piece to the nearer end of its fiber, and the outward direction there.
    pub fn end_of(&self, piece: usize, share: f64) -> (f64, DVec3) {
        let fiber = self.fiber[piece] as usize;
        let along = self.along[piece] + share * (self.along[piece + 1] - self.along[piece]);
        let (first, last) = (self.first[fiber] as usize, self.first[fiber + 1] as usize - 1);
        let left = self.length(fiber) - along;
        if along < left {
            (along, (self.points[first] - self.points[first + 1]).normalize_or_zero())
        } else {
            (left, (self.points[last] - self.points[last - 1]).normalize_or_zero())
        }
    }

    /// Where a corner comes to lie when it moves: inside the slab, and on a face if it lies there.
    pub fn moved(&self, corner: usize, by: DVec3) -> DVec3 {
        let [low, high] = self.bounds[self.fiber[corner] as usize];
        let to = self.points[corner] + by;
        let z = if self.held[corner] { self.points[corner].z } else { to.z.clamp(low, high) };
        to.truncate().extend(z)
    }
}

/// Leave corners out that are nearer than this to the one before or to the end.
fn without_crumbs(points: &[DVec3], least: f64) -> Vec<DVec3> {
    let (first, last) = (points[0], points[points.len() - 1]);
    let mut kept = vec![first];
    for &point in &points[1..points.len() - 1] {
        if point.distance(kept[kept.len() - 1]) >= least && point.distance(last) >= least {
            kept.push(point);
        }
    }
    kept.push(last);
    kept
}
