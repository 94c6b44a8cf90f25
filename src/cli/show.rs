//! Numbers as text.

use fiberwalk::bsdf::{Estimate, Totals, hemispherical, totals};
use fiberwalk::measure::Measurement;
use fiberwalk::scene::{Incident, Scene};
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

/// Where the light goes: over the hemisphere and near 0, 30 and 60 degrees, or for each listed direction.
pub fn totals_table(scene: &Scene, measurement: &Measurement) -> String {
    let Measurement { goniometer, tally, .. } = measurement;
    let angles = |cell: usize| -> (f64, f64) {
        let [theta, phi] = match &scene.measure.incident {
            Incident::List(angles) => angles[cell],
            Incident::Disc(_) => goniometer.angles(cell),
        };
        (theta.to_degrees(), phi.to_degrees())
    };
    let mut rows = Vec::new();
    let mut cells: Vec<usize> = match hemispherical(tally, goniometer) {
        Some(mean) => {
            rows.push(("hemispherical".to_owned(), mean));
            let distance = |cell: usize, theta: f64| (angles(cell).0 - theta).abs();
            let all = 0..tally.incident_cells();
            let nearest = |theta| all.clone().min_by(|&a, &b| distance(a, theta).total_cmp(&distance(b, theta)));
            [0.0, 30.0, 60.0].into_iter().filter_map(nearest).collect()
        }
        None => (0..tally.incident_cells()).collect(),
    };
    cells.dedup();
    for cell in cells {
        let (theta, phi) = angles(cell);
        rows.push((format!("θ {theta:.1}°, φ {phi:.1}°"), totals(tally, cell)));
    }
    let mut text = line(["light from", "reflected", "transmitted", "direct", "absorbed"].map(String::from));
    for (name, totals) in &rows {
        let Totals { reflectance, transmittance, direct, absorptance, .. } = *totals;
        let [r, t, d, a] = [reflectance, transmittance, direct, absorptance].map(estimate);
        text += &line([name.clone(), r, t, d, a]);
    }
    let lost: f64 = (0..tally.incident_cells()).map(|cell| tally.lost(cell) as f64).sum();
    if lost > 0.0 {
        let _ = writeln!(text, "lost: {lost} walks were given up; the shares above leave them out");
    }
    text
}

fn line([name, columns @ ..]: [String; 5]) -> String {
    let columns: String = columns.iter().map(|column| format!("  {column:<20}")).collect();
    format!("{name:<22}{}\n", columns.trim_end())
}
