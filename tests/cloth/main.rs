//! The explicit cloth and what is counted of it: yarns, fibers, cells, lists of directions, pictures.

#[path = "../common/mod.rs"]
mod common;

mod calculator;
mod cells;
mod curves;
mod filaments;
mod hairs;
mod knit;
mod openness;
mod packing;
mod picture;
mod visible;
mod voids;
mod weave;
mod webs;
mod yarns;
