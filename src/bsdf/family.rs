//! The tests of a comparison, which share the probability of a false alarm.

use super::compare::{LEVEL, PoolDifference, SumDifference, Tested};
use super::estimate::{Estimate, direct, share};
use super::pair::{ChiSquare, Pair};
use super::pool::{Beam, Effects, Incoming, LEVELS, Outgoing, PARTS, Parts, Pool, gather, starts_of};
use super::significance::{chi_square_tail, normal_quantile, sidak, student_tail};
use crate::goniometer::{Goniometer, Moments, Tally};

/// Degrees of freedom of the error of straight rays: they go through 32 draws of the fibers or more.
const FREEDOM: f64 = 31.0;

/// The tests that belong together.
pub(super) struct Family<'a> {
    tallies: [&'a Tally; 2],
    goniometer: &'a Goniometer,
    parts: Parts,
    effects: [Effects; 2],
    /// Only walks that met a fiber say where light goes.
    met: bool,
    /// By kind of pool: how many were tested, and which of them differs most, with its own probability.
    levels: [Tested; LEVELS],
    least: [Option<PoolDifference>; LEVELS],
    /// Sums over cells, and the one that differs most, with its own probability.
    sums: usize,
    sum: Option<SumDifference>,
    /// The totals of each channel over the most starts.
    totals: Vec<Pair>,
}

impl<'a> Family<'a> {
    /// No tests yet. With `met` only walks that met a fiber say where light goes.
    pub fn new(tallies: [&'a Tally; 2], goniometer: &'a Goniometer, effects: [Effects; 2], met: bool) -> Family<'a> {
        Family {
            tallies,
            goniometer,
            parts: Parts::new(&goniometer.exit),
            effects,
            met,
            levels: [Tested::default(); LEVELS],
            least: [None; LEVELS],
            sums: 0,
            sum: None,
            totals: Vec::new(),
        }
    }

    /// Test all scattered light of a channel, and direct light with the first if walks say it.
    pub fn add_channel(&mut self, channel: usize) {
        let sides = self.goniometer.sides.len();
        let mut chi_squares = [(0.0, 0); 2];
        for side in 0..sides {
            let starts = starts_of(self.goniometer, side);
            let mut whole: Option<Beam> = None;
            for start in starts.clone() {
                let beam = Beam::of_start(self.tallies, start, channel, self.met);
                whole.get_or_insert_with(|| Beam::of_side(side, &beam)).add(&beam);
                let (value, freedom) = self.add_beam(&beam, channel, starts.len() == 1);
                chi_squares[0] = (chi_squares[0].0 + value, chi_squares[0].1 + freedom);
            }
            // One incident cell is all of them.
            if let Some(beam) = whole.filter(|_| starts.len() > 1) {
                let (value, freedom) = self.add_beam(&beam, channel, true);
                chi_squares[1] = (chi_squares[1].0 + value, chi_squares[1].1 + freedom);
            }
        }
        for ((chi_square, freedom), all) in chi_squares.into_iter().zip([false, true]) {
            if freedom > 0 {
                self.sums += 1;
                let probability = chi_square_tail(chi_square, freedom);
                if self.sum.is_none_or(|sum| probability < sum.probability) {
                    self.sum = Some(SumDifference { chi_square, freedom, channel, all, probability });
                }
            }
        }
    }

    /// Test the pools of some incoming light, the whole of a side or not; its χ² and degrees of freedom.
    fn add_beam(&mut self, beam: &Beam, channel: usize, whole: bool) -> (f64, usize) {
        let mut chi_square = ChiSquare::default();
        let mut left = [[Moments::default(); 2]; 2 * PARTS];
        for (bin, light) in beam.light.iter().enumerate() {
            let pair = self.add_pool(beam, Outgoing::Cell(bin), *light, channel);
            if pair.tells() {
                chi_square.add(&pair);
            } else {
                gather(&mut left[self.parts.of_bin(bin)], light);
            }
            // The only cell of a hemisphere is its total.
            if whole && beam.light.len() == 2 {
                self.totals.push(pair);
            }
        }
        if let Some(light) = beam.untouched {
            let pair = self.add_pool(beam, Outgoing::Direct, light, channel);
            if pair.tells() {
                chi_square.add(&pair);
            }
        }
        for (outgoing, light) in beam.pools(&self.parts) {
            let pair = self.add_pool(beam, outgoing, light, channel);
            if whole && matches!(outgoing, Outgoing::Total(_)) {
                self.totals.push(pair);
            }
        }
        // Add up what no cell could be tested with, as far as it must be.
        for hemisphere in left.chunks(PARTS) {
            let mut rest = [Moments::default(); 2];
            for light in hemisphere {
                let pair = self.pair(beam, Outgoing::Part(0), *light);
                if pair.tells() {
                    chi_square.add(&pair);
                } else {
                    gather(&mut rest, light);
                }
            }
            let pair = self.pair(beam, Outgoing::Total(0), rest);
            if pair.tells() {
                chi_square.add(&pair);
            }
        }
        let effect = |i: usize| self.effects[i].of_chi_square(beam.incoming, chi_square.cells);
        chi_square.value([0, 1].map(|i| beam.walks[i] as f64 / effect(i)))
    }

    fn pair(&self, beam: &Beam, outgoing: Outgoing, light: [Moments; 2]) -> Pair {
        let effects = self.effects.map(|effects| effects.of_pool(Pool { incoming: beam.incoming, outgoing }));
        Pair::new(beam.walks, light, self.tallies.map(Tally::unit), effects)
    }

