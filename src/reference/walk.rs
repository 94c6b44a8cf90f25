//! One stochastic walk from fiber to fiber (paper §4).

use super::carried::Touch;
use super::cells::Station;
use super::flight::{Event, Flight};
use super::medium::draw_fiber;
use super::memory::{Known, Memory};
use crate::distribution::CellGrid;
use crate::goniometer::{Goniometer, Outcome};
use crate::optics::{Encounter, Passage};
use crate::scene::Side;
use crate::tables::{Kind, SamplingTables};
use crate::walk::{
    EventDraws, FirstHit, Purpose, ROULETTE_BELOW, ROULETTE_EVERY, WalkPlan, Walked, draw, start_draws, start_place,
    uniform, widen,
};
use glam::{DVec2, DVec3};

/// Sees how near each decision of a walk was to falling the other way.
pub(super) trait Witness {
    /// A decision, and the distance of the deciding number from its threshold, in its own unit of order 1.
    fn decide(&mut self, distance: impl FnOnce() -> f64);

    /// Errors of what is decided from here on have grown by this factor.
    fn magnify(&mut self, factor: impl FnOnce() -> f64);
}

/// Sees nothing and costs nothing.
pub(super) struct Blind;

impl Witness for Blind {
    fn decide(&mut self, _: impl FnOnce() -> f64) {}

    fn magnify(&mut self, _: impl FnOnce() -> f64) {}
}

/// A walk and its nearest decision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Replay {
    /// How it went.
    pub walked: Walked,
    /// The least distance of any decision from its threshold, taken relative to the scale on which errors of that
    /// quantity grow: depths by the sheet's thickness, places among cells by the length of the flights (or the larger of
    /// thickness and repeat), numbers and bins as they are.
    pub nearest_tie: f64,
}

/// The least distance so far, and how much errors have grown.
struct Nearest(f64, f64);

impl Witness for Nearest {
    fn decide(&mut self, distance: impl FnOnce() -> f64) {
        self.0 = self.0.min(distance().abs() / self.1);
    }

    fn magnify(&mut self, factor: impl FnOnce() -> f64) {
        self.1 *= factor();
    }
}

/// Walk number `i` of a start once more, with its nearest decision.
pub fn replay(tables: &SamplingTables, goniometer: &Goniometer, plan: &WalkPlan, start: usize, i: u64) -> Replay {
    let mut nearest = Nearest(f64::INFINITY, 1.0);
    let walked = walk(tables, goniometer, plan, start, i, &mut nearest);
    Replay { walked, nearest_tie: nearest.0 }
}

/// Walk until the light leaves the sheet or is given up.
pub(super) fn walk(
    tables: &SamplingTables,
    goniometer: &Goniometer,
    plan: &WalkPlan,
    start: usize,
    i: u64,
    witness: &mut impl Witness,
) -> Walked {
    if let Some(first_hits) = &plan.first_hits {
        let begun = first_hit(tables, goniometer, plan, (start, i), first_hits.of_walk(start, i), witness);
        return begun.map_or_else(|walked| walked, |begun| go_on(tables, goniometer, plan, (start, i), begun, witness));
    }
    let id = WalkPlan::walk_id(goniometer.starts(), i, start);
    let lit = goniometer.side(start);
    let words = draw(plan.seed, id, 0, Purpose::Start);
    let m = -goniometer.start_direction(start, start_draws(words));
    // A hit lies up to a radius beyond the faces when it belongs to its fiber's axis.
    let beyond = tables.carry.map_or(0.0, |carry| carry.radius);
    let z = if lit == Side::Front { beyond } else { -tables.thickness - beyond };
    let period = tables.cells.as_ref().map_or(DVec2::splat(tables.thickness), |cells| cells.grid.period);
    let place = (start_place(words) * period).extend(z);
    let begun = Begun { place, m, walked: Walked::default(), memory: memory(tables) };
    go_on(tables, goniometer, plan, (start, i), begun, witness)
}

/// Send a walk along a straight ray and through the fiber that it meets: event 0. It has ended if there is none.
fn first_hit(
    tables: &SamplingTables,
    goniometer: &Goniometer,
    plan: &WalkPlan,
    (start, i): (usize, u64),
    ray: &FirstHit,
    witness: &mut impl Witness,
) -> Result<Begun, Walked> {
    let m = widen(ray.m).normalize();
    let mut walked = Walked::default();
    walked.record.events = 1;
    let Some(fiber) = ray.fiber else {
        walked.record.bin = goniometer.exit_bin(goniometer.side(start), m, false) as u32;
        return Err(walked);
    };
    let id = WalkPlan::walk_id(goniometer.starts(), i, start);
    let number = EventDraws::new(draw(plan.seed, id, 0, Purpose::Event)).accept;
    let (kind, p) = (&tables.kinds[fiber.kind as usize], widen(fiber.p).normalize());
    let passage = scatter(m, p, f64::from(fiber.offset), number, kind, tables.half_length, witness);
    walked.record.hits = 1;
    walked.lengths[fiber.kind as usize] = passage.path * kind.radius;
    walked.base_exits = u32::from(passage.through_base);
    let out = passage.direction.normalize();
    let mut begun = Begun { place: widen(fiber.place), m: out, walked, memory: memory(tables) };
    let Some(carry) = &tables.carry else { return Ok(begun) };
    let face = if m.z < 0.0 { carry.radius } else { -tables.thickness - carry.radius };
    let flown = ((begun.place.z - face) / m.z).max(0.0);
    let displacement = passage.displacement * kind.radius;
    begun.place += displacement;
    if let Some(memory) = &mut begun.memory {
        let touch = Touch { m, p, offset: f64::from(fiber.offset), radius: kind.radius };
        memory.fly(flown, flown, witness);
        memory.hit(&touch, fiber.kind as usize, displacement, (begun.place.z, out), witness);
    }
    Ok(begun)
}

