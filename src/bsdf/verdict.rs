//! What walks through a medium and through the fibers of its own cloth say together: how far it is from them, and whether that
//! keeps a tolerance. Pilots and the check at the end of a run both ask here.

use super::distance::{Distance, distance};
use super::estimate::Estimate;
use super::totals::{Totals, totals};
use crate::error::Result;
use crate::goniometer::Tally;
use serde::Serialize;

/// Standard errors of E² on both sides of an interval at the level of 95 %, and of a total at which it is surely off.
const Z: f64 = 2.0;
/// A total may be off by this share of the light, however little it is.
const LIGHT: f64 = 0.005;
/// A total whose standard error is more than this part of what it may be off by is not known well enough.
const BLUNT: f64 = 0.75;
/// Part of the distance to the tolerance that an interval may take after more walks.
const AIM: f64 = 0.9;
/// Most times as many walks as there are that a further round is to bring.
const MOST: f64 = 8.0;

/// A part of the light that is held against the fibers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Share {
    /// Leaves on the lit side.
    Reflected,
    /// Touched a fiber and leaves on the other side.
    Transmitted,
    /// Touched no fiber.
    Direct,
    /// Stays in the fibers.
    Absorbed,
}

impl Share {
    /// All four; with what is lost they add up to 1.
    pub const ALL: [Share; 4] = [Share::Reflected, Share::Transmitted, Share::Direct, Share::Absorbed];

    /// It among the totals of a start, or in a mean of them.
    pub fn of(self, totals: &Totals) -> Estimate {
        match self {
            Share::Reflected => totals.reflectance,
            Share::Transmitted => totals.transmittance,
            Share::Direct => totals.direct,
            Share::Absorbed => totals.absorptance,
        }
    }

    /// Its word.
    pub fn name(self) -> &'static str {
        match self {
            Share::Reflected => "reflected",
            Share::Transmitted => "transmitted",
            Share::Direct => "direct",
            Share::Absorbed => "absorbed",
        }
    }
}

/// A total through the fibers, and by how much that through the medium is off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gap {
    /// Which light.
    pub share: Share,
    /// Incident direction of the pilot; none of the mean over all of them.
    pub start: Option<usize>,
    /// Index of the channel.
    pub channel: usize,
    /// Its value through the fibers.
    pub value: f64,
    /// Medium less fibers, with the standard error that the scatter between blocks gives it.
    pub off: Estimate,
}

impl Gap {
    /// By how much it may be off: the tolerance of itself, or half a percent of the light.
    fn allowed(&self, tolerance: f64) -> f64 {
        LIGHT.max(tolerance * self.value)
    }

    /// What is surely more than allowed, as a part of that: above 1 the promise is broken.
    fn surely(&self, tolerance: f64) -> f64 {
        (self.off.value.abs() - Z * self.off.stderr) / self.allowed(tolerance)
    }
}

/// Whether a medium keeps a tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kept {
    /// At the level of 95 %.
    Yes,
    /// It does not, at that level.
    No,
    /// Walks are too few to tell; with so many times as many it may be told.
    Untold(f64),
}

/// What blocks of walks through a medium and through the fibers say together.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// E² of all scattered light.
    pub light: Distance,
    /// Reflected, transmitted, direct and absorbed light of each direction and channel, and their means over directions.
    pub gaps: Vec<Gap>,
}

impl Verdict {
    /// Of equal numbers of blocks of both; block i of one may share its realization with block i of the other, and with no other.
    ///
    /// # Errors
    /// Those of [`distance`].
    pub fn new(medium: &[Tally], fibers: &[Tally]) -> Result<Verdict> {
        let light = distance(medium, fibers)?;
        let (starts, channels) = (fibers[0].starts(), fibers[0].channels());
        let mut gaps = Vec::new();
        for channel in 0..channels {
            // By start and block: totals of both.
            let of = |start: usize| -> Vec<[Totals; 2]> {
                medium.iter().zip(fibers).map(|(a, b)| [a, b].map(|tally| totals(tally, start, channel))).collect()
            };
            let all: Vec<Vec<[Totals; 2]>> = (0..starts).map(of).collect();
            for share in Share::ALL {
                let pair = |start: usize, block: usize| all[start][block].map(|totals| share.of(&totals).value);
                let one = |start: Option<usize>| {
                    let mean = |block: usize| match start {
                        Some(start) => pair(start, block),
                        None => {
                            let sum = (0..starts).map(|start| pair(start, block));
                            sum.fold([0.0; 2], |sum, pair| [0, 1].map(|i| sum[i] + pair[i] / starts as f64))
                        }
                    };
                    gap(share, start, channel, &(0..fibers.len()).map(mean).collect::<Vec<_>>())
                };
                gaps.extend((0..starts).map(|start| one(Some(start))));
                gaps.push(one(None));
            }
        }
        Ok(Verdict { light, gaps })
    }

    /// E, and the ends of its interval at the level of 95 %.
    pub fn interval(&self) -> [f64; 2] {
        let Distance { square, square_error } = self.light;
        let positive = square.max(0.0);
        // Where E stands clear of its noise it is E, and not its square, that scatters evenly.
        let clear = if square_error > 0.0 { square_error * square_error / (positive + square_error) } else { 0.0 };
        [(square - Z * square_error).max(0.0).sqrt(), (positive + Z * square_error + clear).sqrt()]
    }

