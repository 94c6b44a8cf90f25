//! How the work of a run is cut, and how it went.

use crate::error::{Error, Result};

/// How the work is cut. The tally does not depend on it; what is not set is chosen for the device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settings {
    /// Invocations of a workgroup, 1 to 256; 64 if not set.
    pub workgroup: Option<u32>,
    /// Lanes, a multiple of the workgroup.
    pub lanes: Option<u32>,
    /// Passes of a dispatch; without it, few enough for a driver that ends loops early.
    pub budget: Option<u32>,
    /// Passes between two flushes.
    pub flush_every: Option<u32>,
    /// Keep the direction table in a texture, whatever its size.
    pub table_in_texture: Option<bool>,
    /// Keep the table of cells in a texture, whatever its size.
    pub cells_in_texture: Option<bool>,
    /// Most walks of each start in one segment.
    pub walks_per_segment: Option<u64>,
    /// Most starts in one batch.
    pub starts_per_batch: Option<usize>,
    /// Number at which every bin of the device starts.
    pub bins_preset: u32,
    /// Number at which the low words of the device's sums of events and collisions start.
    pub sums_preset: u32,
    /// Blocks of walks that the device is not told of: the account of such a run must not close.
    pub withheld_blocks: u32,
}

impl Settings {
    /// Refuse what no device can do.
    pub(super) fn check(&self) -> Result<()> {
        let workgroup = self.workgroup.unwrap_or(64);
        let lanes = self.lanes.unwrap_or(workgroup);
        let fine = (1..=256).contains(&workgroup)
            && lanes > 0
            && lanes.is_multiple_of(workgroup)
            && self.budget != Some(0)
            && self.flush_every != Some(0);
        if fine {
            return Ok(());
        }
        Err(Error::Device {
            needed:
                "the gpu engine needs a workgroup of 1 to 256, lanes that are a multiple of it, a budget and a flush \
                     interval above 0"
                    .into(),
            found: format!("it was given {self:?}"),
        })
    }
}

/// How a run went on the device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Dispatches.
    pub dispatches: u64,
    /// Walks that went on in a later dispatch than they started in, once for each such dispatch.
    pub resumed: u64,
    /// Lanes of the last batch.
    pub lanes: u32,
    /// Passes of a dispatch.
    pub budget: u32,
    /// Passes between two flushes.
    pub flush_every: u32,
}
