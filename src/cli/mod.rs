//! The command line: one file per command, arguments → library calls → text.
//!
//! Results go to stdout, all else to stderr.

mod engines;
mod measure;
mod show;

use clap::{Parser, Subcommand};
use fiberwalk::Result;

/// The BSDF of a cloth from its fibers, every value with its standard error.
///
/// Exit codes: 0 done, 1 a check failed, 2 the input is wrong, 3 the device cannot do it.
#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Measure(measure::Arguments),
    Engines(engines::Arguments),
}

/// Read the arguments and do what they say.
pub fn run() -> Result<()> {
    match Arguments::parse().command {
        Command::Measure(arguments) => measure::run(&arguments),
        Command::Engines(arguments) => engines::run(&arguments),
    }
}
