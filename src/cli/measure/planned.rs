//! The model that a planner chooses.

use super::super::one_line;
use super::super::show::budget_lines;
use super::{Arguments, Choice};
use fiberwalk::bsdf::noise;
use fiberwalk::measure::{AgainstFibers, ChosenEngine, EngineChoice, Measurement, Prepared, Promise, Stop, choose};
use fiberwalk::plan::{Budget, Configuration, EngineClass, Extent, plan};
use fiberwalk::results::Replay;
use fiberwalk::scene::{Medium, Scene};
use fiberwalk::{Error, Result};
use std::path::Path;

/// Walks of all directions in each of the blocks of a budget.
const OF_BUDGET: u64 = 1 << 17;

/// What is ready before the run.
pub struct Ready {
    /// When to stop.
    pub stop: Stop,
    /// The plan, if there is one.
    pub plan: Option<Planned>,
    /// The medium, if the planner has made it.
    pub prepared: Option<Prepared>,
    /// What was planned and why.
    pub told: Vec<String>,
    /// The engine, if the planner needed it.
    pub engine: Option<ChosenEngine>,
}

impl Ready {
    /// Nothing but the rule.
    pub fn new(stop: Stop) -> Ready {
        Ready { stop, plan: None, told: Vec::new(), prepared: None, engine: None }
    }
}

/// What a plan promises.
pub struct Planned {
    tolerance: f64,
    /// Ends of the interval of the model's error: 0 and 0 of the fibers themselves.
    pilots: Option<[f64; 2]>,
    /// The plan as it goes into the summary.
    pub summary: serde_json::Value,
}

impl Planned {
    /// Of a plan for this medium, whose error pilots gave this interval.
    fn new(tolerance: f64, medium: Medium, interval: Option<[f64; 2]>, summary: serde_json::Value) -> Planned {
        let pilots = if medium == Medium::Explicit { Some([0.0; 2]) } else { interval };
        Planned { tolerance, pilots, summary }
    }

    /// Whether a measurement kept what was planned.
    pub fn promise(&self, measurement: &Measurement) -> Promise {
        let verdict = measurement.against.as_ref().map(AgainstFibers::verdict);
        Promise::of(self.tolerance, noise(&measurement.tally), self.pilots, verdict.as_ref())
    }
}

/// Say where a promise was not kept; an error if the user is `strict` about it.
pub fn tell_promise(promise: Option<&Promise>, strict: bool) -> Result<()> {
    match promise.and_then(Promise::line) {
        Some(line) if strict => Err(Error::Failed(line)),
        Some(line) => {
            eprintln!("{}", one_line(&format!("warning: {line}")));
            Ok(())
        }
        None => Ok(()),
    }
}

impl Arguments {
    /// Where a tolerance is to be met and nothing is said of the model, choose one.
    pub fn make_plan(&self, scene: &mut Scene, ready: Ready) -> Result<Ready> {
        let Stop::Tolerance(tolerance) = ready.stop else { return Ok(ready) };
        let engine = self.choose_engine()?;
        let extent = Extent::of(scene)?;
        // The fibers themselves are for the processor alone.
        let fibers = !matches!(self.engine, Choice::Gpu) && self.adapter.is_none();
        let class = EngineClass::of(&engine);
        let (plan, prepared) = plan(scene, &extent, tolerance, (&engine, class), self.seed, fibers, true)?;
        *scene = plan.apply(scene, &extent);
        let (stop, told) = (Stop::Tolerance(plan.noise), plan.lines());
        let planned = Planned::new(plan.tolerance, scene.model.medium, plan.interval, plan.summary());
        Ok(Ready { stop, plan: Some(planned), told, prepared, engine: Some(engine) })
    }

    /// Go by the plan of an earlier result, on the engine that it had if none is asked for.
    pub fn replay(&self, scene: &mut Scene, folder: &Path) -> Result<Ready> {
        let replay = Replay::read(folder)?;
        *scene = replay.apply(scene)?;
        let fibers = scene.model.medium == Medium::Explicit;
        let engine = match (fibers, self.engine, &self.adapter) {
            (true, ..) => None,
            (false, Choice::Auto, None) => {
                let (engine, adapter) = match replay.engine.as_str() {
                    "cpu" => (EngineChoice::Cpu, None),
                    _ => (EngineChoice::Gpu, Some(replay.adapter.as_str())),
                };
                let mut engine = choose(engine, adapter)?;
                engine.grounds.reason = "that of the plan".into();
                Some(engine)
            }
            _ => Some(self.choose_engine()?),
        };
        let plan = Planned::new(replay.tolerance, scene.model.medium, replay.interval, replay.plan);
        let told = vec![format!("plan: that of {}", folder.display())];
        Ok(Ready { stop: Stop::Tolerance(replay.noise), plan: Some(plan), told, prepared: None, engine })
    }

    /// Measure where the error of the model comes from, add it to the measurement, and tell it.
    pub fn add_budget(&self, scene: &Scene, measurement: &mut Measurement) -> Result<String> {
        if scene.model.medium == Medium::Explicit {
            return Ok("error budget: the fibers themselves have no error but noise\n".into());
        }
        let engine = self.choose_engine()?;
        let extent = Extent::of(scene)?;
        let walks = (OF_BUDGET / measurement.goniometer.starts() as u64).max(16);
        let base = Configuration::of(scene, &extent);
        let budget = Budget::measure(scene, &extent, base, &engine, self.seed, walks)?;
        measurement.budget = Some(serde_json::json!(budget));
        Ok(budget_lines(&budget))
    }
}
