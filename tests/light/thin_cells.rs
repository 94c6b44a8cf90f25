//! Comparing results whose single cells hold too few walks to be tested. Tallies are synthetic, so what they are drawn from is
//! known: as of a cloth of yarns, with direct light from the same straight rays in both.

use crate::common::SplitMix;
use crate::common::stats::{GATE, binomial_z, means_z};
use fiberwalk::bsdf::{Comparison, Outgoing, compare};
use fiberwalk::goniometer::{
    Basis, BinLayout, Counts, Coverage, Goniometer, Incidence, Origin, Straight, Tally, WEIGHT,
};
use fiberwalk::scene::{BasisChoice, Side};
use rayon::prelude::*;

const PAIRS: u64 = 200;
/// Share of the walks that touch no fiber.
const DIRECT: f64 = 0.1;

/// What walks are drawn from.
#[derive(Clone, Copy)]
struct Source {
    incident: BasisChoice,
    exit: BasisChoice,
    /// Absorption in units of a mean path, by channel; none where fibers are clear.
    absorption: Option<[f64; 2]>,
    /// What share of the reflected light goes through instead.
    turned: f64,
}

const RIB: Source =
    Source { incident: BasisChoice::Disc(8), exit: BasisChoice::Disc(24), absorption: None, turned: 0.0 };

impl Source {
    fn goniometer(&self) -> Goniometer {
        let incidence = Incidence::Cells(Basis::new(self.incident));
        Goniometer { incidence, exit: Basis::new(self.exit), sides: vec![Side::Front] }
    }

    /// So many walks of each start: reflected and transmitted light alike over all cells, more of it reflected from
    /// start to start.
    fn tally(&self, seed: u64, walks: u64) -> Tally {
        let goniometer = self.goniometer();
        let (layout, starts) = (BinLayout { exit_cells: goniometer.exit.cells() }, goniometer.starts());
        let origin = Origin { engine: "synthetic".into(), adapter: String::new(), seed };
        let mut tally = Tally::new(origin.clone(), layout, starts, self.absorption.map(|_| 2));
        let mut random = SplitMix(seed);
        let untouched = (DIRECT * walks as f64) as u64;
        for start in 0..starts {
            let reflected = (0.3 + 0.3 * start as f64 / starts as f64) * (1.0 - self.turned);
            // Both have the same rays, so as many touch nothing.
            tally.bins[start * layout.stride() + 2 * layout.exit_cells] = untouched;
            for _ in untouched..walks {
                let cell = (random.uniform() * layout.exit_cells as f64) as usize;
                let bin = if random.uniform() < reflected { cell } else { layout.exit_cells + cell };
                tally.bins[start * layout.stride() + bin] += 1;
                if let (Some(absorption), Some(weights)) = (self.absorption, &mut tally.weights) {
                    let path = -random.uniform().ln();
                    for (channel, absorption) in absorption.into_iter().enumerate() {
                        let q = ((-absorption * path).exp() * WEIGHT as f64 + random.uniform()) as u64;
                        let absorbed = start * (2 * layout.exit_cells + 1) + 2 * layout.exit_cells;
                        weights.moments[(absorbed - 2 * layout.exit_cells + bin) * 2 + channel].add(q.min(WEIGHT));
                        weights.moments[absorbed * 2 + channel].add(WEIGHT - q.min(WEIGHT));
                    }
                }
            }
        }
        tally.straight = Some(vec![Straight { value: DIRECT, stderr: 0.001, with_mean: 1e-6 }; starts]);
        tally.coverage = Coverage::new(origin, 0..walks);
        let all = walks * starts as u64;
        tally.counts = Counts { launched: all, finished: all, ..Counts::default() };
        tally.check(walks).expect("its account closes");
        tally
    }

    /// Pairs of runs of so many walks, of this and of another.
    fn pairs(&self, other: &Source, walks: [u64; 2], count: u64) -> Vec<Comparison> {
        let goniometer = self.goniometer();
        let pair = |i| {
            let [a, b] = [(self, 2 * i, walks[0]), (other, 2 * i + 1, walks[1])].map(|(of, seed, n)| of.tally(seed, n));
            compare(&a, &b, &goniometer, [None; 2])
        };
        (0..count).into_par_iter().map(pair).collect()
    }
}

