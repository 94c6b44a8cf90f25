//! The account of light: dyes and kinds of fiber, fixed point and roulette, in both engines.

#[path = "../common/mod.rs"]
mod common;

mod closed_forms;
mod cloths;
mod engines;
mod error_bars;
mod fibers;
