//! From the cells of a table to those of a file, and how far a file is from its table.

mod balance;
mod check;
mod grid;
mod overlap;
mod smooth;

pub use balance::balance;
pub use check::{Check, Loaded, Sums, check};
pub use grid::{Grid, steps, sum};
pub use overlap::{Fitted, fit, fit_direct};
pub use smooth::{Smooth, SmoothRow, near};
