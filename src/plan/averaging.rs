//! What is lost by counting many realizations into one medium.

use super::budget::AVERAGED;
use super::configuration::Extent;
use super::stretches::{KeptBanks, stretches, walk};
use super::trial::{BLOCKS, Trial};
use crate::bsdf::{Distance, distance_of, scattered};
use crate::cloth::{DrawnFor, Realization, Realizer};
use crate::distribution::{Effort, SpecificLength};
use crate::error::Result;
use crate::goniometer::{Goniometer, Straight, Tally};
use crate::measure::Prepared;
use crate::scene::Scene;
use crate::tables::SamplingTables;
use crate::walk::{Engine, FirstHitBanks, Implicit};
use serde::{Deserialize, Serialize};

/// What media of single realizations say of averaging.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Averaged {
    /// E between the mean over media of single realizations and the medium of their mean.
    pub of_mean: Distance,
    /// E between the mean over media of single realizations and the fibers. Where cells are finer than the distance of fibers it may be
    /// the larger one: light that has left a fiber meets its like again in a cell that holds no other.
    pub of_fibers: Distance,
}

/// Media of single realizations, and the medium of their mean.
///
/// Light sees one realization at a time, a medium the mean of many: the mean of what light does is not what it does in the mean.
/// Both sides have the same realizations, so that what they differ by as single draws drops out to first order; of G
/// realizations they share, the mean differs from that of many by the share 1/G of the effect.
pub struct Averaging {
    singles: Vec<SamplingTables>,
    mean: SamplingTables,
    goniometer: Goniometer,
    straight: Option<Vec<Straight>>,
    first_hits: Option<KeptBanks>,
}

impl Averaging {
    /// Count each of the first `realizations` of a prepared medium of yarns alone, and all together; none of a sheet, whose
    /// density is stated. `scene` is that which the medium was prepared from.
    ///
    /// # Errors
    /// Those of [`SpecificLength::of_draws`]: a single realization may be too dense for a cell where the mean of many is not.
    pub fn new(scene: &Scene, prepared: &Prepared, realizations: u64) -> Result<Option<Averaging>> {
        let Some(cloth) = &prepared.cloth else { return Ok(None) };
        let realizer = Realizer::of_yarns(cloth.clone(), &scene.model, DrawnFor::Medium);
        let drawn: Vec<Realization> = (0..realizations).map(|number| realizer.draw(number)).collect::<Result<_>>()?;
        let tables = |count: u64, which: &(dyn Fn(u64) -> usize + Sync)| {
            let draw = |number| Ok(drawn[which(number)].clone());
            let (length, _) =
                SpecificLength::of_draws(cloth, &scene.model, Effort::Realizations(count), &draw, |_| {})?;
            SamplingTables::new(scene, &length)
        };
        // A realization counted twice is the mean of itself.
        let singles = (0..drawn.len()).map(|number| tables(2, &|_| number)).collect::<Result<_>>()?;
        let mean = tables(realizations, &|number| number as usize)?;
        let (goniometer, straight) = (prepared.goniometer.clone(), prepared.straight.clone());
        Ok(Some(Averaging {
            singles,
            mean,
            goniometer,
            straight,
            first_hits: prepared.first_hits.clone().map(KeptBanks::new),
        }))
    }

    /// Of a trial of a medium, what [`Averaging::measure`] finds, with the first [`AVERAGED`] realizations; or why there is none.
    ///
    /// # Errors
    /// A sentence that says why it does not apply or could not be measured.
    pub fn of(
        scene: &Scene,
        extent: &Extent,
        trial: &Trial,
        engine: &dyn Engine,
        seed: u64,
        walks: u64,
        fibers: &[Tally],
    ) -> std::result::Result<Averaged, String> {
        let none = "no realizations are counted: the density is stated";
        let medium = trial.medium().ok_or(none)?;
        let scene = trial.configuration().apply(scene, extent);
        let averaging = Averaging::new(&scene, medium, AVERAGED).map_err(|error| error.to_string())?.ok_or(none)?;
        // Walks of their own, independent of those of the trial.
        let seed = !trial.configuration().seed(seed);
        averaging.measure(engine, seed, walks, fibers).map_err(|error| error.to_string())
    }

    /// E between the mean over the media of single realizations and the medium of their mean, with `walks` walks of each start in
    /// each of [`BLOCKS`] blocks of both; and between that mean and the fibers.
    ///
    /// # Errors
    /// Those of [`Engine::run`] and [`distance_of`].
    pub fn measure(&self, engine: &dyn Engine, seed: u64, walks: u64, fibers: &[Tally]) -> Result<Averaged> {
        let each = walks.div_ceil(self.singles.len() as u64);
        let span = self.first_hits.as_ref().map_or(u64::MAX, KeptBanks::span);
        let first_hits = self.first_hits.as_ref().map(|banks| banks as &dyn FirstHitBanks);
        let light = |tables: &SamplingTables, block: u64, made: u64, walks: u64| -> Result<Vec<f64>> {
            let medium = Implicit { engine, tables, straight: self.straight.as_deref(), first_hits };
            Ok(scattered(&walk(&medium, &self.goniometer, seed, &stretches(span, block, made, walks))?))
        };
        let (mut apart, mut together) = (Vec::new(), Vec::new());
        for block in 0..BLOCKS {
            let mut mean: Vec<f64> = Vec::new();
            let mut made = 0;
            for tables in &self.singles {
                let part = light(tables, block, made, each)?;
                made += each;
                mean.resize(part.len(), 0.0);
                mean.iter_mut().zip(&part).for_each(|(sum, part)| *sum += part / self.singles.len() as f64);
            }
            apart.push(mean);
            together.push(light(&self.mean, block, made, walks)?);
        }
        let fibers: Vec<Vec<f64>> = fibers.iter().map(scattered).collect();
        Ok(Averaged { of_mean: distance_of(&apart, &together)?, of_fibers: distance_of(&apart, &fibers)? })
    }
}
