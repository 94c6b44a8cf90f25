//! Whether two tallies are of the same BSDF, and how far apart they are.

use super::estimate::{Estimate, direct, noise, share};
use super::significance::{binomial_tail, chi_square_tail, normal_tail, sidak};
use crate::goniometer::{Moments, Outcome, Tally};

/// Probability of a false alarm of each of the two tests.
pub const LEVEL: f64 = 1e-3;
/// Least number of walks that each tally is expected to have in a cell that is tested.
const LEAST_COUNTED: f64 = 25.0;
/// Least effective number, (Σw)²/Σw², where walks have weights.
const LEAST_EFFECTIVE: f64 = 400.0;

/// A cell in which both tallies saw light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellDifference {
    /// Start: side and incident cell.
    pub start: usize,
    /// Bin of the start.
    pub bin: usize,
    /// Channel.
    pub channel: usize,
    /// Share of the light in both tallies.
    pub shares: [Estimate; 2],
    /// Probability of so large a difference, corrected for the number of cells (Šidák).
    pub probability: f64,
}

/// The sum over many cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PooledDifference {
    /// χ² of the channel that differs most.
    pub chi_square: f64,
    /// Its degrees of freedom.
    pub freedom: usize,
    /// That channel.
    pub channel: usize,
    /// Probability of so large a χ², corrected for the number of channels (Šidák).
    pub probability: f64,
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
    /// Cells that have counts enough to be tested, direct light among them.
    pub tested: usize,
    /// Cells in which any light was seen.
    pub seen: usize,
    /// The tested cell that differs most.
    pub cell: Option<CellDifference>,
    /// The sum over the tested cells.
    pub pooled: Option<PooledDifference>,
}

impl Comparison {
    /// Whether either test finds a difference at its level.
    pub fn differ(&self) -> bool {
        self.cell.is_some_and(|cell| cell.probability < LEVEL)
            || self.pooled.is_some_and(|pooled| pooled.probability < LEVEL)
    }
}

