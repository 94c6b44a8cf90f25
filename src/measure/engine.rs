//! The choice of the engine.

use super::figures::{Figures, standard_rate};
use crate::error::{Error, Result};
use crate::goniometer::{Goniometer, Tally};
use crate::gpu::{self, Found, Gpu, Kind};
use crate::reference::Reference;
use crate::tables::SamplingTables;
use crate::walk::{Engine, WalkPlan};
use serde::Serialize;

/// What the user asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EngineChoice {
    /// A graphics processor; without one, the fastest of software adapters and processor in the standard run.
    #[default]
    Auto,
    /// The WGSL kernel, on whatever adapter there is.
    Gpu,
    /// The f64 engine.
    Cpu,
}

/// An engine and its figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rated {
    /// `gpu` or `cpu`.
    pub engine: &'static str,
    /// The adapter, or the number of threads.
    pub adapter: String,
    /// Walks a second in the standard run, a sheet of depth 4.
    pub walks_per_second: f64,
}

/// Why an engine was chosen.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Grounds {
    /// In words.
    pub reason: String,
    /// What was compared, the fastest first; empty where nothing had to be measured.
    pub compared: Vec<Rated>,
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
    pub grounds: Grounds,
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
/// Where several adapters of one sort are there, or software ones beside the processor, they are ordered by a figure that is
/// measured once and kept in the user's cache folder.
///
/// # Errors
/// [`Error::Device`] when no adapter fits and the choice leaves no other way; [`Error::Input`] when `adapter` comes
/// with the cpu engine.
pub fn choose(choice: EngineChoice, adapter: Option<&str>) -> Result<ChosenEngine> {
    if adapter.is_some_and(|name| name.trim().is_empty()) {
        return Err(Error::Input("--adapter needs a part of an adapter's name; `fiberwalk engines` lists them".into()));
    }
    match (choice, adapter) {
        (EngineChoice::Cpu, None) => Ok(cpu("asked for".into())),
        (EngineChoice::Cpu, Some(_)) => {
            Err(Error::Input("--adapter belongs to the gpu engine, not to --engine cpu".into()))
        }
        // An adapter asked for must not turn into something else.
        (_, Some(name)) => Ok(on(Gpu::open(Some(name))?, format!("asked for by --adapter {name}"))),
        (_, None) => {
            let fit = gpu::list().into_iter().filter(|found| found.summary.unfit.is_none()).collect();
            Search { choice, figures: Figures::of_user(), passed_over: Vec::new() }.best(fit)
        }
    }
}

fn on(gpu: Gpu, reason: String) -> ChosenEngine {
    ChosenEngine {
        name: "gpu",
        adapter: gpu.adapter(),
        hardware: gpu.kind() == Kind::Hardware,
        grounds: Grounds { reason, compared: Vec::new() },
        engine: Box::new(gpu),
    }
}

fn cpu(reason: String) -> ChosenEngine {
    ChosenEngine {
        engine: Box::new(Reference),
        name: "cpu",
        adapter: Reference.adapter(),
        hardware: false,
        grounds: Grounds { reason, compared: Vec::new() },
    }
}

/// The name by which the figure of an adapter, or of the processor, is kept. Software adapters use all threads.
pub fn figure_name(engine: &str, adapter: &str) -> String {
    format!("{engine} on {adapter}; {} threads", rayon::current_num_threads())
}

/// Something that can be opened and rated: an adapter, or something else in a test.
trait Adapter {
    fn description(&self) -> &str;
    fn kind(&self) -> Kind;
    fn rank(&self) -> u8;
    fn open(&self) -> Result<ChosenEngine>;
}

impl Adapter for Found {
    fn description(&self) -> &str {
        &self.summary.description
    }

    fn kind(&self) -> Kind {
        self.summary.kind
    }

    fn rank(&self) -> u8 {
        self.summary.rank
    }

    fn open(&self) -> Result<ChosenEngine> {
        Found::open(self).map(|gpu| on(gpu, String::new()))
    }
}

/// A search for the best engine.
struct Search {
    choice: EngineChoice,
    figures: Figures,
    /// Adapters that failed, and why.
    passed_over: Vec<String>,
}

