//! The plan of a run and the interface of an engine.

use crate::error::Result;
use crate::goniometer::{Goniometer, Tally};
use crate::tables::SamplingTables;

/// A walk is given up after this many tentative events.
pub const MAX_EVENTS: u32 = 1 << 24;

/// Which walks to make.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WalkPlan {
    /// Seed of the random numbers.
    pub seed: u64,
    /// First walk number i inside each incident cell.
    pub first: u64,
    /// Walks of each incident cell.
    pub walks_per_incident: u64,
    /// Draw directions inside the patch of a table entry; without it they sit in the middle of the patch.
    pub jitter: bool,
    /// A walk is lost after this many tentative events.
    pub max_events: u32,
}

impl WalkPlan {
    /// A plan with the usual settings.
    pub fn new(seed: u64, walks_per_incident: u64) -> WalkPlan {
        WalkPlan { seed, first: 0, walks_per_incident, jitter: true, max_events: MAX_EVENTS }
    }

    /// The walk id of walk number `i` of an incident cell, i·C + c with C incident cells.
    pub fn walk_id(incident_cells: usize, i: u64, cell: usize) -> u64 {
        i * incident_cells as u64 + cell as u64
    }
}

/// How one walk went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    /// [`Error::Device`](crate::Error::Device) when the device cannot hold or finish the run;
    /// [`Error::Account`](crate::Error::Account) when the counts do not add up to the plan.
    fn run(
        &self,
        tables: &SamplingTables,
        goniometer: &Goniometer,
        plan: &WalkPlan,
        progress: &mut dyn FnMut(&Tally),
    ) -> Result<Tally>;
}
