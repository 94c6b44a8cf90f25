//! `fiberwalk measure`.

use super::show::{grouped, reciprocity_lines, totals_table};
use super::{one_line, print};
use fiberwalk::distribution::{Gathering, SpecificLength};
use fiberwalk::measure::{
    ChosenEngine, EngineChoice, MAX_WALKS, Measurement, Prepared, Progress, Stop, choose, prepare_with, run as measure,
};
use fiberwalk::results::{ResultFolder, TALLY};
use fiberwalk::scene::{Scene, Source, Structure};
use fiberwalk::{Error, Result};
use indicatif::{ProgressBar, ProgressStyle};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Time between two lines of progress where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Measure the BSDF of a cloth: a result folder with bsdf.exr, tally.exr and summary.json
#[derive(clap::Args)]
pub struct Arguments {
    /// Cloth file, or a preset: charmeuse, denim, dimout, felt, gabardine, jersey, linen, lining, muslin,
    /// nonwoven, rib, sheer, voile
    cloth: String,
    /// Result folder [default: the file's stem or the preset's name]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Stop after so many walks of each incident cell
    #[arg(long, value_name = "N", value_parser = walks, allow_negative_numbers = true, group = "stop")]
    walks: Option<u64>,
    /// Stop when the noise of the scattered light is at most this share, such as 5% [default without another rule: 5%]
    #[arg(long, value_name = "SHARE", value_parser = share, allow_hyphen_values = true, group = "stop")]
    tolerance: Option<f64>,
    /// Stop when the walks have taken so long, such as 60s
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true, group = "stop")]
    time: Option<Duration>,
    /// What makes the walks; auto takes the best adapter, then a software adapter, then the processor
    #[arg(long, value_enum, default_value_t = Choice::Auto)]
    engine: Choice,
    /// Adapter by its number, its name or a part of its description (see `fiberwalk engines`)
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Seed of the random numbers
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = whole, allow_negative_numbers = true)]
    seed: u64,
    /// Replace an existing result
    #[arg(long)]
    force: bool,
    /// No notes and no progress, only results and errors
    #[arg(long)]
    quiet: bool,
    /// How the next collision is drawn: null-collision or tabulated
    #[arg(long, value_name = "TRACKING")]
    tracking: Option<String>,
    /// Where the next flight starts, and at which rate it ends: at-hit, carried, carried-dense or carried-void
    #[arg(long, value_name = "PLACEMENT")]
    placement: Option<String>,
    /// Cells of the repeat of a weave or a knit along x, y and z, such as 24x24x8 [default: edges of two fiber radii, at
    /// most 2^18 cells]
    #[arg(long, value_name = "CELLS")]
    cells: Option<String>,
    /// Cells of the grid of fiber directions, a square number [default: 1024]
    #[arg(long, value_name = "D", allow_hyphen_values = true)]
    directions: Option<String>,
    /// Half angle in degrees of the cone that a fiber direction of a weave is gathered from [default: 2]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    cone: Option<String>,
    /// Incident directions: N of the disc basis, or a list such as "[[30, 0], [60, 0]]" (theta, phi in degrees)
    #[arg(long, value_name = "BASIS", allow_hyphen_values = true)]
    incident: Option<String>,
    /// Exit cells: N of the disc basis
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    exit: Option<String>,
    /// Lit sides: front, back or front,back
    #[arg(long, value_name = "SIDES")]
    sides: Option<String>,
}

fn whole(text: &str) -> std::result::Result<u64, String> {
    text.parse().map_err(|_| format!("must be a whole number from 0 to {}", u64::MAX))
}

fn walks(text: &str) -> std::result::Result<u64, String> {
    let number = whole(text).ok().filter(|number| (1..=MAX_WALKS).contains(number));
    number.ok_or_else(|| format!("must be a whole number from 1 to {MAX_WALKS}"))
}

pub fn share(text: &str) -> std::result::Result<f64, String> {
    let number = match text.strip_suffix('%') {
        Some(percent) => percent.parse().ok().map(|percent: f64| percent / 100.0),
        None => text.parse().ok(),
    };
    let number = number.filter(|share| (1e-5..=1.0).contains(share));
    number.ok_or_else(|| "must be a share from 0.001% to 100%, such as 5% or 0.05".into())
}

