//! The medium of a cloth against its fibers.

use super::run::Prepared;
use crate::bsdf::{
    Distance, Estimate, Gap, Share, Totals, Verdict, distance_of, hemispherical, scattered_parts, totals,
};
use crate::cloth::DrawnFor;
use crate::error::Result;
use crate::explicit::Explicit;
use crate::goniometer::{Goniometer, Tally};
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

/// Where light goes through the fibers themselves, and through the medium, in one channel: means over the hemisphere and the lit
/// sides as a table of totals has them, plain ones over listed directions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AgainstFibers {
    /// Walks through the fibers.
    pub walks: u64,
    /// Index of the channel, the middle one.
    pub channel: usize,
    /// Reflected, transmitted, direct and absorbed light through fibers; the errors are those between realizations.
    pub fibers: [Estimate; 4],
    /// The same through the medium.
    pub medium: [Estimate; 4],
    /// E² of the scattered light of all starts and channels, by parts of the hemispheres.
    pub light: Distance,
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
            let tally = explicit.run(goniometer, &plan, &mut |_| {})?;
            let values = scattered_parts(&tally, &goniometer.exit).iter().map(|part| part.value).collect();
            Ok((means(&tally, goniometer, channel), values))
        };
        let blocks: Vec<([Estimate; 4], Vec<f64>)> =
            (0..realizations).into_par_iter().map(through).collect::<Result<_>>()?;
        let (parts, light): (Vec<[Estimate; 4]>, Vec<Vec<f64>>) = blocks.into_iter().unzip();
        let mut sums = [(0.0, 0.0); 4];
        for (sum, share) in parts.iter().flat_map(|part| (0..4).zip(part)) {
            sums[sum] = (sums[sum].0 + share.value, sums[sum].1 + share.value.powi(2));
        }
        let (n, walks) = (realizations as f64, realizations * each * starts);
        let fibers = sums.map(|(sum, square)| {
            let value = sum / n;
            // Of few realizations the scatter may come out too small: walks alone leave this much.
            let alone = (value * (1.0 - value) / walks as f64).max(0.0).sqrt().max(1.0 / walks as f64);
            Estimate { value, stderr: ((square / n - value * value).max(0.0) / (n - 1.0)).sqrt().max(alone) }
        });
        let light = apart(&scattered_parts(tally, &goniometer.exit), &light)?;
        Ok(Some(AgainstFibers { walks, channel, fibers, medium: means(tally, goniometer, channel), light }))
    }

    /// By how much the medium is off, as a share of all light.
    pub fn differences(&self) -> [Estimate; 4] {
        [0, 1, 2, 3].map(|i| Estimate {
            value: self.medium[i].value - self.fibers[i].value,
            stderr: self.medium[i].stderr.hypot(self.fibers[i].stderr),
        })
    }

    /// What it says of a tolerance.
    pub fn verdict(&self) -> Verdict {
        let differences = self.differences();
        let gap = |(share, i): (Share, usize)| Gap {
            share,
            start: None,
            channel: self.channel,
            value: self.fibers[i].value,
            off: differences[i],
        };
        Verdict { light: self.light, gaps: Share::ALL.into_iter().zip(0..).map(gap).collect() }
    }
}

/// E² between the light of a medium and that of blocks of walks through the fibers. All blocks are held against the same walks through
/// the medium, whose noise is therefore taken off.
fn apart(medium: &[Estimate], fibers: &[Vec<f64>]) -> Result<Distance> {
    let values: Vec<f64> = medium.iter().map(|part| part.value).collect();
    let Distance { square, square_error } = distance_of(&vec![values; fibers.len()], fibers)?;
    let sum = |of: fn(&Estimate) -> f64| medium.iter().map(of).sum::<f64>();
    let (noise, all) = (sum(|part| part.stderr.powi(2)), sum(|part| part.value.powi(2)));
    Ok(Distance { square: square - if all > 0.0 { noise / all } else { 0.0 }, square_error })
}

/// Means of what is reflected, transmitted, direct and absorbed.
fn means(tally: &Tally, goniometer: &Goniometer, channel: usize) -> [Estimate; 4] {
    let sides = 0..goniometer.sides.len();
    let hemispheres: Option<Vec<Totals>> = sides.map(|side| hemispherical(tally, goniometer, side, channel)).collect();
    let parts = hemispheres.unwrap_or_else(|| (0..tally.starts()).map(|start| totals(tally, start, channel)).collect());
    let n = parts.len() as f64;
    Share::ALL.map(|share| Estimate {
        value: parts.iter().map(|part| share.of(part).value).sum::<f64>() / n,
        stderr: parts.iter().map(|part| share.of(part).stderr.powi(2)).sum::<f64>().sqrt() / n,
    })
}
