//! The explicit engine: the same rays and the same optics of a fiber, through the real fibers of a cloth.
//!
//! Computes: the walks of a plan on all processor cores, from realization to realization of the cloth, so the answer is the
//! mean over random cloths. It judges the implicit medium, and needs no tables.
//!
//! Inputs: realizations of the cloth (fibers as polylines, mm), kinds of fiber (radius in mm, index, absorption in 1/mm),
//! goniometer, plan.
//!
//! Differs from the paper, which has no such engine:
//! - A ray goes to the fiber that it enters next; the offset α and the normal are those of that place, not drawn. What
//!   happens there is the closed form of a straight cylinder (see [`optics`](crate::optics)), and the light goes on from
//!   where it leaves that cylinder, even where the fiber bends.
//! - A place may lie in several fibers that overlap. Those that a ray starts in are not entered.

mod clustering;
mod engine;
mod straight;
mod walk;

pub use clustering::Clustering;
pub use engine::Explicit;
pub use straight::{Banks, StraightRays};
pub use walk::{Bodies, walk};