fn seconds(text: &str) -> std::result::Result<Duration, String> {
    let number: Option<f64> = text.strip_suffix('s').unwrap_or(text).parse().ok();
    let number = number.filter(|seconds| (1e-3..=1e7).contains(seconds));
    number.map(Duration::from_secs_f64).ok_or_else(|| "must be a time from 0.001s to 10000000s, such as 60s".into())
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Choice {
    Auto,
    Gpu,
    Cpu,
}

/// Run the command.
pub fn run(arguments: &Arguments) -> Result<()> {
    let started = Instant::now();
    let note = |text: &str| {
        if !arguments.quiet {
            eprintln!("{}", one_line(text));
        }
    };
    // Check everything that can be wrong before the first walk.
    let source = Source::find(&arguments.cloth)?;
    let mut scene = arguments.apply(Scene::parse(&source)?)?;
    let counting = if arguments.quiet { ProgressBar::hidden() } else { ProgressBar::new(1000) };
    let style = ProgressStyle::with_template("{bar:30} {percent}% counting the fibers, {eta} left");
    counting.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let prepared = prepare_with(&scene, |share| counting.set_position((1000.0 * share) as u64))?;
    counting.finish_and_clear();
    if prepared.gathering.is_some() {
        // Tell the cells that were chosen.
        scene.model.cells = Some(prepared.specific_length.cells.counts);
    }
    let cells = prepared.goniometer.starts() as u64;
    let most = MAX_WALKS / cells;
    if let Some(walks) = arguments.walks.filter(|walks| *walks > most) {
        let message = format!("--walks {walks} is too many for {cells} incident cells; allowed: 1 to {most}");
        return Err(Error::Input(message));
    }
    let folder = arguments.output.clone().unwrap_or_else(|| PathBuf::from(&source.stem));
    let folder = ResultFolder::prepare(&folder, arguments.force)?;
    let choice = match arguments.engine {
        Choice::Auto => EngineChoice::Auto,
        Choice::Gpu => EngineChoice::Gpu,
        Choice::Cpu => EngineChoice::Cpu,
    };
    let engine = choose(choice, arguments.adapter.as_deref())?;
    let stop = arguments.stop();
    describe(&source, &scene, &prepared, &engine, stop).iter().for_each(|line| note(line));
    let mut watch = Watch::new();
    let mut show = |progress| watch.show(progress);
    let progress: Option<&mut dyn FnMut(Progress)> = if arguments.quiet { None } else { Some(&mut show) };
    let measurement = measure(&prepared, &engine, arguments.seed, stop, started, progress)?;
    watch.bar.finish_and_clear();

    let path = folder.path().to_owned();
    folder.write(&scene, &measurement)?;
    let files = ["bsdf.exr", TALLY, "summary.json"].map(|file| format!("{}\n", path.join(file).display())).concat();
    let findings =
        [totals_table(&scene, &measurement), reciprocity_lines(&scene, &measurement), speed(&measurement)].concat();
    print(&format!("{findings}\n{files}"))
}

/// What is going to be measured, how, and until when.
fn describe(source: &Source, scene: &Scene, prepared: &Prepared, engine: &ChosenEngine, stop: Stop) -> Vec<String> {
    let depth = prepared.tables.depth();
    let mut lines = vec![format!("{}: {}", source.file, scene.name)];
    if let Some(gathering) = &prepared.gathering {
        lines.extend(woven(prepared, gathering));
    }
    if let Structure::Sheet(sheet) = &scene.structure {
        let mass = sheet.areal_mass(&scene.fibers).map(|mass| format!(", {mass:.0} g/m²")).unwrap_or_default();
        let fraction = sheet.volume_fraction(&scene.fibers);
        lines.push(format!("medium: optical depth at most {depth:.1}, fibers fill {fraction:.3}{mass}"));
    }
    if prepared.specific_length.spread_error > 0.0 {
        lines.push(format!(
            "directions: a grid of {} smears the spread bundles; the largest error of H found is {:.2} %",
            scene.model.directions,
            100.0 * prepared.specific_length.spread_error
        ));
    }
    if let Some(visible) = &prepared.tables.visible {
        let (n, percent) = (visible.n, 100.0 * visible.error);
        lines
            .push(format!("tracking: a table of H for {n} × {n} rays; the largest error of H found is {percent:.2} %"));
    }
    lines.push(format!("engine: {} on {}; {}", engine.name, engine.adapter, engine.reason));
    if let Stop::Tolerance(tolerance) = stop {
        let percent = (1e8 * tolerance).round() / 1e6;
        lines.push(format!("stop: at a noise of {percent} % of the scattered light; the model's error is not in it"));
    }
    lines
}

/// The cells of a woven cloth.
fn woven(prepared: &Prepared, gathering: &Gathering) -> Vec<String> {
    let SpecificLength { cells, lists, .. } = &prepared.specific_length;
    let [nx, ny, nz] = cells.counts;
    let Gathering { realizations, error, volume_fraction, largest_fraction, filled, .. } = gathering;
    let mut lines = vec![
        format!(
            "cells: {nx} × {ny} × {nz}, {} of {} hold fiber, which fills {volume_fraction:.3} of the cloth and at most \
             {largest_fraction:.2} of a cell; {} lists of directions",
            grouped(*filled as u64),
            grouped(cells.len() as u64),
            grouped(lists.len() as u64)
        ),
        format!("counted: {realizations} realizations, standard error of the densities {:.1} %", 100.0 * error),
    ];
    lines.extend(gathering.warning().map(|warning| format!("warning: {warning}")));
    lines
}

impl Arguments {
    /// The rule that was given, or a noise of 5 %.
    fn stop(&self) -> Stop {
        match (self.walks, self.time) {
            (Some(walks), _) => Stop::Walks(walks),
            (_, Some(time)) => Stop::Time(time),
            _ => Stop::Tolerance(self.tolerance.unwrap_or(0.05)),
        }
    }

    /// Let the flags have their way over the file.
    fn apply(&self, mut scene: Scene) -> Result<Scene> {
        let model = [
            ("tracking", &self.tracking),
            ("placement", &self.placement),
            ("cells", &self.cells),
            ("directions", &self.directions),
            ("cone", &self.cone),
        ];
        for (key, text) in model {
            if let Some(text) = text {
                scene.model.set_from_flag(key, text)?;
            }
        }
        for (key, text) in [("incident", &self.incident), ("exit", &self.exit), ("sides", &self.sides)] {
            if let Some(text) = text {
                scene.measure.set_from_flag(key, text)?;
            }
        }
        Ok(scene)
    }
}

/// Shows how far a run has come: a bar on a terminal, now and then a line elsewhere.
struct Watch {
    bar: ProgressBar,
    line_due: Instant,
}

impl Watch {
    fn new() -> Watch {
        let template = "{bar:30} {percent}% {msg}, {eta} left";
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        Watch { bar: ProgressBar::new(1).with_style(style), line_due: Instant::now() + LINE_EVERY }
    }

    fn show(&mut self, progress: Progress) {
        let rate = progress.walks as f64 / self.bar.elapsed().as_secs_f64();
        let message = format!("{rate:.2e} walks/s, noise {:.1} %", 100.0 * progress.noise);
        if self.bar.is_hidden() && Instant::now() >= self.line_due {
            self.line_due += LINE_EVERY;
            let planned = progress.planned.unwrap_or(progress.walks);
            let share = progress.walks as f64 / planned as f64;
            let left = planned.saturating_sub(progress.walks) as f64 / rate;
            eprintln!("{:.0} % done, {message}, {left:.0} s left", 100.0 * share);
        }
        if let Some(planned) = progress.planned {
            self.bar.set_length(planned.max(progress.walks));
        }
        self.bar.set_position(progress.walks);
        self.bar.set_message(message);
    }
}

fn speed(measurement: &Measurement) -> String {
    let Measurement { tally, seconds, .. } = measurement;
    let rate = tally.counts.launched as f64 / seconds.walk;
    let noise = fiberwalk::bsdf::noise(tally);
    format!(
        "{} walks, {} collisions in {:.1} s ({rate:.2e} walks/s), noise of the scattered light {}",
        grouped(tally.counts.launched),
        grouped(tally.counts.collisions),
        seconds.total,
        if noise.is_finite() { format!("{:.2} %", 100.0 * noise) } else { "unknown: nothing scattered".into() },
    )
}
