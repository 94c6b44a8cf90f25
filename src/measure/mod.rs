//! A run from scene to tally: the choice of the engine, the tables, the walks, the clock.
//!
//! Computes: nothing of its own; calls the floors below in their order.
//!
//! Differs from the paper: nothing.

mod engine;
mod fibers;
mod figures;
mod promise;
mod run;
mod self_test;
mod stop;

pub use engine::{ChosenEngine, EngineChoice, Grounds, Rated, choose, figure_name};
pub use fibers::AgainstFibers;
pub use figures::{Figures, standard_rate};
pub use promise::{Measured, Promise};
pub use run::{
    MAX_WALKS, Measurement, Prepared, Progress, Seconds, check_results, memory, peak_bytes, prepare, prepare_explicit,
    prepare_from, prepare_with, run,
};
pub use self_test::{SelfTest, self_test};
pub use stop::{Stop, percent};
