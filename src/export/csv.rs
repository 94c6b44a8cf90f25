//! A line for each pair of cells.

use super::fit::{Check, Sums};
use super::format::{File, Written};
use crate::bsdf::{Bsdf, Component, Estimate};
use std::fmt::Write;

/// Write the table and read it again.
pub fn write(table: &Bsdf, stem: &str) -> Written {
    let name = format!("{stem}.csv");
    let text = text(table);
    let check = read(table, &text);
    Written { checks: vec![(name.clone(), check)], files: vec![File { name, bytes: text.into_bytes() }] }
}

/// What the format leaves out of a table.
pub fn notes() -> Vec<String> {
    vec!["direct light has lines of its own; angles are those of the middles of cells, φ of wi and wo from +x seen from the front".into()]
}

fn text(table: &Bsdf) -> String {
    let goniometer = &table.goniometer;
    let (cells, exits, channels) = (goniometer.incident_cells(), goniometer.exit.cells(), table.channels.len());
    let mut text = String::from(
        "side,component,incident_cell,theta_i_deg,phi_i_deg,exit_cell,theta_o_deg,phi_o_deg,projected_solid_angle_sr",
    );
    for channel in &table.channels {
        // A comma would part the columns.
        let channel = channel.replace(',', ".");
        let _ = write!(text, ",{channel},stderr {channel}");
    }
    text.push('\n');
    let angles: Vec<[f64; 2]> = (0..exits)
        .map(|exit| {
            let wo = goniometer.exit.centre(exit);
            [wo.z.min(1.0).acos(), wo.y.atan2(wo.x)].map(f64::to_degrees)
        })
        .collect();
    let mut line =
        |start: [&str; 2], cell: usize, exit: Option<usize>, estimates: &mut dyn Iterator<Item = Estimate>| {
            let [theta, phi] = goniometer.angles(cell).map(f64::to_degrees);
            let _ = write!(text, "{},{},{cell},{theta:.4},{phi:.4},", start[0], start[1]);
            let _ = match exit {
                Some(exit) => {
                    let [theta, phi] = angles[exit];
                    write!(text, "{exit},{theta:.4},{phi:.4},{:.6e}", goniometer.exit.projected_solid_angle(exit))
                }
                None => write!(text, ",,,"),
            };
            for Estimate { value, stderr } in estimates {
                let _ = write!(text, ",{value:.6e},{stderr:.3e}");
            }
            text.push('\n');
        };
    for part in table.tables() {
        let start = [part.side.name(), component(part.component)];
        for (pair, estimates) in part.f.chunks_exact(channels).enumerate() {
            line(start, pair / exits, Some(pair % exits), &mut estimates.iter().copied());
        }
    }
    for side in &goniometer.sides {
        for (cell, direct) in table.direct(*side).iter().enumerate().take(cells) {
            line([side.name(), "direct"], cell, None, &mut std::iter::repeat_n(*direct, channels));
        }
    }
    text
}

fn component(component: Component) -> &'static str {
    match component {
        Component::Reflection => "reflection",
        Component::Transmission => "transmission",
    }
}

/// Hold the lines against the table, by the numbers of their cells.
fn read(table: &Bsdf, text: &str) -> Check {
    let exit = &table.goniometer.exit;
    let (exits, channels) = (exit.cells(), table.channels.len());
    let mut sums = Sums::default();
    let mut light = std::collections::BTreeMap::new();
    for line in text.lines().skip(1) {
        let words: Vec<&str> = line.split(',').collect();
        let number = |word: usize| words.get(word).and_then(|word| word.parse::<usize>().ok());
        let part = table.tables().iter().position(|part| [part.side.name(), component(part.component)] == words[..2]);
        let (Some(part), Some(cell), Some(bin)) = (part, number(2), number(5)) else { continue };
        for channel in 0..channels {
            let estimate = table.tables()[part].f[(cell * exits + bin) * channels + channel];
            let read: f64 = words.get(9 + 2 * channel).and_then(|word| word.parse().ok()).unwrap_or(f64::NAN);
            let solid_angle = exit.projected_solid_angle(bin);
            sums.compare(read, estimate, solid_angle);
            *light.entry((part, cell, channel)).or_insert(0.0) += (read - estimate.value) * solid_angle;
        }
    }
    sums.light = light.into_values().fold(0.0, |most: f64, light: f64| most.max(light.abs()));
    sums.check()
}
