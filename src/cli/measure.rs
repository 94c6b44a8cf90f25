//! `fiberwalk measure`.

mod notes;
mod planned;
mod watch;

use super::show::{grouped, reciprocity_lines, totals_table};
use super::{one_line, print};
use fiberwalk::goniometer::Goniometer;
use fiberwalk::measure::{
    AgainstFibers, ChosenEngine, EngineChoice, MAX_WALKS, Measurement, Progress, Stop, choose, prepare_explicit,
    prepare_with, run as measure,
};
use fiberwalk::results::{ResultFolder, TALLY};
use fiberwalk::scene::{Medium, Scene, Source};
use fiberwalk::walk::Walker;
use fiberwalk::{Error, Result};
use indicatif::{ProgressBar, ProgressStyle};
use planned::Ready;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use watch::Watch;

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
    /// Stop when noise and expected model error together are at most this share of the scattered light, such as 5%; where the
    /// model is given, the noise alone [default without another rule: 5%]
    #[arg(long, value_name = "SHARE", value_parser = share, allow_hyphen_values = true, group = "stop")]
    tolerance: Option<f64>,
    /// Stop when the walks have taken so long, such as 60s
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true, group = "stop")]
    time: Option<Duration>,
    /// Go by the plan of this result, which has its model, its noise and its engine, and make no pilots: with the same seed and bases the files
    /// are the same
    #[arg(long, value_name = "DIR", conflicts_with_all = ["walks", "tolerance", "time", "model", "packing", "tracking", "placement",
        "direct", "first_hit", "memory", "cells", "directions", "cone"])]
    plan: Option<PathBuf>,
    /// What makes the walks; auto takes a graphics processor, or the fastest of software adapters and the processor
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
    /// Walk through the fibers themselves as well, and through finer media, and say where the error of the model comes from
    #[arg(long)]
    budget: bool,
    /// End with exit code 1 where the tolerance was not kept, or could not be told to be
    #[arg(long)]
    strict: bool,
    /// No notes and no progress, only results and errors
    #[arg(long)]
    quiet: bool,
    /// What the light goes through: implicit, the statistical medium, or explicit, the fibers themselves [default: with
    /// --tolerance, where nothing is said of the medium, what the planner chooses; else implicit]
    #[arg(long, value_enum)]
    model: Option<ModelChoice>,
    /// How fibers are laid: random, where they may overlap, or separate, where they do not
    #[arg(long, value_name = "PACKING")]
    packing: Option<String>,
    /// How the next collision is drawn: null-collision or tabulated
    #[arg(long, value_name = "TRACKING")]
    tracking: Option<String>,
    /// Where the next flight starts, and at which rate it ends: at-hit, carried, carried-dense or carried-void
    #[arg(long, value_name = "PLACEMENT")]
    placement: Option<String>,
    /// Where the light comes from that touches no fiber: walks, or straight, which is rays through realizations [default:
    /// straight for yarns, walks for sheets]
    #[arg(long, value_name = "DIRECT")]
    direct: Option<String>,
    /// What walks meet first: medium, a fiber of the medium, or fibers, a fiber of a realization, by a straight ray [default:
    /// fibers for yarns, medium for sheets]
    #[arg(long, value_name = "FIRST")]
    first_hit: Option<String>,
    /// What walks remember after a hit: none, or flight, the last flight and the fiber that it set out from [default: flight
    /// for yarns, none for sheets and with --placement at-hit]
    #[arg(long, value_name = "MEMORY")]
    memory: Option<String>,
    /// Cells of the repeat of a weave or a knit along x, y and z, such as 24x24x8 [default: edges of two fiber radii, 1.4 of
    /// filaments without twist, opaque ones beside others, at most 2^20 cells]
    #[arg(long, value_name = "CELLS")]
    cells: Option<String>,
    /// Cells of the grid of fiber directions, a square number [default: 1024 of sheets, 4096 of
    /// yarns, 16384 of yarns without twist]
    #[arg(long, value_name = "D", allow_hyphen_values = true)]
    directions: Option<String>,
    /// Half angle in degrees of the cone that a fiber direction of a weave is gathered from [default: 0]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    cone: Option<String>,
    /// Incident directions: N of the disc basis, klems, polar:18x36 (rings × sectors), or a list such as
    /// "[[30, 0], [60, 0]]" (theta, phi in degrees)
    #[arg(long, value_name = "BASIS", allow_hyphen_values = true)]
    incident: Option<String>,
    /// Exit cells: N of the disc basis, klems or polar:18x36 (rings × sectors)
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    exit: Option<String>,
    /// Lit sides: front, back or front,back
    #[arg(long, value_name = "SIDES")]
    sides: Option<String>,
}

