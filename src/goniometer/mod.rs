//! The virtual goniospectrophotometer (paper §2): where light comes from, where it is counted.
//!
//! Computes: the incident direction of every walk and the bin of every exit; holds the integer tally.
//!
//! Inputs: the bases of the scene's `[measure]` section; directions as unit vectors away from the sheet.
//!
//! Differs from the paper:
//! - Incoming light is uniform in projected solid angle and stratified by incident cell, not over the whole sphere at once.
//! - Light that touched no fiber is a delta and is tallied apart, never smeared into an exit cell.
//! - Bins are integers, so tallies add exactly and every bin has an exact standard error.

mod basis;
mod coverage;
mod disc;
mod instrument;
mod rings;
mod tally;

pub use basis::Basis;
pub use coverage::{Coverage, Origin, Run};
pub use disc::DiscBasis;
pub use instrument::{Goniometer, Incidence};
pub use rings::{MOST_RINGS, Ring, RingBasis};
pub use tally::{BinLayout, Counts, Moments, OUTCOMES, Outcome, Straight, Tally, WEIGHT, Weights};
