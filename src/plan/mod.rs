//! How much model a scene needs: one way to model it, a trial of that way, where its error comes from, and what accuracy costs.
//!
//! Computes: blocks of walks through a cloth that is modelled in a given way, timed; E between such ways and the fibers
//! themselves, part by part; cost against error of many of them; from pilot runs, the model that meets a tolerance soonest.
//!
//! Inputs: a scene; edges of cells in radii of the thinnest fiber, seeds, numbers of walks, seconds.
//!
//! Differs from the paper: nothing; the paper does not say what its numbers of cells and directions cost and give.

mod averaging;
mod budget;
pub mod chart;
mod choice;
mod configuration;
mod cost;
mod growing;
mod pilot;
mod planner;
mod prior;
mod stretches;
mod trial;

pub use averaging::{Averaged, Averaging};
pub use budget::{AVERAGED, Blocks, Budget, BudgetPart, Deviation, Evidence, Part, refinements};
pub use choice::{Candidate, Plan};
pub use configuration::{Configuration, Extent, short};
pub use cost::{Cost, EngineClass};
pub use pilot::{Beside, Pilot};
pub use planner::{candidates, plan};
pub use prior::{Belief, Expected};
pub use trial::{BLOCKS, Block, Trial};
