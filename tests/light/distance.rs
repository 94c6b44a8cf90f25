//! The distance of two models from blocks of walks: unbiased and with an honest error, also where walks of a block resemble
//! each other. Tallies are synthetic, so what they are drawn from is known.

use crate::common::stats::{GATE, mean_error};
use fiberwalk::bsdf::{BlockTotals, Distance, block_noise, block_totals, compare, distance, noise};
use fiberwalk::goniometer::{Basis, BinLayout, Counts, Coverage, Goniometer, Incidence, Origin, Straight, Tally};
use fiberwalk::scene::{BasisChoice, Side};
use fiberwalk::walk::{Purpose, draw, uniform};
use rayon::prelude::*;

const SEEDS: u64 = 400;
const BLOCKS: u64 = 8;
/// Walks of a start in a block.
const WALKS: u64 = 1200;
/// Walks that see the same cloth.
const CLUSTER: u64 = 60;
/// Shares of the bins of two starts: two exit cells of each hemisphere, and direct light.
const SHARES: [[f64; 5]; 2] = [[0.30, 0.20, 0.15, 0.10, 0.25], [0.25, 0.25, 0.20, 0.20, 0.10]];

/// What walks are drawn from.
#[derive(Clone, Copy)]
struct Source {
    /// By how much light of the first bin goes to the fourth in all cloths.
    bent: f64,
    /// What share of the direct light meets fibers after all, and is shared out like the rest.
    closed: f64,
    /// By how much, at most, light of the second bin goes to the third in one cloth and back in another.
    clustered: f64,
}

const EQUAL: Source = Source { bent: 0.0, closed: 0.0, clustered: 0.0 };

impl Source {
    fn shares(self, start: usize, cloth: f64) -> [f64; 5] {
        let mut shares = SHARES[start];
        (shares[0], shares[3]) = (shares[0] - self.bent, shares[3] + self.bent);
        let moved = self.clustered * (2.0 * cloth - 1.0);
        (shares[1], shares[2]) = (shares[1] - moved, shares[2] + moved);
        let met = 1.0 - shares[4];
        shares[4] *= 1.0 - self.closed;
        shares[..4].iter_mut().for_each(|share| *share *= (1.0 - SHARES[start][4] * (1.0 - self.closed)) / met);
        shares
    }

    /// E from the shares of another.
    fn error(self, other: Source) -> f64 {
        let (mut part, mut all) = (0.0, 0.0);
        for start in 0..2 {
            let [a, b] = [self, other].map(|source| source.shares(start, 0.5));
            part += (0..4).map(|bin| (a[bin] - b[bin]).powi(2)).sum::<f64>();
            all += (0..4).map(|bin| b[bin].powi(2)).sum::<f64>();
        }
        (part / all).sqrt()
    }

    fn block(self, seed: u64, number: u64) -> Tally {
        let origin = Origin { engine: "synthetic".into(), adapter: String::new(), seed };
        let mut tally = Tally::new(origin.clone(), BinLayout { exit_cells: 2 }, 2, None);
        for i in 0..WALKS {
            // One number for each cloth, one for each walk.
            let cloth = uniform(draw(seed, (number * WALKS + i) / CLUSTER, 1, Purpose::Event)[0]);
            let words = draw(seed, number * WALKS + i, 0, Purpose::Event);
            for (start, word) in words[..2].iter().enumerate() {
                let mut left = uniform(*word);
                let shares = self.shares(start, cloth);
                let bin = shares.iter().position(|share| {
                    left -= share;
                    left < 0.0
                });
                tally.bins[start * 7 + bin.unwrap_or(4)] += 1;
            }
        }
        tally.coverage = Coverage::new(origin, number * WALKS..(number + 1) * WALKS);
        tally.counts = Counts { launched: 2 * WALKS, finished: 2 * WALKS, ..Counts::default() };
        tally
    }

    fn blocks(self, seed: u64) -> Vec<Tally> {
        (0..BLOCKS).map(|number| self.block(seed, number)).collect()
    }
}

fn whole(blocks: &[Tally]) -> Tally {
    let mut tally = blocks[0].clone();
    blocks[1..].iter().for_each(|block| tally.merge(block).expect("their walks are disjoint"));
    tally
}

/// Distances of many pairs.
fn distances(a: Source, b: Source) -> Vec<Distance> {
    let pair = |seed| distance(&a.blocks(2 * seed), &b.blocks(2 * seed + 1)).expect("blocks are alike");
    (0..SEEDS).into_par_iter().map(pair).collect()
}

