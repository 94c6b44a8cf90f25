//! The account of light: dyes and kinds of fiber, fixed point and roulette, in both engines.

mod closed_forms;
mod cloths;
mod engines;
mod error_bars;
mod fibers;