impl Search {
    /// The best of adapters, which come sorted by rank, and of the processor.
    fn best(mut self, adapters: Vec<impl Adapter>) -> Result<ChosenEngine> {
        for sort in adapters.chunk_by(|a, b| a.rank() == b.rank()) {
            let software = sort[0].kind() == Kind::Software;
            // Software shares the processor with the f64 engine, which may be faster.
            let with_cpu = software && self.choice == EngineChoice::Auto;
            let chosen = if sort.len() > 1 || with_cpu { self.fastest(sort, with_cpu) } else { self.only(&sort[0]) };
            if let Some(mut chosen) = chosen {
                for fault in &self.passed_over {
                    chosen.grounds.reason += &format!("; passed over: {fault}");
                }
                if let Some(trouble) = self.figures.trouble() {
                    chosen.grounds.reason += &format!("; figures cannot be kept: {trouble}");
                }
                return Ok(chosen);
            }
        }
        let error = gpu::none(&self.passed_over);
        if self.choice == EngineChoice::Auto { Ok(cpu(error.to_string())) } else { Err(error) }
    }

    /// The only adapter of its sort.
    fn only(&mut self, adapter: &impl Adapter) -> Option<ChosenEngine> {
        let reason = match (adapter.kind(), self.choice) {
            (Kind::Software, _) => "the best adapter, a software one",
            (_, EngineChoice::Gpu) => "asked for",
            (Kind::Hardware, _) => "the best adapter",
        };
        let mut chosen = self.open(adapter)?;
        chosen.grounds.reason = reason.into();
        Some(chosen)
    }

    fn open(&mut self, adapter: &impl Adapter) -> Option<ChosenEngine> {
        adapter.open().map_err(|error| self.passed_over.push(error.to_string())).ok()
    }

