//! `fiberwalk engines`.

use fiberwalk::gpu::{AdapterSummary, Kind, list};
use fiberwalk::measure::{EngineChoice, choose, self_test};
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
    let adapters = list();
    let mut failures = Vec::new();
    let mut shown = 0;
    for adapter in &adapters {
        if wanted.as_ref().is_some_and(|name| !adapter.name.to_lowercase().contains(name)) {
            continue;
        }
        shown += 1;
        println!("gpu  {}", describe(adapter));
        check(EngineChoice::Gpu, Some(&adapter.name), &mut failures);
    }
    match &wanted {
        Some(_) if shown == 0 => {
            // Let the search itself say what there is.
            choose(EngineChoice::Gpu, arguments.adapter.as_deref())?;
        }
        Some(_) => {}
        None => {
            if adapters.is_empty() {
                println!("gpu  no adapter with the default limits of WebGPU");
            }
            println!("cpu  {}", choose(EngineChoice::Cpu, None)?.adapter);
            check(EngineChoice::Cpu, None, &mut failures);
        }
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
fn check(choice: EngineChoice, adapter: Option<&str>, failures: &mut Vec<String>) {
    let started = Instant::now();
    match choose(choice, adapter).and_then(|engine| self_test(&engine)) {
        Ok(result) => println!(
            "     self-test passed in {:.2} s: direct light off by {:.1} standard errors, {} of the walks differ from f64",
            started.elapsed().as_secs_f64(),
            result.direct_z,
            result.moved
        ),
        Err(error) => {
            println!("     {error}");
            failures.push(format!("{}: {error}", adapter.unwrap_or("cpu")));
        }
    }
}
