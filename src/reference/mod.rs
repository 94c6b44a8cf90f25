//! The `cpu` engine: f64, in angles and vectors, written from the paper.
//!
//! Computes: the walks of a plan on all processor cores. It judges the `gpu` engine and stands in for it where there is
//! no Vulkan driver.
//!
//! Inputs: sampling tables (mm, 1/mm), goniometer, plan.
//!
//! Differs from the paper: null-collision tracking beside the paper's own (see [`tables`](crate::tables)), and the closed
//! form of the cylinder (see [`optics`](crate::optics)). The next flight starts at the hit point, as in the paper, or by
//! choice where the light leaves the fiber. By choice a walk remembers its last flight, where no fiber is, and the fiber that it set out
//! from (see `memory`).

mod carried;
mod cells;
mod engine;
mod flight;
mod medium;
mod memory;
mod walk;

pub use engine::Reference;
pub use walk::{Replay, replay};
