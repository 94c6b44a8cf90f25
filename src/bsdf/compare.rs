//! Whether two tallies are of the same BSDF, and how far apart they are.

use super::estimate::{Estimate, direct, noise, share};
use super::family::Family;
use super::pair::Pair;
use super::pool::{Effects, LEVELS, Pool};
use crate::goniometer::{Goniometer, Tally};

/// Probability of a false alarm of each of the two tests.
pub const LEVEL: f64 = 1e-3;

/// A pool in which both tallies saw light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoolDifference {
    /// Which light it is.
    pub pool: Pool,
    /// Channel.
    pub channel: usize,
    /// Share of the light in both tallies; of a lit side the mean over its incident cells.
    pub shares: [Estimate; 2],
    /// Probability of so large a difference, corrected for the number of pools (Šidák).
    pub probability: f64,
}

/// The sum over many cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SumDifference {
    /// χ² of the channel that differs most, over its design effect.
    pub chi_square: f64,
    /// Its degrees of freedom.
    pub freedom: usize,
    /// That channel.
    pub channel: usize,
    /// Whether the light of all incident cells of a side was added up first.
    pub all: bool,
    /// Probability of so large a χ², corrected for the number of such sums (Šidák).
    pub probability: f64,
}

/// How many pools there are of a kind, over all channels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tested {
    /// That have counts enough to be tested.
    pub tested: usize,
    /// In which any light was seen.
    pub seen: usize,
}

/// What was tested of the light of each incident cell, or of that of all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    /// Exit cells.
    pub cells: Tested,
    /// Parts of hemispheres.
    pub parts: Tested,
    /// Hemispheres.
    pub totals: Tested,
    /// Direct light.
    pub direct: Tested,
}

/// How two tallies differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// E(A, B) = √max(0, Σ[(Pa − Pb)² − σa² − σb²]) / √ΣPb² of the scattered light, over all starts, exit cells and channels.
    pub error: f64,
    /// The E that noise alone would leave in one of three such comparisons.
    pub resolution: f64,
    /// Relative noise of the scattered light in both.
    pub noise: [f64; 2],
    /// Largest difference of the share of direct light, and its start.
    pub direct: (f64, usize),
    /// What was tested of the light of each start.
    pub each: Counted,
    /// What was tested of the light of all starts of a lit side together.
    pub all: Counted,
    /// The tested pool that differs most.
    pub farthest: Option<PoolDifference>,
    /// The sum over cells that differs most.
    pub sum: Option<SumDifference>,
    /// Whether direct light is that of the same straight rays in both, so that it can not differ.
    pub same_rays: bool,
    /// The least relative difference of a hemisphere's total, over all incident cells, that would be found half of the time.
    pub found_from: Option<f64>,
    /// Walks of each start with which the first total could be tested; none where no light was scattered.
    pub wanted: Option<f64>,
}

impl Comparison {
    /// Whether either test finds a difference at its level.
    pub fn differ(&self) -> bool {
        self.farthest.is_some_and(|pool| pool.probability < LEVEL)
            || self.sum.is_some_and(|sum| sum.probability < LEVEL)
    }

    /// Pools of scattered light that were tested.
    pub fn scattered(&self) -> usize {
        let of = |counted: &Counted| counted.cells.tested + counted.parts.tested + counted.totals.tested;
        of(&self.each) + of(&self.all)
    }

    /// All pools that were tested, those of direct light among them.
    pub fn tested(&self) -> usize {
        self.scattered() + self.each.direct.tested + self.all.direct.tested
    }
}

