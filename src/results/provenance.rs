//! What the numbers were made from, as JSON with sorted keys.

use crate::goniometer::Run;
use crate::measure::Measurement;
use crate::scene::{Incident, Medium, Scene, Structure};
use serde_json::{Value, json};

/// The attribute that every part of an EXR file carries.
pub fn attribute(scene: &Scene, measurement: &Measurement) -> Value {
    let origin = measurement.tally.origin();
    let mut value = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "cloth": scene.text,
        "model": model(scene),
        "incident": incident(scene),
        "exit": scene.measure.exit,
        "seed": origin.seed,
        "walks": measurement.tally.counts.launched,
        "engine": origin.engine,
        "adapter": origin.adapter,
    });
    // The cloth file may leave the draft to another file.
    if let Some(weave) = weave(scene) {
        value["weave"] = weave;
    }
    value
}

/// The settings that the medium goes by.
pub fn model(scene: &Scene) -> Value {
    let mut settings = json!(scene.model);
    if let (Medium::Explicit, Some(settings)) = (scene.model.medium, settings.as_object_mut()) {
        settings.retain(|key, _| ["medium", "packing", "length_over_radius"].contains(&key.as_str()));
    }
    settings
}

/// The repeat of a weave: its draft as the cloth file writes it, the yarns and the settings of its threads.
pub fn weave(scene: &Scene) -> Option<Value> {
    let Structure::Weave(weave) = &scene.structure else { return None };
    let yarns = |threads: &[usize]| threads.iter().map(|&yarn| weave.yarns[yarn].name.as_str()).collect::<Vec<_>>();
    // Without the noise of the conversion.
    let per_cm = |spacing: f64| (1e9 * 10.0 / spacing).round() / 1e9;
    Some(json!({
        "draft": weave.draft(),
        "warp": yarns(&weave.ends),
        "weft": yarns(&weave.picks),
        "ends_per_cm": per_cm(weave.end_spacing),
        "picks_per_cm": per_cm(weave.pick_spacing),
    }))
}

/// The runs of which a result is made.
pub fn runs(measurement: &Measurement) -> Value {
    let tally = &measurement.tally;
    let starts = tally.starts() as u64;
    let run = |run: &Run| {
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "engine": run.origin.engine,
            "adapter": run.origin.adapter,
            "seed": run.origin.seed,
            "walks": starts * run.walks.iter().map(|[first, end]| end - first).sum::<u64>(),
        })
    };
    tally.coverage.runs().iter().map(run).collect()
}

/// The incident basis as the cloth file writes it.
pub fn incident(scene: &Scene) -> Value {
    match &scene.measure.incident {
        Incident::Cells(basis) => json!(basis),
        Incident::List(angles) => angles.iter().map(|pair| json!(pair.map(degrees))).collect(),
    }
}

/// Degrees without the noise of the conversion.
pub fn degrees(radians: f64) -> f64 {
    (radians.to_degrees() * 1e9).round() / 1e9
}
