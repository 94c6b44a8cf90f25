//! `fiberwalk engines`.

use super::print;
use fiberwalk::gpu::{AdapterSummary, Gpu, Kind, list};
use fiberwalk::measure::self_test;
use fiberwalk::reference::Reference;
use fiberwalk::walk::Engine;
use fiberwalk::{Error, Result};
use std::time::Instant;

/// List adapters with their limits, and check that each engine gives right answers on this machine
#[derive(clap::Args)]
pub struct Arguments {
    /// Only this adapter: its number, its name, or a part of its description
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

/// Run the command.
pub fn run(arguments: &Arguments) -> Result<()> {
    let mut failures = Vec::new();
    let adapters = list();
    let wanted = match &arguments.adapter {
        Some(name) => Some(Gpu::open(Some(name))?.adapter()),
        None => None,
    };
    for (place, found) in adapters.iter().enumerate() {
        let adapter = &found.summary;
        if wanted.as_ref().is_some_and(|wanted| *wanted != adapter.description) {
            continue;
        }
        print(&format!("gpu {}  {}\n", place + 1, describe(adapter)))?;
        match &adapter.unfit {
            Some(why) => print(&format!("     cannot be used: {why}\n"))?,
            None => check(&adapter.name, found.open(), &mut failures)?,
        }
    }
    if wanted.is_none() {
        if adapters.is_empty() {
            print("gpu    no adapter\n")?;
        }
        print(&format!("cpu    {}\n", Reference.adapter()))?;
        check("cpu", Ok(Reference), &mut failures)?;
    }
    if failures.is_empty() { Ok(()) } else { Err(Error::Failed(failures.join("; "))) }
}

fn describe(adapter: &AdapterSummary) -> String {
    let kind = match adapter.kind {
        Kind::Hardware => "graphics processor",
        Kind::Software => "software, on the processor",
    };
    let limits = &adapter.limits;
    format!(
        "{} ({kind})\n     storage binding {} MiB, uniform binding {} KiB, {} invocations of a workgroup, texture {}",
        adapter.description,
        limits.max_storage_buffer_binding_size >> 20,
        limits.max_uniform_buffer_binding_size >> 10,
        limits.max_compute_invocations_per_workgroup,
        limits.max_texture_dimension_2d,
    )
}

/// Print how a self-test went, and keep its failure.
fn check(name: &str, engine: Result<impl Engine>, failures: &mut Vec<String>) -> Result<()> {
    let started = Instant::now();
    match engine.and_then(|engine| self_test(&engine)) {
        Ok(result) => print(&format!(
            "     self-test passed in {:.2} s: direct light off by {:.1} standard errors, {} of the walks differ from f64\n",
            started.elapsed().as_secs_f64(),
            result.direct_z,
            result.moved
        )),
        Err(error) => {
            failures.push(format!("{name}: {error}"));
            print(&format!("     {error}\n"))
        }
    }
}
