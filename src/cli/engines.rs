//! `fiberwalk engines`.
use fiberwalk::Result;
/// List the engines
#[derive(clap::Args)]
pub struct Arguments {}
/// Run the command.
pub fn run(_: &Arguments) -> Result<()> {
    Ok(())
}
