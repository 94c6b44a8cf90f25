//! Scattered light by parts of a hemisphere, where walks are too few for exit cells.

use super::estimate::{Estimate, share};
use super::pool::{PARTS, Parts};
use crate::goniometer::{Basis, Moments, Tally};

/// Scattered light of a tally, as [`share`] has it: by start, part of both hemispheres (reflection first, [`PARTS`] each) and channel.
pub fn scattered_parts(tally: &Tally, exit: &Basis) -> Vec<Estimate> {
    let (parts, channels) = (Parts::new(exit), tally.channels());
    let mut light = Vec::with_capacity(tally.starts() * 2 * PARTS * channels);
    for start in 0..tally.starts() {
        let mut sums = vec![Moments::default(); 2 * PARTS * channels];
        for bin in 0..2 * tally.layout.exit_cells {
            for channel in 0..channels {
                sums[parts.of_bin(bin) * channels + channel] += tally.light(start, bin, channel);
            }
        }
        light.extend(sums.into_iter().map(|sum| share(tally, start, tally.walks_per_incident(), sum)));
    }
    light
}
