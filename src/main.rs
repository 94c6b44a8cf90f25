//! The program `fiberwalk`: see the library's documentation for what it computes.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    match cli::run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", cli::one_line(&error.to_string()));
            ExitCode::from(error.exit_code())
        }
    }
}
