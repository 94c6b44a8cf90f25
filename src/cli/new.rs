//! `fiberwalk new`.

use super::print;
use fiberwalk::{Error, Result};
use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;

const TEMPLATE: &str = include_str!("../../assets/new.toml");

/// Write a commented cloth file to start from: NAME.toml
#[derive(clap::Args)]
pub struct Arguments {
    /// Name of the cloth; the file is NAME.toml in the working directory
    name: String,
}

/// Run the command.
pub fn run(arguments: &Arguments) -> Result<()> {
    let name = &arguments.name;
    if name.is_empty() || name.chars().any(|c| c.is_control() || "/\\\"".contains(c)) {
        let message = "the name of a cloth must not be empty or have slashes, quotes or control characters";
        return Err(Error::Input(message.into()));
    }
    let path = PathBuf::from(format!("{name}.toml"));
    // Never write over a file.
    let mut file = File::create_new(&path).map_err(|source| match source.kind() {
        io::ErrorKind::AlreadyExists => Error::Input(format!("{} exists already; choose another name", path.display())),
        _ => Error::File { action: "write the cloth file", path: path.clone(), source },
    })?;
    let written = file.write_all(TEMPLATE.replace("NAME", name).as_bytes());
    written.map_err(|source| Error::File { action: "write the cloth file", path: path.clone(), source })?;
    print(&format!("{}\n", path.display()))
}
