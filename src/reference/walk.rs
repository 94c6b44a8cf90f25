//! One stochastic walk from fiber to fiber (paper §4).

use super::medium::{draw_fiber, free_path};
use crate::goniometer::Goniometer;
use crate::optics::Encounter;
use crate::tables::SamplingTables;
use crate::walk::{EventDraws, Purpose, WalkPlan, WalkRecord, draw, start_draws};
use glam::DVec3;

/// Sees how near each decision of a walk was to falling the other way.
pub(super) trait Witness {
    /// A decision, and the distance of the deciding number from its threshold, in its own unit of order 1.
    fn decide(&mut self, distance: impl FnOnce() -> f64);
}

/// Sees nothing and costs nothing.
pub(super) struct Blind;

impl Witness for Blind {
    fn decide(&mut self, _: impl FnOnce() -> f64) {}
}

/// A walk and its nearest decision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Replay {
    /// How it went.
    pub record: WalkRecord,
    /// The least distance of any decision from its threshold, taken relative to the scale on which errors of that
    /// quantity grow: depths by the sheet's thickness, numbers and bins as they are.
    pub nearest_tie: f64,
}

struct Nearest(f64);

impl Witness for Nearest {
    fn decide(&mut self, distance: impl FnOnce() -> f64) {
        self.0 = self.0.min(distance().abs());
    }
}

/// Walk number `i` of an incident cell once more, with its nearest decision.
pub fn replay(tables: &SamplingTables, goniometer: &Goniometer, plan: &WalkPlan, cell: usize, i: u64) -> Replay {
    let mut nearest = Nearest(f64::INFINITY);
    let record = walk(tables, goniometer, plan, cell, i, &mut nearest);
    Replay { record, nearest_tie: nearest.0 }
}

/// Walk until the light leaves the sheet or is given up.
pub(super) fn walk(
    tables: &SamplingTables,
    goniometer: &Goniometer,
    plan: &WalkPlan,
    cell: usize,
    i: u64,
    witness: &mut impl Witness,
) -> WalkRecord {
    let id = WalkPlan::walk_id(goniometer.incident_cells(), i, cell);
    let mut m = -goniometer.start_direction(cell, start_draws(draw(plan.seed, id, 0, Purpose::Start)));
    let (mut z, mut hits) = (0.0, 0);
    for event in 0..plan.max_events {
        let draws = EventDraws::new(draw(plan.seed, id, event, Purpose::Event));
        // Fly to the next tentative event.
        z += m.z * free_path(tables, &draws);
        witness.decide(|| z.abs().min((z + tables.thickness).abs()) / tables.thickness);
        if z > 0.0 || z < -tables.thickness {
            witness.decide(|| bin_distance(goniometer, m, hits));
            return WalkRecord { bin: goniometer.exit_bin(m, hits > 0) as u32, events: event + 1, hits };
        }
        // Draw the fiber there and see whether the ray hits it.
        let p = draw_fiber(tables, &draws, plan.jitter);
        let visible = m.cross(p).length();
        witness.decide(|| draws.accept - visible);
        if draws.accept < visible {
            m = scatter(m, p, draws.offset, draws.accept / visible, tables.ior, witness);
            hits += 1;
        }
    }
    WalkRecord { bin: goniometer.layout().lost() as u32, events: plan.max_events, hits }
}

/// Send the ray through the fiber it has hit; `number` is uniform in (0, 1).
fn scatter(m: DVec3, p: DVec3, offset: f64, number: f64, ior: f64, witness: &mut impl Witness) -> DVec3 {
    let encounter = Encounter::new(m, p, offset, ior);
    let chords = encounter.chords(number);
    // Thresholds of 1 − number lie at (1 − F) F^j: the two around the drawn k decide.
    witness.decide(|| {
        let (rest, f) = (1.0 - number, encounter.reflectance);
        let threshold = |j: i32| rest - (1.0 - f) * f.powi(j);
        threshold(chords as i32).abs().min(if chords > 0 { threshold(chords as i32 - 1).abs() } else { 1.0 })
    });
    encounter.exit_direction(chords).normalize()
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
