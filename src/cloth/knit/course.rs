//! The axis of a course in its cloth, with its frame.

use super::relax::Relaxed;
use super::series::Series;
use crate::cloth::steps::Curve;
use crate::scene::{Knit, Yarn};
use glam::{DQuat, DVec2, DVec3};

/// Points of the table of a loop.
const POINTS: usize = 4096;
/// Of them in a part of one step length.
const PER_PART: usize = 32;
/// Cells along each edge of the repeat on which the cover is counted.
const RASTER: usize = 256;
/// Lines along the yarn that are laid on them.
const LINES: usize = 128;

/// A place on an axis; lengths in mm.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// The point of the axis.
    pub point: DVec3,
    /// Level and across the axis, to the left.
    pub left: DVec3,
    /// Across both: the direction of the axis is left × up.
    pub up: DVec3,
    /// Angle in radians of the twist-free frame in (left, up), which are parallel where the first loop has its head. A
    /// yarn lies with its long side level, but its twist is counted against the frame that only bends with it. Loops are
    /// their own mirror images, so the angle comes back to 0 at the next head.
    pub turn: f64,
    /// Curvature of the axis in 1/mm.
    pub curvature: f64,
}

impl Frame {
    /// The point off the axis by (left, up).
    pub fn off(&self, place: DVec2) -> DVec3 {
        self.point + self.left * place.x + self.up * place.y
    }

    /// The frame so far ahead on the tangent, in mm.
    pub fn ahead(self, length: f64) -> Frame {
        Frame { point: self.point + self.left.cross(self.up) * length, ..self }
    }

    fn mix(&self, other: &Frame, share: f64) -> Frame {
        Frame {
            point: self.point.lerp(other.point, share),
            left: self.left.lerp(other.left, share),
            up: self.up.lerp(other.up, share),
            turn: self.turn + share * (other.turn - self.turn),
            curvature: self.curvature + share * (other.curvature - self.curvature),
        }
    }
}

/// The axis of a course over a repeat, from the head of a loop in the middle of the first wale, as a table over its length.
#[derive(Clone, Debug)]
pub struct Course {
    /// How far it goes along x in a repeat, in mm.
    pub period: f64,
    /// Length of the axis in a repeat in mm.
    pub length: f64,
    /// How far a fiber lies off the axis, at most, in mm: the mean radius of the yarn, and the highest loop.
    radius: f64,
    /// Frames at equal distances along the axis, from 0 to `length`.
    frames: Vec<Frame>,
    /// Distance between the lowest and the highest point of the yarn in mm; the highest is z = 0.
    pub thickness: f64,
}

impl Course {
    /// The course of a relaxed loop.
    pub fn new(knit: &Knit, relaxed: &Relaxed) -> Course {
        let series = relaxed.series.scaled(knit.loop_length);
        let length = knit.loop_length * knit.wales() as f64;
        let count = POINTS * knit.wales();
        let mut frames: Vec<Frame> = Vec::with_capacity(count + 1);
        let (mut t, mut last) = (0.0, DVec3::X);
        for _ in 0..count {
            let [point, first, second] = series.at(t);
            let along = first.normalize();
            let left = DVec3::Z.cross(along).normalize();
            let up = along.cross(left);
            let turn = frames.last().map_or(0.0, |before| {
                // Carry the frame before over by the smallest rotation.
                let carried = DQuat::from_rotation_arc(last, along) * before.left;
                before.turn + carried.dot(up).atan2(carried.dot(left))
            });
            let curvature = first.cross(second).length() / first.length().powi(3);
            let point = point + DVec3::X * (knit.wale_spacing / 2.0);
            frames.push(Frame { point, left, up, turn, curvature });
            last = along;
            t = step(&series, t, length / count as f64);
        }
        let climb = |frame: &Frame| frame.left.cross(frame.up).z.abs().min(1.0).asin();
        let half = |frame: &Frame| knit.yarn.height / 2.0 * frame.up.z + knit.yarn.reach(climb(frame));
        let lowest = frames.iter().map(|frame| frame.point.z - half(frame)).fold(f64::INFINITY, f64::min);
        let highest = frames.iter().map(|frame| frame.point.z + half(frame)).fold(f64::NEG_INFINITY, f64::max);
        frames.iter_mut().for_each(|frame| frame.point.z -= highest);
        let period = knit.wale_spacing * knit.wales() as f64;
        frames.push(Frame { point: frames[0].point + DVec3::X * period, ..frames[0] });
        let loops = knit.yarn.flyaways.and_then(|flyaways| flyaways.loops);
        let radius = knit.diameter() / 2.0 + loops.map_or(0.0, |loops| loops.height.limits[1]);
        Course { period, length, radius, frames, thickness: highest - lowest }
    }