    /// The fastest of several adapters, and of the processor if that is wanted; none where no adapter works.
    fn fastest(&mut self, adapters: &[impl Adapter], with_cpu: bool) -> Option<ChosenEngine> {
        let mut rated: Vec<(Rated, Option<usize>)> = Vec::new();
        for (place, adapter) in adapters.iter().enumerate() {
            let (engine, name) = ("gpu", figure_name("gpu", adapter.description()));
            match self.figures.of(&name, || standard_rate(&adapter.open()?)) {
                Ok(walks_per_second) => {
                    let adapter = adapter.description().to_owned();
                    rated.push((Rated { engine, adapter, walks_per_second }, Some(place)));
                }
                Err(error) => self.passed_over.push(error.to_string()),
            }
        }
        if with_cpu && !rated.is_empty() {
            let (engine, adapter) = ("cpu", Reference.adapter());
            let walks_per_second =
                self.figures.of(&figure_name(engine, &adapter), || standard_rate(&Reference)).unwrap_or_default();
            rated.push((Rated { engine, adapter, walks_per_second }, None));
        }
        rated.sort_by(|(a, _), (b, _)| b.walks_per_second.total_cmp(&a.walks_per_second));
        let compared: Vec<Rated> = rated.iter().map(|(rated, _)| rated.clone()).collect();
        let (place, mut chosen) = rated.iter().enumerate().find_map(|(rank, (_, adapter))| match adapter {
            Some(place) => Some((rank, self.open(&adapters[*place])?)),
            None => Some((rank, cpu(String::new()))),
        })?;
        let others = compared.iter().enumerate().filter(|(other, _)| *other != place);
        let others: Vec<String> = others
            .map(|(_, Rated { engine, adapter, walks_per_second })| {
                format!("{walks_per_second:.1e} of {engine} on {adapter}")
            })
            .collect();
        chosen.grounds.reason = format!(
            "the fastest by the standard run, {:.1e} walks/s against {}",
            compared[place].walks_per_second,
            others.join(", ")
        );
        chosen.grounds.compared = compared;
        Some(chosen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// An adapter that is as fast as it is said to be, and counts how often it is opened.
    struct Said {
        name: &'static str,
        rank: u8,
        works: bool,
        opened: Cell<u32>,
    }

    impl Adapter for &Said {
        fn description(&self) -> &str {
            self.name
        }

        fn kind(&self) -> Kind {
            if self.rank == 4 { Kind::Software } else { Kind::Hardware }
        }

        fn rank(&self) -> u8 {
            self.rank
        }

        fn open(&self) -> Result<ChosenEngine> {
            self.opened.set(self.opened.get() + 1);
            match self.works {
                true => Ok(ChosenEngine { name: "gpu", adapter: self.name.into(), ..cpu(String::new()) }),
                false => Err(Error::Failed(format!("{} is broken", self.name))),
            }
        }
    }

    fn said(name: &'static str, rank: u8) -> Said {
        Said { name, rank, works: true, opened: Cell::new(0) }
    }

    /// A search with figures of adapters, and of the processor under `cpu`.
    fn search(choice: EngineChoice, known: &[(&str, f64)]) -> Search {
        let folder = tempfile::tempdir().expect("a folder");
        let mut figures = Figures::in_folder(Some(folder.path()));
        for (name, figure) in known {
            let name = match *name {
                "cpu" => figure_name("cpu", &Reference.adapter()),
                adapter => figure_name("gpu", adapter),
            };
            figures.keep(&name, *figure).expect("it is sound");
        }
        Search { choice, figures, passed_over: Vec::new() }
    }

    #[test]
    fn the_faster_software_adapter_is_taken_whichever_comes_first() {
        let (slow, fast) = (said("slow", 4), said("fast", 4));
        for adapters in [vec![&slow, &fast], vec![&fast, &slow]] {
            let known = [("slow", 2e5), ("fast", 1e6), ("cpu", 3e5)];
            let chosen = search(EngineChoice::Auto, &known).best(adapters).expect("one works");
            assert_eq!((chosen.name, chosen.adapter.as_str()), ("gpu", "fast"));
            let compared: Vec<&str> = chosen.grounds.compared.iter().map(|rated| rated.adapter.as_str()).collect();
            assert_eq!(compared, ["fast", Reference.adapter().as_str(), "slow"]);
            assert!(chosen.grounds.reason.contains("1.0e6 walks/s against 3.0e5 of cpu"), "{}", chosen.grounds.reason);
        }
        assert_eq!(slow.opened.get(), 0, "a known figure needs no device");
    }

    #[test]
    fn the_processor_is_taken_where_the_only_adapter_is_slower() {
        let slow = said("slow", 4);
        let known = [("slow", 2e5), ("cpu", 3e5)];
        let chosen = search(EngineChoice::Auto, &known).best(vec![&slow]).expect("one works");
        assert_eq!(chosen.name, "cpu");
        let asked = search(EngineChoice::Gpu, &known).best(vec![&slow]).expect("it works");
        assert_eq!((asked.name, asked.grounds.compared.len()), ("gpu", 0));
    }

    #[test]
    fn a_graphics_processor_is_taken_without_a_measurement() {
        let (card, software) = (said("card", 0), said("software", 4));
        let chosen = search(EngineChoice::Auto, &[]).best(vec![&card, &software]).expect("one works");
        assert_eq!((chosen.adapter.as_str(), card.opened.get(), software.opened.get()), ("card", 1, 0));
        assert_eq!(chosen.grounds, Grounds { reason: "the best adapter".into(), compared: Vec::new() });
    }

    #[test]
    fn graphics_processors_of_one_sort_are_compared_among_themselves() {
        let (slow, fast, chip) = (said("slow", 0), said("fast", 0), said("chip", 1));
        let known = [("slow", 2e8), ("fast", 1e9), ("chip", 9e9), ("cpu", 9e9)];
        let chosen = search(EngineChoice::Auto, &known).best(vec![&slow, &fast, &chip]).expect("one works");
        assert_eq!((chosen.adapter.as_str(), chosen.grounds.compared.len(), chip.opened.get()), ("fast", 2, 0));
    }

    #[test]
    fn what_does_not_work_is_passed_over_and_told() {
        let broken = Said { works: false, ..said("broken", 4) };
        let slow = said("slow", 4);
        // Broken although its figure is known, and broken at the measurement.
        for known in [&[("broken", 9e9), ("slow", 1e6), ("cpu", 1e3)][..], &[("slow", 1e6), ("cpu", 1e3)]] {
            let chosen = search(EngineChoice::Auto, known).best(vec![&broken, &slow]).expect("one works");
            assert_eq!(chosen.adapter, "slow");
            assert!(chosen.grounds.reason.ends_with("; passed over: broken is broken"), "{}", chosen.grounds.reason);
        }
        let chosen = search(EngineChoice::Auto, &[("cpu", 1e3)]).best(vec![&broken]).expect("the processor works");
        assert!(
            chosen.name == "cpu" && chosen.grounds.reason.ends_with("broken is broken"),
            "{}",
            chosen.grounds.reason
        );
        let error = search(EngineChoice::Gpu, &[]).best(vec![&broken]).err().expect("none works");
        assert_eq!(error.exit_code(), 3);
    }
}
