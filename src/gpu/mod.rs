//! The `gpu` engine: a WGSL compute kernel on wgpu.
//!
//! Computes: the same walks as the `cpu` engine, from the same random numbers, in f32 and by complex products; millions
//! at a time, one tentative event per lane and pass, resumable, in dispatches of bounded length.
//!
//! Inputs: sampling tables (mm, 1/mm), goniometer, plan.
//!
//! Differs from the paper: see [`tables`](crate::tables) and [`optics`](crate::optics); and light that is still inside a
//! fiber after 1024 chords is let out there.

mod adapter;
mod buffers;
mod device;
mod drivers;
mod engine;
pub mod layout;
mod loops;
mod opening;
mod pack;
mod params;
mod probe;
mod session;
mod settings;
pub mod shader;
pub mod translate;
mod tuning;

pub use adapter::{AdapterSummary, Found, Kind, list, none};
pub use drivers::{DriverFault, driver_faults};
pub use engine::Gpu;
pub use probe::{Probe, ProbeInput, ProbeOutput};
pub use settings::{Report, Settings};