/// z of the mean of E² against a value, and mean and root mean square of its pulls.
fn pulls(found: &[Distance], square: f64) -> (f64, f64, f64) {
    let n = found.len() as f64;
    let sums = |of: &dyn Fn(&Distance) -> f64| {
        found.iter().map(of).fold((0.0, 0.0), |(sum, square), x| (sum + x, square + x * x))
    };
    let (sum, squares) = sums(&|found| found.square - square);
    let (mean, error) = mean_error(sum, squares, n);
    let (sum, squares) = sums(&|found| (found.square - square) / found.square_error);
    (mean / error, sum / n, (squares / n).sqrt())
}

#[test]
fn a_distance_is_unbiased_and_its_error_is_honest() {
    let bent = Source { bent: 0.05, ..EQUAL };
    let clustered = Source { bent: 0.05, clustered: 0.1, ..EQUAL };
    for (name, a, b) in [("independent", bent, EQUAL), ("clustered", clustered, Source { bent: 0.0, ..clustered })] {
        let (z, mean, spread) = pulls(&distances(a, b), a.error(b).powi(2));
        println!("{name}: E = {:.4}, mean of E² at {z:.1} σ, pulls {mean:+.2} ± {spread:.2}", a.error(b));
        assert!(z.abs() < GATE, "{name}: the mean of E² is {z:.1} σ off");
        // A jackknife of 8 has 7 degrees of freedom: pulls spread by √(7/5) = 1.18 around a shared error.
        assert!((0.95..1.4).contains(&spread), "{name}: pulls spread by {spread:.2}");
    }
}

#[test]
fn equal_models_have_no_distance_and_their_error_is_on_the_safe_side() {
    for clustered in [0.0, 0.1] {
        let source = Source { clustered, ..EQUAL };
        let found = distances(source, source);
        let (z, _, spread) = pulls(&found, 0.0);
        println!("clustered {clustered}: mean of E² at {z:.1} σ, pulls spread by {spread:.2}");
        assert!(z.abs() < GATE, "E² is {z:.1} σ off");
        // √((K − 2)/2(K − 1)) = 0.65 with K = 8 blocks.
        assert!((0.5..0.9).contains(&spread), "pulls spread by {spread:.2}");
        assert!(found.iter().all(|found| found.bounds()[0] <= found.error() && found.error() <= found.bounds()[1]));
    }
}

#[test]
fn walks_that_resemble_each_other_mislead_the_error_of_independent_ones() {
    // The negative control: E with the variance of independent walks takes the likeness of walks for a distance.
    let source = Source { clustered: 0.1, ..EQUAL };
    let exit = Basis::new(BasisChoice::Polar { rings: 1, sectors: 2 });
    let incidence = Incidence::Listed(vec![glam::DVec3::Z; 2]);
    let goniometer = Goniometer { incidence, exit, sides: vec![Side::Front] };
    let naive: Vec<f64> = (0..SEEDS)
        .into_par_iter()
        .map(|seed| {
            let [a, b] = [2 * seed, 2 * seed + 1].map(|seed| source.blocks(seed));
            let found = compare(&whole(&a), &whole(&b), &goniometer, [None; 2]);
            found.error.powi(2) / found.resolution.powi(2)
        })
        .collect();
    let (mean, error) = mean_error(naive.iter().sum(), naive.iter().map(|x| x * x).sum(), SEEDS as f64);
    println!("the mean of E² over its resolution is {mean:.2} ± {error:.2}");
    assert!(mean > 1.0 + GATE * error, "{mean} ± {error}");
}

#[test]
fn a_small_bend_is_seen() {
    // Sized to stand at 8 to 10 σ of the mean of all pairs.
    let bent = Source { bent: 0.0046, ..EQUAL };
    let (z, ..) = pulls(&distances(bent, EQUAL), 0.0);
    println!("E = {:.4}: the mean of E² stands at {z:.1} σ", bent.error(EQUAL));
    assert!(z > GATE, "z = {z:.1}");
}

