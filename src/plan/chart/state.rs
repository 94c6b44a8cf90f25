//! What a chart has measured so far, in a folder: so that it can be interrupted and go on.

use super::super::averaging::Averaged;
use super::super::configuration::Configuration;
use super::engines::Class;
use super::series::{Series, Visit};
use crate::error::{Error, Result};
use crate::goniometer::{BinLayout, Counts, Coverage, Moments, Straight, Tally, Weights};
use crate::results::{About, ResultFolder};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The folder of the state, inside of that of the chart.
const FOLDER: &str = "chart.state";
/// What the chart is of, and how long it has taken.
const HEAD: &str = "chart.json";

/// All that decides what a chart is of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChartAbout {
    /// The cloth, its measurement and the model that it asks for.
    pub about: About,
    /// Seed of the walks.
    pub seed: u64,
    /// Engine classes of media and of fibers, and what they run on.
    pub engines: Vec<(Class, String)>,
}

/// What does not belong to one configuration.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Head {
    chart: ChartAbout,
    /// Seconds spent.
    pub spent: f64,
    /// The averaging part of the error budget, or why there is none; missing before it was measured.
    pub averaging: Option<std::result::Result<Averaged, String>>,
    /// Seconds that the gpu engine needs before its first walk.
    pub opening: f64,
}

impl Head {
    /// What the chart is of.
    pub fn chart(&self) -> &ChartAbout {
        &self.chart
    }
}

/// The state of a chart on disk; every file is written beside its place and moved.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    /// What does not belong to one configuration.
    pub head: Head,
}

impl Store {
    /// Go on with the chart in a folder, or begin one there; `force` leaves nothing of an older one.
    ///
    /// # Errors
    /// [`Error::Input`] when the folder holds a chart of other settings, or one whose state cannot be read;
    /// [`Error::File`] when it cannot be written.
    pub fn open(path: &Path, chart: ChartAbout, force: bool) -> Result<Store> {
        let folder = path.join(FOLDER);
        let shown = path.display();
        let anew = "--force starts anew, -o names another folder";
        if force {
            clear(&folder)?;
        }
        let head = match fs::read_to_string(folder.join(HEAD)) {
            Ok(text) => {
                let unreadable = |error| {
                    Error::Input(format!("{}: not the state of a chart ({error}); {anew}", folder.join(HEAD).display()))
                };
                let head: Head = serde_json::from_str(&text).map_err(unreadable)?;
                if let Some(what) = difference(&head.chart, &chart) {
                    return Err(Error::Input(format!("{shown} holds a chart of {what}: {anew}")));
                }
                head
            }
            Err(source) if source.kind() == std::io::ErrorKind::NotFound => {
                if !force && path.join("chart.csv").exists() {
                    return Err(Error::Input(format!(
                        "{shown} holds a chart that cannot go on, without {FOLDER}: {anew}"
                    )));
                }
                Head { chart, spent: 0.0, averaging: None, opening: 0.0 }
            }
            Err(source) => {
                return Err(Error::File { action: "read the chart's state", path: folder.join(HEAD), source });
            }
        };
        let store = Store { folder, head };
        store.save_head()?;
        Ok(store)
    }

    /// What is known of a configuration.
    ///
    /// # Errors
    /// [`Error::Input`] when its file is not what this program wrote; [`Error::File`] when it cannot be read.
    pub fn load(&self, configuration: Configuration) -> Result<Series> {
        let path = self.folder.join(file_of(&configuration));
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(source) if source.kind() == std::io::ErrorKind::NotFound => return Ok(Series::new(configuration)),
            Err(source) => return Err(Error::File { action: "read the chart's state", path, source }),
        };
        let spoilt = |why: String| {
            Error::Input(format!(
                "{}: not the state of a chart ({why}); remove it, or --force starts anew",
                path.display()
            ))
        };
        let stored: StoredSeries = serde_json::from_str(&text).map_err(|error| spoilt(error.to_string()))?;
        stored.series(configuration).map_err(|error| spoilt(error.to_string()))
    }

    /// Keep what is known of a configuration, and the seconds spent.
    ///
    /// # Errors
    /// [`Error::File`] when it cannot be written; then the state is what it was before.
    pub fn save(&self, series: &Series) -> Result<()> {
        let text = serde_json::to_vec(&StoredSeries::of(series))
            .map_err(std::io::Error::from)
            .map_err(|source| self.failed(source))?;
        ResultFolder::add(&self.folder, &file_of(&series.configuration), |file| file.write_all(&text))?;
        self.save_head()
    }

    /// Keep what does not belong to one configuration.
    ///
    /// # Errors
    /// [`Error::File`] when it cannot be written.
    pub fn save_head(&self) -> Result<()> {
        let text = serde_json::to_vec_pretty(&self.head)
            .map_err(std::io::Error::from)
            .map_err(|source| self.failed(source))?;
        ResultFolder::add(&self.folder, HEAD, |file| file.write_all(&text)).map(|_| ())
    }

    fn failed(&self, source: std::io::Error) -> Error {
        Error::File { action: "write the chart's state", path: self.folder.clone(), source }
    }
}

