//! The smallest model that a tolerance allows.

use super::configuration::{Configuration, Extent};
use super::cost::{Cost, EngineClass};
use super::pilot::Pilot;
use super::prior::{Belief, Expected, USUAL_EDGE};
use crate::bsdf::Estimate;
use crate::error::Result;
use crate::goniometer::Goniometer;
use crate::measure::{Prepared, prepare};
use crate::scene::{Medium, Packing, Scene, Structure};
use crate::walk::Engine;
use serde::Serialize;
use std::time::Instant;

/// Edges of cells, in radii of the thinnest fiber, that are chosen from; the usual one is in the place of those near it.
const EDGES: [f64; 4] = [8.0, 4.0, 2.0, 1.4];
/// Edges that are nearer to the usual one than this factor are left out.
const NEAR: f64 = 1.2;
/// Seconds of pilots of short runs, and their share of long ones: below the second and the tenth that are promised.
const PILOTS: f64 = 0.5;
const SHARE: f64 = 0.07;
/// Part of that time for walks through the fibers; the rest is for the medium.
const OF_FIBERS: f64 = 0.6;
/// The least part of that which walks get, however long the fibers take to be drawn.
const LEAST_WALKING: f64 = 0.3;
/// A smaller model may cost so many times as much in walks as the cheapest.
const WORTH: f64 = 1.15;
/// Standard errors of the expected error of a model that are taken off the tolerance beside it.
const ROOM: f64 = 0.75;
/// Tentative events of a walk through a medium, for each piece that one through the fibers is tested against, before any is
/// tried.
const EVENTS_A_TEST: f64 = 0.13;

/// A way to model the cloth, and what is expected of it.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// Its name.
    pub name: String,
    #[serde(skip)]
    configuration: Configuration,
    /// Expected E of the model, with its standard error; 0 of the fibers themselves.
    pub model_error: Estimate,
    /// Noise that the tolerance leaves; none where the model takes all of it.
    pub noise: Option<f64>,
    /// Seconds of a walk.
    pub seconds_a_walk: f64,
    /// Seconds of the walks that bring the noise so low, as far as pilots tell; none where none do.
    pub walk_seconds: Option<f64>,
    /// Whether pilots have tried it.
    pub tried: bool,
}

/// What is going to be measured with, and why.
#[derive(Clone, Debug, Serialize)]
pub struct Plan {
    /// What √(noise² + model error²) is to be at most.
    pub tolerance: f64,
    /// Name of the configuration that was chosen.
    pub chosen: String,
    #[serde(skip)]
    configuration: Configuration,
    /// Expected E of the model, with its standard error.
    pub model_error: Estimate,
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
            vec![format!("plan: {} for a tolerance of {:.3} %: {}", self.chosen, 100.0 * self.tolerance, self.reason)];
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

/// The list that a planner chooses from, all of the placement for the packing of the cloth: of yarns, media at edges of 8, 4, 2 and
/// 1.4 radii with first hits on fibers, the usual one among them; of a sheet, its medium; and the fibers themselves.
pub fn candidates(scene: &Scene, extent: &Extent) -> Vec<Configuration> {
    let usual = Configuration::of(scene, extent);
    let media = match extent.usual_edge() {
        None => vec![usual],
        Some(edge) => {
            let coarse = EDGES.into_iter().filter(|coarse| *coarse > NEAR * edge);
            // Where the usual one is larger than it should be, finer ones would be too many cells.
            let fine = EDGES.into_iter().filter(|fine| *fine < edge / NEAR && edge <= 2.0);
            coarse.chain([edge]).chain(fine).map(|edge| usual.edged(edge)).collect()
        }
    };
    media.into_iter().chain([Configuration::usual_fibers(scene)]).collect()
}

/// Choose from [`candidates`]: the one whose walks are expected to meet the tolerance soonest, or a smaller one that takes
/// hardly longer. A pilot of the fibers tells what their walks cost; one of the medium that is likeliest to be chosen tells its
/// error, and its tables are given back if it is chosen after all. What pilots would cost too much is taken from what is known
/// of other cloths. Without `fibers` only media are chosen from; unless its tables are to be `kept`, a medium is
/// prepared as far as a pilot needs it, and not given back. Costs are events by the time that one took once, so the plan does not depend on the clock.
///
/// # Errors
/// Those of [`Pilot::new`] and of its walks, and of [`prepare`].
pub fn plan(
    scene: &Scene,
    extent: &Extent,
    tolerance: f64,
    (engine, class): (&dyn Engine, EngineClass),
    seed: u64,
    fibers: bool,
    kept: bool,
) -> Result<(Plan, Option<Prepared>)> {
    let (belief, cost) = (Belief::of(scene), Cost::of(scene, class));
    let planner = Planner {
        scene,
        goniometer: Goniometer::new(&scene.measure),
        extent,
        tolerance,
        fibers,
        kept,
        belief,
        cost,
        events: None,
    };
    // Separate fibers take too long to draw for a pilot.
    if scene.model.packing == Packing::Separate { Ok((planner.unpiloted(), None)) } else { planner.plan(engine, seed) }
}

struct Planner<'a> {
    scene: &'a Scene,
    /// Of the run.
    goniometer: Goniometer,
    extent: &'a Extent,
    tolerance: f64,
    /// Whether the fibers themselves may be chosen, and whether tables are given back.
    fibers: bool,
    kept: bool,
    belief: Belief,
    cost: Cost,
    /// Edge of the medium that was tried, in radii of the thinnest fiber, and tentative events of a walk through it.
    events: Option<(f64, f64)>,
}