pub fn whole(text: &str) -> std::result::Result<u64, String> {
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

pub fn seconds(text: &str) -> std::result::Result<Duration, String> {
    let number: Option<f64> = text.strip_suffix('s').unwrap_or(text).parse().ok();
    let number = number.filter(|seconds| (1e-3..=1e7).contains(seconds));
    number.map(Duration::from_secs_f64).ok_or_else(|| "must be a time from 0.001s to 10000000s, such as 60s".into())
}

#[derive(Clone, Copy, clap::ValueEnum)]
pub enum Choice {
    Auto,
    Gpu,
    Cpu,
}

impl From<Choice> for EngineChoice {
    fn from(choice: Choice) -> EngineChoice {
        match choice {
            Choice::Auto => EngineChoice::Auto,
            Choice::Gpu => EngineChoice::Gpu,
            Choice::Cpu => EngineChoice::Cpu,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum ModelChoice {
    Implicit,
    Explicit,
}

/// Run the command.
pub fn run(arguments: &Arguments) -> Result<()> {
    let started = Instant::now();
    // Check everything that can be wrong before the first walk.
    let source = Source::find(&arguments.cloth)?;
    let mut scene = arguments.apply(Scene::parse(&source)?)?;
    let folder = arguments.folder(&source, Goniometer::new(&scene.measure).starts() as u64)?;
    let mut ready = Ready::new(arguments.stop());
    if let Some(folder) = &arguments.plan {
        ready = arguments.replay(&mut scene, folder)?;
    } else if arguments.model.is_none() && !scene.model.chosen {
        ready = arguments.make_plan(&mut scene, ready)?;
    }
    let plan = ready.plan.take();
    if arguments.strict && plan.is_none() {
        let message =
            "--strict asks whether a tolerance was kept; leave out --walks, --time and what is said of the model";
        return Err(Error::Input(message.into()));
    }
    let mut measurement = match scene.model.medium {
        Medium::Implicit => arguments.through_medium(&mut scene, &source, ready, started)?,
        Medium::Explicit => arguments.through_fibers(&scene, &source, ready, started)?,
    };
    measurement.promise = plan.as_ref().map(|plan| plan.promise(&measurement));
    measurement.plan = plan.map(|plan| plan.summary);
    let mut budget = String::new();
    if arguments.budget {
        budget = arguments.add_budget(&scene, &mut measurement)?;
    }
    let path = folder.path().to_owned();
    folder.write(&scene, &measurement)?;
    let files = ["bsdf.exr", TALLY, "summary.json"].map(|file| format!("{}\n", path.join(file).display())).concat();
    let against = measurement.against.as_ref().map(|against| notes::of_fibers_and_medium(&scene, against));
    let clustering = match scene.model.medium {
        Medium::Implicit => String::new(),
        Medium::Explicit => notes::of_clustering(measurement.clustering.as_ref()),
    };
    let findings = [
        totals_table(&scene, &measurement),
        clustering,
        against.unwrap_or_default(),
        budget,
        reciprocity_lines(&scene, &measurement),
        speed(&measurement),
    ];
    print(&format!("{}\n{files}", findings.concat()))?;
    planned::tell_promise(measurement.promise.as_ref(), arguments.strict)
}

impl Arguments {
    /// Walk through the implicit medium.
    fn through_medium(
        &self,
        scene: &mut Scene,
        source: &Source,
        ready: Ready,
        started: Instant,
    ) -> Result<Measurement> {
        let counting = if self.quiet { ProgressBar::hidden() } else { ProgressBar::new(1000) };
        let style = ProgressStyle::with_template("{bar:30} {percent}% counting the fibers, {eta} left");
        counting.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        let prepared = match ready.prepared {
            Some(prepared) => prepared,
            None => prepare_with(scene, |share| counting.set_position((1000.0 * share) as u64))?,
        };
        counting.finish_and_clear();
        if prepared.gathering.is_some() {
            // Tell the cells that were chosen.
            scene.model.cells = Some(prepared.specific_length.cells.counts);
        }
        let engine = match ready.engine {
            Some(engine) => engine,
            None => self.choose_engine()?,
        };
        let how = [ready.told, notes::of_medium(scene, &prepared, &engine)].concat();
        self.tell(source, scene, how, ready.stop);
        let mut measurement = self.walk(&prepared.with(&engine), &prepared.goniometer, ready.stop, started)?;
        measurement.grounds = Some(engine.grounds);
        let untold = match AgainstFibers::new(scene, &prepared, &measurement.tally, self.seed) {
            Ok(Some(against)) => {
                measurement.against = Some(against);
                None
            }
            Ok(None) => {
                Some("separate ones take too long to be drawn for so many walks; --model explicit draws them".into())
            }
            // The measurement is worth more than the glance.
            Err(error) => Some(error.to_string()),
        };
        if let Some(why) = untold.filter(|_| !self.quiet) {
            eprintln!("{}", one_line(&format!("not held against the fibers: {why}")));
        }
        Ok(measurement)
    }

    /// The engine that was asked for, or the best there is.
    fn choose_engine(&self) -> Result<ChosenEngine> {
        choose(self.engine.into(), self.adapter.as_deref())
    }

    /// Walk through the fibers themselves.
    fn through_fibers(&self, scene: &Scene, source: &Source, ready: Ready, started: Instant) -> Result<Measurement> {
        let asked = match self.engine {
            Choice::Gpu => Some("--engine gpu"),
            _ => self.adapter.as_ref().map(|_| "--adapter"),
        };
        if let Some(flag) = asked {
            let message = format!("{flag} cannot be used with --model explicit, which the cpu engine alone can do");
            return Err(Error::Input(message));
        }
        let (explicit, goniometer) = prepare_explicit(scene)?;
        let how = [ready.told, notes::of_fibers(scene, &explicit, &goniometer)].concat();
        self.tell(source, scene, how, ready.stop);
        let mut measurement = self.walk(&explicit, &goniometer, ready.stop, started)?;
        measurement.clustering = explicit.clustering(&measurement.tally);
        Ok(measurement)
    }

    /// Check the number of walks, and where the results go.
    fn folder(&self, source: &Source, cells: u64) -> Result<ResultFolder> {
        let most = MAX_WALKS / cells;
        if let Some(walks) = self.walks.filter(|walks| *walks > most) {
            let message = format!("--walks {walks} is too many for {cells} incident cells; allowed: 1 to {most}");
            return Err(Error::Input(message));
        }
        let folder = self.output.clone().unwrap_or_else(|| PathBuf::from(&source.stem));
        ResultFolder::prepare(&folder, self.force)
    }

    /// Say what is going to be measured, how, and until when.
    fn tell(&self, source: &Source, scene: &Scene, how: Vec<String>, stop: Stop) {
        if self.quiet {
            return;
        }
        eprintln!("{}", one_line(&format!("{}: {}", source.file, scene.name)));
        how.iter().for_each(|line| eprintln!("{}", one_line(line)));
        let stop =
            notes::of_stop(stop, self.model.is_none() && !scene.model.chosen || scene.model.medium == Medium::Explicit);
        stop.iter().for_each(|line| eprintln!("{line}"));
    }

    /// Make the walks.
    fn walk(&self, walker: &dyn Walker, goniometer: &Goniometer, stop: Stop, started: Instant) -> Result<Measurement> {
        let mut watch = Watch::new();
        let mut show = |progress| watch.show(progress);
        let progress: Option<&mut dyn FnMut(Progress)> = if self.quiet { None } else { Some(&mut show) };
        let measurement = measure(walker, goniometer, self.seed, stop, started, progress)?;
        watch.bar.finish_and_clear();
        Ok(measurement)
    }

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
        scene.model.seed = self.seed;
        let implicit = [
            ("tracking", &self.tracking),
            ("placement", &self.placement),
            ("direct", &self.direct),
            ("first-hit", &self.first_hit),
            ("memory", &self.memory),
            ("cells", &self.cells),
            ("directions", &self.directions),
            ("cone", &self.cone),
        ];
        if self.model == Some(ModelChoice::Explicit) {
            scene.model.medium = Medium::Explicit;
            if let Some((flag, _)) = implicit.iter().find(|(_, text)| text.is_some()) {
                let message =
                    format!("--{flag} belongs to --model implicit; leave it out: the explicit model has no medium");
                return Err(Error::Input(message));
            }
        }
        for (key, text) in implicit.into_iter().chain([("packing", &self.packing)]) {
            if let Some(text) = text {
                scene.model.set_from_flag(key, text)?;
            }
        }
        for (key, text) in [("incident", &self.incident), ("exit", &self.exit), ("sides", &self.sides)] {
            if let Some(text) = text {
                scene.measure.set_from_flag(key, text)?;
            }
        }
        match (scene.model.medium, scene.model.conflict()) {
            (Medium::Implicit, Some(message)) => Err(Error::Input(message)),
            _ => Ok(scene),
        }
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