/// The same in other bases and colours.
fn sources() -> [Source; 4] {
    let polar = BasisChoice::Polar { rings: 18, sectors: 36 };
    [
        RIB,
        Source { absorption: Some([0.5, 2.0]), ..RIB },
        Source { exit: BasisChoice::Klems, absorption: Some([0.5, 2.0]), ..RIB },
        Source { exit: polar, ..RIB },
    ]
}

#[test]
fn equal_light_of_thin_cells_is_tested_and_called_different_as_often_as_stated() {
    for (source, walks) in sources().into_iter().zip([[8000, 8000], [2500, 2500], [1000, 3000], [2000, 8000]]) {
        // Few directions do.
        let source = Source { incident: BasisChoice::Disc(4), ..source };
        let all = source.pairs(&source, walks, PAIRS);
        let called = all.iter().filter(|comparison| comparison.differ()).count();
        println!(
            "{:?} {walks:?}: {called} of {PAIRS} called different, {:?}, {:?}",
            source.exit, all[0].each, all[0].all
        );
        for comparison in &all {
            assert_eq!(comparison.each.cells.tested, 0);
            assert!(comparison.scattered() > 0 && comparison.all.totals.tested >= 2, "{comparison:?}");
        }
        // Two tests at 10⁻³ each: 0.4 expected, and more than 4 in 6 of 10⁵ such trials.
        assert!(called <= 4, "{called} of {PAIRS}");
        for level in [0.5, 0.2, 0.05] {
            let below = |of: &dyn Fn(&Comparison) -> Option<f64>| {
                let count = all.iter().filter(|comparison| of(comparison).is_some_and(|p| p < level)).count();
                (count, binomial_z(count as u64, PAIRS, level))
            };
            let pools = below(&|c| c.farthest.map(|pool| pool.probability));
            let sums = below(&|c| c.sum.map(|sum| sum.probability));
            println!("  below {level}: pools {}, together {}", pools.0, sums.0);
            // Pools that hold the same light and channels that go together are on the safe side.
            assert!(pools.1 < GATE && sums.1 < GATE, "below {level}: {pools:?}, {sums:?}");
        }
    }
}

#[test]
fn three_percent_less_reflected_light_is_found_where_no_cell_can_be_tested() {
    for (source, walks) in sources().into_iter().zip([8000, 4000, 2000, 8000]) {
        let bent = Source { turned: 0.03, ..source };
        let all = source.pairs(&bent, [walks; 2], 20);
        let called = all.iter().filter(|comparison| comparison.differ()).count();
        let z = |comparison: &Comparison| {
            comparison.farthest.map(|pool| {
                let [a, b] = pool.shares.map(|share| (share.value, share.stderr));
                means_z(a, b)
            })
        };
        let farthest = all[0].farthest.expect("it was tested");
        println!("{:?}: {called} of 20, {:.1?} standard errors, {farthest:?}", source.exit, z(&all[0]));
        assert!(all.iter().all(|comparison| comparison.each.cells.tested == 0));
        assert!(called > 18, "{called} of 20");
        assert!(matches!(farthest.pool.outgoing, Outgoing::Total(_)), "{farthest:?}");
        assert!(all.iter().all(|comparison| comparison.found_from.is_some_and(|least| least < 0.03)));
    }
}

#[test]
fn too_few_walks_tell_nothing_and_the_number_that_would_is_about_right() {
    for (source, few) in sources().into_iter().zip([4, 40, 40, 4]) {
        let source = Source { incident: BasisChoice::Disc(2), ..source };
        let all = source.pairs(&source, [few, 1000], 20);
        for comparison in &all {
            assert!(comparison.scattered() == 0 && !comparison.differ(), "{comparison:?}");
        }
        let wanted = all.iter().map(|comparison| comparison.wanted.expect("light was seen")).fold(0.0, f64::max);
        println!("{:?}: {few} walks tell nothing, {wanted:.1} would", source.exit);
        assert!(wanted > few as f64 && wanted < 1000.0);
        let more = source.pairs(&source, [(1.5 * wanted).ceil() as u64, 1000], 20);
        assert!(more.iter().all(|comparison| comparison.all.totals.tested > 0));
    }
}
