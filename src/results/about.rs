//! What a tally is of.

use super::provenance::{incident, model, weave};
use crate::error::{Error, Result};
use crate::goniometer::{DiscBasis, Goniometer, Incidence};
use crate::scene::{Scene, Side};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// All that decides the numbers of a tally but the walks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// Version of the program.
    pub version: String,
    /// Text of the cloth file.
    pub cloth: String,
    /// The repeat of a weave, whose draft the cloth file may leave to another file; none of a sheet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weave: Option<Value>,
    /// The model's settings.
    pub model: Value,
    /// Incident basis as the cloth file writes it.
    pub incident: Value,
    /// N of the exit basis.
    pub exit: u32,
    /// Lit sides.
    pub sides: Vec<Side>,
    /// Names of the channels.
    pub channels: Vec<String>,
    /// Absorption in 1/mm by kind of fiber and channel.
    pub absorption: Vec<Vec<f64>>,
}

impl About {
    /// What a measurement of a scene is of.
    pub fn new(scene: &Scene) -> About {
        About {
            version: env!("CARGO_PKG_VERSION").into(),
            cloth: scene.text.clone(),
            weave: weave(scene),
            model: model(scene),
            incident: incident(scene),
            exit: scene.measure.exit,
            sides: scene.measure.sides.clone(),
            channels: scene.channels.names.clone(),
            absorption: scene.channels.absorption.clone(),
        }
    }

    /// Incident cells of one side.
    pub fn incident_cells(&self) -> usize {
        match &self.incident {
            Value::Array(list) => list.len(),
            n => n.as_u64().map_or(0, |n| n.min(1 << 16).pow(2) as usize),
        }
    }

    /// A word for an incident cell and side: its angles in degrees.
    pub fn start_name(&self, start: usize) -> String {
        let cells = self.incident_cells().max(1);
        let side = self.sides.get(start / cells).map_or("", |side| side.name());
        let angles = match &self.incident {
            Value::Array(list) => {
                let angle = |i: usize| list.get(start % cells).and_then(|pair| pair.get(i)).and_then(Value::as_f64);
                [angle(0).unwrap_or_default(), angle(1).unwrap_or_default()]
            }
            n => {
                let n = n.as_u64().unwrap_or(1) as u32;
                let incidence = Incidence::Disc(DiscBasis { n });
                let exit = DiscBasis { n: self.exit };
                let goniometer = Goniometer { incidence, exit, sides: vec![Side::Front] };
                goniometer.angles(start % cells).map(f64::to_degrees)
            }
        };
        format!("{side} θ {:.1}°, φ {:.1}°", angles[0], angles[1])
    }

    /// See that another tally is of the same bases, sides and channels.
    ///
    /// # Errors
    /// [`Error::Input`] names what differs.
    pub fn check_same_bases(&self, other: &About) -> Result<()> {
        let fail = |what: &str, a: String, b: String| {
            Err(Error::Input(format!("the results differ in {what} ({a} and {b}): measure both alike to compare them")))
        };
        if self.incident != other.incident {
            return fail("incident directions", self.incident.to_string(), other.incident.to_string());
        }
        if self.exit != other.exit {
            return fail("exit cells", self.exit.to_string(), other.exit.to_string());
        }
        let sides = |about: &About| about.sides.iter().map(|side| side.name()).collect::<Vec<_>>().join(",");
        if self.sides != other.sides {
            return fail("lit sides", sides(self), sides(other));
        }
        if self.channels != other.channels {
            return fail("channels", self.channels.join(" "), other.channels.join(" "));
        }
        Ok(())
    }
}
