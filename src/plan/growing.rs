//! What pilots that go on cost, and whether that pays.

use super::choice::Candidate;
use super::configuration::Configuration;
use super::pilot::{BESIDE, Pilot};
use super::planner::Planner;
use super::prior::USUAL_EDGE;
use super::trial::BLOCKS;
use crate::bsdf::{Distance, Verdict};

/// Pilots may take so many seconds, or this part of what walks through the fibers would take.
const ALLOWED: f64 = 1.0;
const OF_FIBERS: f64 = 0.5;
/// Seconds of a pilot over those of its walks and pieces: first hits, dispatches.
const AROUND: f64 = 1.5;

impl Planner<'_> {
    /// Whether twice the walks of a pilot cost less than they save: an error that is known better leaves more to noise. One that was
    /// found smaller than in other cloths may come out as large as there.
    pub(super) fn pays(&self, chosen: &Candidate, verdict: &Verdict, pilot: &Pilot) -> bool {
        let known = self.belief.at(chosen.configuration.edge.unwrap_or(USUAL_EDGE)).error.powi(2);
        let Distance { square, square_error } = verdict.light;
        let sharp = self.left_by(&Distance { square: square.max(known), square_error: square_error / 2.0 });
        let (Some(noise), Some(sharp), Some(seconds)) = (chosen.noise, sharp, chosen.walk_seconds) else {
            return false;
        };
        seconds * (1.0 - (noise / sharp).powi(2)) > self.of_pilot(pilot, pilot.walks()) - self.of_pilot(pilot, 0.0)
    }

    /// Seconds of a pilot with so many more walks in a further round, and of those through a medium beside them; of the pilot as it
    /// is without any.
    fn of_pilot(&self, pilot: &Pilot, walks: f64) -> f64 {
        let more = if walks > 0.0 { (walks / pilot.walks_a_realization).max(BLOCKS as f64) } else { 0.0 };
        let beside = self.events.map_or(0.0, |(_, events)| BESIDE as f64 * events * self.cost.event);
        let of_walks = (pilot.walks() + walks) * (pilot.tests_a_walk * self.cost.test + beside);
        AROUND * (of_walks + (pilot.realizations() + more) * pilot.pieces as f64 * self.cost.piece)
    }

    /// Whether a pilot may make so many more walks: while that is cheap beside walks through the fibers.
    pub(super) fn may_grow(&self, pilot: &Pilot, walks: f64) -> bool {
        let fibers = self.judge(&Configuration::usual_fibers(self.scene), pilot, false).seconds();
        walks <= pilot.room() && self.of_pilot(pilot, walks) <= ALLOWED.max(OF_FIBERS * fibers)
    }
}
