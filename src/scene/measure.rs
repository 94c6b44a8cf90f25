//! `[measure]`: how the cloth is measured.

use super::absorption::{MAX_CHANNELS, WAVELENGTH};
use super::basis::BasisChoice;
use super::reader::{Allowed, Document, Table, Value};
use crate::error::Result;
use serde::{Deserialize, Serialize};
use toml::de::DeValue;

/// Incident directions.
#[derive(Clone, Debug, PartialEq)]
pub enum Incident {
    /// Cells of a basis; light is uniform in projected solid angle inside its cell.
    Cells(BasisChoice),
    /// Collimated directions (θ, φ) in radians.
    List(Vec<[f64; 2]>),
}

/// A face of the cloth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Its normal is +z.
    Front,
    /// Its normal is −z.
    Back,
}

impl Side {
    /// `front` or `back`.
    pub fn name(self) -> &'static str {
        match self {
            Side::Front => "front",
            Side::Back => "back",
        }
    }
}

/// The instrument's settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Lit sides, front first, each once.
    pub sides: Vec<Side>,
    /// Wavelengths in nm at which spectra are read, ascending; empty for 400 to 700 by 10.
    pub wavelengths: Vec<f64>,
    /// Incident directions of each lit side.
    pub incident: Incident,
    /// Exit cells of each hemisphere.
    pub exit: BasisChoice,
}

impl Default for Measure {
    fn default() -> Measure {
        let (incident, exit) = (Incident::Cells(BasisChoice::Disc(8)), BasisChoice::Disc(16));
        Measure { sides: vec![Side::Front], wavelengths: Vec::new(), incident, exit }
    }
}

/// Most incident cells or directions of one side.
const MOST_INCIDENT: usize = 4096;
const KEYS: [&str; 4] = ["sides", "incident", "exit", "wavelengths_nm"];

impl Measure {
    pub(super) fn read(&mut self, table: &Table) -> Result<()> {
        table.expect_keys(&KEYS, &[])?;
        for key in KEYS {
            if let Some(value) = table.get(key) {
                self.set(key, &value)?;
            }
        }
        Ok(())
    }

    /// Replace one setting by a flag's text: `sides`, `incident` or `exit`, written as in the file or as a bare word.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) naming the flag, what was found and what is allowed.
    pub fn set_from_flag(&mut self, key: &str, text: &str) -> Result<()> {
        let document = Document { file: format!("--{key}"), source: text };
        let word = || toml::Spanned::new(0..text.len(), DeValue::String(text.into()));
        let value = DeValue::parse(text).unwrap_or_else(|_| word());
        self.set(key, &Value::alone(&document, key, &value))
    }

    fn set(&mut self, key: &str, value: &Value) -> Result<()> {
        match key {
            "sides" => self.sides = read_sides(value)?,
            "wavelengths_nm" => self.wavelengths = read_wavelengths(value)?,
            "incident" => self.incident = read_incident(value)?,
            _ => self.exit = read_exit(value)?,
        }
        Ok(())
    }
}

fn read_sides(value: &Value) -> Result<Vec<Side>> {
    // A flag's bare words stand for a list; commas part them.
    let mut sides = match value.as_array() {
        Some(items) => items.iter().map(|item| read_side(item, item.string()?)).collect::<Result<Vec<_>>>()?,
        None => value.string()?.split(',').map(|word| read_side(value, word.trim())).collect::<Result<Vec<_>>>()?,
    };
    sides.sort_unstable();
    sides.dedup();
    if sides.is_empty() { Err(value.expected("a list such as [\"front\", \"back\"]")) } else { Ok(sides) }
}

fn read_side(value: &Value, word: &str) -> Result<Side> {
    match word {
        "front" => Ok(Side::Front),
        "back" => Ok(Side::Back),
        _ => Err(value.error(format!("`sides`: unknown side \"{word}\"; allowed: front, back"))),
    }
}

fn read_wavelengths(value: &Value) -> Result<Vec<f64>> {
    let what = "an ascending list of 1 to 128 wavelengths in nm, 0.001 nm or more apart";
    let items = value.as_array().ok_or_else(|| value.expected(what))?;
    let wavelengths = items.iter().map(|item| item.number(WAVELENGTH)).collect::<Result<Vec<f64>>>()?;
    // Names of channels have six decimals, and two channels must not share one.
    let ascending = wavelengths.windows(2).all(|pair| pair[1] - pair[0] > 0.000_999);
    if ascending && (1..=MAX_CHANNELS).contains(&wavelengths.len()) {
        Ok(wavelengths)
    } else {
        Err(value.expected(what))
    }
}

fn read_exit(value: &Value) -> Result<BasisChoice> {
    let what = "the N of an N×N disc basis, a whole number from 1 to 256, \"klems\", or rings × sectors such as \"polar:18x36\", \
                at most 90 × 360";
    read_basis(value, 256, what)
}

fn read_incident(value: &Value) -> Result<Incident> {
    let what = "the N of an N×N disc basis, a whole number from 1 to 64, \"klems\", rings × sectors such as \"polar:18x36\", \
                at most 4096 cells, or a list of directions [[theta, phi], …]";
    let Some(items) = value.as_array() else {
        let basis = read_basis(value, 64, what)?;
        return if basis.cells() > MOST_INCIDENT { Err(value.expected(what)) } else { Ok(Incident::Cells(basis)) };
    };
    if items.is_empty() || items.len() > MOST_INCIDENT {
        return Err(value.error(format!("`incident` lists {} directions; allowed: 1 to {MOST_INCIDENT}", items.len())));
    }
    let directions = items.iter().map(|item| {
        let pair = item.as_array().filter(|pair| pair.len() == 2);
        let pair = pair.ok_or_else(|| item.expected("a pair [theta, phi] in degrees"))?;
        let theta = pair[0].named("theta").number(Allowed::from(0.0, 89.9))?;
        let phi = pair[1].named("phi").number(Allowed::from(-360.0, 360.0))?;
        Ok([theta.to_radians(), phi.to_radians()])
    });
    Ok(Incident::List(directions.collect::<Result<_>>()?))
}

/// A basis by its word, or the N of a disc basis.
fn read_basis(value: &Value, most: u32, what: &str) -> Result<BasisChoice> {
    match value.as_string() {
        Some(word) => BasisChoice::from_word(word).ok_or_else(|| value.expected(what)),
        None => Ok(BasisChoice::Disc(value.integer(1, most, what)?)),
    }
}
