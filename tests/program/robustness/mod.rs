//! Bad input: what the program says of it, its exit code, and that it leaves nothing behind.

mod fibers;
mod files;
mod instrument;
mod refusals;
mod runs;
