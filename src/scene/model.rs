//! `[model]`: how the cloth is modelled.

use super::reader::{Allowed, Document, Table, Value};
use crate::error::Result;
use serde::Serialize;
use toml::de::DeValue;

/// How the next collision is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tracking {
    /// Tentative events at the rate of a majorant, accepted with probability |m × p|: exact for H and h/H.
    NullCollision,
}

/// Where the next flight starts after a hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Placement {
    /// At the hit point (the paper).
    AtHit,
}

/// The model's settings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Model {
    /// How the next collision is drawn.
    pub tracking: Tracking,
    /// Where the next flight starts.
    pub placement: Placement,
    /// Cells of the direction grid, a square number.
    pub directions: u32,
    /// Length of the approximating cylinder over its radius (paper §2); infinite for none, written as null in JSON.
    pub length_over_radius: f64,
}

impl Default for Model {
    fn default() -> Model {
        Model {
            tracking: Tracking::NullCollision,
            placement: Placement::AtHit,
            directions: 1024,
            length_over_radius: f64::INFINITY,
        }
    }
}

impl Model {
    pub(super) fn read(&mut self, table: &Table) -> Result<()> {
        let not_woven = "belongs to woven cloth, which is not available yet; leave it out";
        let planned = ["cells", "cone_deg"].map(|key| (key, not_woven));
        table.expect_keys(&["tracking", "placement", "directions", "length_over_radius"], &planned)?;
        for key in ["tracking", "placement", "directions", "length_over_radius"] {
            if let Some(value) = table.get(key) {
                self.set(key, &value)?;
            }
        }
        Ok(())
    }

    /// Replace one setting by a flag's text: `tracking` or `placement`.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) naming the flag, what was found and what is allowed.
    pub fn set_from_flag(&mut self, key: &str, text: &str) -> Result<()> {
        let document = Document { file: format!("--{key}"), source: text };
        let word = toml::Spanned::new(0..text.len(), DeValue::String(text.into()));
        self.set(key, &Value::alone(&document, key, &word))
    }

    fn set(&mut self, key: &str, value: &Value) -> Result<()> {
        match key {
            "tracking" => {
                self.tracking = value.choice(&[("null-collision", Tracking::NullCollision)], &["tabulated"])?
            }
            "placement" => {
                let planned = ["carried", "carried-dense", "carried-void"];
                self.placement = value.choice(&[("at-hit", Placement::AtHit)], &planned)?;
            }
            "directions" => self.directions = read_directions(value)?,
            _ if value.is_infinite() => self.length_over_radius = f64::INFINITY,
            _ => {
                let number = value.number(Allowed::from(1.0, 1e9));
                self.length_over_radius = number.map_err(|_| value.expected("inf or a number from 1 to 1000000000"))?;
            }
        }
        Ok(())
    }
}

fn read_directions(value: &Value) -> Result<u32> {
    let what = "a square number from 16 to 65536, such as 1024";
    let directions = value.integer(16, 65536, what)?;
    if directions.isqrt().pow(2) == directions { Ok(directions) } else { Err(value.expected(what)) }
}
