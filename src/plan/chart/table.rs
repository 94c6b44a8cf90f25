//! The points as a table of comma-separated values.

use super::points::{Chart, Point};
use crate::scene::{Direct, FirstHit, Memory, Packing, Tracking};

/// The columns of `chart.csv`, in their order.
pub const COLUMNS: [&str; 42] = [
    "name",
    "model",
    "engine",
    "tracking",
    "placement",
    "packing",
    "direct",
    "first_hit",
    "memory",
    "cells",
    "edge_r",
    "directions",
    "cone_deg",
    "realizations",
    "walks",
    "walks_made",
    "prepare_s",
    "seconds",
    "seconds_min",
    "seconds_max",
    "total_s",
    "total_s_min",
    "total_s_max",
    "events_per_walk",
    "ns_per_event",
    "noise_free_cost_s",
    "bytes",
    "noise",
    "noise_stderr",
    "model_error",
    "model_error_stderr",
    "model_error_low",
    "model_error_high",
    "total_error",
    "total_error_stderr",
    "total_error_low",
    "total_error_high",
    "direct_error",
    "direct_error_stderr",
    "own",
    "pareto",
    "pareto_walks",
];

/// The table with its head; what does not apply is empty. Names, numbers and words need no quotes.
pub fn csv(chart: &Chart) -> String {
    let mut text = COLUMNS.join(",") + "\n";
    for point in &chart.points {
        text += &(row(point, chart.own == point.name).join(",") + "\n");
    }
    text
}

fn row(point: &Point, own: bool) -> Vec<String> {
    let number = |value: f64| if value.is_finite() { format!("{value:.5e}") } else { "inf".into() };
    let whole = |value: Option<u64>| value.map_or(String::new(), |value| value.to_string());
    let plain = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value}"));
    let word = |value: Option<&str>| value.unwrap_or_default().to_owned();
    let Point { noise, model_error, total_error, direct_error, .. } = point;
    let tracking = point.tracking.map(|tracking| match tracking {
        Tracking::NullCollision => "null-collision",
        Tracking::Tabulated => "tabulated",
    });
    let direct = point.direct.map(|direct| match direct {
        Direct::Walks => "walks",
        Direct::Straight => "straight",
    });
    let first_hit = point.first_hit.map(|first_hit| match first_hit {
        FirstHit::Medium => "medium",
        FirstHit::Fibers => "fibers",
    });
    let memory = point.memory.map(|memory| match memory {
        Memory::None => "none",
        Memory::Flight => "flight",
    });
    let packing = match point.packing {
        Packing::Random => "random",
        Packing::Separate => "separate",
    };
    let mut row = vec![
        point.name.clone(),
        if point.explicit { "explicit" } else { "implicit" }.into(),
        point.class.name().into(),
        word(tracking),
        word(point.placement.map(|placement| placement.name())),
        packing.into(),
        word(direct),
        word(first_hit),
        word(memory),
        point.cells.map_or(String::new(), |[x, y, z]| format!("{x}x{y}x{z}")),
        plain(point.edge_r),
        whole(point.directions.map(u64::from)),
        plain(point.cone_deg),
        whole(point.realizations),
        point.walks.to_string(),
        point.walks_made.to_string(),
        number(point.prepare_s),
    ];
    row.extend(point.seconds.iter().chain(&point.total_s).map(|seconds| number(*seconds)));
    row.extend([point.events_per_walk, point.ns_per_event, point.noise_free_cost_s].map(number));
    row.push(point.bytes.to_string());
    row.extend([noise.value, noise.stderr].map(number));
    for error in [model_error, total_error] {
        row.extend([error.value, error.stderr, error.bounds[0], error.bounds[1]].map(number));
    }
    row.extend([direct_error.value, direct_error.stderr].map(number));
    row.extend([own, point.pareto, point.pareto_walks].map(|flag| flag.to_string()));
    row
}
