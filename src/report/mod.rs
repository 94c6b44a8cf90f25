//! Pictures of the cloth.
//!
//! Computes: the picture of an explicit cloth, drawn from the fibers of one realization: both faces, two cuts, the draft
//! of a weave.
//!
//! Inputs: a laid out [`Cloth`](crate::cloth::Cloth) and the width of the picture in pixels. One repeat is drawn into a
//! depth buffer, fiber by fiber as cylinders, and laid side by side with itself.
//!
//! Differs from the paper: nothing; the paper does not say how its pictures were made. Light and shade are there to be
//! read and are no measurement: they know nothing of the walks, and a fiber's colour is that of a thick pile of its kind
//! ([`pile`]).

mod chart;
mod colour;
mod depth;
mod draft;
mod image;
mod layout;
mod marks;
mod picture;
mod shade;
mod sheet;
mod text;
mod view;

pub use chart::{chart_deviation, chart_findings, chart_page, chart_picture};
pub use colour::pile;
pub use depth::{Depth, Seen};
pub use image::Image;
pub use layout::Panel;
pub use picture::{Picture, WIDTHS, cloth_picture};
pub use sheet::contact_sheet;
pub use view::Face;
