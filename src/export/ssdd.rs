//! SSDD of libbsdf: reflection, transmission and straight light of a side in one file, as text.
//!
//! Source: KimuraRyo/libbsdf, `doc/SsddFileFormatSpecification.md`. Angles of wi and wo are polar ones from the lit and from the far side's normal,
//! and azimuths from +x as seen from the front.

use super::fit::{Grid, Loaded, Smooth, check, near, steps, sum};
use super::format::{File, Job, Written};
use crate::bsdf::Component;
use crate::colour::Channels;
use crate::scene::Side;
use glam::DVec2;
use std::fmt::Write;

/// What the format leaves out of a table.
pub fn notes() -> Vec<String> {
    vec!["light that touches no fiber is the specular transmittance; a side is a file, its azimuths as seen from the front".into()]
}

fn grid() -> Grid {
    Grid { axes: [steps(90.0, 10), steps(360.0, 17), steps(90.0, 19), steps(360.0, 25)], specular: false }
}

/// Write a file for each lit side and read it again.
pub fn write(job: &Job) -> Written {
    let mut written = Written::default();
    for &side in &job.table.goniometer.sides {
        let name = format!("{}_{}.ssdd", job.stem, side.name());
        let text = text(job, side);
        let loaded = Blocks::read(&text, side, job.table.channels.len());
        written.checks.push((name.clone(), check(job.table, job.incident, &loaded)));
        written.files.push(File { name, bytes: text.into_bytes() });
    }
    written
}

fn text(job: &Job, side: Side) -> String {
    let (table, grid) = (job.table, grid());
    let mut text = format!("VERSION 0.3\nSOFTWARE fiberwalk-{}\n", env!("CARGO_PKG_VERSION"));
    let colours = match job.channels {
        Channels::Grey => "COLOR_MODEL monochrome\n".to_owned(),
        Channels::Rgb => "COLOR_MODEL rgb\n".to_owned(),
        Channels::Spectral(wavelengths) => format!("COLOR_MODEL spectrum\nWAVELENGTH_LIST{}\n", words(wavelengths)),
    };
    let list = |index: usize| format!("PARAM{index}_LIST{}\n", words(&grid.axes[index]));
    let title = job.title.replace(['\n', '\r'], " ");
    let mut head = |kind: &str, parameters: &str| {
        let _ = write!(
            text,
            "\nDATA_TYPE {kind}\n{colours}{parameters}NAME {title}, {}\nSOURCE_TYPE generated\nDATA ascii\n",
            side.name()
        );
        std::mem::take(&mut text)
    };
    let mut parts = String::new();
    for part in table.tables().iter().filter(|part| part.side == side) {
        let kind = if part.component == Component::Reflection { "brdf" } else { "btdf" };
        let parameters =
            format!("PARAM_TYPE spherical_coordinate_system\n{}{}{}{}", list(0), list(1), list(2), list(3));
        parts += &head(kind, &parameters);
        let exit = &table.goniometer.exit;
        let starts: Vec<[f64; 2]> = grid.starts().collect();
        let rows = |channel: usize| -> Vec<Vec<f64>> {
            let smooth = Smooth::new(job.incident, exit, &table.values(part, channel));
            grid.rows(&smooth, job.incident, &table.shares(part, channel))
        };
        let channels: Vec<_> = (0..table.channels.len()).map(rows).collect();
        for node in 0..grid.exits() {
            // Here polar angles run fastest, and azimuths of wo slowest, as in a row.
            for start in 0..starts.len() {
                let colour: Vec<f64> = channels.iter().map(|rows| rows[start][node]).collect();
                parts += &numbers(&colour);
            }
        }
    }
    parts += &head("specular_transmittance", &format!("{}{}", list(0), list(1)));
    let direct = table.direct(side);
    for start in grid.starts() {
        let share: f64 =
            near(job.incident, grid.start(start)).iter().map(|(cell, share)| share * direct[*cell].value).sum();
        parts += &numbers(&vec![share; table.channels.len()]);
    }
    parts
}

fn words(list: &[f64]) -> String {
    list.iter().map(|value| format!(" {value}")).collect()
}

/// A colour on a line.
fn numbers(colour: &[f64]) -> String {
    let mut line = colour.iter().map(|value| format!("{value:.6e} ")).collect::<String>();
    line.truncate(line.trim_end().len());
    line + "\n"
}

/// A file as libbsdf evaluates it.
struct Blocks {
    side: Side,
    grid: Grid,
    /// Reflection and transmission: by channel, rows of the nodes of wi.
    parts: [Vec<Vec<Vec<f64>>>; 2],
}

impl Blocks {
    fn read(text: &str, side: Side, channels: usize) -> Blocks {
        let mut blocks = Blocks { side, grid: grid(), parts: [Vec::new(), Vec::new()] };
        for block in text.split("DATA_TYPE ").skip(1) {
            let place = if block.starts_with("brdf") { 0 } else { 1 };
            let Some((head, data)) = block.split_once("DATA ascii\n") else { continue };
            if block.starts_with("specular") {
                continue;
            }
            let list = |index: usize| -> Vec<f64> {
                let line = head.lines().find_map(|line| line.strip_prefix(&format!("PARAM{index}_LIST ")));
                line.map_or_else(Vec::new, |line| line.split(' ').filter_map(|word| word.parse().ok()).collect())
            };
            blocks.grid.axes = [list(0), list(1), list(2), list(3)];
            let starts = blocks.grid.axes[0].len() * blocks.grid.axes[1].len();
            let mut rows = vec![vec![vec![0.0; blocks.grid.exits()]; starts]; channels];
            for (index, line) in data.lines().take_while(|line| !line.is_empty()).enumerate() {
                for (channel, word) in line.split(' ').enumerate().take(channels) {
                    // index = p0 + n0·(p1 + n1·(p2 + n2·p3))
                    rows[channel][index % starts][index / starts] = word.parse().unwrap_or(f64::NAN);
                }
            }
            blocks.parts[place] = rows;
        }
        blocks
    }
}

impl Loaded for Blocks {
    fn has(&self, side: Side, component: Component) -> bool {
        side == self.side && !self.parts[component as usize].is_empty()
    }

    fn f(&self, _: Side, component: Component, wi: DVec2, wo: DVec2) -> Vec<f64> {
        let reads = self.grid.reads(wi, wo);
        self.parts[component as usize].iter().map(|rows| sum(rows, &reads)).collect()
    }
}
