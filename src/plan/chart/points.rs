//! What is drawn of a chart: one point for each configuration, engine class and number of walks.

use super::super::budget::{Blocks, Budget, Deviation, Evidence, NO_FINER_CELLS, refinements};
use super::super::configuration::{Configuration, Extent};
use super::super::trial::BLOCKS;
use super::engines::Class;
use super::judged::{Judged, Speeds};
use super::run::{find, roles};
use super::series::Series;
use super::state::Head;
use crate::bsdf::{Estimate, block_noise};
use crate::error::Result;
use crate::scene::{BasisChoice, Direct, FirstHit, Memory, Packing, Placement, Scene, Tracking};
use serde::Serialize;

/// One point of a chart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// The configuration.
    pub name: String,
    /// Whether light goes through the fibers themselves.
    pub explicit: bool,
    /// On which engine.
    pub class: Class,
    /// How the next collision is drawn; none of the fibers themselves, like all settings of a medium.
    pub tracking: Option<Tracking>,
    /// Where the next flight starts.
    pub placement: Option<Placement>,
    /// How fibers are laid.
    pub packing: Packing,
    /// Where the direct light comes from.
    pub direct: Option<Direct>,
    /// What walks meet first.
    pub first_hit: Option<FirstHit>,
    /// What walks remember after a hit.
    pub memory: Option<Memory>,
    /// Cells along x, y and z; none of a sheet.
    pub cells: Option<[u32; 3]>,
    /// Edge of a cell in radii of the thinnest fiber.
    pub edge_r: Option<f64>,
    /// Cells of the grid of directions.
    pub directions: Option<u32>,
    /// Half angle of the cone in degrees.
    pub cone_deg: Option<f64>,
    /// Realizations that these walks go through; none of a medium.
    pub realizations: Option<u64>,
    /// Walks of each start.
    pub walks: u64,
    /// Walks of each start that were made: noise falls with the root of the walks, and time grows with them.
    pub walks_made: u64,
    /// Seconds to prepare: tables and the opening of the gpu engine, or a realization.
    pub prepare_s: f64,
    /// Seconds of these walks: median, least and most over the visits.
    pub seconds: [f64; 3],
    /// Seconds in all, with the preparation: median, least and most.
    pub total_s: [f64; 3],
    /// Tentative events of a walk, or pieces of fibers tested.
    pub events_per_walk: f64,
    /// Nanoseconds of an event in this engine class, model, tracking and source of first hits: the median over all visits.
    pub ns_per_event: f64,
    /// Seconds of these walks at that speed, and with the drawing of realizations: without the noise of the clock.
    pub noise_free_cost_s: f64,
    /// What more rays to first hits cost, as [`Trial::rays`](crate::plan::Trial::rays) has it; in the seconds it is included.
    pub rays: Option<(u64, u64, f64)>,
    /// Memory in bytes of tables, or of one realization.
    pub bytes: usize,
    /// Noise of these walks as a share of the scattered light.
    pub noise: Deviation,
    /// E of the model against the fibers; 0 of the fibers themselves.
    pub model_error: Deviation,
    /// √(noise² + model²).
    pub total_error: Deviation,
    /// Largest difference of direct light from that of the fibers over all starts, as a share of all light.
    pub direct_error: Estimate,
    /// No other point of the engine class is both faster and more accurate, by seconds in all and the upper bound of the error.
    pub pareto: bool,
    /// The same by the cost of the walks alone.
    pub pareto_walks: bool,
}

/// What all configurations are held against.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reference {
    /// Its configuration.
    pub name: String,
    /// Walks of each start.
    pub walks: u64,
    /// Noise of their scattered light.
    pub noise: f64,
}

/// A chart as it is written and drawn.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chart {
    /// Name of the cloth.
    pub cloth: String,
    /// Directions of light in words, and exit cells along an edge of the disc.
    pub incident: String,
    /// Exit cells of each side, in words.
    pub exit: String,
    /// Number of starts: incident cells of all lit sides.
    pub starts: usize,
    /// Seed of the walks.
    pub seed: u64,
    /// Engine classes, and what they run on.
    pub engines: Vec<(Class, String)>,
    /// Seconds spent.
    pub spent_s: f64,
    /// The fibers themselves.
    pub reference: Reference,
    /// The medium that the scene asks for.
    pub own: String,
    /// The points, by configuration and class, walks ascending.
    pub points: Vec<Point>,
    /// Configurations that the cloth does not admit, and why.
    pub refused: Vec<(String, String)>,
    /// Configurations that there was no time for.
    pub left_out: usize,
    /// The error budget of the scene's own medium.
    pub budget: Budget,
}

