//! The plan of a run and the interface of an engine.

use super::first_hits::{FirstHitBanks, FirstHits};
use crate::error::{Error, Result};
use crate::goniometer::{Goniometer, Straight, Tally};
use crate::tables::SamplingTables;
use std::ops::Range;
use std::sync::Arc;

/// Roulette is played each time that a walk has made this many more tentative events.
pub const ROULETTE_EVERY: u32 = 16;
/// Roulette is played when the brightest channel may have kept less than this share of the light.
pub const ROULETTE_BELOW: f64 = 0.25;
/// Fibers that tracking by tables refuses at a collision before it gives the collision up: there the largest ⟨|m × p|⟩ is
/// some thousandths, which is less than the error of the table.
pub const MOST_REFUSALS: u32 = 1024;
/// A fiber is taken for straight so far from where light met it, in radii, where its place is remembered.
pub const STRAIGHT: f64 = 16.0;
/// A walk is given up after this many tentative events.
pub const MAX_EVENTS: u32 = 1 << 24;

/// Which walks to make.
#[derive(Clone, Debug, PartialEq)]
pub struct WalkPlan {
    /// Seed of the random numbers.
    pub seed: u64,
    /// First walk number i of each start.
    pub first: u64,
    /// Walks of each start, an incident cell of a lit side.
    pub walks_per_incident: u64,
    /// Draw directions inside the patch of a table entry; without it they sit in the middle of the patch.
    pub jitter: bool,
    /// A walk is lost after this many tentative events.
    pub max_events: u32,
    /// Let Russian roulette end walks that carry little light.
    pub roulette: bool,
    /// Where walks first meet a fiber; none where a flight through the medium is to find it.
    pub first_hits: Option<Arc<FirstHits>>,
}

impl WalkPlan {
    /// A plan with the usual settings.
    pub fn new(seed: u64, walks_per_incident: u64) -> WalkPlan {
        WalkPlan {
            seed,
            first: 0,
            walks_per_incident,
            jitter: true,
            max_events: MAX_EVENTS,
            roulette: true,
            first_hits: None,
        }
    }

    /// Refuse a plan that the tables of a medium are not made for.
    ///
    /// # Errors
    /// [`Error::Input`] when directions are to sit in the middle of patches over which H(m) was averaged, or when light that
    /// is carried through fibers is to be tracked by tables.
    pub fn check(&self, tables: &SamplingTables) -> Result<()> {
        if !self.jitter && tables.visible.is_some() {
            let message = "tracking by tables draws directions inside their patches; leave jitter on";
            return Err(Error::Input(message.into()));
        }
        if tables.carry.is_some() && tables.visible.is_some() {
            let message =
                "tracking by tables has the cell of the ray and not that of the fiber's axis; place flights at hits";
            return Err(Error::Input(message.into()));
        }
        Ok(())
    }

    /// The numbers i of the walks of each start.
    pub fn walks(&self) -> std::ops::Range<u64> {
        self.first..self.first + self.walks_per_incident
    }

    /// The walk id of walk number `i` of a start, i·C + c with C starts.
    pub fn walk_id(starts: usize, i: u64, start: usize) -> u64 {
        i * starts as u64 + start as u64
    }
}

/// How one walk went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WalkRecord {
    /// The bin in which it was counted, in the order of [`BinLayout`](crate::goniometer::BinLayout).
    pub bin: u32,
    /// Tentative events, the last step out of the sheet included.
    pub events: u32,
    /// Fibers hit.
    pub hits: u32,
}

/// Something that can make walks.
pub trait Engine {
    /// Make the walks of a plan and count them.
    ///
    /// `progress` sees the tally so far, now and then, in walks per incident cell that may differ between cells.
    ///
    /// # Errors
    /// [`Error::Device`] when the device cannot hold or finish the run;
    /// [`Error::Account`] when the counts do not add up to the plan.
    fn run(
        &self,
        tables: &SamplingTables,
        goniometer: &Goniometer,
        plan: &WalkPlan,
        progress: &mut dyn FnMut(&Tally),
    ) -> Result<Tally>;
}

/// Something that sends the walks of a plan through one cloth.
pub trait Walker {
    /// Make the walks of a plan and count them, as [`Engine::run`] does.
    ///
    /// # Errors
    /// Those of [`Engine::run`].
    fn run(&self, goniometer: &Goniometer, plan: &WalkPlan, progress: &mut dyn FnMut(&Tally)) -> Result<Tally>;
}

/// An engine and the tables of a medium.
#[derive(Clone, Copy)]
pub struct Implicit<'a> {
    /// Who makes the walks.
    pub engine: &'a dyn Engine,
    /// What they go through.
    pub tables: &'a SamplingTables,
    /// The light by start that touches no fiber, if it is known better.
    pub straight: Option<&'a [Straight]>,
    /// Where walks first meet a fiber; none where flights find it.
    pub first_hits: Option<&'a dyn FirstHitBanks>,
}

impl Implicit<'_> {
    /// Make the walks of a plan bank by bank.
    fn run_in_banks(
        &self,
        banks: &dyn FirstHitBanks,
        goniometer: &Goniometer,
        plan: &WalkPlan,
        progress: &mut dyn FnMut(&Tally),
    ) -> Result<Tally> {
        let Range { start: mut first, end } = plan.walks();
        let mut run = |first: u64, before: Option<&Tally>| -> Result<(Tally, u64)> {
            let bank = first / banks.span();
            let next = end.min((bank + 1) * banks.span());
            let first_hits = Some(banks.bank(bank)?);
            let part = WalkPlan { first, walks_per_incident: next - first, first_hits, ..plan.clone() };
            let mut tell = |part: &Tally| match before {
                None => progress(part),
                // Banks before this one count as well.
                Some(before) => {
                    let mut sum = before.clone();
                    sum.add_counts(part);
                    progress(&sum);
                }
            };
            Ok((self.engine.run(self.tables, goniometer, &part, &mut tell)?, next))
        };
        let (mut whole, next) = run(first, None)?;
        first = next;
        while first < end {
            let (part, next) = run(first, Some(&whole))?;
            whole.merge(&part)?;
            first = next;
        }
        Ok(whole)
    }
}

impl Walker for Implicit<'_> {
    fn run(&self, goniometer: &Goniometer, plan: &WalkPlan, progress: &mut dyn FnMut(&Tally)) -> Result<Tally> {
        let straight = self.straight.map(<[Straight]>::to_vec);
        let mut tally = match self.first_hits {
            None => self.engine.run(self.tables, goniometer, plan, progress)?,
            Some(banks) => self.run_in_banks(banks, goniometer, plan, progress)?,
        };
        tally.straight = straight;
        Ok(tally)
    }
}
