//! Where the polylines of the fibers of a thread have their corners.

use glam::DVec2;

/// Corners of the table of an axis for each piece of a fiber.
const FINE: usize = 4;
/// Sagitta of a piece in radii of the fiber at most. Between the corners of the table the axis is straight, which adds up
/// to a sixteenth of it.
const SAGITTA: f64 = 0.09;
/// Most parts of a piece that bends more than all others.
const MOST_PARTS: f64 = 1e3;
/// Radians that a fiber turns in a piece, about.
const TURN: f64 = 0.15;
/// Step lengths along the axis differ by no more than this times their distance.
const GRADING: f64 = 0.25;
/// With that grading, a piece is at most this much longer than the step length of any of its points: (e^¼ − 1)/¼ = 1.14,
/// and a little for the finite parts.
const SLACK: f64 = 1.17;

/// An axis, part by part.
pub trait Curve {
    /// Number of parts of a period; a part has one step length.
    fn parts(&self) -> usize;
    /// Length of a part in mm.
    fn part_length(&self, part: usize) -> f64;
    /// Largest curvature of a part in 1/mm.
    fn part_curvature(&self, part: usize) -> f64;
    /// The point at a fraction of a part: how far along, and how high, in mm.
    fn part_point(&self, part: usize, fraction: f64) -> DVec2;
    /// How far a period goes along, in mm.
    fn advance(&self) -> f64;
}

/// A point of an axis.
#[derive(Clone, Copy, Debug)]
pub struct Station {
    /// Length of the axis up to here in mm.
    pub length: f64,
    /// Distance along the thread's direction in mm; in a knit it is the length as well.
    pub along: f64,
    /// Height in mm; in a knit it has no use.
    pub height: f64,
}

/// An axis as a table over the number of pieces, so that the n-th corner is looked up and not searched.
#[derive(Clone, Debug)]
pub struct Steps {
    /// Pieces of a period; not a whole number.
    pub pieces: f64,
    /// What limited their lengths.
    limits: Limits,
    /// Points at equal distances in pieces, from 0 to `pieces`.
    stations: Vec<Station>,
}

/// What limits the length of a piece.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Radius of the thinnest fiber in mm.
    pub radius: f64,
    /// Largest |d²(place in the section)/ds²| that the twist causes, in 1/mm.
    pub twist: f64,
    /// Longest piece in mm.
    pub longest: f64,
}

impl Limits {
    /// Step length where the axis has this curvature: a chord of the length d over a curve with |X″| ≤ k lies within k d²/8
    /// of it.
    fn step(&self, curvature: f64) -> f64 {
        let bend = curvature + self.twist;
        let sagitta = (8.0 * SAGITTA * self.radius / bend).sqrt();
        sagitta.min(TURN / bend).min(self.longest) / SLACK
    }
}

impl Steps {
    /// Cut an axis, if that takes no more than so many pieces.
    pub fn new(curve: &impl Curve, limits: &Limits, most: f64) -> Option<Steps> {
        let lengths: Vec<f64> = (0..curve.parts()).map(|part| curve.part_length(part)).collect();
        let mut steps: Vec<f64> = (0..curve.parts()).map(|part| limits.step(curve.part_curvature(part))).collect();
        grade(&mut steps, &lengths);

        // Lay stations at equal distances in pieces.
        let counts = lengths.iter().zip(&steps).map(|(length, step)| length / step);
        let pieces: f64 = counts.clone().sum();
        if pieces > most {
            return None;
        }
        let wanted = (pieces * FINE as f64).ceil().max(FINE as f64) as usize;
        let mut stations = Vec::with_capacity(wanted + 1);
        let (mut passed, mut length) = (0.0, 0.0);
        for (part, (count, part_length)) in counts.zip(&lengths).enumerate() {
            while stations.len() < wanted && pieces * stations.len() as f64 / wanted as f64 <= passed + count {
                let fraction = (pieces * stations.len() as f64 / wanted as f64 - passed) / count;
                let point = curve.part_point(part, fraction);
                stations.push(Station { length: length + fraction * part_length, along: point.x, height: point.y });
            }
            passed += count;
            length += part_length;
        }
        // Close the period where it began, however the sums were rounded.
        let first = stations[0];
        stations.resize(wanted, Station { length, along: first.along + curve.advance(), ..first });
        stations.push(Station { length, along: first.along + curve.advance(), ..first });
        Some(Steps { pieces, limits: *limits, stations })
    }

