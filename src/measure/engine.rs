//! The choice of the engine.

use crate::error::{Error, Result};
use crate::goniometer::{Goniometer, Tally};
use crate::gpu::{Gpu, Kind};
use crate::reference::Reference;
use crate::tables::SamplingTables;
use crate::walk::{Engine, WalkPlan};

/// What the user asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EngineChoice {
    /// The best adapter, then a software adapter, then the processor.
    #[default]
    Auto,
    /// The WGSL kernel, on whatever adapter there is.
    Gpu,
    /// The f64 engine.
    Cpu,
}

/// An engine that is ready to run.
pub struct ChosenEngine {
    engine: Box<dyn Engine>,
    /// `gpu` or `cpu`.
    pub name: &'static str,
    /// The adapter, or the number of threads.
    pub adapter: String,
    /// Whether it runs on a graphics processor.
    pub hardware: bool,
    /// Why this one.
    pub reason: String,
}

impl Engine for ChosenEngine {
    fn run(
        &self,
        tables: &SamplingTables,
        goniometer: &Goniometer,
        plan: &WalkPlan,
        progress: &mut dyn FnMut(&Tally),
    ) -> Result<Tally> {
        self.engine.run(tables, goniometer, plan, progress)
    }
}

/// Choose an engine; `adapter` is part of an adapter's name, in any case.
///
/// # Errors
/// [`Error::Device`] when no adapter fits and the choice leaves no other way; [`Error::Input`] when `adapter` comes
/// with the cpu engine.
pub fn choose(choice: EngineChoice, adapter: Option<&str>) -> Result<ChosenEngine> {
    if adapter.is_some_and(|name| name.trim().is_empty()) {
        return Err(Error::Input("--adapter needs a part of an adapter's name; `fiberwalk engines` lists them".into()));
    }
    if choice == EngineChoice::Cpu {
        return match adapter {
            None => Ok(cpu("asked for".into())),
            Some(_) => Err(Error::Input("--adapter belongs to the gpu engine, not to --engine cpu".into())),
        };
    }
    match Gpu::open(adapter) {
        Ok(gpu) => Ok(on(gpu, choice, adapter)),
        // An adapter asked for must not turn into something else.
        Err(error) if choice == EngineChoice::Auto && adapter.is_none() => Ok(cpu(error.to_string())),
        Err(error) => Err(error),
    }
}

fn on(gpu: Gpu, choice: EngineChoice, adapter: Option<&str>) -> ChosenEngine {
    let mut reason = match (gpu.kind(), adapter, choice) {
        (_, Some(name), _) => format!("asked for by --adapter {name}"),
        (Kind::Software, _, _) => "the best adapter, a software one".into(),
        (_, _, EngineChoice::Gpu) => "asked for".into(),
        (Kind::Hardware, _, _) => "the best adapter".into(),
    };
    for skipped in gpu.skipped() {
        reason += &format!("; passed over: {skipped}");
    }
    ChosenEngine {
        name: "gpu",
        adapter: gpu.adapter(),
        hardware: gpu.kind() == Kind::Hardware,
        reason,
        engine: Box::new(gpu),
    }
}

fn cpu(reason: String) -> ChosenEngine {
    ChosenEngine { engine: Box::new(Reference), name: "cpu", adapter: Reference.adapter(), hardware: false, reason }
}
