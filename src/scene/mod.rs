//! The cloth file: TOML text → checked [`Scene`].
//!
//! Computes: nothing but conversions to mm and radians. Every value that gets through is finite and inside its range.
//!
//! Inputs: a file, or one of the embedded presets; the unit is in the key's name.
//!
//! Differs from the paper: nothing; the paper does not say how its input is written.

mod absorption;
mod basis;
mod draft;
mod flyaways;
mod knit;
mod load;
mod measure;
mod model;
mod presets;
mod reader;
mod sheet;
mod structure;
mod weave;
mod wif;
mod yarn;

pub use absorption::{Absorption, Channels, MAX_CHANNELS};
pub use basis::BasisChoice;
pub use flyaways::{Flyaways, Hairs, Loops, Migration, Spread};
pub use knit::{Knit, Stitch, THINNEST};
pub use load::{Scene, Source};
pub use measure::{Incident, Measure, Side};
pub use model::{Direct, FirstHit, Medium, Memory, Model, Packing, Placement, SEED, Tracking};
pub use presets::PRESETS;
pub use reader::closest;
pub use sheet::{Fiber, MAX_KINDS, Orientation, Sheet, SheetFibers, dark_beside_light};
pub use structure::Structure;
pub use weave::Weave;
pub use yarn::{RadialProfile, Yarn};
