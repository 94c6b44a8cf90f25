//! One walk through the fibers of a realization.

use crate::cloth::{FiberGrid, Way, Work};
use crate::goniometer::{Goniometer, Outcome};
use crate::optics::Encounter;
use crate::tables::Kind;
use crate::walk::{EventDraws, Purpose, ROULETTE_EVERY, WalkPlan, Walked, draw, start_draws, start_place, uniform};
use std::sync::Arc;

/// What light meets.
#[derive(Clone, Copy)]
pub struct Bodies<'a> {
    /// The fibers of a realization.
    pub grid: &'a FiberGrid,
    /// Where the light goes on after each hit: through one of these realizations, drawn anew; without any, through the same.
    pub anew: &'a [Arc<FiberGrid>],
    /// Kinds of fiber.
    pub kinds: &'a [Kind],
    /// Of each kind of the scene, its place in `kinds`.
    pub places: &'a [usize],
    /// Half the length of the approximating cylinder in radii; infinite for no bases.
    pub half_length: f64,
}

/// Walk number `i` of a start through one realization, until the light leaves it or is given up. Its events are the pieces
/// that were tested.
pub fn walk(bodies: &Bodies, goniometer: &Goniometer, plan: &WalkPlan, start: usize, i: u64) -> Walked {
    let Bodies { mut grid, anew, kinds, places, half_length } = *bodies;
    let id = WalkPlan::walk_id(goniometer.starts(), i, start);
    let lit = goniometer.side(start);
    let words = draw(plan.seed, id, 0, Purpose::Start);
    let mut m = -goniometer.start_direction(start, start_draws(words));
    let [low, high] = grid.span();
    let mut place = (start_place(words) * grid.period()).extend(if m.z < 0.0 { high } else { low });
    let mut left = None;
    let roulette = plan.roulette && Kind::channels(kinds).is_some();
    let layout = goniometer.layout();
    let (mut walked, mut work) = (Walked::default(), Work::default());
    for hit in 0..plan.max_events {
        let way = grid.first_entry(place, m, left, &mut work);
        walked.record.events = work.tests.min(u64::from(u32::MAX)) as u32;
        let (tube, point, offset) = match way {
            Way::Fiber { tube, point, meeting } => (tube, point, meeting.offset),
            Way::Out => {
                walked.record.bin = goniometer.exit_bin(lit, m, walked.record.hits > 0) as u32;
                return walked;
            }
            Way::Endless => break,
        };
        // Send the light through the fiber there, and on from where it leaves.
        let draws = EventDraws::new(draw(plan.seed, id, hit, Purpose::Event));
        let piece = &grid.tubes()[tube];
        let kind = places[piece.kind()];
        let passage = Encounter::new(m, piece.direction(), offset, kinds[kind].ior).pass(draws.accept, half_length);
        m = passage.direction.normalize();
        place = point + passage.displacement * piece.radius();
        left = Some(tube);
        if !anew.is_empty() {
            let number = uniform(draw(plan.seed, id, hit, Purpose::Realization)[0]);
            (grid, left) = (&anew[(number * anew.len() as f64) as usize], None);
        }
        walked.lengths[kind] += passage.path * piece.radius();
        walked.base_exits += u32::from(passage.through_base);
        walked.record.hits += 1;
        if roulette && (hit + 1) % ROULETTE_EVERY == 0 {
            let number = uniform(draw(plan.seed, id, hit / ROULETTE_EVERY, Purpose::Roulette)[0]);
            if !walked.survives(kinds, number) {
                walked.record.bin = layout.outcome(Outcome::Ended) as u32;
                return walked;
            }
        }
    }
    walked.record.bin = layout.outcome(Outcome::Lost) as u32;
    walked
}