    /// The total that is farthest beyond what it may be off by, if one surely is.
    pub fn broken(&self, tolerance: f64) -> Option<&Gap> {
        let surely = |gap: &&Gap| gap.surely(tolerance);
        self.gaps.iter().max_by(|a, b| surely(a).total_cmp(&surely(b))).filter(|gap| surely(gap) > 1.0)
    }

    /// Whether E and all totals keep a tolerance.
    pub fn kept(&self, tolerance: f64) -> Kept {
        let [low, high] = self.interval();
        if low > tolerance || self.broken(tolerance).is_some() {
            return Kept::No;
        }
        let blunt = self.gaps.iter().map(|gap| gap.off.stderr / gap.allowed(tolerance)).fold(0.0, f64::max);
        if high <= tolerance && blunt <= BLUNT {
            return Kept::Yes;
        }
        // The error of E² falls with the walks where noise makes it, that of a total with their root.
        let margin = AIM * (tolerance * tolerance - self.light.square.max(0.0)).abs();
        let wanted = (Z * self.light.square_error / margin).max((blunt / (AIM * BLUNT)).powi(2));
        Kept::Untold(if wanted.is_finite() { wanted.clamp(2.0, MOST) } else { MOST })
    }
}

/// The gap of a total from its values by block, medium first.
fn gap(share: Share, start: Option<usize>, channel: usize, blocks: &[[f64; 2]]) -> Gap {
    let n = blocks.len() as f64;
    let value = blocks.iter().map(|[_, fibers]| fibers).sum::<f64>() / n;
    let off = blocks.iter().map(|[medium, fibers]| medium - fibers).sum::<f64>() / n;
    let square: f64 = blocks.iter().map(|[medium, fibers]| (medium - fibers - off).powi(2)).sum();
    Gap { share, start, channel, value, off: Estimate { value: off, stderr: (square / n / (n - 1.0)).sqrt() } }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(square: f64, square_error: f64, off: f64, stderr: f64) -> Verdict {
        let off = Estimate { value: off, stderr };
        let gap = Gap { share: Share::Absorbed, start: None, channel: 0, value: 0.1, off };
        Verdict { light: Distance { square, square_error }, gaps: vec![gap] }
    }

    #[test]
    fn a_tolerance_is_kept_or_not_only_where_the_interval_lies_on_one_side() {
        let near = verdict(0.02f64.powi(2), 1e-5, 0.0, 1e-3);
        assert_eq!((near.kept(0.05), near.kept(0.01)), (Kept::Yes, Kept::No));
        let [low, high] = near.interval();
        assert!(low < 0.02 && high > 0.02 && high - low < 0.01, "{low} {high}");
        // What is as coarse as the tolerance asks for more walks, the more the coarser.
        let more = |error: f64| match verdict(0.0, error, 0.0, 1e-3).kept(0.05) {
            Kept::Untold(times) => times,
            kept => panic!("{kept:?}"),
        };
        assert!((2.0..4.0).contains(&more(2e-3)) && more(8e-3) > 6.0 && more(1.0) == MOST);
    }

    #[test]
    fn one_total_that_is_off_breaks_the_promise_though_the_light_as_a_whole_keeps_it() {
        let off = verdict(1e-4, 1e-5, 0.009, 1e-3);
        assert_eq!(off.kept(0.05), Kept::No);
        assert_eq!(off.broken(0.05).map(|gap| gap.share), Some(Share::Absorbed));
        assert_eq!(verdict(1e-4, 1e-5, 0.009, 1e-3).kept(0.1), Kept::Yes);
        assert!(matches!(verdict(1e-4, 1e-5, 0.0, 5e-3).kept(0.05), Kept::Untold(_)));
    }

    /// Normal blocks of 40 cells in two models that are a known distance apart: the interval of E holds it.
    #[test]
    fn intervals_hold_the_truth_as_often_as_stated() {
        use super::super::distance::distance_of;
        use crate::walk::{Purpose, draw, uniform};
        let mut number = 0;
        // Sums of twelve uniform numbers.
        let mut normal = move || {
            number += 3;
            let words = (number - 3..number).flat_map(|event| draw(5, 0, event, Purpose::Event));
            words.map(uniform).sum::<f64>() - 6.0
        };
        let runs = 2000;
        for truth in [0.0, 0.03, 0.1] {
            let mut held = 0;
            for _ in 0..runs {
                let mut blocks = |shift: f64| -> Vec<Vec<f64>> {
                    (0..8).map(|_| (0..40).map(|_| 1.0 + shift + 0.2 * normal()).collect()).collect()
                };
                let (a, b) = (blocks(truth), blocks(0.0));
                let light = distance_of(&a, &b).expect("they are alike");
                let [low, high] = Verdict { light, gaps: Vec::new() }.interval();
                held += usize::from((low..=high).contains(&truth));
            }
            let share = held as f64 / f64::from(runs);
            println!("E {truth}: held by {share}");
            assert!(share > 0.94, "{truth}: {share}");
        }
    }
}
