//! The model that a planner chooses.

use super::super::one_line;
use super::{Arguments, Choice};
use fiberwalk::Result;
use fiberwalk::measure::{ChosenEngine, Prepared, Stop};
use fiberwalk::plan::{EngineClass, Extent, Plan, plan};
use fiberwalk::scene::Scene;

/// What is ready before the run.
pub struct Ready {
    /// When to stop.
    pub stop: Stop,
    /// The plan, if there is one.
    pub plan: Option<Plan>,
    /// The medium, if the planner has made it.
    pub prepared: Option<Prepared>,
    /// The engine, if the planner needed it.
    pub engine: Option<ChosenEngine>,
}

impl Ready {
    /// Nothing but the rule.
    pub fn new(stop: Stop) -> Ready {
        Ready { stop, plan: None, prepared: None, engine: None }
    }
}

impl Arguments {
    /// Where a tolerance is to be met and nothing is said of the model, choose one.
    pub fn plan(&self, scene: &mut Scene, ready: Ready) -> Result<Ready> {
        let Stop::Tolerance(tolerance) = ready.stop else { return Ok(ready) };
        let engine = self.choose_engine()?;
        let extent = Extent::of(scene)?;
        // The fibers themselves are for the processor alone.
        let fibers = !matches!(self.engine, Choice::Gpu) && self.adapter.is_none();
        let class = EngineClass::of(&engine);
        let (plan, prepared) = plan(scene, &extent, tolerance, (&engine, class), self.seed, fibers)?;
        *scene = plan.apply(scene, &extent);
        if !self.quiet {
            plan.lines().iter().for_each(|line| eprintln!("{}", one_line(line)));
        }
        Ok(Ready { stop: Stop::Tolerance(plan.noise), plan: Some(plan), prepared, engine: Some(engine) })
    }
}
