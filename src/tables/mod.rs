//! What the engines read: the alias table of fibers and the rates of the medium.
//!
//! Computes: specific visible area as a majorant and tables (paper §3, §4), packed for constant-time draws; around each
//! empty cell, the block of empty cells that a ray may jump over.
//!
//! Inputs: the specific length (mm/mm³) by cell, fiber radii (mm), indices.
//!
//! Differs from the paper: H(m) is tabulated for the tracking that asks for it only. Otherwise tentative events come at
//! the rate 2·Σ R F, a fiber is drawn with weight R f, and the event is a collision with probability |m × p|; that gives H
//! and h/H jointly and exactly. In a cloth of many cells the densest sets the rate, and a cell takes its share of it. Where
//! flights start at exit points, the share is that of the cell of the fiber's axis, and belongs to the part of it where its fibers
//! are: a plane cuts cells at the rims of yarns.

mod alias;
mod blocks;
mod carry;
mod cut;
mod kind;
mod sampling;
mod visible;

pub use alias::AliasTable;
pub use blocks::Reach;
pub use carry::Carry;
pub use cut::Cut;
pub use kind::Kind;
pub use sampling::{CellEntry, Cells, List, SamplingTables};
pub use visible::VisibleArea;
