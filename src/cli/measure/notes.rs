//! What is going to be measured, and how.

use super::super::show::{estimate, grouped};
use fiberwalk::bsdf::{Distance, Estimate, Share};
use fiberwalk::distribution::{Gathering, SpecificLength, Voids};
use fiberwalk::explicit::{Clustering, Explicit};
use fiberwalk::goniometer::Goniometer;
use fiberwalk::measure::{AgainstFibers, ChosenEngine, Prepared, Stop, percent};
use fiberwalk::scene::{Scene, Structure};
use fiberwalk::tables::Kind;
use std::f64::consts::PI;

/// Absorption in 1/mm above which a real index is no longer right.
const MOST_ABSORPTION: f64 = 2e3;
/// The wavelength in mm at which that is judged.
const GREEN: f64 = 550e-6;

/// Standard errors by which the medium is off before a warning is given, and the share of the value.
const SURELY: f64 = 6.0;
const NOTABLE: f64 = 0.03;

/// The medium, and what sends walks through it.
pub fn of_medium(scene: &Scene, prepared: &Prepared, engine: &ChosenEngine) -> Vec<String> {
    let depth = prepared.tables.depth();
    let mut lines = Vec::new();
    if let Some(gathering) = &prepared.gathering {
        lines.extend(woven(prepared, gathering));
    }
    if let Structure::Sheet(sheet) = &scene.structure {
        let mass = sheet.areal_mass(&scene.fibers).map(|mass| format!(", {mass:.0} g/m²")).unwrap_or_default();
        let fraction = sheet.volume_fraction(&scene.fibers);
        lines.push(format!("medium: optical depth at most {depth:.1}, fibers fill {fraction:.3}{mass}"));
    }
    if prepared.specific_length.spread_error > 0.0 {
        lines.push(format!(
            "directions: a grid of {} smears the spread bundles; the largest error of H found is {:.2} %",
            scene.model.directions,
            100.0 * prepared.specific_length.spread_error
        ));
    }
    if let Some(visible) = &prepared.tables.visible {
        let (n, percent) = (visible.n, 100.0 * visible.error);
        lines
            .push(format!("tracking: a table of H for {n} × {n} rays; the largest error of H found is {percent:.2} %"));
    }
    lines.extend(of_dark_fibers(scene));
    lines.push(format!("engine: {} on {}; {}", engine.name, engine.adapter, engine.grounds.reason));
    lines
}

/// The cells of a woven cloth.
fn woven(prepared: &Prepared, gathering: &Gathering) -> Vec<String> {
    let SpecificLength { cells, lists, .. } = &prepared.specific_length;
    let [nx, ny, nz] = cells.counts;
    let Gathering { realizations, error, volume_fraction, largest_fraction, filled, .. } = gathering;
    let mut lines = vec![
        format!(
            "cells: {nx} × {ny} × {nz}, {} of {} hold fiber, which fills {volume_fraction:.3} of the cloth and at most \
             {largest_fraction:.2} of a cell; {} lists of directions",
            grouped(*filled as u64),
            grouped(cells.len() as u64),
            grouped(lists.len() as u64)
        ),
        format!("counted: {realizations} realizations, standard error of the densities {:.1} %", 100.0 * error),
    ];
    lines.extend(gathering.warning().map(|warning| format!("warning: {warning}")));
    lines.extend(gathering.voids.map(|Voids { free_surface, covered, largest, error }| {
        format!(
            "voids: {free_surface:.3} of the fibers' surface lies in no other fiber, fibers cover {covered:.3} of the volume; the \
             factor e/(1 − c) of a cell is at most {largest:.2}, its standard error {:.1} %",
            100.0 * error
        )
    }));
    lines
}

/// The fibers, and what sends walks through them.
pub fn of_fibers(scene: &Scene, explicit: &Explicit, goniometer: &Goniometer) -> Vec<String> {
    let [pieces, grid] = explicit.bytes().map(|bytes| bytes as f64 / f64::from(1 << 20));
    let packing = scene.model.packing.description();
    let walks = explicit.walks_of_start(goniometer.starts());
    let mut lines = vec![
        format!(
            "fibers: {} straight pieces in a realization, {packing}; {pieces:.1} MiB and {grid:.1} MiB for the grid that finds \
             them, for each thread",
            grouped(explicit.pieces() as u64)
        ),
        format!("realizations: a fresh one after {walks} walks of each incident cell"),
        format!("engine: cpu on {}; the explicit model has no other", explicit.adapter()),
    ];
    lines.extend(of_dark_fibers(scene));
    lines
}

