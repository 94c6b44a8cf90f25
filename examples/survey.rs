//! Measure every preset with both engines and hold the results against each other and against what light must obey:
//! `cargo run --release --example survey`
//!
//! Ends non-zero when the engines differ, an account does not close, or light is not reciprocal.

use fiberwalk::bsdf::{Component, Estimate, LEVEL, Residual, Totals, compare, reciprocity, totals};
use fiberwalk::goniometer::Tally;
use fiberwalk::measure::{ChosenEngine, EngineChoice, Prepared, Stop, choose, prepare, run};
use fiberwalk::scene::{BasisChoice, Incident, PRESETS, Scene, Side, Source};
use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

/// The incident basis and the exit basis, and walks of each incident cell.
const INCIDENT: BasisChoice = BasisChoice::Disc(4);
const EXIT: BasisChoice = BasisChoice::Disc(4);
const WALKS: u64 = 16_384;
/// Incident cells around the normal.
const NEAR: [usize; 4] = [5, 6, 9, 10];
/// By how much the shares of light may miss 1.
const ROUNDING: f64 = 1e-9;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let [gpu, cpu] = [choose(EngineChoice::Gpu, None)?, choose(EngineChoice::Cpu, None)?];
    println!(
        "gpu: {}; cpu: {}; {WALKS} walks for each of {} incident cells\n",
        gpu.adapter,
        cpu.adapter,
        INCIDENT.cells()
    );
    println!(
        "| preset | reflected | transmitted | direct | absorbed | gpu against cpu: p | reciprocal: χ² of pairs, p |"
    );
    println!("|---|---|---|---|---|---|---|");
    let mut failed = Vec::new();
    for (name, _) in PRESETS {
        let mut scene = Scene::parse(&Source::find(name)?)?;
        (scene.measure.incident, scene.measure.exit) = (Incident::Cells(INCIDENT), EXIT);
        let prepared = prepare(&scene)?;
        // The run itself checks both accounts, and fails where they do not close.
        let [a, b] = [(&gpu, 1), (&cpu, 2)].map(|(engine, seed)| tally(&prepared, engine, seed));
        let (a, b) = (a?, b?);
        let channel = a.channels() / 2;
        let near = near(&a, channel);
        let comparison = compare(&a, &b, &prepared.goniometer, [prepared.walks_a_ray(WALKS); 2]);
        let probabilities =
            [comparison.farthest.map(|pool| pool.probability), comparison.sum.map(|sum| sum.probability)];
        let equal = probabilities.into_iter().flatten().fold(1.0, f64::min);
        let there_and_back = reciprocity(&a, &prepared.goniometer, Component::Reflection, Side::Front, channel);
        let Residual { chi_square, pairs, probability, .. } = there_and_back.ok_or("the bases do not fit together")?;
        let shares = [near.reflectance, near.transmittance, near.direct, near.absorptance];
        let missing = shares.iter().map(|share| share.value).sum::<f64>() + near.lost - 1.0;
        let [r, t, direct, absorbed] = shares.map(|share| match share {
            Estimate { value: 0.0, .. } => "0".into(),
            Estimate { value, stderr } => format!("{value:.4} ± {stderr:.4}"),
        });
        println!(
            "| {name} | {r} | {t} | {direct} | {absorbed} | {equal:.2} of {} | {chi_square:.0} of {pairs}, {probability:.2} |",
            comparison.tested()
        );
        for (wrong, what) in [
            (comparison.differ(), "the engines differ"),
            (probability < LEVEL, "light is not reciprocal"),
            (missing.abs() > ROUNDING, "the shares do not add up to 1"),
            (near.lost > 1e-3, "walks were given up"),
        ] {
            if wrong {
                failed.push(format!("{name}: {what}"));
            }
        }
    }
    failed.iter().for_each(|failure| eprintln!("FAILED: {failure}"));
    Ok(if failed.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn tally(prepared: &Prepared, engine: &ChosenEngine, seed: u64) -> fiberwalk::Result<Tally> {
    Ok(run(&prepared.with(engine), &prepared.goniometer, seed, Stop::Walks(WALKS), Instant::now(), None)?.tally)
}

/// The mean over the cells around the normal.
fn near(tally: &Tally, channel: usize) -> Totals {
    let parts = NEAR.map(|cell| totals(tally, cell, channel));
    let count = parts.len() as f64;
    let mean = |of: fn(&Totals) -> Estimate| Estimate {
        value: parts.iter().map(|part| of(part).value).sum::<f64>() / count,
        stderr: parts.iter().map(|part| of(part).stderr.powi(2)).sum::<f64>().sqrt() / count,
    };
    Totals {
        reflectance: mean(|part| part.reflectance),
        transmittance: mean(|part| part.transmittance),
        direct: mean(|part| part.direct),
        absorptance: mean(|part| part.absorptance),
        lost: parts.iter().map(|part| part.lost).sum::<f64>() / count,
    }
}
