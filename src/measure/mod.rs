//! A run from scene to tally: the choice of the engine, the tables, the walks, the clock.
//!
//! Computes: nothing of its own; calls the floors below in their order.
//!
//! Differs from the paper: nothing.

mod engine;
mod fibers;
mod run;
mod self_test;
mod stop;

pub use engine::{ChosenEngine, EngineChoice, choose};
pub use fibers::AgainstFibers;
pub use run::{
    MAX_WALKS, Measurement, Prepared, Progress, Seconds, memory, peak_bytes, prepare, prepare_explicit, prepare_from,
    prepare_with, run,
};
pub use self_test::{SelfTest, self_test};
pub use stop::Stop;
