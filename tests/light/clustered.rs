//! Walks along rays through draws of the fibers are alike. Their sums scatter more than those of independent walks, by no more
//! than comparisons take into account; without that they would call equal cloths different.

use crate::common::gpu;
use fiberwalk::bsdf::{Comparison, compare};
use fiberwalk::goniometer::Tally;
use fiberwalk::measure::{Prepared, prepare};
use fiberwalk::scene::{Scene, Source};
use fiberwalk::walk::{FirstHitBanks, WalkPlan, Walker};

const RUNS: u64 = 12;

/// Banks of a run that go through the same draws: those that the medium was counted from.
const SHARED: u64 = 4;

/// Runs of one medium whose walks set out along different rays, through different draws.
fn runs(name: &str) -> (Prepared, Vec<Tally>) {
    let scene = Scene::parse(&Source::find(name).expect("a preset")).expect("it is fine");
    let prepared = prepare(&scene).expect("the cloth is fine");
    let span = prepared.first_hits.as_ref().expect("walks meet fibers first").span();
    let medium = prepared.with(gpu());
    let run = |number| {
        let plan = WalkPlan { first: (SHARED + number) * span, ..WalkPlan::new(50 + number, span) };
        medium.run(&prepared.goniometer, &plan, &mut |_| {}).expect("the device works")
    };
    let runs = (0..RUNS).map(run).collect();
    (prepared, runs)
}

/// Variance of the shares of hemispheres between runs over that of independent walks: of single starts in the mean, and of the
/// sum over all.
fn effects(runs: &[Tally], channel: usize) -> [f64; 2] {
    let (n, exits, starts) = (runs.len() as f64, runs[0].layout.exit_cells, runs[0].starts());
    let (mut found, mut expected) = ([0.0; 2], 0.0);
    for hemisphere in 0..2 {
        let share = |tally: &Tally, start: usize| {
            let (walks, unit) = (tally.walks_per_incident() as f64, tally.unit() as f64);
            let bins = hemisphere * exits..(hemisphere + 1) * exits;
            let light = bins.map(|bin| tally.light(start, bin, channel));
            let (sum, square) = light.fold((0.0, 0.0), |(sum, square), light| {
                (sum + light.sum as f64 / unit / walks, square + light.square as f64 / unit / unit / walks)
            });
            (sum, (square - sum * sum) / walks)
        };
        let variance = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / n;
            values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0)
        };
        let mut whole = vec![0.0; runs.len()];
        for start in 0..starts {
            let shares: Vec<_> = runs.iter().map(|tally| share(tally, start)).collect();
            whole.iter_mut().zip(&shares).for_each(|(sum, share)| *sum += share.0);
            found[0] += variance(&shares.iter().map(|share| share.0).collect::<Vec<_>>());
            expected += shares.iter().map(|share| share.1).sum::<f64>() / n;
        }
        found[1] += variance(&whole);
    }
    found.map(|found| found / expected)
}

#[test]
fn runs_through_other_draws_of_the_fibers_are_not_called_different() {
    let mut misled = 0;
    // A knit, whose repeat has few fibers, and a filament cloth.
    for name in ["jersey", "lining"] {
        let (prepared, runs) = runs(name);
        let span = runs[0].walks_per_incident();
        let [one, all] = effects(&runs, runs[0].channels() / 2);
        println!("{name}: design effect of totals {one:.2} in the mean over starts, {all:.1} of all together");
        assert!(one < 2.0 && all < 12.0, "{name}: {one} and {all}");
        let pairs = |walks_a_ray: Option<f64>| -> Vec<Comparison> {
            let pairs = (0..runs.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
            pairs.map(|(i, j)| compare(&runs[i], &runs[j], &prepared.goniometer, [walks_a_ray; 2])).collect()
        };
        let differ = |pairs: &[Comparison]| pairs.iter().filter(|pair| pair.differ()).count();
        let honest = pairs(prepared.walks_a_ray(span));
        let naive = differ(&pairs(None));
        println!("{name}: {} of {} pairs differ, {naive} if walks were independent", differ(&honest), honest.len());
        assert!(honest.iter().all(|pair| pair.all.totals.tested >= 2));
        // Six independent pairs at 2·10⁻³ each: one in 80 would have one.
        assert_eq!(differ(&honest), 0, "{name}");
        misled += naive;
    }
    // The negative control: without design effects, the likeness of walks is taken for a difference.
    assert!(misled > 5, "only {misled} pairs differ");
}
