//! The explicit cloth: the geometry that the distribution calculator counts (paper §5).
//!
//! Computes: the axes of the threads of one repeat of a weave or a knit, and random draws of all their fibers, whole and as
//! straight pieces; the same for an element of a sheet ([`Realizer`]). Fibers of a draw can be pushed apart
//! ([`Realizer::draw_separate`]).
//!
//! Inputs: a checked scene with a `[weave]` or a `[knit]`; lengths in mm, twists in turns per mm. End i lies at x = (i + ½)·spacing,
//! pick j at y = (j + ½)·spacing; the repeat starts at x = y = 0 and the front's highest point is z = 0.
//!
//! Differs from the paper, which leaves the geometry to its first reference:
//! - Crimp follows from the interlacing. At a crossing the two yarns touch: their axes are (h₁ + h₂)/2 apart, of which
//!   the warp takes a stated share. From one crossing to the next an axis follows the section of the yarn that it
//!   crosses, then the common tangent, then the section of the next: the arcs and straight lines of Peirce, "The
//!   geometry of cloth structure", J. Textile Institute 28, T45 (1937), for elliptical sections. A float is straight.
//! - The section of a yarn is the same ellipse in every vertical plane across it. A yarn that climbs is sheared, not
//!   turned: it is thinner by the cosine of its slope, as one that squeezes between its neighbours. For this the gap
//!   between two yarns has a closed form, and yarns touch without running through each other
//!   ([`Cloth::largest_penetration`]). The limit: sections do not change from place to place, and where a yarn climbs
//!   steeply its fibers are packed closer by the same factor ([`Statistics::densest`]).
//! - Loops of a knit bend as little as they can at the stated density and loop length, with their axes a diameter apart
//!   wherever yarns meet. Their sections stand across the axis; contact takes them as circles of the mean diameter.
//! - Fibers, with their surface, fill their plies at random and independently, and may migrate, loop and end outside (Zhao, Luan, Bala 2016),
//!   so they may overlap if they are not pushed apart. Loops of fibers follow the bends of their yarn, and so do hairs of a weave; hairs of a knit stand
//!   on the tangent of their yarn where they leave it. Nothing keeps them out of other yarns.
//! - Yarns run through the repeat without end; twist need not close over it, so each thread is cut at a random place, and
//!   there its fibers jump.

mod curves;
mod draws;
mod flyaways;
mod grid;
mod knit;
mod path;
mod realization;
mod realizer;
mod repeat;
mod rim;
mod section;
mod separate;
mod statistics;
mod steps;
mod tube;
mod web;
mod woven;

pub use curves::Curve;
pub use draws::{DrawnFor, OF_USER};
pub use grid::{FiberGrid, Way, Work};
pub use realization::{Primitive, Realization};
pub use realizer::Realizer;
pub use repeat::{Cloth, System, Thread};
pub use separate::Separation;
pub use statistics::{Shape, Statistics};
pub use tube::{Meeting, Tube};
