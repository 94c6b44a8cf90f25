//! DDR and DDT of Integra: reflection and transmission of a side, as text.
//!
//! Source: KimuraRyo/libbsdf, `DdrReader.cpp`, `DdrWriter.cpp`, `SpecularCoordinateSystem.h`. The angles of wo are those about the mirror
//! direction, of transmitted light about the undeflected one; stored is f·π, and `kbdf` scales each direction of wi.

use super::fit::{Grid, Loaded, Smooth, check, steps, sum};
use super::format::{File, Job, Written};
use crate::bsdf::{Component, Scattering};
use crate::colour::Channels;
use crate::scene::Side;
use glam::DVec2;
use std::f64::consts::PI;
use std::fmt::Write;

/// What the format leaves out of a table.
pub fn notes() -> Vec<String> {
    vec!["there is no place for light that touches no fiber, and it is left out; a side is a pair of files, its azimuths as seen from the front".into()]
}

fn grid() -> Grid {
    Grid { axes: [steps(90.0, 10), steps(360.0, 17), steps(180.0, 37), steps(360.0, 25)], specular: true }
}

/// Write a pair of files for each lit side and read them again.
pub fn write(job: &Job) -> Written {
    let mut written = Written::default();
    for part in job.table.tables() {
        let extension = if part.component == Component::Reflection { "ddr" } else { "ddt" };
        let name = format!("{}_{}.{extension}", job.stem, part.side.name());
        let text = text(job, part);
        let loaded = Sheets::read(&text, part.side, part.component);
        written.checks.push((name.clone(), check(job.table, job.incident, &loaded)));
        written.files.push(File { name, bytes: text.into_bytes() });
    }
    written
}

fn text(job: &Job, part: &Scattering) -> String {
    let (table, grid) = (job.table, grid());
    let model = match job.channels {
        Channels::Grey => "BW".to_owned(),
        Channels::Rgb => "RGB".to_owned(),
        Channels::Spectral(wavelengths) => format!("spectral {}", wavelengths.len()),
    };
    let title = job.title.replace(['\n', '\r'], " ");
    let mut text = format!(
        ";; {title}: {}, fiberwalk {}\nSource Generated\nTypeSym ASymmetrical 4D\nTypeColorModel {model}\nTypeData Luminance Absolute\n",
        part.side.name(),
        env!("CARGO_PKG_VERSION")
    );
    for (name, axis) in [("psi", 1), ("sigma", 0), ("phi", 3), ("theta", 2)] {
        let list: String = grid.axes[axis].iter().map(|angle| format!(" {angle}")).collect();
        let _ = writeln!(text, "{name} {}\n{list}", grid.axes[axis].len());
    }
    let starts: Vec<[f64; 2]> = grid.starts().collect();
    for channel in 0..table.channels.len() {
        let smooth = Smooth::new(job.incident, &table.goniometer.exit, &table.values(part, channel));
        let rows = grid.rows(&smooth, job.incident, &table.shares(part, channel));
        let name = match job.channels {
            Channels::Grey => "bw".to_owned(),
            Channels::Rgb => ["red", "gre", "blu"][channel].to_owned(),
            Channels::Spectral(wavelengths) => format!("wl {}", wavelengths[channel]),
        };
        let _ = writeln!(text, "{name}\n kbdf\n {}\n def", vec![" 1.0"; starts.len()].concat());
        for (start, row) in starts.iter().zip(&rows) {
            let _ = writeln!(text, ";; Psi = {}, Sigma = {}", start[1], start[0]);
            for values in row.chunks_exact(grid.axes[2].len()) {
                let line: String = values.iter().map(|f| format!(" {:.6e}", f * PI)).collect();
                let _ = writeln!(text, "{line}");
            }
        }
        text += " enddef\n";
    }
    text
}

/// A file as libbsdf evaluates it.
struct Sheets {
    side: Side,
    component: Component,
    grid: Grid,
    /// By channel, rows of the nodes of wi.
    channels: Vec<Vec<Vec<f64>>>,
}

impl Sheets {
    fn read(text: &str, side: Side, component: Component) -> Sheets {
        let lines = text.lines().filter(|line| !line.starts_with(";;"));
        let mut words = lines.flat_map(str::split_whitespace);
        let mut sheets = Sheets { side, component, grid: grid(), channels: Vec::new() };
        let mut axes = [const { Vec::new() }; 4];
        while let Some(word) = words.next() {
            let mut list = |count: usize| -> Vec<f64> {
                words.by_ref().take(count).filter_map(|word| word.parse().ok()).collect()
            };
            let axis = ["sigma", "psi", "theta", "phi"].iter().position(|name| *name == word);
            if let Some(axis) = axis {
                let count = list(1).first().map_or(0, |count| *count as usize);
                axes[axis] = list(count);
            } else if word == "kbdf" {
                sheets.grid.axes = axes.clone();
                let starts = sheets.grid.axes[0].len() * sheets.grid.axes[1].len();
                let factors = list(starts);
                words.next();
                let exits = sheets.grid.exits();
                let mut row = |factor: &f64| -> Vec<f64> {
                    words
                        .by_ref()
                        .take(exits)
                        .filter_map(|word| word.parse::<f64>().ok())
                        .map(|f| f * factor / PI)
                        .collect()
                };
                sheets.channels.push(factors.iter().map(&mut row).collect());
            }
        }
        sheets
    }
}

impl Loaded for Sheets {
    fn has(&self, side: Side, component: Component) -> bool {
        (side, component) == (self.side, self.component)
    }

    fn f(&self, _: Side, _: Component, wi: DVec2, wo: DVec2) -> Vec<f64> {
        let reads = self.grid.reads(wi, wo);
        self.channels.iter().map(|rows| sum(rows, &reads)).collect()
    }
}
