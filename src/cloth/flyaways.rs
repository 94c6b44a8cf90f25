//! Fibers outside of the section of their yarn: loops and hairs (Zhao, Luan, Bala 2016).
//!
//! A loop is a stretch of one of the yarn's fibers that is led out and back: it adds no fiber but the length of the way.
//! A hair is a fiber more: the open end that sticks out.
//!
//! Differs from that paper:
//! - Places of both are measured from the surface of the yarn and not of a ply, so heights are what is seen.
//! - The way out of a loop is smooth, (1 + cos)/2, where the paper's has a corner at the top; loops lie anywhere on a fiber
//!   and not only where it migrates furthest out.
//! - A hair is as long as it is drawn: it rises from the surface at a constant angle, and unrolled from the yarn it is
//!   straight. It starts at the surface and goes the way of the outermost fibers, forwards or backwards alike.

use super::section::{Section, Strand};
use super::steps::{Station, Steps};
use crate::scene::{Hairs, Loops, Spread};
use glam::DVec2;
use rand::{Rng, RngExt};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Places that are tried for a loop until it lies clear of the others of its fiber.
const TRIES: usize = 10_000;

/// A loop of a fiber.
#[derive(Clone, Copy, Debug)]
struct Loop {
    /// Number of the fiber in its yarn.
    strand: usize,
    /// Length of the axis at its top in mm; it may lie beyond the ends of the fiber, where the loop is parted by the cut.
    at: f64,
    /// Height of its top over the yarn's surface in mm.
    height: f64,
    /// Eccentric angle of the top in radians, against the frame that the twist is counted against.
    angle: f64,
}

/// The loops of the fibers of a thread.
#[derive(Clone, Debug, Default)]
pub struct LoopSet {
    /// By fiber.
    loops: Vec<Loop>,
    /// Half of the length that a loop takes of the axis in mm.
    half: f64,
    /// Turn of the way out along the axis in radians per mm.
    twist: f64,
    /// Largest |d²(place)/ds²| of any loop in 1/mm.
    bend: f64,
}

impl LoopSet {
    /// Draw the loops of a thread whose fibers run from `start` on (a length of the axis in mm) over one period.
    pub fn draw(
        loops: &Loops,
        section: &Section,
        strands: &[Strand],
        steps: &Steps,
        start: f64,
        rng: &mut impl Rng,
    ) -> LoopSet {
        let period = steps.length();
        let half = loops.span.min(period) / 2.0;
        let twist = section.surface_twist();
        let mut set = LoopSet { loops: Vec::new(), half, twist, bend: bend(loops, section, half) };
        let mut taken: HashMap<usize, Vec<f64>> = HashMap::new();
        // The distance of two places round the period.
        let apart = |a: f64, b: f64| ((a - b + period / 2.0).rem_euclid(period) - period / 2.0).abs();
        for _ in 0..number(loops.per_mm * period, rng) {
            let mut place = (0, start);
            for _ in 0..TRIES {
                place = (rng.random_range(0..strands.len()), start + period * rng.random::<f64>());
                let clear = |at: &f64| apart(place.1, *at) >= 2.0 * half;
                if taken.get(&place.0).is_none_or(|others| others.iter().all(clear)) {
                    break;
                }
            }
            let (strand, at) = place;
            taken.entry(strand).or_default().push(at);
            let height = draw(&loops.height, rng);
            // What lies beyond the cut comes back at the other end.
            let images = [at - period, at, at + period].into_iter();
            for at in images.filter(|at| at + half > start && at - half < start + period) {
                set.loops.push(Loop { strand, at, height, angle: section.disc(&strands[strand], at, 0.0).to_angle() });
            }
        }
        set.loops.sort_by_key(|one| one.strand);
        set
    }

    /// The loops of a fiber, as a range of numbers.
    pub fn of(&self, strand: usize) -> Range<usize> {
        let first = self.loops.partition_point(|one| one.strand < strand);
        first..self.loops.partition_point(|one| one.strand <= strand)
    }

    /// Where a fiber with these loops lies if it would lie at `inside` without them, at a length of the axis and an angle of
    /// the frame that the twist is counted against.
    pub fn lead_out(
        &self,
        loops: &Range<usize>,
        section: &Section,
        kind: usize,
        [length, turn]: [f64; 2],
        inside: DVec2,
    ) -> DVec2 {
        let near = |one: &&Loop| (length - one.at).abs() < self.half;
        let Some(one) = self.loops[loops.clone()].iter().find(near) else { return inside };
        let off = length - one.at;
        let share = (1.0 + (PI * off / self.half).cos()) / 2.0;
        // Between a point inside and one at the height h the fiber is at most as high as its share of h.
        inside.lerp(section.rim(kind).point(one.angle + self.twist * off + turn, one.height), share)
    }

    /// Parts that a piece between two lengths of the axis must be cut into.
    pub fn parts(&self, loops: &Range<usize>, steps: &Steps, from: f64, to: f64) -> u32 {
        let meets = |one: &Loop| one.at + self.half > from && one.at - self.half < to;
        if self.loops[loops.clone()].iter().any(meets) { steps.parts(to - from, self.bend) } else { 1 }
    }
}

