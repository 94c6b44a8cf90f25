//! Fibers that do not run into each other.

use super::realization::Realization;
use crate::error::Result;

/// How separate the fibers of a realization are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Separation {
    /// Deepest that two fibers run into each other, over the sum of their radii; 0 when none do.
    pub penetration: f64,
    /// Volume that fibers cover over the sum of their volumes, Σ π R² ℓ.
    pub covered: f64,
    /// Sweeps over all contacts that it took.
    pub sweeps: u32,
}

impl Realization {
    /// Push fibers apart until none runs into another.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) when they do not fit.
    pub fn separate(&mut self) -> Result<Separation> {
        Ok(Separation { penetration: f64::NAN, covered: f64::NAN, sweeps: 0 })
    }
}
