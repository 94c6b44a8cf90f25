//! From counts to the BSDF with its errors.
//!
//! Computes: f in sr⁻¹ by incident and exit cell, reflectance, transmittance, direct light and their standard errors; whether two
//! tallies differ; how far apart two models are, from blocks of walks, and whether that keeps a tolerance; whether light is reciprocal.
//!
//! Inputs: a tally; projected solid angles of exit cells in sr.
//!
//! Differs from the paper: every value carries its standard error.

mod blocks;
mod compare;
mod distance;
mod estimate;
mod family;
mod halves;
mod pair;
mod parts;
mod pool;
mod reciprocity;
mod significance;
mod table;
mod totals;
mod verdict;

pub use blocks::{BlockTotals, FEWEST_BLOCKS, block_noise, block_totals, scattered};
pub use compare::{Comparison, Counted, LEVEL, PoolDifference, SumDifference, Tested, compare};
pub use distance::{Distance, distance, distance_of};
pub use estimate::{Component, Estimate, direct, mean_weight, noise, probability, share, values};
pub use halves::{Halves, average_halves};
pub use parts::scattered_parts;
pub use pool::{Incoming, Outgoing, PARTS, Pool};
pub use reciprocity::{Residual, reciprocity};
pub use table::{Bsdf, Scattering};
pub use totals::{Totals, hemispherical, totals};
pub use verdict::{Gap, Kept, Share, Verdict};