    /// The frame after a length of yarn from the first head.
    pub fn at(&self, length: f64) -> Frame {
        let intervals = self.frames.len() - 1;
        let turns = (length / self.length).floor();
        let place = ((length / self.length - turns) * intervals as f64).clamp(0.0, intervals as f64);
        let index = (place as usize).min(intervals - 1);
        let mut frame = self.frames[index].mix(&self.frames[index + 1], place - index as f64);
        frame.point.x += turns * self.period;
        frame
    }

    /// Largest curvature in 1/mm.
    pub fn tightest(&self) -> f64 {
        self.frames.iter().map(|frame| frame.curvature).fold(0.0, f64::max)
    }

    /// Steepest slope of the axis, rise over run.
    pub fn steepest(&self) -> f64 {
        let slope = |frame: &Frame| {
            let rise = frame.left.cross(frame.up).z;
            rise.abs() / (1.0 - rise * rise).max(0.0).sqrt()
        };
        self.frames.iter().map(slope).fold(0.0, f64::max)
    }

    /// Share of the repeat that the outline of the yarn covers, seen along z, counted on a raster; `period` is the size of the
    /// repeat.
    pub fn cover(&self, yarn: &Yarn, period: DVec2) -> f64 {
        let mut covered = vec![false; RASTER * RASTER];
        let cell = |place: f64, period: f64| ((place / period).rem_euclid(1.0) * RASTER as f64) as usize % RASTER;
        for frame in &self.frames {
            for line in 0..=LINES {
                let off = yarn.width * (line as f64 / LINES as f64 - 0.5);
                let point = frame.off(DVec2::new(off, 0.0));
                covered[cell(point.y, period.y) * RASTER + cell(point.x, period.x)] = true;
            }
        }
        covered.iter().filter(|covered| **covered).count() as f64 / covered.len() as f64
    }
}

impl Curve for Course {
    fn parts(&self) -> usize {
        self.frames.len() / PER_PART
    }

    fn part_length(&self, _: usize) -> f64 {
        self.length / self.parts() as f64
    }

    fn part_curvature(&self, part: usize) -> f64 {
        let frames = &self.frames[part * PER_PART..=(part + 1) * PER_PART];
        let curvature = frames.iter().map(|frame| frame.curvature).fold(0.0, f64::max);
        // A fiber on the outside of a bend is longer than the axis.
        curvature * (1.0 + curvature * self.radius)
    }

    fn part_point(&self, part: usize, fraction: f64) -> DVec2 {
        DVec2::new((part as f64 + fraction) * self.part_length(part), 0.0)
    }

    fn advance(&self) -> f64 {
        self.length
    }
}

/// The parameter after a length of the axis: one step of the classical Runge–Kutta rule.
fn step(series: &Series, t: f64, length: f64) -> f64 {
    let slope = |t: f64| length / series.at(t)[1].length();
    let a = slope(t);
    let b = slope(t + a / 2.0);
    let c = slope(t + b / 2.0);
    let d = slope(t + c);
    t + (a + 2.0 * b + 2.0 * c + d) / 6.0
}
