//! Charts of speed against accuracy: a picture that stands alone, and a page with it.

mod labels;
mod looks;
mod page;
mod panel;
mod picture;
mod scale;
mod words;

pub use page::chart_page;
pub use picture::chart_picture;
pub use words::{chart_findings, deviation as chart_deviation};
