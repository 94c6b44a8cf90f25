//! The built program: commands, files, bad input, other programs that read what it writes; and the structure of its source.

#[path = "../common/mod.rs"]
mod common;

mod chart;
mod cli;
mod documented;
mod engines;
mod exports;
mod floors;
mod knit_hairs;
mod memory;
mod replay;
mod robustness;
mod wif;
mod wif_errors;
mod woven_input;