/// What a real index leaves out of fibers that absorb much.
fn of_dark_fibers(scene: &Scene) -> Vec<String> {
    let line = |(kind, place): (Kind, usize)| {
        let most = kind.absorption.iter().copied().fold(0.0, f64::max);
        // The index is n + i κ with κ = σ λ / 4π.
        let kappa = most * GREEN / (4.0 * PI);
        let reflected = |kappa: f64| {
            let square = |real: f64| real * real + kappa * kappa;
            100.0 * square(kind.ior - 1.0) / square(kind.ior + 1.0)
        };
        (most > MOST_ABSORPTION).then(|| {
            format!(
                "warning: fiber `{}` absorbs up to {most}/mm, and from {MOST_ABSORPTION}/mm on a real index is not enough: at 550 nm \
                 the imaginary part is {kappa:.2}, with which a surface reflects {:.2} % of light along its normal; \
                 {:.2} % are computed",
                scene.fibers[place].name,
                reflected(kappa),
                reflected(0.0)
            )
        })
    };
    Kind::of_scene(scene).into_iter().zip(scene.kinds()).filter_map(line).collect()
}

/// Until when.
pub fn of_stop(stop: Stop, explicit: bool) -> Option<String> {
    let Stop::Tolerance(tolerance) = stop else { return None };
    let rest = if explicit { "" } else { "; the model's error is not in it" };
    Some(format!("stop: at a noise of {} of the scattered light{rest}", percent(tolerance)))
}

/// How much the walks of one realization resemble each other.
pub fn of_clustering(clustering: Option<&Clustering>) -> String {
    let Some(clustering) = clustering else {
        return "all walks went through one realization: the scatter between cloths is not in the errors\n".into();
    };
    let Clustering { realizations, reflectance, transmittance, direct } = clustering;
    let factors = [reflectance, transmittance, direct].map(|factor| factor.max(1.0).sqrt());
    let [reflected, transmitted, direct] = factors;
    format!(
        "{realizations} realizations; errors of means over all incident directions take walks as independent, those of one realization are \
         not: they are {reflected:.1} (reflected), {transmitted:.1} (transmitted), {direct:.1} (direct) times as large\n"
    )
}

/// Where light goes through the fibers, and how far the medium is from that.
pub fn of_fibers_and_medium(scene: &Scene, against: &AgainstFibers) -> String {
    let channel = match scene.channels.names.len() {
        1 => String::new(),
        _ => format!(" in {}", scene.channels.names[against.channel]),
    };
    let each = || (0..).zip(Share::ALL);
    let differences = against.differences();
    let found: Vec<String> =
        each().map(|(i, share)| format!("{} {}", estimate(against.fibers[i]), share.name())).collect();
    let off: Vec<String> = differences
        .iter()
        .map(|Estimate { value, stderr }| format!("{:+.1} ± {:.1}", 100.0 * value, 100.0 * stderr))
        .collect();
    let [low, high] = against.verdict().interval().map(|end| 100.0 * end);
    let mut text = format!(
        "{} walks through the fibers themselves{channel}: {}; the medium is off by {} % of the light, and by {:.1} % ({low:.1} to \
         {high:.1}) of the scattered light\n",
        grouped(against.walks),
        found.join(", "),
        off.join(", "),
        100.0 * against.light.error(),
    );
    let wrong = |i: usize| {
        let Estimate { value, stderr } = differences[i];
        value.abs() > SURELY * stderr && value.abs() > NOTABLE * against.fibers[i].value
    };
    let mut wrong: Vec<String> = each().filter(|(i, _)| wrong(*i)).map(|(_, share)| share.name().to_owned()).collect();
    let Distance { square, square_error } = against.light;
    if square > SURELY * square_error && against.light.error() > NOTABLE {
        wrong.push("the distribution of scattered".into());
    }
    if !wrong.is_empty() {
        let usual = scene.model.usual_placement();
        let cells = (!matches!(scene.structure, Structure::Sheet(_))).then(|| "finer cells".to_owned());
        let placement = (scene.model.placement != usual).then(|| format!("placement \"{}\"", usual.name()));
        let cures: Vec<String> = cells.into_iter().chain(placement).chain(["--model explicit".to_owned()]).collect();
        text += &format!(
            "warning: {} light is off by more than {:.0} % of its value; {} may mend it\n",
            wrong.join(" and "),
            100.0 * NOTABLE,
            cures.join(" or "),
        );
    }
    text
}
