//! The medium of a cloth against its fibers.

use super::run::Prepared;
use crate::bsdf::{Estimate, Totals, totals};
use crate::cloth::DrawnFor;
use crate::error::Result;
use crate::explicit::Explicit;
use crate::goniometer::Tally;
use crate::scene::{Packing, Scene};
use crate::walk::{WalkPlan, Walker};
use rayon::prelude::*;
use serde::Serialize;

/// Realizations, and walks through each, all starts together.
const REALIZATIONS: u64 = 8;
const WALKS: u64 = 2048;
/// Separate fibers take long to draw, those of yarns, which lie close, four times as long as those of sheets: their realizations
/// have so many straight pieces at most, all together, and no more than the run has walks; they are so many at least.
const SEPARATE_PIECES: u64 = 1 << 17;
const OF_YARNS: u64 = 1 << 15;
const FEWEST: u64 = 4;

/// Where light goes through the fibers themselves, and through the medium: means over all starts in one channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AgainstFibers {
    /// Walks through the fibers.
    pub walks: u64,
    /// Index of the channel, the middle one.
    pub channel: usize,
    /// Reflected, transmitted and direct light through fibers; the errors are those between realizations.
    pub fibers: [Estimate; 3],
    /// The same through the medium.
    pub medium: [Estimate; 3],
}

impl AgainstFibers {
    /// Send a few walks through the fibers of a prepared cloth, whose medium `tally` has measured with this seed; none where they are
    /// separate and take too long to be drawn for such a run. The fibers are others than those that the medium was made of.
    ///
    /// # Errors
    /// Those of [`Realizer::draw`](crate::cloth::Realizer::draw), of [`Explicit::drawn`] and of its run.
    pub fn new(scene: &Scene, prepared: &Prepared, tally: &Tally, seed: u64) -> Result<Option<AgainstFibers>> {
        let realizer = prepared.realizer(scene, scene.model.packing, DrawnFor::Judge)?.keeping();
        let realizations = match scene.model.packing {
            Packing::Random => REALIZATIONS,
            Packing::Separate => {
                let most = if prepared.cloth.is_some() { OF_YARNS } else { SEPARATE_PIECES };
                let pieces = most.min(tally.counts.launched);
                REALIZATIONS.min(pieces / realizer.expected_pieces().max(1) as u64)
            }
        };
        if realizations < FEWEST {
            return Ok(None);
        }
        let goniometer = &prepared.goniometer;
        let starts = goniometer.starts() as u64;
        let explicit = Explicit::drawn(scene, Some(WALKS as usize), move |number| realizer.draw(number))?;
        let each = explicit.walks_of_start(starts as usize);
        let channel = tally.channels() / 2;
        let through = |number| {
            let plan = WalkPlan { first: number * each, ..WalkPlan::new(!seed, each) };
            Ok(means(&explicit.run(goniometer, &plan, &mut |_| {})?, channel))
        };
        let parts: Vec<[Estimate; 3]> = (0..realizations).into_par_iter().map(through).collect::<Result<_>>()?;
        let mut sums = [(0.0, 0.0); 3];
        for (sum, share) in parts.iter().flat_map(|part| (0..3).zip(part)) {
            sums[sum] = (sums[sum].0 + share.value, sums[sum].1 + share.value.powi(2));
        }
        let (n, walks) = (realizations as f64, realizations * each * starts);
        let fibers = sums.map(|(sum, square)| {
            let value = sum / n;
            // Of few realizations the scatter may come out too small: walks alone leave this much.
            let alone = (value * (1.0 - value) / walks as f64).max(0.0).sqrt().max(1.0 / walks as f64);
            Estimate { value, stderr: ((square / n - value * value).max(0.0) / (n - 1.0)).sqrt().max(alone) }
        });
        Ok(Some(AgainstFibers { walks, channel, fibers, medium: means(tally, channel) }))
    }

    /// By how much the medium is off, as a share of all light.
    pub fn differences(&self) -> [Estimate; 3] {
        [0, 1, 2].map(|i| Estimate {
            value: self.medium[i].value - self.fibers[i].value,
            stderr: self.medium[i].stderr.hypot(self.fibers[i].stderr),
        })
    }
}

/// Means over the starts of what is reflected, transmitted and direct.
fn means(tally: &Tally, channel: usize) -> [Estimate; 3] {
    let parts: Vec<Totals> = (0..tally.starts()).map(|start| totals(tally, start, channel)).collect();
    let n = parts.len() as f64;
    let mean = |of: fn(&Totals) -> Estimate| Estimate {
        value: parts.iter().map(|part| of(part).value).sum::<f64>() / n,
        stderr: parts.iter().map(|part| of(part).stderr.powi(2)).sum::<f64>().sqrt() / n,
    };
    [mean(|part| part.reflectance), mean(|part| part.transmittance), mean(|part| part.direct)]
}