/// Largest |d²(place)/ds²| of a fiber in a loop: of (1 − b) q + b g with b = (1 + cos(π s/w))/2.
pub fn bend(loops: &Loops, section: &Section, half: f64) -> f64 {
    let rim = section.rim(section.thinnest_kind());
    let height = loops.height.limits[1];
    let [first, second] = rim.bounds(height);
    let (rate, twist) = (PI / half, section.surface_twist().abs());
    let way = 2.0 * rim.half.max_element() + height;
    rate.powi(2) / 2.0 * way + rate * (section.drift() + twist * first) + section.bend().max(twist.powi(2) * second)
}

/// A hair.
#[derive(Clone, Copy, Debug)]
pub struct Hair {
    /// Its kind of fiber.
    pub kind: usize,
    /// Length of the axis where it leaves the yarn in mm.
    start: f64,
    /// Eccentric angle there in radians.
    angle: f64,
    /// Its length in mm.
    length: f64,
    /// Its direction: along the axis, round the yarn, outwards.
    direction: [f64; 3],
}

impl Hair {
    /// Draw the hairs of a thread.
    pub fn draw(hairs: &Hairs, section: &Section, steps: &Steps, rng: &mut impl Rng) -> Vec<Hair> {
        let hair = |rng: &mut _| Hair::one(hairs, section, steps.length(), rng);
        (0..number(hairs.per_mm * steps.length(), rng)).map(|_| hair(rng)).collect()
    }

    fn one(hairs: &Hairs, section: &Section, period: f64, rng: &mut impl Rng) -> Hair {
        let kind = section.draw_kind(rng);
        let (start, angle) = (period * rng.random::<f64>(), TAU * rng.random::<f64>());
        let (length, rise) = (draw(&hairs.length, rng), draw(&hairs.rise, rng));
        // Outermost fibers climb round the yarn by their twist.
        let way = DVec2::new(1.0, section.surface_twist() * section.rim(kind).speed(angle, 0.0)).normalize();
        let way = way * rise.cos() * if rng.random::<bool>() { 1.0 } else { -1.0 };
        Hair { kind, start, angle, length, direction: [way.x, way.y, rise.sin()] }
    }

    /// Call `corner` with the points of its polyline, from the yarn to its end: the station of the axis and the place in the
    /// section.
    pub fn trace(&self, section: &Section, steps: &Steps, mut corner: impl FnMut(Station, DVec2)) {
        let rim = section.rim(self.kind);
        let [along, round, out] = self.direction;
        let (mut passed, mut angle) = (0.0, self.angle);
        let turned = |angle: f64, passed: f64, step: f64| step * round / rim.speed(angle, out * passed);
        loop {
            let (station, piece) = steps.at_length(self.start + along * passed);
            corner(station, rim.point(angle, out * passed));
            let left = self.length - passed;
            if left <= 0.0 {
                break;
            }
            // Take a step for the curvature here, then for the larger one of both its ends and its middle.
            let bend = |angle: f64, passed: f64| round * round * rim.curvature(angle, out * passed);
            let first = steps.step(piece, along, bend(angle, passed)).min(left);
            let ahead = |share: f64| {
                let step = share * first;
                bend(angle + turned(angle, passed, step), passed + step)
            };
            let largest = bend(angle, passed).max(ahead(0.5)).max(ahead(1.0));
            let step = steps.step(piece, along, largest);
            // Leave no crumb.
            let step = if step > 0.999 * left { left } else { step };
            let middle = angle + turned(angle, passed, step / 2.0);
            angle += turned(middle, passed + step / 2.0, step);
            passed = if step == left { self.length } else { passed + step };
        }
    }
}

/// Pieces that hairs and loops add to a thread, about.
pub fn loose_pieces(section: &Section, steps: &Steps) -> f64 {
    let Some(flyaways) = section.flyaways() else { return 0.0 };
    let (period, usual) = (steps.length(), steps.length() / steps.pieces);
    let loops = flyaways.loops.map_or(0.0, |loops| {
        let span = loops.span.min(period);
        let parts = f64::from(steps.parts(usual, bend(&loops, section, span / 2.0)));
        loops.per_mm * period * (span / usual + 2.0) * (parts - 1.0)
    });
    let hairs = flyaways.hairs.map_or(0.0, |hairs| {
        // A hair that goes round the yarn bends as the surface does.
        let rim = section.rim(section.thinnest_kind());
        let round = hairs.rise.limits[0].cos().powi(2) * rim.curvature(std::f64::consts::FRAC_PI_4, 0.0);
        hairs.per_mm * period * (hairs.length.limits[1] / steps.step(usual, 1.0, round) + 2.0)
    });
    loops + hairs
}

/// A whole number with this mean: it or its neighbour.
fn number(mean: f64, rng: &mut impl Rng) -> usize {
    (mean + rng.random::<f64>()).floor() as usize
}

/// A number of a cut normal distribution (Box and Muller 1958); what lies beyond the limits is drawn anew.
fn draw(spread: &Spread, rng: &mut impl Rng) -> f64 {
    let [low, high] = spread.limits;
    loop {
        let size = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
        let value = spread.mean + spread.deviation * size * (TAU * rng.random::<f64>()).cos();
        if spread.deviation == 0.0 || (value >= low && value <= high && value > 0.0) {
            return value;
        }
    }
}
