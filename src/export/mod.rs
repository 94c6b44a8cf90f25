//! What others read: the BSDF in the formats of renderers, and the explicit fibers of a cloth as curves.
//!
//! Computes: f of a table in the cells, angles or channels that a format has, with all of the light that the table has; how far each file, read
//! again with the arithmetic of its loader, is from the table.
//!
//! Inputs: a [`Bsdf`](crate::bsdf::Bsdf), f in sr⁻¹; the fibers of one realization of [`cloth`](crate::cloth), in mm.
//!
//! Differs from the paper, which exports nothing.

mod csv;
mod curves;
mod ddr;
mod fit;
mod format;
mod radiance;
mod rgl;
mod spectral_exr;
mod ssdd;

pub use curves::{CurveChoice, CurveCounts, CurveFormat, REPEATS, write_curves};
pub use fit::Check;
pub use format::{File, Format, Written};
