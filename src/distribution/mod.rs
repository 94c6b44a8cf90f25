//! Specific length of fibers by direction (paper §3).
//!
//! Computes: how many millimetres of fiber a cubic millimetre of the cloth holds, by place and direction: a periodic grid of
//! cells, each with a density and a list of bundles of directions.
//!
//! Inputs: the checked sheet (densities in mm/mm³, axes as unit vectors, spreads in radians) or the explicit cloth, the
//! number of cells of the direction grid, the cells of the repeat, and the cone of directions in radians.
//!
//! Differs from the paper:
//! - The sheet is given by its statistics, so one cell describes it and nothing is counted.
//! - The direction is tabulated on equal-area cells of the hemisphere; exactly aligned and exactly planar fibers are
//!   entries of their own, with no smear.
//! - Fibers are cut at the faces of cells, where the paper gives a whole primitive to the cell of its centre: no length is
//!   misplaced, whatever the size of cells. Lengths are summed in integers, so they do not depend on the order of the work.
//! - f is the mean over random realizations, as many as bring the standard error of the densities of cells to 15 %.
//! - Densities lie on a fine grid and lists of directions on a coarser one, never wider than a sixteenth of the distance of
//!   two yarns. Cells share a list where lists differ by less than their sampling error.
//! - Directions are counted on a grid twice as fine as the one they are tabulated on; the cone of the paper is laid
//!   around what was counted. Fibers of a cell that share one direction to 10⁻⁶ keep it exactly.
//! - Of fibers that lie independently as many may overlap as cover 0.9 of a cell; more are refused.
//! - Where flights start at exit points a cell has a factor of its rate: from its volume fraction, or from points thrown at
//!   the fibers of the realizations, which tell how much of their surface and of the volume is free.
//! - The mean place of the fibers in a cell is counted too, so that cells can be cut where fibers end.
//! - Fiber and direction are drawn together from one table, so kinds of fiber may share a direction.

mod calculator;
mod cells;
mod clip;
mod count;
mod directions;
mod lists;
mod placement;
mod sheet;
mod spread;
mod sums;
mod voids;

pub use calculator::{Effort, Element, Gathering, cells_of_edge, thinnest_radius, usual_edge};
pub use cells::{Cell, CellGrid};
pub use directions::{DirectionGrid, direction_of, square_of};
pub use sheet::{Bundle, SpecificLength, surface};
pub use sums::MOST_ENTRIES;
pub use voids::Voids;
