//! Light: optics, walks, tallies and what is made of them, in every engine.

#[path = "../common/mod.rs"]
mod common;

mod account;
mod bases;
mod calculator_light;
mod cell_functions;
mod clustered;
mod compare;
mod direct;
mod distance;
mod explicit;
mod first_hits;
mod hot_spot;
mod knit_light;
mod layout;
mod lockstep;
mod physics;
mod placements;
mod plan;
mod planner;
mod primitives;
mod promise;
mod shaders_valid;
mod sides;
mod stability;
mod statistics;
mod tally;
mod thin_cells;
mod tracking;
mod users;