/// Compare two tallies of the same bases and channels that share no random numbers.
///
/// Cells of lossless cloth are held against the binomial, exactly: of the walks that both have in a cell (or outside of
/// it, when that is the smaller number), each belongs to A with probability N_A/(N_A + N_B). Cells of weighted walks are
/// held against the normal law with the variance of both tallies together, ⟨w²⟩ − ⟨w⟩². The χ² of a start takes the
/// covariance −⟨w⟩_i⟨w⟩_j of its cells into account: a walk leaves in one of them.
pub fn compare(a: &Tally, b: &Tally) -> Comparison {
    let (error, resolution) = error_norm(a, b);
    let mut family = Family { straight: a.straight != b.straight, ..Family::default() };
    for channel in 0..a.channels().max(b.channels()) {
        family.add_channel(a, b, channel);
    }
    let difference = |start| (direct(a, start).value - direct(b, start).value, start);
    let most = (0..a.starts()).map(difference).max_by(|x, y| x.0.abs().total_cmp(&y.0.abs())).unwrap_or_default();
    let Family { tested, seen, cell, pooled, channels, .. } = family;
    let corrected = |cell: CellDifference| CellDifference { probability: sidak(cell.probability, tested), ..cell };
    let over_channels =
        |pooled: PooledDifference| PooledDifference { probability: sidak(pooled.probability, channels), ..pooled };
    Comparison {
        error,
        resolution,
        noise: [noise(a), noise(b)],
        direct: most,
        tested,
        seen,
        cell: cell.map(corrected),
        pooled: pooled.map(over_channels),
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
    let light = light(tally, start, bin, channel);
    if light.sum == 0 { Estimate::default() } else { share(tally, start, tally.walks_per_incident(), light) }
}

/// Light of an exit bin or of the direct bin.
fn light(tally: &Tally, start: usize, bin: usize, channel: usize) -> Moments {
    if bin < 2 * tally.layout.exit_cells {
        return tally.light(start, bin, channel);
    }
    let (direct, unit) = (tally.direct(start), tally.unit());
    Moments { sum: direct * unit, square: direct * unit * unit }
}

/// The tests that belong together.
#[derive(Default)]
struct Family {
    /// Straight rays say for one of the tallies, and not alike for both, how much light meets fibers: then exit cells are
    /// compared among the walks that did.
    straight: bool,
    tested: usize,
    seen: usize,
    cell: Option<CellDifference>,
    channels: usize,
    pooled: Option<PooledDifference>,
}

impl Family {
    /// Hold the light of a start that touches no fiber against the normal law; whether it was tested.
    fn add_straight(&mut self, a: &Tally, b: &Tally, start: usize, chi_square: &mut f64) -> bool {
        let shares = [a, b].map(|tally| direct(tally, start));
        let spread = shares[0].stderr.hypot(shares[1].stderr);
        self.seen += usize::from(shares.iter().any(|share| share.value > 0.0));
        if spread == 0.0 || shares.iter().all(|share| share.value == 0.0) {
            return false;
        }
        self.tested += 1;
        let z = (shares[0].value - shares[1].value) / spread;
        *chi_square += z * z;
        let probability = normal_tail(z);
        if self.cell.is_none_or(|cell| probability < cell.probability) {
            let bin = a.layout.outcome(Outcome::Direct);
            self.cell = Some(CellDifference { start, bin, channel: 0, shares, probability });
        }
        true
    }

    fn add_channel(&mut self, a: &Tally, b: &Tally, channel: usize) {
        let exits = 2 * a.layout.exit_cells;
        let untouched = a.layout.outcome(Outcome::Direct);
        let (mut chi_square, mut freedom) = (0.0, 0);
        for start in 0..a.starts() {
            let mut pool = Pool::default();
            let walks =
                [a, b].map(|tally| tally.walks_per_incident() - if self.straight { tally.direct(start) } else { 0 });
            // Direct light is the same in all channels. What straight rays say of it is held against it apart from the walks.
            if self.straight && channel == 0 {
                freedom += usize::from(self.add_straight(a, b, start, &mut chi_square));
            }
            for bin in (0..exits).chain((channel == 0 && !self.straight).then_some(untouched)) {
                let pair = Pair::new(a, b, walks, start, bin, channel);
                self.seen += usize::from(pair.pooled.value > 0.0);
                if !pair.tells() {
                    continue;
                }
                self.tested += 1;
                pool.add(&pair);
                let probability = pair.probability();
                if self.cell.is_none_or(|cell| probability < cell.probability) {
                    let of = |tally: &Tally| match bin == untouched {
                        true => direct(tally, start),
                        false => share(tally, start, tally.walks_per_incident(), tally.light(start, bin, channel)),
                    };
                    self.cell = Some(CellDifference { start, bin, channel, shares: [of(a), of(b)], probability });
                }
            }
            let (value, degrees) = pool.chi_square(walks);
            chi_square += value;
            freedom += degrees;
        }
        if freedom > 0 {
            self.channels += 1;
            let probability = chi_square_tail(chi_square, freedom);
            if self.pooled.is_none_or(|pooled| probability < pooled.probability) {
                self.pooled = Some(PooledDifference { chi_square, freedom, channel, probability });
            }
        }
    }
}

/// One bin in both tallies.
struct Pair {
    walks: [u64; 2],
    light: [Moments; 2],
    units: [u64; 2],
    /// Mean weight and mean square of all walks.
    pooled: Pooled,
}

struct Pooled {
    value: f64,
    square: f64,
}

impl Pair {
    fn new(a: &Tally, b: &Tally, walks: [u64; 2], start: usize, bin: usize, channel: usize) -> Pair {
        let both = [a, b];
        let light = both.map(|tally| light(tally, start, bin, channel));
        let units = both.map(Tally::unit);
        let total = (walks[0] + walks[1]).max(1) as f64;
        let mean = |of: fn(&Moments) -> u64, power: i32| {
            light.iter().zip(units).map(|(light, unit)| of(light) as f64 / (unit as f64).powi(power)).sum::<f64>()
                / total
        };
        let pooled = Pooled { value: mean(|light| light.sum, 1), square: mean(|light| light.square, 2) };
        Pair { walks, light, units, pooled }
    }

    /// Whether walks are all or nothing in both.
    fn counted(&self) -> bool {
        self.light.iter().zip(self.units).all(|(light, unit)| light.square == light.sum * unit)
    }

    /// Whether the smaller tally is expected to hold enough.
    fn tells(&self) -> bool {
        let fewer = self.walks[0].min(self.walks[1]) as f64;
        let Pooled { value, square } = self.pooled;
        if value == 0.0 {
            return false;
        }
        if self.counted() {
            return fewer * value.min(1.0 - value) >= LEAST_COUNTED;
        }
        fewer * value * value / square >= LEAST_EFFECTIVE
    }

    fn difference(&self) -> f64 {
        let share = |i: usize| self.light[i].sum as f64 / self.units[i] as f64 / self.walks[i] as f64;
        share(0) - share(1)
    }

    fn probability(&self) -> f64 {
        if !self.counted() {
            let reciprocals: f64 = self.walks.iter().map(|walks| 1.0 / *walks as f64).sum();
            let variance = (self.pooled.square - self.pooled.value.powi(2)) * reciprocals;
            return normal_tail(self.difference() / variance.sqrt());
        }
        let mut counts = [0, 1].map(|i| self.light[i].sum / self.units[i]);
        if self.pooled.value > 0.5 {
            counts = [0, 1].map(|i| self.walks[i] - counts[i]);
        }
        let share = self.walks[0] as f64 / (self.walks[0] + self.walks[1]) as f64;
        binomial_tail(counts[0], counts[0] + counts[1], share)
    }
}

/// The tested cells of one start.
#[derive(Default)]
struct Pool {
    cells: usize,
    /// Σ Δ²/⟨w²⟩, Σ Δ⟨w⟩/⟨w²⟩, Σ ⟨w⟩²/⟨w²⟩.
    sums: [f64; 3],
}

impl Pool {
    fn add(&mut self, pair: &Pair) {
        let (difference, Pooled { value, square }) = (pair.difference(), &pair.pooled);
        self.cells += 1;
        let parts = [difference * difference, difference * value, value * value];
        self.sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part / square);
    }

    /// χ² = Δᵀ Σ⁻¹ Δ with Σ = (diag⟨w²⟩ − ⟨w⟩⟨w⟩ᵀ)(1/N_A + 1/N_B), inverted by Sherman and Morrison; and its degrees of
    /// freedom.
    fn chi_square(&self, walks: [u64; 2]) -> (f64, usize) {
        let [own, mixed, filled] = self.sums;
        let walks = walks.map(|walks| walks as f64);
        let scale = 1.0 / (1.0 / walks[0] + 1.0 / walks[1]);
        let rest = 1.0 - filled;
        if self.cells == 0 {
            (0.0, 0)
        } else if rest * walks[0].min(walks[1]) < LEAST_COUNTED {
            // Next to nothing is left outside of these cells: their differences add up to 0.
            (own * scale, self.cells - 1)
        } else {
            ((own + mixed * mixed / rest) * scale, self.cells)
        }
    }
}
