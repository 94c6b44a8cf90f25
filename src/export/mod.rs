//! What others read: the explicit fibers of a cloth as curves.
//!
//! Computes: nothing; the fibers are those of one realization of [`cloth`](crate::cloth), in mm.
//!
//! Differs from the paper, which exports nothing.

mod curves;

pub use curves::{CurveChoice, CurveCounts, CurveFormat, REPEATS, write_curves};
