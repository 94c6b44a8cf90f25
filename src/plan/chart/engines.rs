//! The engines that a chart is timed on.

use crate::error::Result;
use crate::measure::{ChosenEngine, EngineChoice, choose};
use crate::walk::Engine;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Engines that are compared among themselves only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Class {
    /// All cores in f64: media and the fibers themselves.
    Cpu,
    /// The WGSL kernel: media only.
    Gpu,
}

impl Class {
    /// `cpu` or `gpu`.
    pub fn name(self) -> &'static str {
        match self {
            Class::Cpu => "cpu",
            Class::Gpu => "gpu",
        }
    }
}

/// The engines at hand.
pub struct Engines {
    /// For the fibers themselves, and for media unless the gpu engine alone is asked for.
    pub cpu: ChosenEngine,
    /// For media; none where there is no adapter or none is asked for.
    pub gpu: Option<ChosenEngine>,
    /// Why there is no gpu engine, if one might have been.
    pub without: Option<String>,
    /// Seconds that it took to open the gpu engine.
    pub opening: f64,
    media_on_cpu: bool,
}

impl Engines {
    /// The processor, and an adapter unless `choice` is the cpu engine.
    ///
    /// # Errors
    /// Those of [`choose`].
    pub fn open(choice: EngineChoice, adapter: Option<&str>) -> Result<Engines> {
        let started = Instant::now();
        let cpu = choose(EngineChoice::Cpu, if choice == EngineChoice::Cpu { adapter } else { None })?;
        let (gpu, without) = match choice {
            EngineChoice::Cpu => (None, None),
            EngineChoice::Gpu => (Some(choose(EngineChoice::Gpu, adapter)?), None),
            EngineChoice::Auto => match choose(EngineChoice::Auto, adapter)? {
                engine if engine.name == Class::Gpu.name() => (Some(engine), None),
                engine => (None, Some(engine.grounds.reason)),
            },
        };
        let opening = started.elapsed().as_secs_f64();
        Ok(Engines { cpu, gpu, without, opening, media_on_cpu: choice != EngineChoice::Gpu })
    }

    /// The classes that walk through media.
    pub fn of_media(&self) -> Vec<Class> {
        let classes = [(Class::Cpu, self.media_on_cpu), (Class::Gpu, self.gpu.is_some())];
        classes.into_iter().filter(|(_, there)| *there).map(|(class, _)| class).collect()
    }

    /// The engine of a class; the processor where there is no other.
    pub fn of(&self, class: Class) -> &dyn Engine {
        match (class, &self.gpu) {
            (Class::Gpu, Some(gpu)) => gpu,
            _ => &self.cpu,
        }
    }

    /// Classes and what they run on.
    pub fn names(&self) -> Vec<(Class, String)> {
        let gpu = self.gpu.iter().map(|gpu| (Class::Gpu, gpu.adapter.clone()));
        std::iter::once((Class::Cpu, self.cpu.adapter.clone())).chain(gpu).collect()
    }
}