/// Compare two tallies of one instrument that share no random numbers.
///
/// Light is tested by exit cell, by part of a hemisphere and by hemisphere, of each start and of all starts of a lit side: each
/// [`Pool`] in which the smaller tally is expected to hold 25 walks, or 400 effective ones, (Σw)²/Σw², where walks have weights.
/// Which pools there are does not depend on the counts. Counts are held against the binomial, exactly; sums of weights against
/// the normal law with the variance of both tallies together, ⟨w²⟩ − ⟨w⟩². The χ² of a start takes cells that can be
/// tested, what is left of a part if that can, and what is left of a hemisphere; it takes the
/// covariance −⟨w⟩_i⟨w⟩_j into account: a walk leaves in one cell. Each of the kinds of pools gets an equal share of the
/// probability of a false alarm.
///
/// Straight rays say of a start what touches no fiber: then scattered light is compared among the walks that did. `walks_a_ray`
/// are the walks of each tally that set out along one ray through a draw of the fibers, if they do; variances are raised by
/// design effects then. Where both have the same walks along the same rays, their difference has less than the variance of
/// independent ones, and none is raised.
pub fn compare(a: &Tally, b: &Tally, goniometer: &Goniometer, walks_a_ray: [Option<f64>; 2]) -> Comparison {
    let (error, resolution) = error_norm(a, b);
    let difference = |start| (direct(a, start).value - direct(b, start).value, start);
    let most = (0..a.starts()).map(difference).max_by(|x, y| x.0.abs().total_cmp(&y.0.abs())).unwrap_or_default();
    let same_rays = a.straight.is_some() && a.straight == b.straight;
    let ranges = |tally: &Tally| tally.coverage.runs().iter().map(|run| run.walks.clone()).collect::<Vec<_>>();
    let stratified = same_rays && ranges(a) == ranges(b);
    let effects = walks_a_ray.map(|walks| walks.filter(|_| !stratified).map_or(Effects::NONE, Effects::of));
    let met = a.straight.is_some() || b.straight.is_some();
    let mut family = Family::new([a, b], goniometer, effects, met);
    if met && !same_rays {
        family.add_straight();
    }
    for channel in 0..a.channels().max(b.channels()) {
        family.add_channel(channel);
    }
    let [each, all] = [0, LEVELS / 2].map(|first| {
        let [cells, parts, totals, direct] = [0, 1, 2, 3].map(|kind| family.levels()[first + kind]);
        Counted { cells, parts, totals, direct }
    });
    let walks = a.walks_per_incident().min(b.walks_per_incident()) as f64;
    let enough = family.totals().iter().map(Pair::enough).fold(0.0, f64::max);
    Comparison {
        error,
        resolution,
        noise: [noise(a), noise(b)],
        direct: most,
        each,
        all,
        farthest: family.farthest(),
        sum: family.sum(),
        same_rays,
        found_from: family.found_from(),
        wanted: (enough > 0.0).then(|| walks / enough),
    }
}

/// E(A, B), and the standard deviation that noise gives to its square, as an E.
fn error_norm(a: &Tally, b: &Tally) -> (f64, f64) {
    let (mut excess, mut spread, mut square) = (0.0, 0.0, 0.0);
    for start in 0..a.starts() {
        for bin in 0..2 * a.layout.exit_cells {
            let mut deviation = 0.0;
            for channel in 0..a.channels().max(b.channels()) {
                let [a, b] = [a, b].map(|tally| seen_share(tally, start, bin, channel));
                let variance = a.stderr.powi(2) + b.stderr.powi(2);
                excess += (a.value - b.value).powi(2) - variance;
                deviation += 2f64.sqrt() * variance;
                square += b.value * b.value;
            }
            // Channels share their walks: take their deviations to go together.
            spread += deviation * deviation;
        }
    }
    if square == 0.0 {
        return if excess > 0.0 { (f64::INFINITY, 0.0) } else { (0.0, 0.0) };
    }
    ((excess.max(0.0) / square).sqrt(), (spread.sqrt() / square).sqrt())
}

/// The share of a bin; an empty one has no error of its own.
fn seen_share(tally: &Tally, start: usize, bin: usize, channel: usize) -> Estimate {
    let light = tally.light(start, bin, channel);
    if light.sum == 0 { Estimate::default() } else { share(tally, start, tally.walks_per_incident(), light) }
}
