//! `summary.json`.

use super::provenance::{degrees, runs};
use crate::bsdf::{Estimate, Totals, hemispherical, totals};
use crate::measure::{Measurement, peak_bytes};
use crate::scene::{Incident, Scene};
use serde_json::{Value, json};

/// The text of `summary.json`, keys sorted.
pub fn summary(scene: &Scene, measurement: &Measurement) -> String {
    let Measurement { goniometer, tally, seconds } = measurement;
    let incident: Vec<Value> = (0..tally.incident_cells())
        .map(|cell| {
            // A listed direction keeps the angles that it was given by.
            let [theta, phi] = match &scene.measure.incident {
                Incident::List(angles) => angles[cell],
                Incident::Disc(_) => goniometer.angles(cell),
            };
            let mut entry = shares(&totals(tally, cell));
            entry["theta_deg"] = json!(degrees(theta));
            entry["phi_deg"] = json!(degrees(phi));
            entry
        })
        .collect();
    let rate = |count: u64| count as f64 / seconds.walk;
    let value = json!({
        "name": scene.name,
        "engine": tally.origin.engine,
        "adapter": tally.origin.adapter,
        "seed": tally.origin.seed,
        "walks": tally.counts.launched,
        "walks_per_incident": tally.walks_per_incident,
        "collisions": tally.counts.collisions,
        "tentative_events": tally.counts.tentative_events,
        "seconds": seconds,
        "walks_per_second": rate(tally.counts.launched),
        "collisions_per_second": rate(tally.counts.collisions),
        "peak_bytes": peak_bytes(),
        "provenance": runs(measurement),
        "model": scene.model,
        "sides": { "front": {
            "incident": incident,
            "hemispherical": hemispherical(tally, goniometer).map(|mean| shares(&mean)),
        }},
    });
    format!("{value:#}\n")
}

/// The four shares by channel, and what was lost.
fn shares(totals: &Totals) -> Value {
    let channel = |estimate: Estimate| json!({ "Y": estimate });
    json!({
        "reflectance": channel(totals.reflectance),
        "transmittance": channel(totals.transmittance),
        "direct": channel(totals.direct),
        "absorptance": channel(totals.absorptance),
        "lost": totals.lost,
    })
}