    /// Test a pool if it can be.
    fn add_pool(&mut self, beam: &Beam, outgoing: Outgoing, light: [Moments; 2], channel: usize) -> Pair {
        let pair = self.pair(beam, outgoing, light);
        let pool = Pool { incoming: beam.incoming, outgoing };
        let level = &mut self.levels[pool.level()];
        level.seen += usize::from(pair.value > 0.0);
        if pair.tells() {
            level.tested += 1;
            self.offer(pool, channel, pair.probability());
        }
        pair
    }

    /// Test the light that straight rays find to touch no fiber. The errors of all starts go together: the rays go through the
    /// same draws.
    pub fn add_straight(&mut self) {
        for side in 0..self.goniometer.sides.len() {
            let starts = starts_of(self.goniometer, side);
            let each = starts.clone().map(Incoming::Start);
            let all = (starts.len() > 1).then_some(Incoming::Side(side));
            for incoming in each.chain(all) {
                let pool = Pool { incoming, outgoing: Outgoing::Direct };
                let shares = self.shares(pool, 0);
                let spread = shares[0].stderr.hypot(shares[1].stderr);
                let seen = shares.iter().any(|share| share.value > 0.0);
                let level = &mut self.levels[pool.level()];
                level.seen += usize::from(seen);
                if seen && spread > 0.0 {
                    level.tested += 1;
                    self.offer(pool, 0, student_tail((shares[0].value - shares[1].value) / spread, FREEDOM));
                }
            }
        }
    }

    /// Keep a tested pool if none of its kind differs more.
    fn offer(&mut self, pool: Pool, channel: usize, probability: f64) {
        if self.least[pool.level()].is_none_or(|least| probability < least.probability) {
            let shares = self.shares(pool, channel);
            self.least[pool.level()] = Some(PoolDifference { pool, channel, shares, probability });
        }
    }

    /// Share of the light in both tallies, with the errors that were tested.
    fn shares(&self, pool: Pool, channel: usize) -> [Estimate; 2] {
        let starts = match pool.incoming {
            Incoming::Start(start) => start..start + 1,
            Incoming::Side(side) => starts_of(self.goniometer, side),
        };
        let n = starts.len() as f64;
        [0, 1].map(|i| {
            let (tally, effect) = (self.tallies[i], self.effects[i].of_pool(pool).sqrt());
            let straight = tally.straight.as_ref().filter(|_| pool.outgoing == Outgoing::Direct);
            let each = starts.clone().map(|start| self.share(tally, start, pool.outgoing, channel));
            let (mut value, mut square) = (0.0, 0.0);
            for share in each {
                value += share.value;
                square += share.stderr * share.stderr;
            }
            let stderr = match (straight, pool.incoming) {
                (Some(rays), Incoming::Side(_)) => {
                    let shared = starts.clone().map(|start| rays[start].with_mean).sum::<f64>();
                    (shared.max(0.0) / n).sqrt()
                }
                (Some(_), Incoming::Start(_)) => square.sqrt(),
                (None, _) => square.sqrt() * effect / n,
            };
            Estimate { value: value / n, stderr }
        })
    }

    /// A share of the light of one start.
    fn share(&self, tally: &Tally, start: usize, outgoing: Outgoing, channel: usize) -> Estimate {
        if outgoing == Outgoing::Direct {
            return direct(tally, start);
        }
        let holds = |bin: &usize| match outgoing {
            Outgoing::Cell(cell) => *bin == cell,
            Outgoing::Part(part) => self.parts.of_bin(*bin) == part,
            _ => Outgoing::Total(self.parts.of_bin(*bin) / PARTS) == outgoing,
        };
        let bins = (0..2 * tally.layout.exit_cells).filter(holds);
        let light = bins.map(|bin| tally.light(start, bin, channel)).sum();
        share(tally, start, tally.walks_per_incident(), light)
    }

    /// The pool that differs most, corrected for those of its kind and for the kinds.
    pub fn farthest(&self) -> Option<PoolDifference> {
        let kinds = self.kinds();
        let corrected = |(least, level): (&Option<PoolDifference>, &Tested)| {
            least.map(|least| PoolDifference { probability: sidak(least.probability, level.tested), ..least })
        };
        let each = self.least.iter().zip(&self.levels).filter_map(corrected);
        let least = each.min_by(|a, b| a.probability.total_cmp(&b.probability));
        least.map(|least| PoolDifference { probability: sidak(least.probability, kinds), ..least })
    }

    /// How many pools there are, by kind.
    pub fn levels(&self) -> &[Tested; LEVELS] {
        &self.levels
    }

    /// The totals of each channel over the most starts.
    pub fn totals(&self) -> &[Pair] {
        &self.totals
    }

    /// The sum over cells that differs most, corrected for their number.
    pub fn sum(&self) -> Option<SumDifference> {
        self.sum.map(|sum| SumDifference { probability: sidak(sum.probability, self.sums), ..sum })
    }

    /// Kinds of pools of which any was tested.
    fn kinds(&self) -> usize {
        self.levels.iter().filter(|level| level.tested > 0).count()
    }

    /// The least relative difference of a total that would be found half of the time.
    pub fn found_from(&self) -> Option<f64> {
        let tested = |pair: &&Pair| pair.tells();
        let total = self.totals.iter().filter(tested).map(|pair| pair.deviation() / pair.value).reduce(f64::min)?;
        let tests = self.kinds() * self.totals.iter().filter(tested).count();
        Some(total * normal_quantile(LEVEL / tests.max(1) as f64))
    }
}
