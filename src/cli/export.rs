//! `fiberwalk export`.

use super::show::estimate_ratio;
use super::{one_line, print};
use clap::ValueEnum;
use fiberwalk::bsdf::{Bsdf, Component, LEVEL, average_halves, reciprocity};
use fiberwalk::cloth::Cloth;
use fiberwalk::export::{Check, Format};
use fiberwalk::results::{ResultFolder, Stored, result_name};
use fiberwalk::scene::{Scene, Side, Source, Structure};
use fiberwalk::{Error, Result};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Write a result in the formats of renderers, into DIR/export
///
/// Each file is read again with the arithmetic of its loader and held against the table.
#[derive(clap::Args)]
pub struct Arguments {
    /// Result folder
    dir: PathBuf,
    /// Formats, parted by commas
    #[arg(long, value_name = "FORMATS", required = true, value_delimiter = ',')]
    to: Vec<Choice>,
    /// Give light and its way back their mean, where they differ by noise alone
    #[arg(long)]
    reciprocal: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Choice {
    /// Radiance and WINDOW: XML over the basis of Klems
    Klems,
    /// Radiance: XML, a pruned tree of rank 4
    TensorTree,
    /// Mitsuba 3 and pbrt-v4: measured, reflection
    Rgl,
    /// slices as images of colours and wavelengths
    SpectralExr,
    /// libbsdf: reflection, transmission and straight light
    Ssdd,
    /// Integra and libbsdf: .ddr and .ddt
    Ddr,
    /// a line for each pair of cells
    Csv,
}

impl Choice {
    fn format(self) -> Format {
        match self {
            Choice::Klems => Format::Klems,
            Choice::TensorTree => Format::TensorTree,
            Choice::Rgl => Format::Rgl,
            Choice::SpectralExr => Format::SpectralExr,
            Choice::Ssdd => Format::Ssdd,
            Choice::Ddr => Format::Ddr,
            Choice::Csv => Format::Csv,
        }
    }
}

/// Run the command.
pub fn run(arguments: &Arguments) -> Result<()> {
    let stored = Stored::read(&arguments.dir)?;
    let mut table = stored.bsdf()?;
    let mut formats: Vec<Format> = Vec::new();
    for format in arguments.to.iter().map(|choice| choice.format()) {
        if !formats.contains(&format) {
            formats.push(format);
        }
    }
    let folder = arguments.dir.join("export");
    if folder.symlink_metadata().is_ok() && !folder.is_dir() {
        let message = format!("{} is not a folder: files go there, so move it away", folder.display());
        return Err(Error::Input(message));
    }
    // Say what is lost before anything is written.
    for format in &formats {
        for note in format.notes(&table)? {
            eprintln!("{}: {}", format.name(), one_line(&note));
        }
    }
    let mut text = String::new();
    if arguments.reciprocal {
        text += &average(&stored, &mut table)?;
    }
    let stem = stem(&arguments.dir);
    let title = result_name(&arguments.dir).unwrap_or_else(|| stem.clone());
    let thickness = thickness(&stored.about.cloth);
    print(&text)?;
    for format in formats {
        let mut text = String::new();
        let written = format.write(&table, &title, &stem, thickness)?;
        for file in &written.files {
            let path = ResultFolder::add(&folder, &file.name, |out| out.write_all(&file.bytes))?;
            let _ = writeln!(text, "{}", path.display());
            if let Some((_, check)) = written.checks.iter().find(|(name, _)| *name == file.name) {
                let _ = writeln!(text, "  {}", told(check));
            }
        }
        // Tell of every format as it comes: some take a minute.
        print(&text)?;
    }
    Ok(())
}

/// How far a file is from the table.
fn told(check: &Check) -> String {
    format!(
        "read again: cells known to 20 % are {} standard errors off on the average, {} at most; all of it by E = {:.2} % (noise of the \
         table {:.2} %), light of an incident cell by {:.1e} at most",
        estimate_ratio(check.mean),
        estimate_ratio(check.most),
        100.0 * check.relative,
        100.0 * check.noise,
        check.light
    )
}

/// Average the halves of every component whose light is reciprocal up to noise.
fn average(stored: &Stored, table: &mut Bsdf) -> Result<String> {
    let goniometer = stored.about.goniometer()?;
    let mut text = String::new();
    for &side in &goniometer.sides {
        for (name, component) in [("reflection", Component::Reflection), ("transmission", Component::Transmission)] {
            // Transmission from the back is the other half of the same pairs.
            if (side, component) == (Side::Back, Component::Transmission) {
                continue;
            }
            let residuals = (0..stored.tally.channels())
                .filter_map(|channel| reciprocity(&stored.tally, &goniometer, component, side, channel));
            let least = residuals.min_by(|a, b| a.probability.total_cmp(&b.probability));
            let side_name = side.name();
            let Some(least) = least else {
                let why = "the other side was not lit, or an exit cell lies in several incident ones";
                let _ = writeln!(text, "reciprocal: {side_name} {name} stays as it is: {why}");
                continue;
            };
            if least.probability < LEVEL {
                let _ = writeln!(
                    text,
                    "reciprocal: {side_name} {name} stays as it is: it differs from its reverse by {:.1} % beyond noise, p = {:.1e}",
                    100.0 * least.error,
                    least.probability
                );
                continue;
            }
            if let Some(halves) = average_halves(table, component, side) {
                let _ = writeln!(
                    text,
                    "reciprocal: {side_name} {name} differed from its reverse by {:.2} % with its noise (p = {:.2}), now by {:.2} %",
                    100.0 * halves.before,
                    least.probability,
                    100.0 * halves.after
                );
            }
        }
    }
    Ok(text)
}

/// The folder's name as one word, for names of files and materials.
fn stem(dir: &Path) -> String {
    let full = dir.canonicalize().unwrap_or_else(|_| dir.to_owned());
    let name = full.file_name().map_or_else(|| "cloth".into(), |name| name.to_string_lossy().into_owned());
    let word = |c: char| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '_' };
    name.chars().map(word).collect()
}

/// Thickness in mm, if the cloth file says all by itself.
fn thickness(text: &str) -> Option<f64> {
    let source = Source { file: "cloth".into(), stem: "cloth".into(), text: text.into(), folder: None };
    let scene = Scene::parse(&source).ok()?;
    match &scene.structure {
        Structure::Sheet(sheet) => Some(sheet.thickness),
        _ => Cloth::new(&scene).ok().map(|cloth| cloth.size().z),
    }
}
