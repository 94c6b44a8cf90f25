//! A plan that an earlier run made, for a run that goes by it and not by the clock.

use super::tally::{Stored, TALLY};
use crate::error::{Error, Result};
use crate::scene::{Medium, Scene};
use serde_json::Value;
use std::path::Path;

/// What a planned result was measured with.
#[derive(Clone, Debug)]
pub struct Replay {
    folder: String,
    /// Text of its cloth file, and the repeat of its weave.
    cloth: (String, Option<Value>),
    model: serde_json::Map<String, Value>,
    /// `gpu` or `cpu`.
    pub engine: String,
    /// Its adapter.
    pub adapter: String,
    /// The plan, as it stands in the summary.
    pub plan: Value,
    /// What √(noise² + model error²) is to be at most.
    pub tolerance: f64,
    /// Noise at which the walks stop.
    pub noise: f64,
    /// Ends of the interval of the model's error by pilots; none where no pilot measured it.
    pub interval: Option<[f64; 2]>,
}

impl Replay {
    /// Of the result in a folder.
    ///
    /// # Errors
    /// [`Error::File`] when `summary.json` or `tally.exr` cannot be read; [`Error::Input`] when it is no result of a plan, or of another version.
    pub fn read(folder: &Path) -> Result<Replay> {
        let path = folder.join("summary.json");
        let text = std::fs::read_to_string(&path).map_err(|source| Error::File {
            action: "read the plan",
            path: path.clone(),
            source,
        })?;
        let summary: Value = serde_json::from_str(&text)
            .map_err(|error| Error::Input(format!("{}: no summary of a result: {error}", path.display())))?;
        let missing = |what: &str| {
            Error::Input(format!(
                "{}: has no {what}: only a run with --tolerance that chose its model has a plan",
                path.display()
            ))
        };
        let plan = summary.get("plan").ok_or_else(|| missing("`plan`"))?;
        let number = |key: &str| plan[key].as_f64().ok_or_else(|| missing(&format!("`plan.{key}`")));
        let word = |key: &str| summary[key].as_str().map(String::from).ok_or_else(|| missing(&format!("`{key}`")));
        let about = Stored::read(&folder.join(TALLY))?.about;
        if about.version != env!("CARGO_PKG_VERSION") {
            let message =
                format!("{}: of version {}, this is {}", path.display(), about.version, env!("CARGO_PKG_VERSION"));
            return Err(Error::Input(message));
        }
        Ok(Replay {
            folder: folder.display().to_string(),
            cloth: (about.cloth, about.weave),
            model: summary["model"].as_object().cloned().ok_or_else(|| missing("`model`"))?,
            engine: word("engine")?,
            adapter: word("adapter")?,
            plan: plan.clone(),
            tolerance: number("tolerance")?,
            noise: number("noise")?,
            interval: serde_json::from_value(plan["interval"].clone()).unwrap_or_default(),
        })
    }

    /// The scene, modelled as it was there.
    ///
    /// # Errors
    /// [`Error::Input`] when the cloth is another, or a setting of the model is none.
    pub fn apply(&self, scene: &Scene) -> Result<Scene> {
        if (&scene.text, super::provenance::weave(scene)) != (&self.cloth.0, self.cloth.1.clone()) {
            let message = format!(
                "--plan {}: is of another cloth; a plan is measured on its own cloth and serves no other",
                self.folder
            );
            return Err(Error::Input(message));
        }
        let mut scene = scene.clone();
        let model = &mut scene.model;
        for (key, value) in &self.model {
            match (key.as_str(), value) {
                ("medium", Value::String(medium)) => {
                    model.medium = if medium == "explicit" { Medium::Explicit } else { Medium::Implicit };
                }
                (_, Value::Null) => {}
                (key, Value::String(word)) => model.set_from_flag(key, word)?,
                (key, value) => model.set_from_flag(key, &value.to_string())?,
            }
        }
        Ok(scene)
    }
}