impl Planner<'_> {
    fn plan(mut self, engine: &dyn Engine, seed: u64) -> Result<(Plan, Option<Prepared>)> {
        let started = Instant::now();
        let Cost { test, piece, .. } = self.cost;
        // Drawing takes its part, but leaves some for walks.
        let walks = |seconds: f64| {
            move |tests: f64, pieces: f64| (seconds - piece * pieces).max(LEAST_WALKING * seconds) / (tests * test)
        };
        let mut pilot = Pilot::new(self.scene, seed, walks(OF_FIBERS * PILOTS))?;
        // A longer run has longer pilots.
        let run = self.choose(&pilot, &[]).walk_seconds.unwrap_or_default();
        let allowed = PILOTS.max(SHARE * run);
        if allowed > 2.0 * PILOTS {
            pilot = Pilot::new(self.scene, seed, walks(OF_FIBERS * (allowed - PILOTS)))?;
        }
        let mut pilot_seconds = started.elapsed().as_secs_f64();
        let likely = self.choose(&pilot, &[]);
        let (mut tried, mut prepared) = (Vec::new(), None);
        for configuration in self.worth_trying(&likely, &pilot, (1.0 - OF_FIBERS) * allowed) {
            // Counting the fibers is a part of the run, unless another model is chosen in the end.
            // Rays to direct light and first hits are no part of a pilot, which has its own.
            let wanted = if self.kept { configuration } else { configuration.without_rays() };
            let medium = prepare(&wanted.apply(self.scene, self.extent))?;
            let started = Instant::now();
            let (found, events) = pilot.try_medium(&medium.tables, engine, seed)?;
            pilot_seconds += started.elapsed().as_secs_f64();
            prepared = Some((configuration, medium));
            let edge = configuration.edge.unwrap_or(USUAL_EDGE);
            self.belief = self.belief.after(found.square, found.square_error, edge);
            self.events = Some((edge, events));
            tried.push(configuration.name());
        }
        let chosen = self.choose(&pilot, &tried);
        let candidates: Vec<Candidate> = self.list().iter().map(|one| self.judge(one, &pilot, &tried)).collect();
        let reason = reason(&chosen, &candidates);
        let prepared =
            prepared.filter(|(tried, _)| self.kept && *tried == chosen.configuration).map(|(_, medium)| medium);
        let plan = Plan {
            tolerance: self.tolerance,
            chosen: chosen.name,
            configuration: chosen.configuration,
            model_error: chosen.model_error,
            noise: chosen.noise.unwrap_or(self.tolerance),
            reason,
            candidates,
            pilot_seconds,
            pilot_walks: pilot.walks(),
        };
        Ok((plan, prepared))
    }

    /// The usual medium, with what is known of other cloths.
    fn unpiloted(&self) -> Plan {
        let configuration = Configuration::of(self.scene, self.extent);
        let (model_error, noise) = self.shared_out(&configuration);
        Plan {
            tolerance: self.tolerance,
            chosen: configuration.name(),
            configuration,
            model_error,
            noise: noise.unwrap_or(self.tolerance),
            reason: format!(
                "separate fibers take too long to be drawn for a pilot; of other cloths {}{}",
                told(model_error),
                if noise.is_none() { ", and the noise alone is held to the tolerance" } else { "" }
            ),
            candidates: Vec::new(),
            pilot_seconds: 0.0,
            pilot_walks: 0,
        }
    }

    /// What is chosen from.
    fn list(&self) -> Vec<Configuration> {
        let all = candidates(self.scene, self.extent).into_iter();
        all.filter(|one| self.fibers || one.model.medium == Medium::Implicit).collect()
    }

    /// Media whose tables are worth making for a pilot: that of a sheet, whose tables cost nothing; of yarns the likeliest, if it would
    /// surely be chosen or its counting is cheap.
    fn worth_trying(&self, likely: &Candidate, pilot: &Pilot, seconds: f64) -> Vec<Configuration> {
        if let Structure::Sheet(_) = self.scene.structure {
            let media = candidates(self.scene, self.extent).into_iter();
            return media.filter(|one| one.model.medium == Medium::Implicit).collect();
        }
        let Estimate { value, stderr } = likely.model_error;
        let sure = self.tolerance > value + 3.0 * stderr;
        let worth =
            likely.configuration.model.medium == Medium::Implicit && (sure || self.cost.counting(pilot) < seconds);
        if worth { vec![likely.configuration] } else { Vec::new() }
    }

    /// E that is expected of a configuration.
    fn expected(&self, configuration: &Configuration) -> Expected {
        if configuration.model.medium == Medium::Explicit {
            return Expected { error: 0.0, spread: 0.0 };
        }
        self.belief.at(configuration.edge.unwrap_or(USUAL_EDGE))
    }

    /// How a configuration shares out the tolerance: its expected E, and the noise that is left, if any. It leaves room for what E
    /// may be more than expected.
    fn shared_out(&self, configuration: &Configuration) -> (Estimate, Option<f64>) {
        let Expected { error, spread } = self.expected(configuration);
        let left = self.tolerance.powi(2) - (error + ROOM * spread).powi(2);
        (Estimate { value: error, stderr: spread }, (left > 0.0).then(|| left.sqrt()))
    }

    /// What is to be expected of a configuration.
    fn judge(&self, configuration: &Configuration, pilot: &Pilot, tried: &[String]) -> Candidate {
        let (model_error, noise) = self.shared_out(configuration);
        let seconds_a_walk = match configuration.model.medium {
            Medium::Implicit => {
                let (tried, events) = self.events.unwrap_or((USUAL_EDGE, EVENTS_A_TEST * pilot.tests_a_walk));
                self.cost.event * events * self.cost.of_edge(configuration.edge, tried)
            }
            Medium::Explicit => self.cost.test * pilot.tests_a_walk,
        };
        // Finer exit cells take more walks at equal noise.
        let Goniometer { exit, .. } = &self.goniometer;
        let walks = |noise: f64| (pilot.noise_of_one / noise).powi(2) * (exit.cells() as f64 / Pilot::EXIT_CELLS);
        let starts = self.goniometer.starts() as f64;
        let name = configuration.name();
        Candidate {
            tried: tried.contains(&name),
            name,
            configuration: *configuration,
            model_error,
            noise,
            seconds_a_walk,
            walk_seconds: noise.map(|noise| walks(noise) * starts * seconds_a_walk),
        }
    }

    /// The cheapest that meets the tolerance, or the first of the list, from coarse to fine, that costs hardly more.
    fn choose(&self, pilot: &Pilot, tried: &[String]) -> Candidate {
        let usual = || self.judge(&Configuration::of(self.scene, self.extent), pilot, tried);
        // Where nothing is scattered, no walks bring the noise down.
        if pilot.noise_of_one.is_infinite() {
            return usual();
        }
        let judged: Vec<Candidate> = self.list().iter().map(|one| self.judge(one, pilot, tried)).collect();
        let cost = |one: &Candidate| one.walk_seconds.unwrap_or(f64::INFINITY);
        let least = judged.iter().map(cost).fold(f64::INFINITY, f64::min);
        let fair = judged.iter().find(|one| least.is_finite() && cost(one) <= WORTH * least);
        // Where nothing is expected to meet it, come as near as can be.
        let error = |one: &&Candidate| one.model_error.value;
        let nearest = || judged.iter().min_by(|a, b| error(a).total_cmp(&error(b)));
        fair.or_else(nearest).cloned().unwrap_or_else(usual)
    }
}

