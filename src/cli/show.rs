//! Numbers as text.

use fiberwalk::bsdf::{Component, Estimate, Residual, Totals, hemispherical, reciprocity, totals};
use fiberwalk::goniometer::Incidence;
use fiberwalk::measure::Measurement;
use fiberwalk::plan::Budget;
use fiberwalk::report::chart_deviation;
use fiberwalk::scene::{Incident, Medium, Model, Placement, Scene, Side};
use std::fmt::Write;

/// A value with its standard error, both to the error's second digit.
pub fn estimate(estimate: Estimate) -> String {
    let Estimate { value, stderr } = estimate;
    if stderr == 0.0 {
        return format!("{value}");
    }
    let digits = (1.0 - stderr.log10().floor()).clamp(1.0, 9.0) as usize;
    format!("{value:.digits$} ± {stderr:.digits$}")
}

/// A ratio to a standard error: two digits below 10, whole numbers above.
pub fn estimate_ratio(ratio: f64) -> String {
    if ratio < 0.005 {
        "less than 0.01".into()
    } else if ratio < 10.0 {
        format!("{ratio:.2}")
    } else {
        format!("{ratio:.0}")
    }
}

/// A count with spaces between groups of three digits.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// Where the light goes on each lit side: over the hemisphere and near 0, 30 and 60 degrees, or for each listed
/// direction; in every channel up to three, else in the first, the middle and the last.
pub fn totals_table(scene: &Scene, measurement: &Measurement) -> String {
    let Measurement { goniometer, tally, .. } = measurement;
    let names = &scene.channels.names;
    let told_apart = tally.channels();
    let mut channels: Vec<usize> =
        if told_apart < 4 { (0..told_apart).collect() } else { vec![0, told_apart / 2, told_apart - 1] };
    channels.dedup();
    let cells = goniometer.incident_cells();
    let mut text = line(["light from", "reflected", "transmitted", "direct", "absorbed"].map(String::from));
    for (place, side) in goniometer.sides.iter().enumerate() {
        for &channel in &channels {
            let mut label = String::new();
            if goniometer.sides.len() > 1 {
                label += side.name();
            }
            if told_apart > 1 {
                label = format!("{label} {}", names[channel]);
            }
            if !label.is_empty() {
                text += &format!("{}\n", label.trim());
            }
            if let Some(mean) = hemispherical(tally, goniometer, place, channel) {
                text += &row("hemispherical".into(), &mean);
            }
            for start in shown(measurement).into_iter().map(|cell| place * cells + cell) {
                // A listed direction keeps the angles that it was given by.
                let angles = match &scene.measure.incident {
                    Incident::List(angles) => angles[start % cells],
                    Incident::Cells(_) => goniometer.angles(start),
                };
                let [theta, phi] = angles.map(f64::to_degrees);
                text += &row(format!("θ {theta:.1}°, φ {phi:.1}°"), &totals(tally, start, channel));
            }
        }
    }
    let lost: u64 = (0..tally.starts()).map(|start| tally.lost(start)).sum();
    if lost > 0 {
        let _ = writeln!(text, "lost: {} were given up; the shares above leave them out", walks(lost));
    }
    text
}

/// Where the error of a model comes from, part by part.
pub fn budget_lines(budget: &Budget) -> String {
    let mut text = format!("error budget of {}, E as a share of the scattered light\n", budget.configuration);
    for part in &budget.parts {
        let name = part.part.name();
        let _ = match (&part.size, &part.missing) {
            (Some(size), _) => writeln!(text, "  {name:<11} {:<17} {}", chart_deviation(size), part.change),
            (None, why) => writeln!(text, "  {name:<11} not measured:     {}", why.as_deref().unwrap_or_default()),
        };
    }
    text
}

/// How reciprocal the light is: for each lit side and component, the channel that is least so.
pub fn reciprocity_lines(scene: &Scene, measurement: &Measurement) -> String {
    let Measurement { goniometer, tally, .. } = measurement;
    let Model { placement, medium, .. } = scene.model;
    // Flights that are carried through fibers take another way back where densities change.
    let carried = placement != Placement::AtHit && medium == Medium::Implicit;
    let model = |residual: &Residual| match 100.0 * residual.error {
        percent if carried => {
            format!("; {percent:.1} % beyond noise are the error of placement \"{}\"", placement.name())
        }
        _ => String::new(),
    };
    let mut text = String::new();
    for &side in &goniometer.sides {
        for (name, component) in [("reflection", Component::Reflection), ("transmission", Component::Transmission)] {
            // Transmission from the back is the other half of the same pairs.
            if (side, component) == (Side::Back, Component::Transmission) {
                continue;
            }
            let residuals = (0..tally.channels())
                .filter_map(|channel| Some((channel, reciprocity(tally, goniometer, component, side, channel)?)));
            let least = residuals.min_by(|a, b| a.1.probability.total_cmp(&b.1.probability));
            let Some((channel, residual)) = least.filter(|(_, residual)| residual.pairs > 0) else { continue };
            let of =
                if tally.channels() > 1 { format!(" in {}", scene.channels.names[channel]) } else { String::new() };
            let ratio = residual.chi_square / residual.pairs as f64;
            let pairs = grouped(residual.pairs as u64);
            let _ = writeln!(
                text,
                "reciprocal: {} {name}{of}, χ² = {ratio:.2} for each of {pairs} pairs of cells, p = {:.2}{model}",
                side.name(),
                residual.probability,
                model = model(&residual)
            );
        }
    }
    text
}

/// The incident cells to show: all listed directions, or those nearest to 0, 30 and 60 degrees.
fn shown(measurement: &Measurement) -> Vec<usize> {
    let goniometer = &measurement.goniometer;
    let all = 0..goniometer.incident_cells();
    if matches!(goniometer.incidence, Incidence::Listed(_)) {
        return all.collect();
    }
    let distance = |cell: usize, theta: f64| (goniometer.angles(cell)[0].to_degrees() - theta).abs();
    let nearest = |theta| all.clone().min_by(|&a, &b| distance(a, theta).total_cmp(&distance(b, theta)));
    let mut cells: Vec<usize> = [0.0, 30.0, 60.0].into_iter().filter_map(nearest).collect();
    cells.dedup();
    cells
}

fn row(name: String, totals: &Totals) -> String {
    let Totals { reflectance, transmittance, direct, absorptance, .. } = *totals;
    let [r, t, d, a] = [reflectance, transmittance, direct, absorptance].map(estimate);
    line([name, r, t, d, a])
}

/// A number of walks in words.
pub fn walks(count: u64) -> String {
    format!("{} {}", grouped(count), if count == 1 { "walk" } else { "walks" })
}

fn line([name, columns @ ..]: [String; 5]) -> String {
    let columns: String = columns.iter().map(|column| format!("  {column:<20}")).collect();
    format!("{name:<22}{}\n", columns.trim_end())
}
