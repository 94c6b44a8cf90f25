//! What equal blocks of independent walks say together: the scatter between them is the error, whatever walks of one block
//! have in common.

use super::estimate::{Estimate, direct, share};
use super::totals::totals;
use crate::error::{Error, Result};
use crate::goniometer::Tally;

/// Fewest blocks that have a scatter of their own when one of them is left out.
pub const FEWEST_BLOCKS: usize = 3;

/// Scattered light of a tally, as [`share`] has it: by start, exit cell of both hemispheres (reflection first) and channel.
pub fn scattered(tally: &Tally) -> Vec<f64> {
    let (bins, channels) = (2 * tally.layout.exit_cells, tally.channels());
    let mut light = Vec::with_capacity(tally.starts() * bins * channels);
    for start in 0..tally.starts() {
        for bin in 0..bins {
            for channel in 0..channels {
                let seen = tally.light(start, bin, channel);
                light.push(share(tally, start, tally.walks_per_incident(), seen).value);
            }
        }
    }
    light
}

/// Where the light of a start goes: means of blocks, with the errors that the scatter between blocks gives them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BlockTotals {
    /// Share that leaves on the lit side.
    pub reflectance: Estimate,
    /// Share that touched a fiber and leaves on the other side.
    pub transmittance: Estimate,
    /// Share that touched no fiber.
    pub direct: Estimate,
}

/// The totals of a start in a channel.
///
/// Where straight rays say how much light touches no fiber, all blocks have the same of it: then the error of the direct
/// light is that of the rays, and a part of the others. No error is below that of one walk of all.
///
/// # Errors
/// [`Error::Input`] of fewer than [`FEWEST_BLOCKS`] blocks, or of blocks of different shapes or sizes.
pub fn block_totals(blocks: &[Tally], start: usize, channel: usize) -> Result<BlockTotals> {
    check(blocks.iter().map(shape))?;
    let walks = blocks.iter().map(Tally::walks_per_incident).sum::<u64>() as f64;
    let parts: Vec<_> = blocks.iter().map(|block| totals(block, start, channel)).collect();
    let spread = |of: &dyn Fn(usize) -> f64| {
        let n = parts.len() as f64;
        let value = (0..parts.len()).map(of).sum::<f64>() / n;
        let square: f64 = (0..parts.len()).map(|i| (of(i) - value).powi(2)).sum();
        Estimate { value, stderr: (square / n / (n - 1.0)).sqrt().max(1.0 / walks) }
    };
    let untouched = match &blocks[0].straight {
        Some(_) => direct(&blocks[0], start),
        None => spread(&|i| parts[i].direct.value),
    };
    let scattered = |of: &dyn Fn(usize) -> f64| {
        let Estimate { value, stderr } = spread(of);
        // What straight rays take from the direct light they give to the rest.
        let shared = match &blocks[0].straight {
            Some(_) if untouched.value < 1.0 => value * untouched.stderr / (1.0 - untouched.value),
            _ => 0.0,
        };
        Estimate { value, stderr: stderr.hypot(shared) }
    };
    Ok(BlockTotals {
        reflectance: scattered(&|i| parts[i].reflectance.value),
        transmittance: scattered(&|i| parts[i].transmittance.value),
        direct: untouched,
    })
}

/// Relative noise of the scattered light in the mean of all blocks, √(Σσ²/ΣP²), with σ from the scatter between blocks and
/// ΣP² from products of different ones; its error is a jackknife over blocks. Infinite where nothing is scattered.
///
/// Unlike [`noise`](super::noise), it holds the likeness of walks that go through one realization of the fibers.
///
/// # Errors
/// Those of [`block_totals`].
pub fn block_noise(blocks: &[Tally]) -> Result<Estimate> {
    check(blocks.iter().map(shape))?;
    let light: Vec<Vec<f64>> = blocks.iter().map(scattered).collect();
    let products = Products::new(&light);
    let of = |left_out: Option<usize>| {
        let (n, own, mixed) = products.sums(left_out);
        // Σ|A_i − Ā|²/(n(n − 1)), with n|Ā|² = (own + mixed)/n.
        let variance = (own - (own + mixed) / n) / (n * (n - 1.0));
        (variance.max(0.0) / (mixed / (n * (n - 1.0))).max(0.0)).sqrt()
    };
    let value = of(None);
    if !value.is_finite() {
        return Ok(Estimate { value: f64::INFINITY, stderr: f64::INFINITY });
    }
    // Without a block the noise is that of the others: bring it to the number of all.
    let scale = ((light.len() - 1) as f64 / light.len() as f64).sqrt();
    let parts: Vec<f64> = (0..light.len()).map(|i| scale * of(Some(i))).collect();
    Ok(Estimate { value, stderr: jackknife(&parts) })
}

/// Products of blocks with each other.
pub(super) struct Products(Vec<Vec<f64>>);

impl Products {
    /// All products of two.
    pub fn new(blocks: &[Vec<f64>]) -> Products {
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum();
        let row = |a: &Vec<f64>| blocks.iter().map(|b| product(a, b)).collect();
        Products(blocks.iter().map(row).collect())
    }

    /// Number of blocks, products of blocks with themselves and those of different ones, perhaps without one block.
    pub fn sums(&self, left_out: Option<usize>) -> (f64, f64, f64) {
        let (mut n, mut own, mut mixed) = (0.0, 0.0, 0.0);
        for (i, row) in self.0.iter().enumerate().filter(|(i, _)| Some(*i) != left_out) {
            n += 1.0;
            own += row[i];
            mixed +=
                row.iter().enumerate().filter(|(j, _)| *j != i && Some(*j) != left_out).map(|(_, p)| p).sum::<f64>();
        }
        (n, own, mixed)
    }

    /// The square of the mean without noise: products of different blocks.
    pub fn square(&self, left_out: Option<usize>) -> f64 {
        let (n, _, mixed) = self.sums(left_out);
        mixed / (n * (n - 1.0))
    }
}

/// Standard error of a function of n blocks from its values without one of them (Tukey 1958): √((n − 1)/n Σ(x_i − x̄)²).
pub(super) fn jackknife(parts: &[f64]) -> f64 {
    let n = parts.len() as f64;
    let mean = parts.iter().sum::<f64>() / n;
    ((n - 1.0) / n * parts.iter().map(|part| (part - mean).powi(2)).sum::<f64>()).sqrt()
}

/// Starts, exit cells, channels and walks.
pub(super) fn shape(tally: &Tally) -> ([usize; 3], u64) {
    ([tally.starts(), tally.layout.exit_cells, tally.channels()], tally.walks_per_incident())
}

/// Refuse too few blocks, and such as are not alike.
pub(super) fn check<T: PartialEq>(mut blocks: impl ExactSizeIterator<Item = T>) -> Result<()> {
    let count = blocks.len();
    let first = blocks.next();
    if count < FEWEST_BLOCKS || blocks.any(|block| Some(&block) != first.as_ref()) {
        let message = format!(
            "a scatter between blocks needs {FEWEST_BLOCKS} or more that are alike in incident cells, exit cells, channels and walks"
        );
        return Err(Error::Input(message));
    }
    Ok(())
}
