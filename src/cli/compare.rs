//! `fiberwalk compare`.

use super::measure::share;
use super::print;
use super::show::{estimate, grouped};
use fiberwalk::bsdf::{CellDifference, Comparison, LEVEL, compare};
use fiberwalk::results::{About, Stored};
use fiberwalk::{Error, Result};
use std::fmt::Write;
use std::path::PathBuf;

/// Compare two results: whether they differ by more than noise, and by how much
///
/// The error E is the root of the summed squared differences of the scattered light, noise removed, as a share of B.
/// Results differ when a cell or the sum over all cells does so at a level of 0.001 each; the exit code is 1 then.
#[derive(clap::Args)]
pub struct Arguments {
    /// Result folder, or a tally.exr
    a: PathBuf,
    /// Result folder, or a tally.exr: what A is held against
    b: PathBuf,
    /// Ask whether the error E is at most this share, such as 2%, instead of whether the results differ at all
    #[arg(long, value_name = "SHARE", value_parser = share, allow_hyphen_values = true)]
    within: Option<f64>,
    /// Compare results of the same seed too: their walks may be the same ones, and the tests take them for independent
    #[arg(long)]
    same_seed: bool,
}

/// Run the command.
pub fn run(arguments: &Arguments) -> Result<()> {
    let stored = [Stored::read(&arguments.a)?, Stored::read(&arguments.b)?];
    let [a, b] = &stored;
    a.about.check_same_bases(&b.about)?;
    if let (Some(seed), false) = (a.tally.coverage.common_seed(&b.tally.coverage), arguments.same_seed) {
        return Err(Error::Input(format!(
            "both results were made with seed {seed}: their noise is not independent; measure one again with another \
             --seed, or pass --same-seed"
        )));
    }
    let comparison = compare(&a.tally, &b.tally);
    let mut text = String::new();
    for (name, stored) in ["A", "B"].into_iter().zip(&stored) {
        let tally = &stored.tally;
        let Comparison { noise: [of_a, of_b], .. } = comparison;
        let noise = if name == "A" { of_a } else { of_b };
        let walks = grouped(tally.walks_per_incident() * tally.starts() as u64);
        let _ = writeln!(text, "{name:<8}  {walks} walks, {}; noise {}", tally.origin().engine, percent(noise));
    }
    text += &findings(&a.about, &comparison);
    print(&text)?;
    match arguments.within {
        Some(within) if comparison.error > within => Err(Error::Failed(format!(
            "the error E = {} is larger than the {} allowed",
            percent(comparison.error),
            percent(within)
        ))),
        None if comparison.differ() => Err(Error::Failed("the results differ".into())),
        Some(_) => print(&format!("the error is within {}\n", percent(arguments.within.unwrap_or_default()))),
        None if comparison.tested == 0 => print("too few walks to tell: no cell could be tested\n"),
        None => print("no difference was found\n"),
    }
}

/// The error, direct light, cells and their sum.
fn findings(about: &About, comparison: &Comparison) -> String {
    let Comparison { error, resolution, direct, tested, seen, .. } = comparison;
    let mut text = format!(
        "error     E = {} of the scattered light; noise alone would give up to {}\n",
        percent(*error),
        percent(*resolution)
    );
    let (difference, start) = direct;
    let place = about.start_name(*start);
    let _ = writeln!(text, "direct    differs by {difference:+.2e} at most, {place}");
    let _ = write!(text, "cells     {} of {} with light have walks enough to be tested", grouped(*tested as u64), seen);
    let _ = match &comparison.cell {
        Some(cell) => {
            writeln!(text, "; the farthest apart has p = {:.2e}:\n          {}", cell.probability, named(about, cell))
        }
        None => writeln!(text),
    };
    if let Some(pooled) = comparison.pooled {
        let channel = &about.channels[pooled.channel];
        let of = if about.channels.len() > 1 { format!(" in {channel}") } else { String::new() };
        let _ = writeln!(
            text,
            "together  χ² = {:.1} of {} degrees of freedom{of}, p = {:.2e}",
            pooled.chi_square,
            grouped(pooled.freedom as u64),
            pooled.probability
        );
    }
    let _ = writeln!(text, "          (a p is for the whole family of tests; below {LEVEL} the results differ)");
    text
}

/// Where a cell is, and its light in both.
fn named(about: &About, cell: &CellDifference) -> String {
    let exits = about.exit.cells();
    let place = match cell.bin {
        bin if bin < exits => format!("reflection, exit cell {bin}"),
        bin if bin < 2 * exits => format!("transmission, exit cell {}", bin - exits),
        _ => "direct light".into(),
    };
    let channel = if about.channels.len() > 1 { format!(", {}", about.channels[cell.channel]) } else { String::new() };
    let [a, b] = cell.shares.map(estimate);
    format!("{}, {place}{channel}: {a} against {b}", about.start_name(cell.start))
}

fn percent(share: f64) -> String {
    if share.is_finite() { format!("{:.2} %", 100.0 * share) } else { "without bound".into() }
}
