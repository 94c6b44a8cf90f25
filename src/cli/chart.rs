//! `fiberwalk chart`.

mod watch;
mod words;

use super::measure::{Choice, seconds, whole};
use super::{one_line, print};
use fiberwalk::plan::Extent;
use fiberwalk::plan::chart::{Chart, ChartAbout, Engines, Progress, Series, Settings, Store, csv, run as make};
use fiberwalk::report::{chart_page, chart_picture};
use fiberwalk::results::{About, ResultFolder};
use fiberwalk::scene::{Medium, Scene, Source};
use fiberwalk::{Error, Result};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;
use watch::Watch;

/// Directions of light where neither file nor flag lists some.
const INCIDENT: &str = "[[3, 35], [30, 20], [60, 12], [60, 55]]";
/// Exit cells along an edge of the disc where no flag says.
const EXIT: &str = "8";

/// Chart speed against accuracy: many ways to model a cloth, timed and held against its fibers
///
/// Writes chart.csv, chart.svg and chart.html. A chart that was interrupted, or has had its time, goes on where it stopped.
#[derive(clap::Args)]
pub struct Arguments {
    /// Cloth file or preset
    cloth: String,
    /// Folder of the chart [default: the file's stem or the preset's name]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Time for the whole chart, that of interrupted runs included, such as 60s
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true, default_value = "120s")]
    time: Duration,
    /// What walks through media: auto takes the processor and the best adapter, cpu or gpu one of them; the fibers themselves are
    /// for the processor
    #[arg(long, value_enum, default_value_t = Choice::Auto)]
    engine: Choice,
    /// Adapter by its number, its name or a part of its description (see `fiberwalk engines`)
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Seed of the random numbers
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = whole, allow_negative_numbers = true)]
    seed: u64,
    /// Start anew, whatever chart the folder holds
    #[arg(long)]
    force: bool,
    /// No notes and no progress, only results and errors
    #[arg(long, conflicts_with = "json")]
    quiet: bool,
    /// The chart as JSON on stdout, no notes and no progress
    #[arg(long)]
    json: bool,
    /// How fibers are laid: random, where they may overlap, or separate, where they do not [default: that of the file; of sheets
    /// separate, of yarns random]
    #[arg(long, value_name = "PACKING")]
    packing: Option<String>,
    /// Incident directions: a list such as "[[30, 0], [60, 0]]" (theta, phi in degrees), or N of the disc basis [default: those
    /// of the file if it lists some, else four]
    #[arg(long, value_name = "BASIS", allow_hyphen_values = true)]
    incident: Option<String>,
    /// Exit cells: N of the disc basis [default: 8]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    exit: Option<String>,
}

/// Run the command.
pub fn run(arguments: &Arguments) -> Result<()> {
    let source = Source::find(&arguments.cloth)?;
    let scene = arguments.apply(Scene::parse(&source)?)?;
    let folder = arguments.output.clone().unwrap_or_else(|| PathBuf::from(&source.stem));
    let engines = Engines::open(arguments.engine.into(), arguments.adapter.as_deref())?;
    let about = ChartAbout { about: About::new(&scene), seed: arguments.seed, engines: engines.names() };
    let mut store = Store::open(&folder, about, arguments.force)?;
    let extent = Extent::of(&scene)?;
    let silent = arguments.quiet || arguments.json;
    if !silent {
        words::notes(&source, &scene, &engines, &store, arguments.time)
            .iter()
            .for_each(|line| eprintln!("{}", one_line(line)));
    }
    let settings =
        Settings { scene: &scene, extent: &extent, engines: &engines, seed: arguments.seed, time: arguments.time };
    let mut watch = (!silent).then(Watch::new);
    let series = make(&settings, &mut store, |store, progress: Progress, series: &[Series]| {
        if let Some(watch) = &mut watch {
            watch.show(&progress);
        }
        // A chart that is interrupted has at least what the last round gave.
        if progress.round {
            if let Some(chart) = Chart::new(&scene, &extent, series, &store.head)? {
                write(&folder, &chart)?;
            }
        }
        Ok(())
    })?;
    if let Some(watch) = watch {
        watch.bar.finish_and_clear();
    }
    let chart = Chart::new(&scene, &extent, &series, &store.head)?
        .ok_or_else(|| Error::Failed("neither the fibers nor the medium could be measured".into()))?;
    let files = write(&folder, &chart)?;
    if arguments.json {
        let text = serde_json::to_string_pretty(&chart).map_err(|error| Error::Failed(error.to_string()))?;
        return print(&(text + "\n"));
    }
    let files: String = files.iter().map(|file| format!("{}\n", file.display())).collect();
    print(&format!("{}\n{files}", words::findings(&chart)))
}

/// Write the table, the picture and the page; each is whole or as it was.
fn write(folder: &Path, chart: &Chart) -> Result<Vec<PathBuf>> {
    let files = [("chart.csv", csv(chart)), ("chart.svg", chart_picture(chart)), ("chart.html", chart_page(chart))];
    let add = |(name, text): &(&str, String)| ResultFolder::add(folder, name, |file| file.write_all(text.as_bytes()));
    files.iter().map(add).collect()
}

impl Arguments {
    /// The scene with the instrument of the chart.
    fn apply(&self, mut scene: Scene) -> Result<Scene> {
        use fiberwalk::scene::Incident;
        let listed = matches!(scene.measure.incident, Incident::List(_));
        if let Some(basis) = self.incident.as_deref().or((!listed).then_some(INCIDENT)) {
            scene.measure.set_from_flag("incident", basis)?;
        }
        scene.measure.set_from_flag("exit", self.exit.as_deref().unwrap_or(EXIT))?;
        if let Some(packing) = &self.packing {
            scene.model.set_from_flag("packing", packing)?;
        }
        scene.model.medium = Medium::Implicit;
        scene.model.seed = self.seed;
        Ok(scene)
    }
}
