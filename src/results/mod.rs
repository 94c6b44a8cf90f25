//! The result folder: `bsdf.exr`, `tally.exr` and `summary.json`.
//!
//! Computes: the files, each written beside its place and moved there when it is whole.
//!
//! Inputs: a measurement and the scene it is of; f in sr⁻¹, angles in degrees.
//!
//! Differs from the paper: nothing; the paper does not say how its output is written.

mod about;
mod exr;
mod folder;
mod provenance;
mod replay;
mod summary;
mod tally;

pub use about::About;
pub use folder::ResultFolder;
pub use replay::Replay;
pub use summary::result_name;
pub use tally::{Stored, TALLY, write_tally};
