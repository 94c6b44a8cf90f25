//! Specific length of fibers by direction (paper §3).
//!
//! Computes: how many millimetres of fiber a cubic millimetre of the cloth holds, by place and direction: a periodic grid of
//! cells, each with a density and a list of bundles of directions.
//!
//! Inputs: the checked sheet (densities in mm/mm³, axes as unit vectors, spreads in radians), and the number of cells
//! of the direction grid.
//!
//! Differs from the paper:
//! - The sheet is given by its statistics, so one cell describes it and nothing is counted.
//! - The direction is tabulated on equal-area cells of the hemisphere; exactly aligned and exactly planar fibers are
//!   entries of their own, with no smear.
//! - Fiber and direction are drawn together from one table, so kinds of fiber may share a direction.

mod cells;
mod directions;
mod sheet;

pub use cells::{Cell, CellGrid};
pub use directions::{DirectionGrid, direction_of, square_of};
pub use sheet::{Bundle, SpecificLength, surface};
