//! How far apart two models are, from blocks of walks and without their noise.

use super::blocks::{Products, check, jackknife, scattered, shape};
use super::estimate::Estimate;
use crate::error::{Error, Result};
use crate::goniometer::Tally;
use serde::{Deserialize, Serialize};

/// E between two models, E² = |A − B|²/|B|² with sums over starts, exit cells of both hemispheres and channels of the
/// scattered light.
///
/// The square is what is unbiased: noise makes it negative as often as positive where the models are equal, so E itself has
/// no standard error there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Distance {
    /// E².
    pub square: f64,
    /// Its standard error, a jackknife over blocks. Where E is well above the resolution, it is the usual one; where the models
    /// are equal it is too large, by √(2(K − 1)/(K − 2)) with K blocks (1.5 with 8), so on the safe side.
    pub square_error: f64,
}

impl Distance {
    /// E = √max(0, E²).
    pub fn error(&self) -> f64 {
        self.square.max(0.0).sqrt()
    }

    /// The E that noise alone may leave, √σ(E²).
    pub fn resolution(&self) -> f64 {
        self.square_error.sqrt()
    }

    /// E where its square is a standard error lower, and where it is one higher.
    pub fn bounds(&self) -> [f64; 2] {
        [(self.square - self.square_error).max(0.0).sqrt(), (self.square.max(0.0) + self.square_error).sqrt()]
    }

    /// E with the distance to its upper bound as its error: σ(E²)/2E where E is large, the resolution where it is 0.
    pub fn estimate(&self) -> Estimate {
        Estimate { value: self.error(), stderr: self.bounds()[1] - self.error() }
    }
}

/// E between two models, each with K equal blocks of walks; see [`distance_of`].
///
/// # Errors
/// [`Error::Input`] of fewer than [`FEWEST_BLOCKS`](super::FEWEST_BLOCKS) blocks, of different numbers of them, or of blocks
/// that differ in starts, exit cells or channels; of those of one model that differ in walks.
pub fn distance(a: &[Tally], b: &[Tally]) -> Result<Distance> {
    check(a.iter().map(shape))?;
    check(b.iter().map(shape))?;
    distance_of(&a.iter().map(scattered).collect::<Vec<_>>(), &b.iter().map(scattered).collect::<Vec<_>>())
}

/// E between two models from the scattered light of K blocks of each.
///
/// With D_i = A_i − B_i, E² = [(ΣD_i)² − ΣD_i²]/[(ΣB_i)² − ΣB_i²]: products of different blocks alone, so nothing is known or
/// assumed of the noise inside a block, and walks of one block may resemble each other. Block i of A may share random numbers
/// or realizations with block i of B, and with no other.
///
/// # Errors
/// Those of [`distance`].
pub fn distance_of(a: &[Vec<f64>], b: &[Vec<f64>]) -> Result<Distance> {
    check(a.iter().map(Vec::len))?;
    if a.len() != b.len() || b.iter().any(|block| block.len() != a[0].len()) {
        let message =
            "models are held against each other by equal numbers of blocks of walks, alike in cells and channels";
        return Err(Error::Input(message.into()));
    }
    let apart = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a - b).collect();
    let difference = Products::new(&a.iter().zip(b).map(apart).collect::<Vec<_>>());
    let whole = Products::new(b);
    let ratio = |left_out| {
        let (part, all) = (difference.square(left_out), whole.square(left_out));
        if part == 0.0 { 0.0 } else { part / all.max(0.0) }
    };
    let square = ratio(None);
    let parts: Vec<f64> = (0..a.len()).map(|i| ratio(Some(i))).collect();
    let square_error = if parts.iter().all(|part| part.is_finite()) { jackknife(&parts) } else { f64::INFINITY };
    Ok(Distance { square, square_error })
}
