//! The BSDF of a cloth from its fibers.
//!
//! # Conventions
//! - Frame: x = weft, y = warp (of a knit: x along a course, y along a wale), z = outward normal of the *front* face;
//!   right-handed. The sheet fills 0 ≥ z ≥ −thickness.
//! - Lengths are in mm and angles in radians. In files the unit is part of the key's name.
//! - `wi` points to where the light comes from, `wo` to where it goes; both point away from the sheet. A walk's
//!   direction `m` is its propagation direction, so it starts as −wi.
//! - φ is counter-clockwise from +x seen from the front, whichever side is lit; θ is from the lit side's normal.
//! - BSDF values are in sr⁻¹ and exclude the cosine: directional albedo(wi) = ∫ f |cos θo| dΩo.
//! - Incident and exit cells index the (x, y) projections of wi and wo in the one fixed sheet frame. Undeflected light
//!   leaves in the cell of (−x, −y) of wi.
//! - Symbols are the paper's: f specific length, h specific visible area, H total specific visible area, R radius,
//!   m ray, p fiber direction, n normal, α offset, η index. F = ∫f dΩ; as an optical quantity F is the reflectance.
//!
//! "The paper" is Bogaevski, Kopylov, Khodulev, "An Implicit Approach to Cloth Synthesis".
//!
//! # Floors
//! Data flows down once: [`scene`] → [`cloth`], of yarns → [`distribution`] → [`tables`], [`goniometer`] → an engine
//! ([`mod@reference`] or [`gpu`]) → [`bsdf`] → [`results`] → [`report`]; [`measure`] runs it, [`plan`] holds ways to model a
//! scene against each other and chooses one, and [`export`] writes the table, and the fibers of a cloth, for other programs;
//! [`colour`] serves all. No module imports one from a later floor,
//! and the engines do not know of each other.

pub mod bsdf;
pub mod cloth;
pub mod colour;
pub mod concentric;
pub mod distribution;
pub mod error;
pub mod explicit;
pub mod export;
pub mod goniometer;
pub mod gpu;
pub mod measure;
pub mod optics;
pub mod plan;
pub mod reference;
pub mod report;
pub mod results;
pub mod scene;
pub mod tables;
pub mod walk;

pub use error::{Error, Result};
