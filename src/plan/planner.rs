//! The smallest model that a tolerance allows.

use super::choice::{Candidate, Plan, reason};
use super::configuration::{Configuration, Extent};
use super::cost::{Cost, EngineClass};
use super::pilot::{Beside, Pilot};
use super::prior::{Belief, Expected, USUAL_EDGE};
use super::trial::BLOCKS;
use crate::bsdf::{Distance, Estimate, Kept, Verdict};
use crate::cloth::{DrawnFor, Realizer};
use crate::error::Result;
use crate::goniometer::Goniometer;
use crate::measure::{Prepared, check_results, prepare_from};
use crate::scene::{Medium, Packing, Scene, Structure};
use crate::walk::Engine;
use std::time::Instant;

/// Edges of cells, in radii of the thinnest fiber, that are chosen from; the usual one is in the place of those near it.
const EDGES: [f64; 4] = [8.0, 4.0, 2.0, 1.4];
/// Edges that are nearer to the usual one than this factor are left out.
const NEAR: f64 = 1.2;
/// Seconds of the first walks of a pilot.
const PILOT: f64 = 0.3;
/// The least part of them that walks get, however long the fibers take to be drawn.
const LEAST_WALKING: f64 = 0.3;
/// Straight pieces that pilots of separate fibers of a sheet, whose medium costs nothing, may draw.
const SEPARATE_PIECES: f64 = (1u64 << 18) as f64;
/// A smaller model may cost so many times as much in walks as the cheapest.
const WORTH: f64 = 1.05;
/// Standard errors of the error that is expected of a model before it is tried, taken off the tolerance beside it.
const ROOM: f64 = 0.75;
/// Standard errors that are added to E² as it was found, where noise gets what it leaves of the tolerance.
const CAREFUL: f64 = 0.25;
/// Standard errors below what is expected at which an error is not looked for.
const UNLIKELY: f64 = 2.0;
/// The least part of the tolerance to which pilots that go on are expected to tell an error.
const TOLD: f64 = 0.3;
/// Tentative events of a walk through a medium, for each piece that one through the fibers is tested against, before any is
/// tried.
const EVENTS_A_TEST: f64 = 0.13;

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

/// Choose from [`candidates`]: the one that is expected to meet the tolerance soonest, or a smaller one that takes hardly longer.
///
/// Whether a medium keeps the tolerance is measured on this cloth: pilots send walks through its fibers and through the medium,
/// and go on while they do not tell, as long as that is cheaper than the fibers. What is known of other cloths only says which medium
/// to try first. A medium that does not keep it, that cannot be told to, or that the cloth does not have gives way to others and in
/// the end to the fibers themselves, which are right by construction. Tables of the medium that is chosen are given back.
/// Without `fibers` only media are chosen from; unless its tables are to be `kept`, a medium is prepared as far as a pilot needs it,
/// and not given back. Costs are events by the time that one took once, so the plan does not depend on the clock.
///
/// # Errors
/// Those of [`check_results`], of [`Pilot::new`] and of its walks; without `fibers` those of [`prepare_from`] where the cloth has none of the media.
pub fn plan(
    scene: &Scene,
    extent: &Extent,
    tolerance: f64,
    (engine, class): (&dyn Engine, EngineClass),
    seed: u64,
    fibers: bool,
    kept: bool,
) -> Result<(Plan, Option<Prepared>)> {
    let started = Instant::now();
    let cost = Cost::of(scene, class);
    let (test, piece) = (cost.test, cost.piece);
    // Drawing takes its part, but leaves some for walks.
    let walks = |tests: f64, pieces: f64| (PILOT - piece * pieces).max(LEAST_WALKING * PILOT) / (tests * test);
    let mut planner = Planner {
        scene,
        goniometer: check_results(scene)?,
        extent,
        tolerance,
        fibers,
        kept,
        engine,
        belief: Belief::of(scene),
        cost,
        events: None,
        tried: Vec::new(),
        refused: Vec::new(),
        prepared: None,
    };
    if planner.cannot_be_tried()? {
        return Ok((planner.unpiloted(), None));
    }
    let mut pilot = Pilot::new(scene, extent.realizer(), seed, walks)?;
    let counting = planner.go_on(&mut pilot)?;
    let seconds = started.elapsed().as_secs_f64() - counting;
    Ok(planner.chosen(&pilot, seconds))
}

/// A medium that pilots have tried.
struct Tried {
    configuration: Configuration,
    beside: Beside,
    verdict: Verdict,
}

