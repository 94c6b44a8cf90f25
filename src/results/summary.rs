//! `summary.json`.

use super::provenance::{degrees, model, runs};
use crate::bsdf::{Component, Estimate, Totals, hemispherical, reciprocity, totals};
use crate::measure::{Measurement, peak_bytes};
use crate::scene::{Incident, Scene};
use serde_json::{Value, json};
use std::path::Path;

/// The text of `summary.json`, keys sorted.
pub fn summary(scene: &Scene, measurement: &Measurement) -> String {
    let Measurement { goniometer, tally, seconds, clustering, against, plan, budget, promise, grounds } = measurement;
    let channels = |of: &dyn Fn(usize) -> Totals| -> Vec<(String, Totals)> {
        let names = scene.channels.names.iter().cloned().enumerate();
        names.map(|(channel, name)| (name, of(channel))).collect()
    };
    let cells = goniometer.incident_cells();
    let mut sides = serde_json::Map::new();
    for (place, side) in goniometer.sides.iter().enumerate() {
        let entry = |start: usize| {
            let mut entry = shares(&channels(&|channel| totals(tally, start, channel)));
            // A listed direction keeps the angles that it was given by.
            let [theta, phi] = match &scene.measure.incident {
                Incident::List(angles) => angles[start % cells],
                Incident::Cells(_) => goniometer.angles(start),
            };
            entry["theta_deg"] = json!(degrees(theta));
            entry["phi_deg"] = json!(degrees(phi));
            entry
        };
        let incident: Vec<Value> = (place * cells..(place + 1) * cells).map(entry).collect();
        let mean = hemispherical(tally, goniometer, place, 0)
            .map(|_| channels(&|channel| hemispherical(tally, goniometer, place, channel).unwrap_or_default()));
        let hemispherical = mean.map(|mean| shares(&mean));
        sides.insert(side.name().into(), json!({ "incident": incident, "hemispherical": hemispherical }));
    }
    let rate = |count: u64| count as f64 / seconds.walk;
    let mut value = json!({
        "name": scene.name,
        "engine": tally.origin().engine,
        "adapter": tally.origin().adapter,
        "seed": tally.origin().seed,
        "walks": tally.counts.launched,
        "walks_per_incident": tally.walks_per_incident(),
        "collisions": tally.counts.collisions,
        "tentative_events": tally.counts.tentative_events,
        "seconds": seconds,
        "walks_per_second": rate(tally.counts.launched),
        "collisions_per_second": rate(tally.counts.collisions),
        "peak_bytes": peak_bytes(),
        "provenance": runs(measurement),
        "model": model(scene),
        "base_exits": tally.counts.base_exits,
        "checks": checks(scene, measurement),
        "sides": sides,
    });
    if let Some(against) = against {
        let names = ["reflectance", "transmittance", "direct", "absorptance"];
        let of = |shares: [Estimate; 4]| -> serde_json::Map<_, _> {
            names.iter().zip(shares).map(|(name, share)| ((*name).to_owned(), json!(share))).collect()
        };
        value["checks"]["fibers"] = json!({
            "walks": against.walks,
            "channel": scene.channels.names[against.channel],
            "fibers": of(against.fibers),
            "medium": of(against.medium),
            "model_error": against.light.estimate(),
            "interval": against.verdict().interval(),
        });
    }
    if let Some(grounds) = grounds {
        value["choice"] = json!(grounds);
    }
    if let Some(budget) = budget {
        value["budget"] = budget.clone();
    }
    if let Some(promise) = promise {
        value["promise"] = json!(promise);
    }
    if let Some(plan) = plan {
        value["plan"] = plan.clone();
    }
    if let Some(clustering) = clustering {
        value["realizations"] = json!(clustering);
    }
    format!("{value:#}\n")
}

/// The name of the cloth that a result folder's summary says.
pub fn result_name(folder: &Path) -> Option<String> {
    let text = std::fs::read(folder.join("summary.json")).ok()?;
    let summary: Value = serde_json::from_slice(&text).ok()?;
    summary["name"].as_str().map(String::from)
}

/// Whether the light adds up and takes the same way back.
fn checks(scene: &Scene, measurement: &Measurement) -> Value {
    let Measurement { goniometer, tally, .. } = measurement;
    let channels = 0..tally.channels();
    let gap = |start: usize, channel: usize| {
        let Totals { reflectance, transmittance, direct, absorptance, lost } = totals(tally, start, channel);
        (reflectance.value + transmittance.value + direct.value + absorptance.value + lost - 1.0).abs()
    };
    let gaps = (0..tally.starts()).flat_map(|start| channels.clone().map(move |channel| gap(start, channel)));
    let mut ways = serde_json::Map::new();
    for &side in &goniometer.sides {
        for (name, component) in [("reflection", Component::Reflection), ("transmission", Component::Transmission)] {
            let names = scene.channels.names.iter().enumerate();
            let by_channel = |(channel, name): (usize, &String)| {
                let residual = reciprocity(tally, goniometer, component, side, channel);
                residual.map(|residual| (name.clone(), json!(residual)))
            };
            let found: Option<serde_json::Map<String, Value>> = names.map(by_channel).collect();
            ways.insert(format!("{}.{name}", side.name()), json!(found));
        }
    }
    json!({ "energy_gap": gaps.fold(0.0, f64::max), "reciprocity": ways })
}

/// The four shares by channel, and what was lost.
fn shares(totals: &[(String, Totals)]) -> Value {
    let by_channel = |of: fn(&Totals) -> Estimate| -> Value {
        totals.iter().map(|(name, totals)| (name.clone(), json!(of(totals)))).collect::<serde_json::Map<_, _>>().into()
    };
    json!({
        "reflectance": by_channel(|totals| totals.reflectance),
        "transmittance": by_channel(|totals| totals.transmittance),
        "direct": by_channel(|totals| totals.direct),
        "absorptance": by_channel(|totals| totals.absorptance),
        "lost": totals[0].1.lost,
    })
}
