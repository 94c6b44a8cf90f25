//! `fiberwalk engines`.

use super::print;
use fiberwalk::gpu::{AdapterSummary, Gpu, Kind, list};
use fiberwalk::measure::{EngineChoice, choose, self_test};
use fiberwalk::reference::Reference;
use fiberwalk::walk::Engine;
use fiberwalk::{Error, Result};
use std::time::Instant;

/// List adapters with their limits, and check that each engine gives right answers on this machine
#[derive(clap::Args)]
pub struct Arguments {
    /// Only adapters with this in their name, and not the cpu engine
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

/// Run the command.
pub fn run(arguments: &Arguments) -> Result<()> {
    let wanted = arguments.adapter.as_ref().map(|name| name.to_lowercase());
    let mut failures = Vec::new();
    let mut shown = 0;
    for (place, adapter) in list().iter().enumerate() {
        if wanted.as_ref().is_none_or(|name| adapter.name.to_lowercase().contains(name)) {
            shown += 1;
            print(&format!("gpu  {}\n", describe(adapter)))?;
            check(&adapter.name, Gpu::open_listed(place), &mut failures)?;
        }
    }
    if wanted.is_some() && shown == 0 {
        // Let the search itself say what there is.
        choose(EngineChoice::Gpu, arguments.adapter.as_deref())?;
    }
    if wanted.is_none() {
        if shown == 0 {
            print("gpu  no adapter with the default limits of WebGPU\n")?;
        }
        print(&format!("cpu  {}\n", Reference.adapter()))?;
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
