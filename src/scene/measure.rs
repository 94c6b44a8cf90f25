//! `[measure]`: how the cloth is measured.

use super::reader::{Allowed, Document, Table, Value};
use crate::error::Result;
use toml::de::DeValue;

/// Incident directions.
#[derive(Clone, Debug, PartialEq)]
pub enum Incident {
    /// N × N cells of the disc basis.
    Disc(u32),
    /// Collimated directions (θ, φ) in radians.
    List(Vec<[f64; 2]>),
}

/// The instrument's settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Incident directions, of light on the front.
    pub incident: Incident,
    /// N of the disc basis of exit cells.
    pub exit: u32,
}

impl Default for Measure {
    fn default() -> Measure {
        Measure { incident: Incident::Disc(8), exit: 16 }
    }
}

const KEYS: [&str; 3] = ["sides", "incident", "exit"];

impl Measure {
    pub(super) fn read(&mut self, table: &Table) -> Result<()> {
        table.expect_keys(&KEYS, &[("wavelengths_nm", "has no use: no fiber has a spectrum")])?;
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
            "sides" => read_sides(value)?,
            "incident" => self.incident = read_incident(value)?,
            _ => {
                let what = "the N of an N×N disc basis, a whole number from 1 to 256";
                refuse_planned_basis(value, what)?;
                self.exit = value.integer(1, 256, what)?;
            }
        }
        Ok(())
    }
}

fn read_sides(value: &Value) -> Result<()> {
    // A flag's bare word stands for a list of one; commas part the words.
    let Some(items) = value.as_array() else {
        return value.string()?.split(',').try_for_each(|word| read_side(value, word.trim()));
    };
    if items.is_empty() {
        return Err(value.expected("[\"front\"]"));
    }
    items.iter().try_for_each(|item| read_side(item, item.string()?))
}

fn read_side(value: &Value, word: &str) -> Result<()> {
    match word {
        "front" => Ok(()),
        "back" => Err(value.error("`sides`: \"back\" is not available yet; allowed: front")),
        _ => Err(value.error(format!("`sides`: unknown side \"{word}\"; allowed: front"))),
    }
}

fn read_incident(value: &Value) -> Result<Incident> {
    let what = "the N of an N×N disc basis, a whole number from 1 to 64, or a list of directions [[theta, phi], …]";
    refuse_planned_basis(value, what)?;
    let Some(items) = value.as_array() else { return Ok(Incident::Disc(value.integer(1, 64, what)?)) };
    if items.is_empty() || items.len() > 4096 {
        return Err(value.error(format!("`incident` lists {} directions; allowed: 1 to 4096", items.len())));
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

fn refuse_planned_basis(value: &Value, what: &str) -> Result<()> {
    match value.as_string() {
        Some(word) if word == "klems" || word.starts_with("polar:") => {
            Err(value.expected(&format!("{what}; this basis is not available yet")))
        }
        _ => Ok(()),
    }
}
