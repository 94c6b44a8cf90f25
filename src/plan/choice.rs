//! What a planner chooses from, what it chose, and why.

use super::configuration::{Configuration, Extent};
use crate::bsdf::{Estimate, Kept, Verdict};
use crate::measure::percent;
use crate::scene::{Medium, Scene};
use serde::Serialize;

/// A way to model the cloth, and what is known or expected of it.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// Its name.
    pub name: String,
    #[serde(skip)]
    pub(super) configuration: Configuration,
    /// E of the model: as a pilot measured it on this cloth, or as it is expected before one; 0 of the fibers themselves.
    pub model_error: Estimate,
    /// Ends of its interval at the level of 95 %, where a pilot measured it.
    pub interval: Option<[f64; 2]>,
    /// Noise that the tolerance leaves; none where the model takes all of it, or does not keep it.
    pub noise: Option<f64>,
    /// Seconds of a walk.
    pub seconds_a_walk: f64,
    /// Seconds of the walks that bring the noise so low, as far as pilots tell; none where none do.
    pub walk_seconds: Option<f64>,
    /// Seconds of preparing it, as far as that is still to be done.
    pub prepare_seconds: f64,
    /// Whether pilots have tried it.
    pub tried: bool,
    /// Why the cloth has no such medium, if that was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
}

impl Candidate {
    /// Seconds until it has met the tolerance; infinite where it does not.
    pub(super) fn seconds(&self) -> f64 {
        self.walk_seconds.map_or(f64::INFINITY, |walks| walks + self.prepare_seconds)
    }

    fn is(&self, medium: Medium) -> bool {
        self.configuration.model.medium == medium
    }
}

/// What is going to be measured with, and why.
#[derive(Clone, Debug, Serialize)]
pub struct Plan {
    /// What √(noise² + model error²) is to be at most.
    pub tolerance: f64,
    /// Name of the configuration that was chosen.
    pub chosen: String,
    #[serde(skip)]
    pub(super) configuration: Configuration,
    /// E of the model, as measured on this cloth, with its standard error.
    pub model_error: Estimate,
    /// Ends of its interval at the level of 95 %; none where no pilot measured it.
    pub interval: Option<[f64; 2]>,
    /// Noise at which the walks are to stop.
    pub noise: f64,
    /// Why it was chosen, in a sentence.
    pub reason: String,
    /// Everything that was chosen from.
    pub candidates: Vec<Candidate>,
    /// Seconds that pilots took; tables that are used in the run are not in it.
    pub pilot_seconds: f64,
    /// Walks of each direction through the fibers by pilots.
    pub pilot_walks: u64,
}

impl Plan {
    /// The scene, modelled as planned.
    pub fn apply(&self, scene: &Scene, extent: &Extent) -> Scene {
        self.configuration.apply(scene, extent)
    }

    /// What was chosen and why, in lines of text.
    pub fn lines(&self) -> Vec<String> {
        let mut lines =
            vec![format!("plan: {} for a tolerance of {}: {}", self.chosen, percent(self.tolerance), self.reason)];
        if self.pilot_walks > 0 {
            lines.push(format!(
                "pilots: {} walks of each direction through the fibers, {:.1} s in all",
                self.pilot_walks, self.pilot_seconds
            ));
        }
        lines
    }

    /// The plan as it stands in a summary; what pilots took is left out, since it differs from run to run.
    pub fn summary(&self) -> serde_json::Value {
        let mut value = serde_json::json!(self);
        if let Some(fields) = value.as_object_mut() {
            fields.remove("pilot_seconds");
        }
        value
    }

    /// The configuration that was chosen.
    pub fn configuration(&self) -> &Configuration {
        &self.configuration
    }
}

/// Why, in a sentence: what was measured first. `verdicts` are those of the media that pilots tried, by name.
pub(super) fn reason(chosen: &Candidate, all: &[Candidate], verdicts: &[(String, Verdict)], tolerance: f64) -> String {
    if chosen.is(Medium::Explicit) {
        return of_fibers(chosen, all, verdicts, tolerance);
    }
    let verdict = verdicts.iter().find(|(name, _)| *name == chosen.name).map(|(_, verdict)| verdict);
    if chosen.walk_seconds.is_some_and(f64::is_infinite) {
        return "pilots found no scattered light".into();
    }
    let Some(verdict) = verdict else {
        return format!("medium: no pilot has tried it; of other cloths {}", told(chosen.model_error));
    };
    let Some(noise) = chosen.noise else {
        return format!(
            "no medium is sure to keep it; this one comes nearest with {}, and the noise alone is held to the tolerance",
            measured(verdict)
        );
    };
    let fibers = all.iter().find(|one| one.is(Medium::Explicit)).map_or_else(String::new, |fibers| {
        let times = fibers.seconds() / chosen.seconds();
        format!("; walks through the fibers themselves would take {times:.1} times as long")
    });
    format!(
        "medium: {}, keeps {}, which leaves {:.1} % to noise{fibers}",
        measured(verdict),
        percent(tolerance),
        100.0 * noise
    )
}

/// Why light goes through the fibers themselves.
fn of_fibers(chosen: &Candidate, all: &[Candidate], verdicts: &[(String, Verdict)], tolerance: f64) -> String {
    let low = |verdict: &Verdict| verdict.interval()[0];
    let nearest = verdicts.iter().min_by(|a, b| low(&a.1).total_cmp(&low(&b.1)));
    let Some((name, verdict)) = nearest else {
        let refused = all.iter().find_map(|one| one.refused.as_ref());
        return match refused {
            Some(why) => format!("fibers: the cloth has no such medium ({why})"),
            None => "fibers: to prepare a medium and to walk through it is expected to take longer".into(),
        };
    };
    let [low, high] = verdict.interval().map(|end| 100.0 * end);
    match (verdict.kept(tolerance), verdict.broken(tolerance)) {
        (Kept::Yes, _) => {
            let times =
                all.iter().find(|one| one.name == *name).map_or(1.0, |medium| medium.seconds() / chosen.seconds());
            format!(
                "fibers: the medium ({name}, {}) leaves so little to noise that its walks would take {times:.1} times as long",
                measured(verdict)
            )
        }
        (Kept::No, Some(gap)) if low <= 100.0 * tolerance => format!(
            "fibers: the {} light of the medium ({name}) is off by {:+.1} ± {:.1} % of all light",
            gap.share.name(),
            100.0 * gap.off.value,
            100.0 * gap.off.stderr
        ),
        (Kept::No, _) => format!("fibers: the medium is off by {low:.1} to {high:.1} % ({name})"),
        (Kept::Untold(_), _) => {
            format!("fibers: pilots do not tell whether the medium ({name}, {}) keeps it", measured(verdict))
        }
    }
}

/// E and its interval, such as "3.1 % (2.2 to 4.0)".
fn measured(verdict: &Verdict) -> String {
    let [low, high] = verdict.interval().map(|end| 100.0 * end);
    format!("{:.1} % ({low:.1} to {high:.1})", 100.0 * verdict.light.error())
}

fn told(Estimate { value, stderr }: Estimate) -> String {
    format!("{:.1} ± {:.1} %", 100.0 * value, 100.0 * stderr)
}
