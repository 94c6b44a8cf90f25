//! A configuration, held against the fibers: its points.

use super::super::budget::Deviation;
use super::super::configuration::Extent;
use super::super::trial::BLOCKS;
use super::engines::Class;
use super::points::Point;
use super::series::{Series, median};
use crate::bsdf::{Distance, Estimate, block_noise, block_totals, distance};
use crate::error::Result;
use crate::scene::{FirstHit, Memory, Tracking};

/// Walks of each start that points are of: 4ᵏ.
const WALKS: std::ops::RangeInclusive<u32> = 4..=14;
/// Most times the walks that were made: noise and time follow from these.
const BEYOND: u64 = 16;
/// Points are drawn from the first with at most this noise, to the first whose noise is below this share of the error.
const LOUDEST: f64 = 0.3;
const QUIET: f64 = 0.25;

/// What kernels have in common: engine class, whether light goes through the fibers, tracking and source of first hits.
type Kernel = (Class, bool, Tracking, FirstHit, Memory);

/// Nanoseconds of an event by kernel.
pub struct Speeds(Vec<(Kernel, f64)>);

impl Speeds {
    /// Of all visits.
    pub fn of(series: &[Series]) -> Speeds {
        let mut all: Vec<(Kernel, Vec<f64>)> = Vec::new();
        for one in series {
            for visit in &one.visits {
                let key = Speeds::key(one, visit.class);
                let walking = (visit.seconds - drawing(one) * visit.realizations as f64).max(0.1 * visit.seconds);
                let ns = 1e9 * walking / visit.events.max(1) as f64;
                match all.iter_mut().find(|(known, _)| *known == key) {
                    Some((_, list)) => list.push(ns),
                    None => all.push((key, vec![ns])),
                }
            }
        }
        Speeds(all.into_iter().filter_map(|(key, list)| Some((key, median(&list)?))).collect())
    }

    fn key(series: &Series, class: Class) -> Kernel {
        let model = series.configuration.model;
        (class, series.explicit(), model.tracking, model.first_hit, model.memory)
    }

    fn get(&self, series: &Series, class: Class) -> f64 {
        let key = Speeds::key(series, class);
        self.0.iter().find(|(known, _)| *known == key).map_or(0.0, |(_, ns)| *ns)
    }
}

/// Seconds that a realization takes all threads together.
fn drawing(series: &Series) -> f64 {
    series.drawing / rayon::current_num_threads() as f64
}

/// Seconds of the rays to first hits that so many walks of each start need beyond those that come with the medium.
pub fn more_rays(rays: Option<(u64, u64, f64)>, walks: f64) -> f64 {
    rays.map_or(0.0, |(ready, span, seconds)| ((walks - ready as f64) / span as f64).ceil().max(0.0) * seconds)
}

/// A configuration, held against the fibers.
pub struct Judged<'a> {
    series: &'a Series,
    /// Noise of all walks that were made.
    noise: Estimate,
    model: Deviation,
    direct: Estimate,
}

impl Judged<'_> {
    /// By its blocks and theirs.
    ///
    /// # Errors
    /// Those of [`distance`].
    pub fn new<'a>(series: &'a Series, fibers: &Series) -> Result<Judged<'a>> {
        let noise = block_noise(&series.blocks)?;
        let model: Deviation = match series.explicit() {
            true => Distance::default().into(),
            false => distance(&series.blocks, &fibers.blocks)?.into(),
        };
        let mut direct = Estimate::default();
        for start in 0..if series.explicit() { 0 } else { fibers.blocks[0].starts() } {
            let [here, there] = [series, fibers].map(|series| block_totals(&series.blocks, start, 0));
            let (here, there) = (here?.direct, there?.direct);
            let value = (here.value - there.value).abs();
            if value > direct.value || start == 0 {
                direct = Estimate { value, stderr: here.stderr.hypot(there.stderr) };
            }
        }
        Ok(Judged { series, noise, model, direct })
    }

    /// Points on an engine class, walks ascending.
    pub fn points(
        &self,
        class: Class,
        extent: &Extent,
        starts: usize,
        speeds: &Speeds,
        opening: f64,
    ) -> Result<Vec<Point>> {
        let Judged { series, noise, model, direct } = self;
        let configuration = &series.configuration;
        let of_medium = !series.explicit();
        let rates = series.rates(class);
        let spread = |of: fn(f64, f64) -> f64, first: f64| rates.iter().copied().fold(first, of);
        let rates = [median(&rates).unwrap_or_default(), spread(f64::min, f64::INFINITY), spread(f64::max, 0.0)];
        let made = BLOCKS * series.made;
        let opening = if class == Class::Gpu { opening } else { 0.0 };
        let extreme = |of: fn(f64, f64) -> f64| series.preparing.iter().copied().reduce(of).unwrap_or_default();
        let usual = series.prepare_seconds().unwrap_or_default();
        let preparing = [usual, extreme(f64::min), extreme(f64::max)].map(|seconds| seconds + opening);
        let (events, ns) = (series.events_per_walk(), speeds.get(series, class));
        let each = configuration.each.unwrap_or(1);
        let mut points = Vec::new();
        for walks in WALKS.map(|k| 4u64.pow(k)).filter(|walks| *walks <= BEYOND * made && *walks >= each) {
            let scale = (made as f64 / walks as f64).sqrt();
            let noise = Estimate { value: noise.value * scale, stderr: noise.stderr * scale };
            if noise.value > LOUDEST {
                continue;
            }
            let all = (walks * starts as u64) as f64;
            let more = more_rays(series.rays, walks as f64);
            let seconds = rates.map(|rate| rate * all + more);
            let realizations = (!of_medium).then(|| walks.div_ceil(each));
            let noise_free_cost_s =
                1e-9 * ns * events * all + drawing(series) * realizations.unwrap_or(0) as f64 + more;
            let noise = Deviation::from(noise);
            points.push(Point {
                name: configuration.name(),
                explicit: !of_medium,
                class,
                tracking: of_medium.then_some(configuration.model.tracking),
                placement: of_medium.then_some(configuration.model.placement),
                packing: configuration.model.packing,
                direct: of_medium.then_some(configuration.model.direct),
                first_hit: of_medium.then_some(configuration.model.first_hit),
                memory: of_medium.then_some(configuration.model.memory),
                cells: if of_medium { configuration.cells(extent) } else { None },
                edge_r: configuration.edge,
                directions: of_medium.then_some(configuration.model.directions),
                cone_deg: if of_medium { configuration.cone_deg() } else { None },
                realizations,
                walks,
                walks_made: made,
                prepare_s: preparing[0],
                seconds,
                total_s: [0, 1, 2].map(|i| preparing[i] + seconds[i]),
                events_per_walk: events,
                ns_per_event: ns,
                noise_free_cost_s,
                rays: series.rays,
                bytes: series.bytes,
                noise,
                model_error: *model,
                total_error: noise.with(*model),
                direct_error: *direct,
                pareto: false,
                pareto_walks: false,
            });
            if noise.value < QUIET * model.value {
                break;
            }
        }
        Ok(points)
    }
}