#[test]
fn noise_of_blocks_is_that_of_walks_and_grows_where_they_resemble_each_other() {
    let found = |source: Source| {
        let ratio = |seed| {
            let blocks = source.blocks(seed);
            let (of_blocks, of_walks) = (block_noise(&blocks).expect("alike"), noise(&whole(&blocks)));
            ((of_blocks.value / of_walks).powi(2), of_blocks.stderr / of_blocks.value)
        };
        let all: Vec<(f64, f64)> = (0..SEEDS).into_par_iter().map(ratio).collect();
        let squares = all.iter().map(|(x, _)| x * x).sum();
        let mean = mean_error(all.iter().map(|(x, _)| x).sum(), squares, SEEDS as f64);
        let scatter = mean.1 * (SEEDS as f64).sqrt() / 2.0;
        (mean, scatter, all.iter().map(|(_, error)| error).sum::<f64>() / SEEDS as f64)
    };
    let ((mean, error), scatter, stated) = found(EQUAL);
    println!("independent: {mean:.3} ± {error:.3}; scatter {scatter:.3}, stated {stated:.3}");
    assert!((mean - 1.0).abs() < GATE * error, "{mean} ± {error}");
    // The scatter of a noise and its jackknife agree within a third.
    assert!((stated / scatter - 1.0).abs() < 0.33, "{scatter} against {stated}");
    let ((mean, error), ..) = found(Source { clustered: 0.1, ..EQUAL });
    println!("clustered: {mean:.3} ± {error:.3}");
    assert!(mean > 1.0 + GATE * error, "{mean} ± {error}");
}

#[test]
fn totals_of_blocks_have_the_scatter_between_them() {
    let source = Source { clustered: 0.1, ..EQUAL };
    let pull = |seed| {
        let BlockTotals { reflectance, transmittance, direct } =
            block_totals(&source.blocks(seed), 0, 0).expect("blocks are alike");
        [(reflectance, 0.5), (transmittance, 0.25), (direct, 0.25)].map(|(found, truth)| {
            assert!(found.stderr > 0.0);
            (found.value - truth) / found.stderr
        })
    };
    let all: Vec<[f64; 3]> = (0..SEEDS).into_par_iter().map(pull).collect();
    for i in 0..3 {
        let (mean, error) =
            mean_error(all.iter().map(|p| p[i]).sum(), all.iter().map(|p| p[i] * p[i]).sum(), SEEDS as f64);
        let spread = (all.iter().map(|p| p[i] * p[i]).sum::<f64>() / SEEDS as f64).sqrt();
        println!("total {i}: pulls {mean:+.2} ± {spread:.2}");
        assert!((mean / error).abs() < GATE, "{mean} ± {error}");
        assert!((1.0..1.4).contains(&spread), "pulls spread by {spread:.2}");
    }
}

#[test]
fn straight_light_is_honoured() {
    // Rays say alike how much light meets fibers; what walks say of that is left out.
    let closed = Source { closed: 0.2, ..EQUAL };
    let lit = |source: Source, seed| -> Vec<Tally> {
        let straight = Some(vec![Straight { value: 0.2, stderr: 0.01, with_mean: 1e-4 }; 2]);
        source.blocks(seed).into_iter().map(|block| Tally { straight: straight.clone(), ..block }).collect()
    };
    let pair = |seed| distance(&lit(closed, 2 * seed), &lit(EQUAL, 2 * seed + 1)).expect("blocks are alike");
    let (z, ..) = pulls(&(0..SEEDS).into_par_iter().map(pair).collect::<Vec<_>>(), 0.0);
    assert!(z.abs() < GATE, "z = {z:.1}");
    // The negative control: without the rays the same tallies differ.
    let (z, ..) = pulls(&distances(closed, EQUAL), 0.0);
    assert!(z > GATE, "z = {z:.1}");
    let totals = block_totals(&lit(EQUAL, 1), 0, 0).expect("blocks are alike");
    assert_eq!((totals.direct.value, totals.direct.stderr), (0.2, 0.01));
    // 0.8 of the light, shared out as 0.5 to 0.25, and its error.
    assert!((totals.reflectance.value - 0.8 * 0.5 / 0.75).abs() < 0.02);
    assert!(totals.reflectance.stderr > 0.5 / 0.75 * 0.01);
}

#[test]
fn blocks_that_do_not_go_together_are_refused() {
    let blocks = EQUAL.blocks(1);
    assert!(distance(&blocks[..2], &blocks[..2]).is_err());
    assert!(distance(&blocks, &blocks[..5]).is_err());
    let mut other = blocks.clone();
    other[3] = Tally::new(other[3].origin().clone(), BinLayout { exit_cells: 3 }, 2, None);
    let error = distance(&blocks, &other).expect_err("they have other cells").to_string();
    assert!(error.contains("alike"), "{error}");
    assert!(block_noise(&other).is_err() && block_totals(&blocks[..2], 0, 0).is_err());
}
