//! Radiance's XML, as WINDOW has it: the basis of Klems and tensor trees.
//!
//! Sources: LBNL-ETA/Radiance, `src/common/bsdf.c`, `bsdf_m.c`, `bsdf_t.c`; schema BSDF-v1.7.7 of LBNL-ETA/BSDFXMLParser. There the face is
//! called back, and an incident cell is named by where its light travels.

pub mod klems;
mod material;
pub mod tensor_tree;
mod xml;
