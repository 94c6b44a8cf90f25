//! The cheapest way to an accuracy.

use super::engines::Class;
use super::judged::more_rays;
use super::points::{Chart, Point};

/// Walks of each start that any measurement has at least.
const LEAST: f64 = 16.0;

/// What a cost is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// Seconds in all, with the preparation.
    All,
    /// The walks alone, at the speed of their engine class.
    Walks,
}

impl Cost {
    /// Of a point.
    pub fn of(self, point: &Point) -> f64 {
        match self {
            Cost::All => point.total_s[0],
            Cost::Walks => point.noise_free_cost_s,
        }
    }
}

/// A way to an accuracy.
#[derive(Clone, Copy, Debug)]
pub struct Way<'a> {
    /// A point of the configuration, with any number of walks.
    pub point: &'a Point,
    /// Walks of each start that bring the error down to what is asked for.
    pub walks: f64,
    /// Its cost in seconds.
    pub seconds: f64,
}

impl Chart {
    /// One point of each configuration and engine class.
    pub fn curves(&self) -> impl Iterator<Item = &Point> {
        let new = |i: &usize| *i == 0 || key(&self.points[*i]) != key(&self.points[*i - 1]);
        (0..self.points.len()).filter(new).map(|i| &self.points[i])
    }

    /// The cheapest way to a total error on an engine class, among configurations that `of` takes; none where the models of all
    /// of them are worse.
    ///
    /// Noise falls with the root of the walks, so √(noise² + model²) = `error` at walks·noise²/(error² − model²). The model has the
    /// upper bound of its error, so that what is not well known does not win.
    pub fn cheapest(&self, error: f64, class: Class, cost: Cost, of: impl Fn(&Point) -> bool) -> Option<Way<'_>> {
        let ways = self.curves().filter(|point| point.class == class && of(point)).filter_map(|point| {
            let left = error.powi(2) - point.model_error.bounds[1].powi(2);
            let walks = (point.noise.value.powi(2) * point.walks as f64 / left).max(LEAST);
            let share = walks / point.walks as f64;
            let [there, here] = [walks, point.walks as f64].map(|walks| more_rays(point.rays, walks));
            let seconds = match cost {
                Cost::All => point.prepare_s + (point.seconds[0] - here) * share + there,
                Cost::Walks => (point.noise_free_cost_s - here) * share + there,
            };
            (left > 0.0).then_some(Way { point, walks, seconds })
        });
        ways.min_by(|a, b| a.seconds.total_cmp(&b.seconds))
    }
}

fn key(point: &Point) -> (&str, Class) {
    (&point.name, point.class)
}

#[cfg(test)]
mod tests {
    use super::super::points::tests::point;
    use super::super::points::{Chart, Reference};
    use super::*;
    use crate::plan::Budget;

    #[test]
    fn the_cheapest_way_pays_for_preparation_and_walks() {
        let points = vec![
            // Needs 1024·(3/3)² walks for 5 %, since 0.05² − 0.04² = 0.03².
            point("medium", false, [2.0, 1.0, 0.03], [0.04, 0.0]),
            // Needs 1024·(10/5)² walks for 5 %.
            point("fibers", true, [0.0, 1.0, 0.10], [0.0, 0.0]),
        ];
        let reference = Reference { name: "fibers".into(), walks: 1024, noise: 0.1 };
        let budget = Budget { configuration: "medium".into(), walks: 1024, parts: vec![] };
        let chart = Chart {
            cloth: "cloth".into(),
            incident: String::new(),
            exit: "8 × 8".into(),
            starts: 1,
            seed: 1,
            engines: vec![],
            spent_s: 1.0,
            reference,
            own: "medium".into(),
            points,
            refused: vec![],
            left_out: 0,
            budget,
        };
        let way =
            |error, cost| chart.cheapest(error, Class::Cpu, cost, |_| true).map(|way| (&*way.point.name, way.seconds));
        let near = |found: Option<(&str, f64)>, name: &str, seconds: f64| {
            let (found, took) = found.expect("there is a way");
            assert!(found == name && (took - seconds).abs() < 1e-9, "{found}, {took} s");
        };
        near(way(0.05, Cost::All), "medium", 3.0);
        near(way(0.05, Cost::Walks), "medium", 1.0);
        // Below the error of the model the fibers alone come so far; at a rough one, preparation does not pay.
        near(way(0.04, Cost::All), "fibers", 6.25);
        near(way(0.10, Cost::All), "fibers", 1.0);
        let gpu = chart.cheapest(0.05, Class::Gpu, Cost::All, |_| true);
        assert!(gpu.is_none());
    }
}
