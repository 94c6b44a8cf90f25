//! Whether error bars are as wide as the scatter of repeated runs: `cargo run --release --example error_bars -- [SEEDS] [WALKS]`
//!
//! Measures small cloths again and again, each time with another seed, hence other fibers to count and to shine through, and other walks. The variance of R, T, D and A over
//! that which the runs state, each with its own standard error: of the means over the hemisphere and, pooled, of the incident cells.
//! 1 is right; error bars are too narrow above it. The shares add up to 1, so their errors go together.

use fiberwalk::bsdf::{Estimate, Share, hemispherical, totals};
use fiberwalk::measure::prepare;
use fiberwalk::reference::Reference;
use fiberwalk::scene::{Scene, Source};
use fiberwalk::walk::{WalkPlan, Walker};
use std::error::Error;

const CLOTHS: [(&str, &str); 3] = [
    (
        "grey mesh of single filaments",
        "[fiber.a]\nradius_um = 30\nior = 1.55\nabsorption_per_mm = 40\n[yarn.a]\nfiber = \"a\"\nfibers_per_ply = 1\nwidth_um = 64\nheight_um = 64\n\
         [weave]\ndraft = [\"X.\", \".X\"]\nwarp = [\"a\"]\nweft = [\"a\"]\nends_per_cm = 80\npicks_per_cm = 80\n",
    ),
    (
        "plain weave of seven dyed filaments",
        "[fiber.a]\nradius_um = 10\nior = 1.55\nabsorption_per_mm = 5\n[yarn.a]\nfiber = \"a\"\nfibers_per_ply = 7\nwidth_um = 80\nheight_um = 60\n\
         ply_twist_per_m = 400\n[weave]\ndraft = [\"X.\", \".X\"]\nwarp = [\"a\"]\nweft = [\"a\"]\nends_per_cm = 70\npicks_per_cm = 70\n",
    ),
    (
        "web of dyed fibers",
        "[fiber.a]\nradius_um = 10\nior = 1.55\nabsorption_per_mm = 5\n[sheet]\nthickness_um = 300\n[[sheet.fibers]]\nfiber = \"a\"\n\
         length_density_per_mm2 = 300\norientation = \"planar\"\n[model]\npacking = \"random\"\n",
    ),
];

/// Variance of the values over the mean square of what they state, and the relative error of a variance of so many values.
fn ratio(values: &[Estimate]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().map(|one| one.value).sum::<f64>() / n;
    let variance = values.iter().map(|one| (one.value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    variance / (values.iter().map(|one| one.stderr.powi(2)).sum::<f64>() / n)
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let (seeds, walks): (u64, u64) =
        (words.first().map_or(Ok(200), |w| w.parse())?, words.get(1).map_or(Ok(2000), |w| w.parse())?);
    println!("| cloth | of | R | T | D | A |\n|---|---|---|---|---|---|");
    let mut pooled = [[0.0; 4]; 2];
    for (name, text) in CLOTHS {
        // By start, the mean last: the four shares of every run.
        let mut runs: Vec<Vec<[Estimate; 4]>> = Vec::new();
        for seed in 1..=seeds {
            let source = Source { file: name.into(), stem: name.into(), text: text.into(), folder: None };
            let mut scene = Scene::parse(&source)?;
            scene.measure.set_from_flag("incident", "4")?;
            scene.measure.set_from_flag("exit", "4")?;
            scene.model.seed = seed;
            let prepared = prepare(&scene)?;
            let goniometer = &prepared.goniometer;
            let tally = prepared.with(&Reference).run(goniometer, &WalkPlan::new(seed, walks), &mut |_| {})?;
            let four = |totals: &fiberwalk::bsdf::Totals| Share::ALL.map(|share| share.of(totals));
            let mut run: Vec<[Estimate; 4]> =
                (0..goniometer.starts()).map(|start| four(&totals(&tally, start, 0))).collect();
            run.extend(hemispherical(&tally, goniometer, 0, 0).as_ref().map(four));
            runs.push(run);
        }
        let starts = runs[0].len() - 1;
        let of = |start: usize, share: usize| ratio(&runs.iter().map(|run| run[start][share]).collect::<Vec<_>>());
        let each = [0, 1, 2, 3].map(|share| (0..starts).map(|start| of(start, share)).sum::<f64>() / starts as f64);
        let mean = [0, 1, 2, 3].map(|share| of(starts, share));
        for (kind, (word, ratios)) in [("directions", each), ("the hemisphere", mean)].into_iter().enumerate() {
            let [r, t, d, a] = ratios;
            println!("| {name} | {word} | {r:.2} | {t:.2} | {d:.2} | {a:.2} |");
            (0..4).for_each(|share| pooled[kind][share] += ratios[share] / CLOTHS.len() as f64);
        }
    }
    let n = (seeds - 1) as f64 * CLOTHS.len() as f64;
    for (word, [r, t, d, a]) in [("directions", pooled[0]), ("the hemisphere", pooled[1])] {
        println!("| all | {word} | {r:.2} | {t:.2} | {d:.2} | {a:.2} |");
    }
    println!(
        "\n{seeds} seeds, {walks} walks of each of 16 incident cells; a ratio of the hemisphere over all cloths has a standard error of {:.2}.",
        (2.0 / n).sqrt()
    );
    Ok(())
}
