//! What every engine is given and gives back; the random numbers that they share.
//!
//! Computes: nothing of its own. Holds the plan of a run, the draw contract and the generator.
//!
//! Differs from the paper: random numbers are a function of (seed, walk, event), so any walk can be replayed alone and
//! a tally does not depend on how the work was cut.

mod draws;
mod first_hits;
mod plan;
mod rng;
mod score;

pub use draws::{EventDraws, start_draws, start_place, uniform};
pub use first_hits::{FirstHit, FirstHitBanks, FirstHits, MetFiber, widen};
pub use plan::{
    Engine, Implicit, MAX_EVENTS, MOST_REFUSALS, ROULETTE_BELOW, ROULETTE_EVERY, STRAIGHT, WalkPlan, WalkRecord, Walker,
};
pub use rng::{Purpose, draw, threefry};
pub use score::{Score, Walked};
