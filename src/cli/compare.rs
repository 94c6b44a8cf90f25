//! `fiberwalk compare`.

use super::measure::share;
use super::print;
use super::show::{estimate, grouped};
use fiberwalk::bsdf::{Comparison, Counted, Incoming, LEVEL, Outgoing, PARTS, Pool, PoolDifference, Tested, compare};
use fiberwalk::results::{About, Stored};
use fiberwalk::{Error, Result};
use std::fmt::Write;
use std::path::PathBuf;

/// Compare two results: whether they differ by more than noise, and by how much
///
/// The error E is the root of the summed squared differences of the scattered light, noise removed, as a share of B.
/// Results differ when a cell, a part of a hemisphere, a hemisphere's total or the sum over all cells does so at a level of
/// 0.001; the exit code is 1 then. Cells are also added up over all incident cells. Where no scattered light could be tested,
/// the answer is that walks are too few to tell; the exit code is 0 then.
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
    let comparison = compare(&a.tally, &b.tally, &a.about.goniometer()?, [a, b].map(Stored::walks_a_ray));
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
        None if comparison.scattered() == 0 => print(&too_few(&comparison)),
        None => print(&no_difference(&comparison)),
    }
}

/// What is said where no scattered light could be tested.
fn too_few(comparison: &Comparison) -> String {
    match comparison.wanted {
        None => "too few walks to tell: no light was scattered\n".into(),
        Some(walks) => {
            // Two digits are all that so few walks say.
            let unit = 10f64.powf(walks.log10().floor() - 1.0).max(1.0);
            let walks = grouped(((walks / unit).ceil() * unit) as u64);
            format!("too few walks to tell: a total could be tested with some {walks} walks of each incident cell\n")
        }
    }
}

/// What is said where nothing differs.
fn no_difference(comparison: &Comparison) -> String {
    match comparison.found_from {
        None => "no difference was found\n".into(),
        Some(share) => {
            format!(
                "no difference was found; one of {} in a total would be in half of such comparisons\n",
                percent(share)
            )
        }
    }
}

/// The error, direct light, cells and their sum.
fn findings(about: &About, comparison: &Comparison) -> String {
    let Comparison { error, resolution, direct, each, all, same_rays, .. } = comparison;
    let mut text = format!(
        "error     E = {} of the scattered light; noise alone would give up to {}\n",
        percent(*error),
        percent(*resolution)
    );
    let (difference, start) = direct;
    let _ = match same_rays {
        true => writeln!(text, "direct    from the same straight rays in both"),
        false => writeln!(text, "direct    differs by {difference:+.2e} at most, {}", about.start_name(*start)),
    };
    let of = |Tested { tested, seen }: Tested| format!("{} of {}", grouped(tested as u64), grouped(seen as u64));
    let untouched = if *same_rays { String::new() } else { format!(", {} of direct light", of(each.direct)) };
    let _ = writeln!(text, "cells     {} of scattered light{untouched} have walks enough to be tested", of(each.cells));
    let pools = |Counted { parts, totals, .. }: &Counted| format!("{} parts and {} totals", of(*parts), of(*totals));
    let _ = writeln!(text, "pools     {} of hemispheres of single incident cells", pools(each));
    if all.cells.seen > 0 {
        let _ = writeln!(text, "          {} cells, {} of all incident cells together", of(all.cells), pools(all));
    }
    if let Some(pool) = &comparison.farthest {
        let _ = writeln!(text, "farthest  p = {:.2e}:\n          {}", pool.probability, named(about, pool));
    }
    if let Some(sum) = comparison.sum {
        let channel = &about.channels[sum.channel];
        let of = if about.channels.len() > 1 { format!(" in {channel}") } else { String::new() };
        let _ = writeln!(
            text,
            "together  χ² = {:.1} of {} degrees of freedom{of}{}, p = {:.2e}",
            sum.chi_square,
            grouped(sum.freedom as u64),
            if sum.all { ", all incident cells together" } else { "" },
            sum.probability
        );
    }
    let _ = writeln!(text, "          (a p is for the whole family of tests; below {LEVEL} the results differ)");
    text
}

/// Which light differs, and how much of it both have.
fn named(about: &About, difference: &PoolDifference) -> String {
    let exits = about.exit.cells();
    let Pool { incoming, outgoing } = difference.pool;
    let from = match incoming {
        Incoming::Start(start) => about.start_name(start),
        Incoming::Side(side) => format!("{} all incident cells", about.sides.get(side).map_or("", |side| side.name())),
    };
    let hemisphere = |number: usize| if number == 0 { "reflection" } else { "transmission" };
    let to = match outgoing {
        Outgoing::Cell(bin) => format!("{}, exit cell {}", hemisphere(bin / exits), bin % exits),
        Outgoing::Part(part) => {
            let (ring, quadrant) = (part % PARTS / 4, part % 4);
            let ring = if ring == 0 { "within" } else { "beyond" };
            format!("{} {ring} 45°, φ {}° to {}°", hemisphere(part / PARTS), 90 * quadrant, 90 * (quadrant + 1))
        }
        Outgoing::Total(number) => format!("all {}", hemisphere(number)),
        Outgoing::Direct => "direct light".into(),
    };
    let channel =
        if about.channels.len() > 1 { format!(", {}", about.channels[difference.channel]) } else { String::new() };
    let [a, b] = difference.shares.map(estimate);
    format!("{from}, {to}{channel}: {a} against {b}")
}

fn percent(share: f64) -> String {
    if share.is_finite() { format!("{:.2} %", 100.0 * share) } else { "without bound".into() }
}