/// What walks remember at first, if they remember anything.
fn memory(tables: &SamplingTables) -> Option<Memory> {
    let remembers = tables.carry.is_some_and(|carry| carry.memory);
    remembers.then(|| Memory::new(tables.thickness, tables.half_length))
}

/// A walk that is under way.
#[derive(Clone, Copy, Debug)]
struct Begun {
    /// Where its next flight sets out, in mm.
    place: DVec3,
    /// Where to.
    m: DVec3,
    /// How it went so far, and what it remembers of that.
    walked: Walked,
    memory: Option<Memory>,
}

fn go_on(
    tables: &SamplingTables,
    goniometer: &Goniometer,
    plan: &WalkPlan,
    (start, i): (usize, u64),
    begun: Begun,
    witness: &mut impl Witness,
) -> Walked {
    let Begun { place, mut m, mut walked, memory } = begun;
    let (id, lit) = (WalkPlan::walk_id(goniometer.starts(), i, start), goniometer.side(start));
    let homogeneous = CellGrid::homogeneous(tables.thickness);
    let grid = tables.cells.as_ref().map_or(&homogeneous, |cells| &cells.grid);
    let station = Station::start(grid, place);
    witness.decide(|| if tables.cells.is_some() { station.face_distance(grid) } else { f64::INFINITY });
    let mut flight = Flight::new(station, memory);
    flight.left_fiber = tables.carry.is_some() && walked.record.hits > 0;
    let roulette = plan.roulette && tables.absorbing();
    let layout = goniometer.layout();
    for event in walked.record.events..plan.max_events {
        let draws = EventDraws::new(draw(plan.seed, id, event, Purpose::Event));
        walked.record.events = event + 1;
        // Come to a fiber that is known, or draw one here.
        let (touch, kind, number) = match flight.event(tables, grid, m, &draws, witness) {
            Event::Left => {
                witness.decide(|| bin_distance(goniometer, m, walked.record.hits));
                walked.record.bin = goniometer.exit_bin(lit, m, walked.record.hits > 0) as u32;
                return walked;
            }
            Event::Passed => (None, 0, 0.0),
            Event::Known(Known { p, offset, kind, .. }) => {
                (Some(Touch { m, p, offset, radius: tables.kinds[kind].radius }), kind, draws.accept)
            }
            Event::Fiber { share, list } => {
                let (p, kind) = draw_fiber(tables, list, &draws, plan.jitter);
                let touch = Touch { m, p, offset: draws.offset, radius: tables.kinds[kind].radius };
                let share = match &tables.carry {
                    Some(_) => share * flight.share_of_axis(tables, grid, &touch, witness),
                    None => share,
                };
                // See whether the ray hits it.
                let seen = share * m.cross(p).length();
                let hit = draws.accept < seen;
                if share > 0.0 {
                    witness.decide(|| draws.accept - seen);
                    flight.drawn(hit);
                }
                let hit = hit && !flight.memory.as_ref().is_some_and(|memory| memory.rules_out(&touch, witness));
                (hit.then_some(touch), kind, draws.accept / seen)
            }
        };
        if let Some(touch) = touch {
            let Touch { p, offset, radius, .. } = touch;
            let passage = scatter(m, p, offset, number, &tables.kinds[kind], tables.half_length, witness);
            m = passage.direction.normalize();
            walked.lengths[kind] += passage.path * radius;
            if tables.carry.is_some() {
                flight.carry(&touch, kind, passage.displacement * radius, m, witness);
            }
            walked.base_exits += u32::from(passage.through_base);
            walked.record.hits += 1;
        }
        if roulette && (event + 1) % ROULETTE_EVERY == 0 {
            let round = event / ROULETTE_EVERY;
            let number = uniform(draw(plan.seed, id, round, Purpose::Roulette)[0]);
            if !survive(&mut walked, tables, number, witness) {
                walked.record.bin = layout.outcome(Outcome::Ended) as u32;
                return walked;
            }
        }
    }
    walked.record.bin = layout.outcome(Outcome::Lost) as u32;
    walked
}

/// Send the ray through the fiber it has hit; `number` is uniform in (0, 1).
fn scatter(
    m: DVec3,
    p: DVec3,
    offset: f64,
    number: f64,
    kind: &Kind,
    half_length: f64,
    witness: &mut impl Witness,
) -> Passage {
    let encounter = Encounter::new(m, p, offset, kind.ior);
    // Thresholds of 1 − number lie at (1 − F) F^j: the two around the drawn k decide.
    witness.decide(|| {
        let chords = encounter.chords(number) as i32;
        let (rest, f) = (1.0 - number, encounter.reflectance);
        let threshold = |j: i32| rest - (1.0 - f) * f.powi(j);
        threshold(chords).abs().min(if chords > 0 { threshold(chords - 1).abs() } else { 1.0 })
    });
    encounter.pass(number, half_length)
}

/// Play Russian roulette with a walk.
fn survive(walked: &mut Walked, tables: &SamplingTables, number: f64, witness: &mut impl Witness) -> bool {
    let kept = walked.kept(&tables.kinds);
    witness.decide(|| kept - ROULETTE_BELOW);
    if kept < ROULETTE_BELOW {
        witness.decide(|| number - kept);
    }
    walked.survives(&tables.kinds, number)
}

/// Distance of an exit from the edge of its bin: in cells, and from the horizon.
fn bin_distance(goniometer: &Goniometer, m: DVec3, hits: u32) -> f64 {
    if hits == 0 {
        return f64::INFINITY;
    }
    let place = goniometer.exit.place(m.truncate());
    let edge = (place - place.round()).abs();
    edge.min_element().min(m.z.abs())
}
