//! What accuracy costs: many configurations of one cloth, timed and held against its fibers.
//!
//! Computes: for each configuration, engine class and number of walks the seconds, the cost without the noise of the clock,
//! the memory, the noise of the walks and the error of the model; which of them nothing beats; the error budget of the
//! configuration that the scene asks for.
//!
//! Inputs: a scene, a seed, seconds to spend. What is counted depends on the clock only by how many walks there are.
//!
//! Differs from the paper: nothing; the paper has no such chart.

mod cheapest;
mod engines;
mod judged;
mod points;
mod run;
mod series;
mod state;
mod sweep;
mod table;

pub use cheapest::{Cost, Way};
pub use engines::{Class, Engines};
pub use points::{Chart, Point, Reference};
pub use run::{Progress, Settings, run};
pub use series::{Series, Visit};
pub use state::{ChartAbout, Head, Store};
pub use sweep::sweep;
pub use table::{COLUMNS, csv};
