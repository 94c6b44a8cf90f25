//! `fiberwalk engines`.

use super::print;
use fiberwalk::gpu::{AdapterSummary, Gpu, Kind, driver_faults, list, none};
use fiberwalk::measure::{EngineChoice, Figures, choose, figure_name, self_test, standard_rate};
use fiberwalk::reference::Reference;
use fiberwalk::walk::Engine;
use fiberwalk::{Error, Result};
use std::time::Instant;

/// List adapters with their limits, check that each engine gives right answers on this machine, and measure how fast it is
#[derive(clap::Args)]
pub struct Arguments {
    /// Only this adapter: its number, its name, or a part of its description
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

/// Run the command.
pub fn run(arguments: &Arguments) -> Result<()> {
    let mut trials = Trials { figures: Figures::of_user(), ..Trials::default() };
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
        if let Some(why) = &adapter.unfit {
            print(&format!("     cannot be used: {why}\n"))?;
            trials.unfit.push(format!("{} cannot be used: {why}", adapter.name));
            continue;
        }
        match found.open() {
            Ok(gpu) => {
                trials.opened += 1;
                if let Some(passes) = gpu.most_passes() {
                    print(&format!(
                        "     ends the loops of a shader after {passes} passes; dispatches are kept shorter\n"
                    ))?;
                }
                trials.check(&adapter.name, &figure_name("gpu", &adapter.description), &gpu)?;
            }
            Err(error) => {
                print(&format!("     {error}\n"))?;
                trials.unopened.push(format!("{}: {error}", adapter.name));
            }
        }
    }
    if wanted.is_some() {
        return trials.end();
    }
    if adapters.is_empty() {
        print("gpu    no adapter\n")?;
    }
    for fault in driver_faults() {
        print(&format!("driver {} does not load: {}\n", fault.file.display(), fault.reason))?;
    }
    print(&format!("cpu    {}\n", Reference.adapter()))?;
    trials.check("cpu", &figure_name("cpu", &Reference.adapter()), &Reference)?;
    let auto = choose(EngineChoice::Auto, None)?;
    print(&format!("auto   {} on {}; {}\n", auto.name, auto.adapter, auto.grounds.reason))?;
    trials.end()
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

/// How trials of engines went.
#[derive(Default)]
struct Trials {
    figures: Figures,
    /// Adapters that gave a device.
    opened: u32,
    /// Adapters that keep less than the default limits, and which.
    unfit: Vec<String>,
    /// Adapters that gave none, and why.
    unopened: Vec<String>,
    /// Engines that failed at a trial, and how.
    failures: Vec<String>,
}

impl Trials {
    /// Print how a self-test went and how fast the engine is; keep its failure, or its figure for later choices.
    fn check(&mut self, name: &str, figure: &str, engine: &dyn Engine) -> Result<()> {
        let started = Instant::now();
        let result = match self_test(engine) {
            Ok(result) => result,
            Err(error) => return self.fail(name, &error),
        };
        print(&format!(
            "     self-test passed in {:.2} s: direct light off by {:.1} standard errors, {} of the walks differ from f64\n",
            started.elapsed().as_secs_f64(),
            result.direct_z,
            result.most_moved()
        ))?;
        match standard_rate(engine).and_then(|rate| self.figures.keep(figure, rate)) {
            Ok(rate) => print(&format!("     standard run: {rate:.2e} walks a second\n")),
            Err(error) => self.fail(name, &error),
        }
    }

    fn fail(&mut self, name: &str, error: &Error) -> Result<()> {
        self.failures.push(format!("{name}: {error}"));
        print(&format!("     {error}\n"))
    }

    /// Whether all is well; the device is at fault where no adapter works at all.
    fn end(&self) -> Result<()> {
        if self.opened == 0 && self.failures.is_empty() {
            return Err(none(&[&self.unfit[..], &self.unopened].concat()));
        }
        let faults = [&self.failures[..], &self.unopened].concat();
        if faults.is_empty() { Ok(()) } else { Err(Error::Failed(faults.join("; "))) }
    }
}
