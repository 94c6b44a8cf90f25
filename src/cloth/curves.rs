//! One random draw of all fibers, as polylines.

use super::flyaways::{Hair, LoopSet};
use super::knit::Frame;
use super::repeat::{Axis, Cloth, System, Thread};
use super::steps::Station;
use glam::{DVec2, DVec3};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// The stream of the flyaways of thread 0: other fibers do not move when there are hairs.
const FLYAWAYS: u64 = 1 << 63;

/// A fiber as a polyline; lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Its corners, at least two. They go on beyond the repeat, so that neighbours lie side by side.
    pub points: Vec<DVec3>,
    /// Radius of the fiber.
    pub radius: f64,
    /// Index of the kind of fiber in the scene.
    pub kind: usize,
    /// Index of the thread in [`Cloth::threads`].
    pub thread: usize,
    /// Whether it is a hair, from the yarn to its open end; other fibers run through one period, from where their thread is
    /// cut.
    pub hair: bool,
}

impl Cloth {
    /// Draw the fibers of one thread, the same as in [`Cloth::realize`]: a function of the seed and the number of the draw.
    /// Hairs come last.
    pub fn draw_thread(&self, seed: u64, number: u64, thread: usize, take: &mut dyn FnMut(&Curve)) {
        let place = &self.threads()[thread];
        let (section, steps) = (self.section(place), self.steps(place));
        let mut rng = generator(seed, number, thread as u64);
        let strands = section.draw(&mut rng);
        // Cut the thread at one place, since its twist need not close over the period.
        let cut = rng.random::<f64>() * steps.pieces;
        let mut loose = generator(seed, number, thread as u64 + FLYAWAYS);
        let flyaways = section.flyaways();
        let loops = flyaways.and_then(|flyaways| flyaways.loops).map_or_else(LoopSet::default, |loops| {
            LoopSet::draw(&loops, section, &strands, steps, steps.at(cut).length, &mut loose)
        });
        let mut curve = Curve { points: Vec::new(), radius: 0.0, kind: 0, thread, hair: false };
        for (index, strand) in strands.iter().enumerate() {
            let own = loops.of(index);
            let corner = |pieces: f64| {
                let station = steps.at(pieces);
                let frame = self.frame(place, &station);
                let turn = frame.map_or(0.0, |frame| frame.turn);
                let inside = section.place(strand, station.length, turn);
                let off = loops.lead_out(&own, section, strand.kind, [station.length, turn], inside);
                self.point(place, &station, frame, off)
            };
            // Shift the corners of each fiber, so that their pieces do not end side by side.
            let first = rng.random::<f64>();
            let inner = (0..).map(|step| first + f64::from(step)).take_while(|pieces| *pieces < steps.pieces);
            (curve.radius, curve.kind) = (section.radius(strand.kind), strand.kind);
            curve.points.clear();
            curve.points.push(corner(cut));
            let mut last = 0.0;
            for next in inner.chain([steps.pieces]) {
                if !own.is_empty() {
                    let [from, to] = [last, next].map(|pieces| steps.at(cut + pieces).length);
                    let parts = loops.parts(&own, steps, from, to);
                    let between = |part: u32| cut + last + (next - last) * f64::from(part) / f64::from(parts);
                    curve.points.extend((1..parts).map(|part| corner(between(part))));
                }
                curve.points.push(corner(cut + next));
                last = next;
            }
            take(&curve);
        }
        let Some(hairs) = flyaways.and_then(|flyaways| flyaways.hairs) else { return };
        curve.hair = true;
        for hair in Hair::draw(&hairs, section, steps, &mut loose) {
            (curve.radius, curve.kind) = (section.radius(hair.kind), hair.kind);
            curve.points.clear();
            let mut root = None;
            hair.trace(section, steps, |station, off| {
                // In a knit it goes on along the tangent.
                let (frame, start) = *root.get_or_insert_with(|| (self.frame(place, &station), station.along));
                let frame = frame.map(|frame: Frame| frame.ahead(station.along - start));
                curve.points.push(self.point(place, &station, frame, off));
            });
            take(&curve);
        }
    }

    /// The frame of a thread at a station, if it lies in loops.
    fn frame(&self, thread: &Thread, station: &Station) -> Option<Frame> {
        match self.axis(thread) {
            Axis::Plane(_) => None,
            Axis::Loops(course) => Some(course.at(station.along)),
        }
    }

    /// The point of a thread at a station, off its axis by `place` (left, up).
    fn point(&self, thread: &Thread, station: &Station, frame: Option<Frame>, place: DVec2) -> DVec3 {
        if let Some(frame) = frame {
            return frame.off(place);
        }
        let z = station.height + place.y;
        // Left is up × the thread's direction.
        match thread.system {
            System::Warp => DVec3::new(thread.at - place.x, station.along, z),
            System::Weft => DVec3::new(station.along, thread.at + place.x, z),
        }
    }
}

/// Random numbers of one stream of one draw.
pub(super) fn generator(seed: u64, number: u64, stream: u64) -> ChaCha8Rng {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&number.to_le_bytes());
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(stream);
    rng
}
