//! What the engines read: the alias table of fibers and the rates of the medium.
//!
//! Computes: specific visible area as a majorant and a table (paper §3, §4), packed for constant-time draws.
//!
//! Inputs: the specific length (mm/mm³), fiber radii (mm), indices, the sheet's thickness (mm).
//!
//! Differs from the paper: no table of H(m). Tentative events come at the rate 2·Σ R F, a fiber is drawn with weight
//! R f, and the event is a collision with probability |m × p|; that gives H and h/H jointly and exactly.

mod alias;
mod sampling;

pub use alias::AliasTable;
pub use sampling::{Kind, SamplingTables};
