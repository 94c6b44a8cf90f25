//! The command line: one file per command, arguments → library calls → text.
//!
//! Results go to stdout, all else to stderr.

mod chart;
mod compare;
mod curves;
mod engines;
mod export;
mod inspect;
mod measure;
mod new;
mod show;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};
use fiberwalk::{Error, Result};
use std::io::{self, Write};

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
    Measure(Box<measure::Arguments>),
    Inspect(inspect::Arguments),
    Chart(chart::Arguments),
    Compare(compare::Arguments),
    Curves(curves::Arguments),
    Engines(engines::Arguments),
    Export(export::Arguments),
    New(new::Arguments),
}

/// Read the arguments and do what they say.
pub fn run() -> Result<()> {
    match parse()?.command {
        Command::Measure(arguments) => measure::run(&arguments),
        Command::Chart(arguments) => chart::run(&arguments),
        Command::Inspect(arguments) => inspect::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Curves(arguments) => curves::run(&arguments),
        Command::Engines(arguments) => engines::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::New(arguments) => new::run(&arguments),
    }
}

/// Read the arguments; help and version end the program here.
fn parse() -> Result<Arguments> {
    Arguments::try_parse().map_err(|error| match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            error.exit()
        }
        _ => Error::Input(complaint(&error.to_string())),
    })
}

/// What was wrong and the tip, on one line; the usage is left to --help.
fn complaint(text: &str) -> String {
    let text = text.strip_prefix("error: ").unwrap_or(text);
    let end = |line: &&str| line.starts_with("Usage:") || line.starts_with("For more information");
    let lines = text.lines().map(str::trim).take_while(|line| !end(line)).filter(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join("; ").replace(":; ", ": ")
}

/// A text from outside with control characters made visible, so that it stays on its line.
pub fn one_line(text: &str) -> String {
    let visible = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
    text.chars().map(visible).collect()
}

/// Write results to stdout; a reader that has seen enough is no error.
fn print(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(source) if source.kind() != io::ErrorKind::BrokenPipe => {
            Err(Error::File { action: "write the results", path: "stdout".into(), source })
        }
        _ => Ok(()),
    }
}