/// What a planner has found so far.
pub(super) struct Planner<'a> {
    pub(super) scene: &'a Scene,
    /// Of the run.
    goniometer: Goniometer,
    extent: &'a Extent,
    tolerance: f64,
    /// Whether the fibers themselves may be chosen, and whether tables are given back.
    fibers: bool,
    kept: bool,
    engine: &'a dyn Engine,
    pub(super) belief: Belief,
    pub(super) cost: Cost,
    /// Edge of the medium that was tried last, in radii of the thinnest fiber, and tentative events of a walk through it.
    pub(super) events: Option<(f64, f64)>,
    tried: Vec<Tried>,
    /// Media that the cloth does not have, and why.
    refused: Vec<(String, String)>,
    /// The medium that was tried last.
    prepared: Option<(Configuration, Prepared)>,
}

impl Planner<'_> {
    /// Try media and let pilots grow until the choice is measured; the seconds that preparing media took.
    fn go_on(&mut self, pilot: &mut Pilot) -> Result<f64> {
        let mut counting = 0.0;
        loop {
            let likely = self.choose(pilot, true);
            if likely.configuration.model.medium == Medium::Explicit || pilot.noise_of_one.is_infinite() {
                return Ok(counting);
            }
            let found = self.tried.iter().position(|tried| tried.configuration == likely.configuration);
            let Some(index) = found else {
                if likely.refused.is_some() {
                    return Ok(counting);
                }
                counting += self.try_medium(likely.configuration, pilot)?;
                continue;
            };
            let verdict = &self.tried[index].verdict;
            let walks = match verdict.kept(self.tolerance) {
                Kept::Untold(times) => (times - 1.0) * pilot.walks(),
                Kept::Yes if self.pays(&self.judge(&likely.configuration, pilot, false), verdict, pilot) => {
                    pilot.walks()
                }
                Kept::Yes | Kept::No => return Ok(counting),
            };
            if !self.may_grow(pilot, walks) {
                return Ok(counting);
            }
            pilot.grow(walks)?;
            self.hold(index, pilot)?;
        }
    }

    /// Prepare a medium and hold it against the fibers, or note why the cloth has none; the seconds that preparing took.
    fn try_medium(&mut self, configuration: Configuration, pilot: &Pilot) -> Result<f64> {
        let started = Instant::now();
        match self.prepare(configuration) {
            Ok(()) => {}
            Err(error) if self.fibers || self.list().len() > self.refused.len() + 1 => {
                self.refuse(&configuration, &error.to_string());
                return Ok(0.0);
            }
            Err(error) => return Err(error),
        }
        let seconds = started.elapsed().as_secs_f64();
        let light = Distance { square: 0.0, square_error: f64::INFINITY };
        let verdict = Verdict { light, gaps: Vec::new() };
        self.tried.push(Tried { configuration, beside: Beside::default(), verdict });
        self.hold(self.tried.len() - 1, pilot)?;
        let Tried { beside, verdict, .. } = &self.tried[self.tried.len() - 1];
        let edge = configuration.edge.unwrap_or(USUAL_EDGE);
        self.events = Some((edge, beside.events()));
        self.belief = self.belief.after(verdict.light.square, verdict.light.square_error, edge);
        Ok(seconds)
    }

    /// Note that the cloth does not have a medium, nor any of finer cells: the fullest part of a full cell is no less full, and lists and
    /// memory grow.
    fn refuse(&mut self, configuration: &Configuration, why: &str) {
        let finer = |one: &Configuration| one.edge.zip(configuration.edge).is_some_and(|(one, edge)| one < edge);
        let all = self.list().into_iter().filter(|one| one == configuration || finer(one));
        let names: Vec<String> = all.map(|one| one.name()).collect();
        let new = |name: &String| self.refused.iter().all(|(known, _)| known != name);
        let refused: Vec<(String, String)> = names.into_iter().filter(new).map(|name| (name, why.to_owned())).collect();
        self.refused.extend(refused);
    }

    /// Prepare a medium, in the place of that which was tried last.
    fn prepare(&mut self, configuration: Configuration) -> Result<()> {
        // Rays to direct light and first hits are no part of a pilot, which has its own.
        let wanted = if self.kept { configuration } else { configuration.without_rays() };
        self.prepared = None;
        let medium = prepare_from(&wanted.apply(self.scene, self.extent), self.extent.realizer(), |_| {})?;
        self.prepared = Some((configuration, medium));
        Ok(())
    }

    /// Bring the walks through a medium that was tried to those of the pilot.
    fn hold(&mut self, index: usize, pilot: &Pilot) -> Result<()> {
        let configuration = self.tried[index].configuration;
        if self.prepared.as_ref().is_none_or(|(ready, _)| *ready != configuration) {
            self.prepare(configuration)?;
        }
        if let Some((_, medium)) = &self.prepared {
            let tried = &mut self.tried[index];
            tried.verdict = pilot.hold(&mut tried.beside, &medium.tables, self.engine)?;
        }
        Ok(())
    }

    /// Whether separate fibers of a sheet take so long to be drawn that its medium, which costs nothing, is taken untried.
    fn cannot_be_tried(&self) -> Result<bool> {
        let separate = self.scene.model.packing == Packing::Separate;
        let (Structure::Sheet(_), true) = (&self.scene.structure, separate) else { return Ok(false) };
        let realizer = Realizer::new(self.scene, self.scene.model.packing, DrawnFor::Pilot)?;
        Ok((BLOCKS * realizer.expected_pieces() as u64) as f64 > SEPARATE_PIECES)
    }

    /// The usual medium, with what is known of other cloths.
    fn unpiloted(&self) -> Plan {
        let configuration = Configuration::of(self.scene, self.extent);
        let (model_error, noise) = self.shared_out(&configuration);
        let Estimate { value, stderr } = model_error;
        let rest = if noise.is_none() { ", and the noise alone is held to the tolerance" } else { "" };
        Plan {
            tolerance: self.tolerance,
            chosen: configuration.name(),
            configuration,
            model_error,
            interval: None,
            noise: noise.unwrap_or(self.tolerance),
            reason: format!(
                "medium: not measured on this cloth, whose separate fibers take too long to be drawn for a pilot; of other cloths \
                 {:.1} ± {:.1} %{rest}",
                100.0 * value,
                100.0 * stderr
            ),
            candidates: Vec::new(),
            pilot_seconds: 0.0,
            pilot_walks: 0,
        }
    }

    /// The plan after all pilots, and the tables of its medium.
    fn chosen(self, pilot: &Pilot, pilot_seconds: f64) -> (Plan, Option<Prepared>) {
        let chosen = self.choose(pilot, false);
        let candidates: Vec<Candidate> = self.list().iter().map(|one| self.judge(one, pilot, false)).collect();
        let verdicts: Vec<(String, Verdict)> =
            self.tried.iter().map(|tried| (tried.configuration.name(), tried.verdict.clone())).collect();
        let plan = Plan {
            tolerance: self.tolerance,
            reason: reason(&chosen, &candidates, &verdicts, self.tolerance),
            chosen: chosen.name,
            configuration: chosen.configuration,
            model_error: chosen.model_error,
            interval: chosen.interval,
            noise: chosen.noise.unwrap_or(self.tolerance),
            candidates,
            pilot_seconds,
            pilot_walks: pilot.of_direction(),
        };
        let own = |(tried, _): &(Configuration, Prepared)| self.kept && *tried == plan.configuration;
        let prepared = self.prepared.filter(own).map(|(_, medium)| medium);
        (plan, prepared)
    }

    /// What is chosen from.
    fn list(&self) -> Vec<Configuration> {
        let all = candidates(self.scene, self.extent).into_iter();
        all.filter(|one| self.fibers || one.model.medium == Medium::Implicit).collect()
    }

    /// E of a configuration that nobody has tried on this cloth, as others and other edges let expect, and the noise that the
    /// tolerance leaves beside it, if any, with room for what it may be more.
    fn shared_out(&self, configuration: &Configuration) -> (Estimate, Option<f64>) {
        if configuration.model.medium == Medium::Explicit {
            return (Estimate::default(), Some(self.tolerance));
        }
        let Expected { error, spread } = self.belief.at(configuration.edge.unwrap_or(USUAL_EDGE));
        // A pilot that has grown would tell it twice as well as that of the last medium is told, or as well as is worth while.
        let told = self.tried.last().map(|tried| (tried.verdict.interval()[1] - tried.verdict.light.error()) / 2.0);
        let told = told.map(|told| told.min(TOLD * self.tolerance));
        (Estimate { value: error, stderr: spread }, self.left(error + told.unwrap_or(ROOM * spread)))
    }

    /// The noise that a model leaves whose E² was measured.
    pub(super) fn left_by(&self, light: &Distance) -> Option<f64> {
        self.left((light.square.max(0.0) + CAREFUL * light.square_error).sqrt())
    }

    /// The noise that a model of this error leaves.
    fn left(&self, error: f64) -> Option<f64> {
        let left = self.tolerance.powi(2) - error.powi(2);
        (left > 0.0).then(|| left.sqrt())
    }

    /// What was measured of a configuration; `before` the last pilot what may be expected of it, with pilots that grow further.
    pub(super) fn judge(&self, configuration: &Configuration, pilot: &Pilot, before: bool) -> Candidate {
        let name = configuration.name();
        let verdict = self.tried.iter().find(|tried| tried.configuration == *configuration).map(|tried| &tried.verdict);
        let refused = self.refused.iter().find(|(refused, _)| *refused == name).map(|(_, why)| why.clone());
        let explicit = configuration.model.medium == Medium::Explicit;
        let (mut model_error, mut expected) = self.shared_out(configuration);
        if expected.is_none() && verdict.is_none() {
            // What other cloths do not rule out a pilot is to tell.
            expected = self.left((model_error.value - UNLIKELY * model_error.stderr).max(0.0));
        }
        let mut noise = expected.filter(|_| before || explicit);
        if let Some(verdict) = verdict {
            let (error, high) = (verdict.light.error(), verdict.interval()[1]);
            model_error = Estimate { value: error, stderr: (high - error) / 2.0 };
            noise = match verdict.kept(self.tolerance) {
                Kept::Yes if !before => self.left_by(&verdict.light),
                // What pilots do not tell yet, more of them may.
                Kept::Yes => expected.or_else(|| self.left_by(&verdict.light)),
                Kept::Untold(times) if before && self.may_grow(pilot, (times - 1.0) * pilot.walks()) => {
                    expected.or_else(|| self.left(error))
                }
                Kept::Untold(_) | Kept::No => None,
            };
        }
        if refused.is_some() {
            noise = None;
        }
        let seconds_a_walk = if explicit {
            self.cost.test * pilot.tests_a_walk + self.cost.piece * pilot.pieces as f64 / pilot.walks_a_realization
        } else {
            let (tried, events) = self.events.unwrap_or((USUAL_EDGE, EVENTS_A_TEST * pilot.tests_a_walk));
            self.cost.event * events * self.cost.of_edge(configuration.edge, tried)
        };
        let ready = self.prepared.as_ref().is_some_and(|(ready, _)| ready == configuration);
        let sheet = matches!(self.scene.structure, Structure::Sheet(_));
        let prepare_seconds = if explicit || ready || sheet { 0.0 } else { self.cost.preparing(pilot) };
        // Finer exit cells take more walks at equal noise.
        let Goniometer { exit, .. } = &self.goniometer;
        let walks = |noise: f64| (pilot.noise_of_one / noise).powi(2) * (exit.cells() as f64 / pilot.exit_cells());
        let starts = self.goniometer.starts() as f64;
        Candidate {
            tried: verdict.is_some(),
            interval: verdict.map(Verdict::interval),
            name,
            configuration: *configuration,
            model_error,
            noise,
            seconds_a_walk,
            walk_seconds: noise.map(|noise| walks(noise) * starts * seconds_a_walk),
            prepare_seconds,
            refused,
        }
    }

    /// The cheapest that meets the tolerance, or the first of the list, from coarse to fine, that costs hardly more.
    fn choose(&self, pilot: &Pilot, before: bool) -> Candidate {
        let usual = || self.judge(&Configuration::of(self.scene, self.extent), pilot, before);
        // Where nothing is scattered, no walks bring the noise down.
        if pilot.noise_of_one.is_infinite() {
            return usual();
        }
        let judged: Vec<Candidate> = self.list().iter().map(|one| self.judge(one, pilot, before)).collect();
        let least = judged.iter().map(Candidate::seconds).fold(f64::INFINITY, f64::min);
        let fair = judged.iter().find(|one| least.is_finite() && one.seconds() <= WORTH * least);
        // Where nothing meets it, come as near as can be, by what was measured if anything was.
        let error = |one: &&Candidate| one.model_error.value;
        let nearest = |tried: bool| {
            let some = judged.iter().filter(move |one| one.refused.is_none() && (one.tried || !tried));
            some.min_by(|a, b| error(a).total_cmp(&error(b)))
        };
        fair.or_else(|| nearest(true)).or_else(|| nearest(false)).cloned().unwrap_or_else(usual)
    }
}
