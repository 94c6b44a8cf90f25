//! Bad input: what the program says of it, its exit code, and that it leaves nothing behind.

#[path = "../program/mod.rs"]
mod program;

mod fibers;
mod files;
mod instrument;
mod refusals;
mod runs;