    /// Length of the axis over a period in mm.
    pub fn length(&self) -> f64 {
        self.stations[self.stations.len() - 1].length
    }

    /// The point of the axis at a length in mm, of any period, and the length of a piece there.
    pub fn at_length(&self, length: f64) -> (Station, f64) {
        let intervals = self.stations.len() - 1;
        let last = self.stations[intervals];
        let turn = (length / last.length).floor();
        let rest = length - turn * last.length;
        let index = self.stations.partition_point(|station| station.length <= rest).clamp(1, intervals) - 1;
        let (a, b) = (self.stations[index], self.stations[index + 1]);
        let apart = b.length - a.length;
        let fraction = if apart > 0.0 { ((rest - a.length) / apart).clamp(0.0, 1.0) } else { 0.0 };
        let station = Station {
            length,
            along: a.along + (b.along - a.along) * fraction + turn * (last.along - self.stations[0].along),
            height: a.height + (b.height - a.height) * fraction,
        };
        let piece = if apart > 0.0 { apart * intervals as f64 } else { last.length };
        (station, piece / self.pieces)
    }

    /// Parts that a piece of some length must be cut into when its fiber bends by |d²(place)/ds²| more than all fibers do.
    pub fn parts(&self, length: f64, bend: f64) -> u32 {
        // The sagitta and the turn of the piece without the bend are within their limits.
        let sagitta = (1.0 + bend * length * length / (8.0 * SAGITTA * self.limits.radius)).sqrt();
        let turn = 1.0 + bend * length / TURN;
        sagitta.max(turn).ceil().min(MOST_PARTS) as u32
    }

    /// Length of a step of a fiber that goes the share `along` of its way along the axis, where pieces are `piece` long, and
    /// bends by `bend` in 1/mm besides.
    pub fn step(&self, piece: f64, along: f64, bend: f64) -> f64 {
        let straight = along.abs() / piece;
        let sagitta = straight.powi(2) + bend / (8.0 * SAGITTA * self.limits.radius);
        let turn = straight + bend / TURN;
        (1.0 / sagitta.sqrt().max(turn)).min(self.limits.longest)
    }

    /// The point of the axis after so many pieces, from 0 to twice [`Steps::pieces`]; past the period it goes on.
    pub fn at(&self, pieces: f64) -> Station {
        let intervals = self.stations.len() - 1;
        let last = self.stations[intervals];
        let (turn, rest) = if pieces < self.pieces { (0.0, pieces) } else { (1.0, pieces - self.pieces) };
        let place = (rest / self.pieces * intervals as f64).clamp(0.0, intervals as f64);
        let index = (place as usize).min(intervals - 1);
        let (a, b, fraction) = (self.stations[index], self.stations[index + 1], place - index as f64);
        let mix = |a: f64, b: f64| a + (b - a) * fraction;
        Station {
            length: mix(a.length, b.length) + turn * last.length,
            along: mix(a.along, b.along) + turn * (last.along - self.stations[0].along),
            height: mix(a.height, b.height),
        }
    }
}

/// Shorten steps beside shorter ones, round the period.
fn grade(steps: &mut [f64], lengths: &[f64]) {
    let count = steps.len();
    let limit = |steps: &mut [f64], from: usize, to: usize| {
        let apart = 0.5 * (lengths[from] + lengths[to]);
        steps[to] = steps[to].min(steps[from] + GRADING * apart);
    };
    for place in 0..2 * count {
        limit(steps, place % count, (place + 1) % count);
    }
    for place in (0..2 * count).rev() {
        limit(steps, (place + 1) % count, place % count);
    }
}