impl Chart {
    /// From all that has been measured; none before the fibers and the scene's own medium have.
    ///
    /// # Errors
    /// Those of [`distance`](crate::bsdf::distance).
    pub fn new(scene: &Scene, extent: &Extent, series: &[Series], head: &Head) -> Result<Option<Chart>> {
        let Some((fibers, own)) = roles(series).filter(|(a, b)| a.made > 0 && b.made > 0) else { return Ok(None) };
        let starts = fibers.blocks.first().map_or(0, |block| block.starts());
        let mut points = Vec::new();
        let speeds = Speeds::of(series);
        for one in series.iter().filter(|series| series.made > 0) {
            let judged = Judged::new(one, fibers)?;
            for class in [Class::Cpu, Class::Gpu].into_iter().filter(|class| !one.rates(*class).is_empty()) {
                points.extend(judged.points(class, extent, starts, &speeds, head.opening)?);
            }
        }
        for class in [Class::Cpu, Class::Gpu] {
            front(&points, class, |point| point.total_s[0]).into_iter().for_each(|i| points[i].pareto = true);
            let front = front(&points, class, |point| point.noise_free_cost_s);
            front.into_iter().for_each(|i| points[i].pareto_walks = true);
        }
        let refused = series.iter().filter_map(|one| Some((one.configuration.name(), one.refused.clone()?)));
        let untouched = |one: &&Series| one.made == 0 && one.refused.is_none();
        let about = head.chart();
        Ok(Some(Chart {
            cloth: scene.name.clone(),
            incident: about.about.incident.to_string(),
            exit: match scene.measure.exit {
                BasisChoice::Disc(n) => format!("{n} × {n}"),
                other => other.to_string(),
            },
            starts,
            seed: about.seed,
            engines: about.engines.clone(),
            spent_s: head.spent,
            reference: Reference {
                name: fibers.configuration.name(),
                walks: BLOCKS * fibers.made,
                noise: block_noise(&fibers.blocks)?.value,
            },
            own: own.configuration.name(),
            points,
            refused: refused.collect(),
            left_out: series.iter().filter(untouched).count(),
            budget: budget(extent, series, fibers, own, head)?,
        }))
    }
}

/// The error budget of the scene's own medium, with what there is.
fn budget(extent: &Extent, series: &[Series], fibers: &Series, own: &Series, head: &Head) -> Result<Budget> {
    let (directions, cells, finest) = refinements(own.configuration, extent);
    let blocks = |configuration: Configuration| -> Blocks {
        match find(series, &configuration) {
            Some(series) if series.made > 0 => Ok(&series.blocks),
            Some(Series { refused: Some(why), .. }) => Err(why.clone()),
            _ => Err("there was no time for it".into()),
        }
    };
    Budget::new(&Evidence {
        configuration: own.configuration,
        base: &own.blocks,
        directions: (directions, blocks(directions)),
        cells: (cells, cells.map_or(Err(NO_FINER_CELLS.into()), blocks)),
        finest: (finest, blocks(finest)),
        fibers: Ok(&fibers.blocks),
        averaging: head.averaging.clone().unwrap_or(Err("there was no time for it".into())),
    })
}

/// The points of an engine class that no other of it beats in both cost and error, by ascending cost.
fn front(points: &[Point], class: Class, cost: fn(&Point) -> f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).filter(|index| points[*index].class == class).collect();
    // What is not well known must not win: judge by the upper bound.
    let error = |index: &usize| points[*index].total_error.bounds[1];
    let key = |index: &usize| [cost(&points[*index]), error(index)];
    order.sort_by(|a, b| key(a)[0].total_cmp(&key(b)[0]).then(key(a)[1].total_cmp(&key(b)[1])));
    let mut best = f64::INFINITY;
    order.retain(|index| {
        let error = error(index);
        let better = error < best;
        best = best.min(error);
        better
    });
    order
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::bsdf::Distance;

    /// A point of 1024 walks with these seconds, noise and model error with its standard error.
    pub fn point(name: &str, explicit: bool, [prepare, walk, noise]: [f64; 3], [model, error]: [f64; 2]) -> Point {
        let noise = Deviation::from(Estimate { value: noise, stderr: 0.0 });
        let square = Distance { square: model * model, square_error: (model + error).powi(2) - model * model };
        let model_error = Deviation::from(square);
        Point {
            name: name.into(),
            explicit,
            class: Class::Cpu,
            tracking: None,
            placement: None,
            packing: Packing::Random,
            direct: None,
            first_hit: None,
            memory: None,
            cells: None,
            edge_r: None,
            directions: None,
            cone_deg: None,
            realizations: None,
            walks: 1024,
            walks_made: 1024,
            prepare_s: prepare,
            seconds: [walk; 3],
            total_s: [prepare + walk; 3],
            events_per_walk: 1.0,
            ns_per_event: 1.0,
            noise_free_cost_s: walk,
            rays: None,
            bytes: 1024,
            noise,
            model_error,
            total_error: noise.with(model_error),
            direct_error: Estimate::default(),
            pareto: false,
            pareto_walks: false,
        }
    }

    #[test]
    fn what_is_beaten_or_not_well_known_is_not_on_the_front() {
        let points = [
            point("good", false, [1.0, 1.0, 0.03], [0.04, 0.0]),
            point("slower and no better", false, [1.0, 2.0, 0.03], [0.04, 0.0]),
            point("fast and rough", false, [0.1, 0.1, 0.03], [0.2, 0.0]),
            point("slow and exact", true, [0.0, 9.0, 0.01], [0.0, 0.0]),
            // As good as the best if one believed it.
            point("lucky", false, [1.0, 1.5, 0.03], [0.0, 0.06]),
        ];
        let names = |front: Vec<usize>| front.into_iter().map(|i| points[i].name.as_str()).collect::<Vec<_>>();
        let front = names(front(&points, Class::Cpu, |point| point.total_s[0]));
        assert_eq!(front, ["fast and rough", "good", "slow and exact"]);
        assert!(names(super::front(&points, Class::Gpu, |point| point.total_s[0])).is_empty());
    }

    #[test]
    fn noise_and_model_add_up_as_squares() {
        let total = point("a", false, [0.0, 1.0, 0.03], [0.04, 0.01]).total_error;
        assert!((total.value - 0.05).abs() < 1e-12);
        assert!((total.bounds[1] - 0.03f64.hypot(0.05)).abs() < 1e-12, "{total:?}");
        assert!(total.bounds[0] < total.value);
    }
}