/// Why, in a sentence.
fn reason(chosen: &Candidate, all: &[Candidate]) -> String {
    let is = |medium: Medium| move |one: &&Candidate| one.configuration.model.medium == medium;
    let seconds = |one: &Candidate| one.walk_seconds.unwrap_or(f64::INFINITY);
    let order = |a: &&Candidate, b: &&Candidate| {
        seconds(a).total_cmp(&seconds(b)).then(a.model_error.value.total_cmp(&b.model_error.value))
    };
    if chosen.configuration.model.medium == Medium::Explicit {
        let best = all.iter().filter(is(Medium::Implicit)).min_by(order);
        return best.map_or_else(String::new, |best| match best.walk_seconds {
            Some(_) => format!(
                "the error of {}, {}, leaves so little to noise that its walks would take {:.1} times as long",
                best.name,
                told(best.model_error),
                seconds(best) / seconds(chosen)
            ),
            None => format!("the error of {}, {}, does not fit into the tolerance", best.name, told(best.model_error)),
        });
    }
    if chosen.walk_seconds.is_some_and(f64::is_infinite) {
        return "pilots found no scattered light".into();
    }
    let known = if chosen.tried { "by a pilot" } else { "as known of other cloths" };
    let Some(noise) = chosen.noise else {
        return format!(
            "no medium is expected to meet the tolerance; this one comes nearest with {}, {known}, and the noise alone is held to \
             the tolerance",
            told(chosen.model_error)
        );
    };
    let fibers = all.iter().find(is(Medium::Explicit)).map_or_else(String::new, |fibers| {
        format!(
            "; walks through the fibers themselves would take {:.1} times as long",
            seconds(fibers) / seconds(chosen)
        )
    });
    format!("its error is {}, {known}, which leaves {:.1} % to noise{fibers}", told(chosen.model_error), 100.0 * noise)
}

fn told(Estimate { value, stderr }: Estimate) -> String {
    format!("{:.1} ± {:.1} %", 100.0 * value, 100.0 * stderr)
}
