//! What a tally is of.

use super::provenance::{incident, model, weave};
use crate::error::{Error, Result};
use crate::goniometer::Goniometer;
use crate::scene::{BasisChoice, Incident, Measure, Scene, Side};
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
    /// Exit basis as the cloth file writes it.
    pub exit: BasisChoice,
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

    /// Incident cells of one side; 0 when the incident directions are none.
    pub fn incident_cells(&self) -> usize {
        self.incidence().map_or(0, |incident| match incident {
            Incident::Cells(basis) => basis.cells(),
            Incident::List(angles) => angles.len(),
        })
    }

    /// The incident directions, if they are written as this program does.
    fn incidence(&self) -> Option<Incident> {
        if let Value::Array(list) = &self.incident {
            let angle = |value: &Value| value.as_f64().map(f64::to_radians);
            let pair = |pair: &Value| Some([angle(pair.get(0)?)?, angle(pair.get(1)?)?]);
            return list.iter().map(pair).collect::<Option<_>>().map(Incident::List);
        }
        serde_json::from_value(self.incident.clone()).ok().map(Incident::Cells)
    }

    /// The instrument.
    ///
    /// # Errors
    /// [`Error::Input`] when the incident directions are none.
    pub fn goniometer(&self) -> Result<Goniometer> {
        let wrong = || Error::Input(format!("{} are no incident directions", self.incident));
        let incident = self.incidence().ok_or_else(wrong)?;
        let measure = Measure { sides: self.sides.clone(), incident, exit: self.exit, ..Measure::default() };
        Ok(Goniometer::new(&measure))
    }

    /// A word for an incident cell and side: its angles in degrees.
    pub fn start_name(&self, start: usize) -> String {
        let cells = self.incident_cells().max(1);
        let side = self.sides.get(start / cells).map_or("", |side| side.name());
        let angles = match self.incidence() {
            Some(Incident::List(angles)) => angles.get(start % cells).copied(),
            _ => self.goniometer().ok().map(|goniometer| goniometer.angles(start)),
        };
        let [theta, phi] = angles.unwrap_or_default().map(f64::to_degrees);
        format!("{side} θ {theta:.1}°, φ {phi:.1}°")
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
