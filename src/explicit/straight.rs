//! Light that touches no fiber, by straight rays through realizations.

use crate::cloth::{FiberGrid, Realization, Way, Work};
use crate::error::Result;
use crate::goniometer::{Goniometer, Straight};
use crate::walk::{Purpose, draw, uniform};
use glam::{DVec2, DVec4};
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Realizations that rays go through; further ones are not looked at.
const REALIZATIONS: u64 = 32;
/// Rays through each, all starts together.
const RAYS: usize = 1 << 14;
/// Fewest rays of a start through each.
const FEWEST: usize = 16;
/// The rays do not depend on the seed of the walks.
const SEED: u64 = 0;
/// Root of x⁵ = x + 1, whose powers make the most even additive sequence in four dimensions (Roberts 2018).
const ROOT: f64 = 1.167_303_978_261_418_7;

/// Straight rays of every start through the realizations of a cloth, which come in any order.
pub struct StraightLight<'a> {
    goniometer: &'a Goniometer,
    /// By realization and start, the share of rays that touch nothing.
    shares: Mutex<BTreeMap<u64, Vec<f64>>>,
}

impl<'a> StraightLight<'a> {
    /// Before the first realization.
    pub fn new(goniometer: &'a Goniometer) -> StraightLight<'a> {
        StraightLight { goniometer, shares: Mutex::new(BTreeMap::new()) }
    }

    /// Whether a realization is one of those that rays go through.
    fn wants(&self, number: u64) -> bool {
        number < REALIZATIONS && !self.seen().contains_key(&number)
    }

    /// Realizations that rays go through.
    pub fn wanted(&self) -> std::ops::Range<u64> {
        0..REALIZATIONS
    }

    /// Send rays through a realization, if it is wanted: an even sequence of places on the lit face and directions inside the
    /// incident cell, begun anywhere.
    ///
    /// # Errors
    /// Those of [`FiberGrid::new`].
    pub fn add(&self, number: u64, realization: &Realization) -> Result<()> {
        if !self.wants(number) {
            return Ok(());
        }
        let grid = FiberGrid::new(&realization.fibers, realization.period)?;
        let starts = self.goniometer.starts();
        let rays = (RAYS / starts).max(FEWEST);
        let [low, high] = grid.span();
        let mut work = Work::default();
        let mut share = |start: usize| {
            let begin = DVec4::from_array(draw(SEED, number, start as u32, Purpose::Start).map(uniform));
            let step = DVec4::new(1.0, ROOT, ROOT.powi(2), ROOT.powi(3)) / ROOT.powi(4);
            let mut untouched = |ray: &usize| {
                let at = (begin + step * (*ray as f64 + 1.0)).fract();
                let m = -self.goniometer.start_direction(start, DVec2::new(at.x, at.y));
                let place = grid.period() * DVec2::new(at.z, at.w);
                let from = place.extend(if m.z < 0.0 { high } else { low });
                matches!(grid.first_entry(from, m, None, &mut work), Way::Out)
            };
            (0..rays).filter(|ray| untouched(ray)).count() as f64 / rays as f64
        };
        let shares = (0..starts).map(&mut share).collect();
        self.seen().insert(number, shares);
        Ok(())
    }

    /// The mean over realizations and its standard error, by start; none before the second realization.
    pub fn light(&self) -> Option<Vec<Straight>> {
        let seen = self.seen();
        let n = seen.len() as f64;
        (seen.len() > 1).then(|| {
            let of = |start: usize| {
                let mean = seen.values().map(|shares| shares[start]).sum::<f64>() / n;
                let square: f64 = seen.values().map(|shares| (shares[start] - mean).powi(2)).sum();
                // Where all or none of the rays were stopped, the error is that of one of them.
                let least = 1.0 / (n * (RAYS / self.goniometer.starts()).max(FEWEST) as f64);
                Straight { value: mean, stderr: (square / n / (n - 1.0)).sqrt().max(least) }
            };
            (0..self.goniometer.starts()).map(of).collect()
        })
    }

    fn seen(&self) -> std::sync::MutexGuard<'_, BTreeMap<u64, Vec<f64>>> {
        self.shares.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}
