//! Formats of files with a BSDF, and what writing one takes and gives.

use super::fit::Check;
use super::{csv, ddr, radiance, rgl, spectral_exr, ssdd};
use crate::bsdf::Bsdf;
use crate::colour::Channels;
use crate::error::{Error, Result};
use crate::goniometer::Basis;
use crate::scene::Side;

/// A format that a table can be written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Radiance and WINDOW: XML, a matrix over the full basis of Klems.
    Klems,
    /// Radiance: XML, a pruned tree of rank 4.
    TensorTree,
    /// Mitsuba 3 and pbrt-v4: `.bsdf` of the RGL, reflection.
    Rgl,
    /// Images of wavelengths or colours, an incident cell each.
    SpectralExr,
    /// libbsdf.
    Ssdd,
    /// Integra and libbsdf: `.ddr` and `.ddt`.
    Ddr,
    /// A line for each pair of cells.
    Csv,
}

/// What is written.
pub struct Job<'a> {
    /// The table.
    pub table: &'a Bsdf,
    /// Its incident cells.
    pub incident: &'a Basis,
    /// What its channels are.
    pub channels: &'a Channels,
    /// The name of the cloth.
    pub title: &'a str,
    /// With what names of files and materials begin.
    pub stem: &'a str,
    /// Thickness of the cloth in mm, if it is known.
    pub thickness: Option<f64>,
}

/// A file that was made.
#[derive(Clone, Debug)]
pub struct File {
    /// Its name.
    pub name: String,
    /// What it holds.
    pub bytes: Vec<u8>,
}

/// What came of writing a format.
#[derive(Debug, Default)]
pub struct Written {
    /// The files.
    pub files: Vec<File>,
    /// By name of a file, how far it is from the table when it is read again.
    pub checks: Vec<(String, Check)>,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 7] =
        [Format::Klems, Format::TensorTree, Format::Rgl, Format::SpectralExr, Format::Ssdd, Format::Ddr, Format::Csv];

    /// Its word in the command line.
    pub fn name(self) -> &'static str {
        match self {
            Format::Klems => "klems",
            Format::TensorTree => "tensor-tree",
            Format::Rgl => "rgl",
            Format::SpectralExr => "spectral-exr",
            Format::Ssdd => "ssdd",
            Format::Ddr => "ddr",
            Format::Csv => "csv",
        }
    }

    /// What the format cannot carry of a table, and where it puts the rest; a sentence each.
    ///
    /// # Errors
    /// [`Error::Input`] when the table cannot be written in this format at all.
    pub fn notes(self, table: &Bsdf) -> Result<Vec<String>> {
        if self == Format::Csv {
            return Ok(csv::notes());
        }
        let incident = incident(table, self)?;
        channels(table)?;
        let mut notes = match self {
            Format::Klems => radiance::klems::notes(table, incident),
            Format::TensorTree => radiance::tensor_tree::notes(table, incident),
            Format::Rgl => rgl::notes(),
            Format::SpectralExr => spectral_exr::notes(),
            Format::Ssdd => ssdd::notes(),
            Format::Ddr => ddr::notes(),
            Format::Csv => Vec::new(),
        };
        if let ([side], Format::Klems | Format::TensorTree) = (&table.goniometer.sides[..], self) {
            let other = if *side == Side::Front { Side::Back } else { Side::Front };
            notes.push(format!(
                "the {} was not lit: Radiance takes it for black, and its transmission for that of the {} turned round",
                other.name(),
                side.name()
            ));
        }
        Ok(notes)
    }

    /// Make the files of this format.
    ///
    /// # Errors
    /// As [`Format::notes`].
    pub fn write(self, table: &Bsdf, title: &str, stem: &str, thickness: Option<f64>) -> Result<Written> {
        let channels = channels(table)?;
        if self == Format::Csv {
            return Ok(csv::write(table, stem));
        }
        let incident = incident(table, self)?;
        let job = Job { table, incident, channels: &channels, title, stem, thickness };
        Ok(match self {
            Format::Klems => radiance::klems::write(&job),
            Format::TensorTree => radiance::tensor_tree::write(&job),
            Format::Rgl => rgl::write(&job),
            Format::SpectralExr => return spectral_exr::write(&job),
            Format::Ssdd => ssdd::write(&job),
            Format::Ddr => ddr::write(&job),
            Format::Csv => Written::default(),
        })
    }
}

impl Job<'_> {
    /// Share of light from the incident cell nearest to the normal that touches no fiber, of the first lit side.
    pub fn openness(&self) -> f64 {
        let cell = self.incident.cell_of(glam::DVec2::ZERO);
        let side = self.table.goniometer.sides[0];
        self.table.direct(side).get(cell).map_or(0.0, |estimate| estimate.value)
    }

    /// Whether any light comes through without touching a fiber.
    pub fn is_open(&self) -> bool {
        self.table.goniometer.sides.iter().any(|side| self.table.direct(*side).iter().any(|share| share.value > 0.0))
    }
}

fn incident(table: &Bsdf, format: Format) -> Result<&Basis> {
    table.goniometer.incident_basis().ok_or_else(|| {
        Error::Input(format!(
            "{} needs light from the whole hemisphere, but this result has a list of incident directions: measure it with \
             --incident 8, klems or polar:9x12, or export it to csv",
            format.name()
        ))
    })
}

fn channels(table: &Bsdf) -> Result<Channels> {
    table.colours().ok_or_else(|| {
        Error::Input(format!("channels {} are neither Y, nor R, G, B, nor wavelengths", table.channels.join(" ")))
    })
}
