//! Opening the engine on an adapter.

use super::adapter::{self, Found, Kind};
use super::device::OpenDevice;
use super::engine::Gpu;
use super::loops::most_passes;
use crate::error::Result;
use std::sync::Mutex;

impl Found {
    /// Open it, and try whether its driver ends loops early.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when it gives no device with default limits, or fails at the trial.
    pub fn open(&self) -> Result<Gpu> {
        let device = OpenDevice::open(self)?;
        let most_passes = most_passes(&device)?;
        let (pipelines, tuned) = (Mutex::default(), Mutex::default());
        Ok(Gpu { device, skipped: Vec::new(), most_passes, pipelines, tuned })
    }
}

impl Gpu {
    /// Open the first adapter that gives a device, or the one that `name` means: its number in [`list`](super::list), its
    /// name, or a part of its description, in any case.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when there is none, or it gives no device with default limits.
    pub fn open(name: Option<&str>) -> Result<Gpu> {
        let mut skipped: Vec<String> = Vec::new();
        for found in adapter::find(name)? {
            match found.open() {
                Ok(gpu) => return Ok(Gpu { skipped, ..gpu }),
                Err(error) => skipped.push(error.to_string()),
            }
        }
        Err(adapter::none(&skipped))
    }

    /// Adapters before this one that gave no device, and why.
    pub fn skipped(&self) -> &[String] {
        &self.skipped
    }

    /// What the adapter is.
    pub fn kind(&self) -> Kind {
        self.device.summary.kind
    }

    /// The adapter in one line.
    pub fn adapter(&self) -> String {
        self.device.summary.description.clone()
    }

    /// Passes of all loops after which the driver ends a shader, found by a trial; none where 70,000 are made.
    pub fn most_passes(&self) -> Option<u32> {
        self.most_passes
    }
}
