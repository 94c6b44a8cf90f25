//! From counts to the BSDF with its errors.
//!
//! Computes: f in sr⁻¹ by incident and exit cell, reflectance, transmittance, direct light and their standard errors.
//!
//! Inputs: a tally; projected solid angles of exit cells in sr.
//!
//! Differs from the paper: every value carries its standard error.

mod estimate;
mod totals;

pub use estimate::{Component, Estimate, mean_weight, noise, probability, values};
pub use totals::{Totals, hemispherical, totals};