/// Remove the files of an older state.
fn clear(folder: &Path) -> Result<()> {
    let Ok(entries) = fs::read_dir(folder) else { return Ok(()) };
    for path in entries.filter_map(|entry| entry.ok().map(|entry| entry.path())) {
        if path.extension().is_some_and(|extension| extension == "json") {
            fs::remove_file(&path).map_err(|source| Error::File { action: "remove the old state", path, source })?;
        }
    }
    Ok(())
}

/// In what a chart in a folder differs from the one that is asked for.
fn difference(found: &ChartAbout, asked: &ChartAbout) -> Option<String> {
    let (a, b) = (&found.about, &asked.about);
    let engines = |chart: &ChartAbout| {
        chart
            .engines
            .iter()
            .map(|(class, adapter)| format!("{} on {adapter}", class.name()))
            .collect::<Vec<_>>()
            .join(", ")
    };
    if a.version != b.version {
        Some(format!("version {} of this program", a.version))
    } else if (&a.cloth, &a.weave, &a.absorption) != (&b.cloth, &b.weave, &b.absorption) {
        Some("another cloth".into())
    } else if a.model != b.model {
        Some("another `model`".into())
    } else if a.incident != b.incident {
        Some(format!("other incident directions ({})", a.incident))
    } else if a.exit != b.exit {
        Some(format!("other exit cells ({})", a.exit))
    } else if a.sides != b.sides || a.channels != b.channels {
        Some("other lit sides or channels".into())
    } else if found.seed != asked.seed {
        Some(format!("seed {}", found.seed))
    } else if found.engines != asked.engines {
        Some(format!("other engines ({})", engines(found)))
    } else {
        None
    }
}

/// The file of a configuration; names have letters, digits, spaces, points and signs that every system takes.
fn file_of(configuration: &Configuration) -> String {
    format!("{}.json", configuration.name().replace(' ', "_"))
}

/// A series as its file has it.
#[derive(Serialize, Deserialize)]
struct StoredSeries {
    /// The settings, to see that the name means the same.
    model: Value,
    edge_r: Option<f64>,
    each: Option<u64>,
    made: u64,
    visits: Vec<Visit>,
    preparing: Vec<f64>,
    drawing: f64,
    rays: Option<(u64, u64, f64)>,
    bytes: usize,
    refused: Option<String>,
    blocks: Vec<StoredTally>,
}

impl StoredSeries {
    fn of(series: &Series) -> StoredSeries {
        let Series { configuration, made, visits, preparing, drawing, rays, bytes, refused, blocks } = series;
        StoredSeries {
            model: json!(configuration.model),
            edge_r: configuration.edge,
            each: configuration.each,
            made: *made,
            visits: visits.clone(),
            preparing: preparing.clone(),
            drawing: *drawing,
            rays: *rays,
            bytes: *bytes,
            refused: refused.clone(),
            blocks: blocks.iter().map(StoredTally::of).collect(),
        }
    }

    fn series(self, configuration: Configuration) -> Result<Series> {
        let same = (self.edge_r, self.each) == (configuration.edge, configuration.each);
        if !same || self.model != json!(configuration.model) {
            return Err(Error::Input("it is of other settings".into()));
        }
        let blocks: Vec<Tally> = self.blocks.into_iter().map(StoredTally::tally).collect::<Result<_>>()?;
        blocks.iter().try_for_each(|block| block.check(self.made))?;
        Ok(Series {
            configuration,
            blocks,
            made: self.made,
            visits: self.visits,
            preparing: self.preparing,
            drawing: self.drawing,
            rays: self.rays,
            bytes: self.bytes,
            refused: self.refused,
        })
    }
}

/// A tally as a file of the state has it.
#[derive(Serialize, Deserialize)]
struct StoredTally {
    walks: Coverage,
    exit_cells: usize,
    bins: Vec<u64>,
    channels: Option<usize>,
    /// Pairs of Σq and Σq².
    moments: Vec<(u64, u64)>,
    counts: Counts,
    straight: Option<Vec<Straight>>,
}

impl StoredTally {
    fn of(tally: &Tally) -> StoredTally {
        let moments = tally.weights.iter().flat_map(|weights| &weights.moments);
        StoredTally {
            walks: tally.coverage.clone(),
            exit_cells: tally.layout.exit_cells,
            bins: tally.bins.clone(),
            channels: tally.weights.as_ref().map(|weights| weights.channels),
            moments: moments.map(|moments| (moments.sum, moments.square)).collect(),
            counts: tally.counts,
            straight: tally.straight.clone(),
        }
    }

    fn tally(self) -> Result<Tally> {
        let layout = BinLayout { exit_cells: self.exit_cells };
        let starts = self.bins.len() / layout.stride();
        let moments = self.channels.map_or(0, |channels| starts * (2 * self.exit_cells + 1) * channels);
        let sound = self.bins.len() == starts * layout.stride()
            && self.moments.len() == moments
            && self.straight.as_ref().is_none_or(|straight| straight.len() == starts)
            && self.walks.is_sound();
        if !sound {
            return Err(Error::Input("its counts do not fit together".into()));
        }
        let weights = self.channels.map(|channels| {
            let moments = self.moments.into_iter().map(|(sum, square)| Moments { sum, square }).collect();
            Weights { channels, moments }
        });
        let (coverage, bins, counts, straight) = (self.walks, self.bins, self.counts, self.straight);
        Ok(Tally { coverage, layout, bins, weights, counts, straight })
    }
}
