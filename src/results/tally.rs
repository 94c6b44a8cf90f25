//! `tally.exr`: the integers of a run, from which every other file can be made again.

use super::about::About;
use super::exr::{layer, write_parts};
use crate::bsdf::Bsdf;
use crate::error::{Error, Result};
use crate::explicit::StraightRays;
use crate::goniometer::{BinLayout, Counts, Coverage, Moments, Outcome, Straight, Tally, Weights};
use crate::scene::Packing;
use exr::prelude::*;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io;
use std::path::Path;

/// Name of the file in a result folder.
pub const TALLY: &str = "tally.exr";
/// Outcomes with a part of their own.
const OUTCOMES: [(&str, Outcome); 3] =
    [("direct", Outcome::Direct), ("lost", Outcome::Lost), ("ended", Outcome::Ended)];

/// A tally and what it is of.
#[derive(Clone, Debug, PartialEq)]
pub struct Stored {
    /// What it is of.
    pub about: About,
    /// The integers.
    pub tally: Tally,
}

/// The attribute of the file.
#[derive(Serialize, Deserialize)]
struct Attribute {
    #[serde(flatten)]
    about: About,
    /// Units of one walk's light.
    unit: u64,
    counts: Counts,
    walks: Coverage,
    /// By start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    straight: Option<Vec<Straight>>,
}

impl Stored {
    /// Add another tally of the same cloth, model and instrument, exactly.
    ///
    /// # Errors
    /// [`Error::Input`] names what differs, or the walks that both hold.
    pub fn merge(&mut self, other: &Stored) -> Result<()> {
        let values = [&self.about, &other.about].map(|about| serde_json::to_value(about).unwrap_or_default());
        let differs = values[0].as_object().and_then(|keys| keys.keys().find(|key| values[0][*key] != values[1][*key]));
        if let Some(key) = differs {
            return Err(Error::Input(format!("the tallies differ in `{key}`: only equal measurements can be merged")));
        }
        self.tally.merge(&other.tally)
    }

    /// The table of the tally.
    ///
    /// # Errors
    /// [`Error::Input`] when the incident directions are none.
    pub fn bsdf(&self) -> Result<Bsdf> {
        Ok(Bsdf::new(&self.tally, &self.about.goniometer()?, &self.about.channels))
    }

    /// Walks that set out along one ray through a draw of the fibers; none where walks are independent. Of walks through the
    /// fibers themselves fewer share a draw than of those along the rays of a medium, for which they are taken.
    pub fn walks_a_ray(&self) -> Option<f64> {
        let is = |key: &str, value: &str| self.about.model[key] == value;
        let explicit = is("medium", "explicit");
        let packing = if is("packing", "separate") && !explicit { Packing::Separate } else { Packing::Random };
        let walks = || StraightRays::walks_a_ray(packing, self.tally.starts(), self.tally.walks_per_incident());
        (explicit || is("first_hit", "fibers")).then(walks)
    }

    /// Read a `tally.exr`, or that of a result folder.
    ///
    /// # Errors
    /// [`Error::File`] when it cannot be read, [`Error::Input`] when it is not what [`write_tally`] makes.
    pub fn read(path: &Path) -> Result<Stored> {
        let path = if path.is_dir() { path.join(TALLY) } else { path.to_owned() };
        let file = |source| Error::File { action: "read the tally", path: path.clone(), source };
        let wrong = |what: &str| Error::Input(format!("{}: not a tally of this program: {what}", path.display()));
        let bytes = std::fs::read(&path).map_err(file)?;
        let reader = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
        let image = reader.from_buffered(io::Cursor::new(bytes)).map_err(|error| wrong(&error.to_string()))?;
        let text = image.layer_data.first().and_then(|layer| layer.attributes.other.get(&Text::from("fiberwalk")));
        let Some(AttributeValue::Text(text)) = text else { return Err(wrong("it has no attribute `fiberwalk`")) };
        let attribute: Attribute = serde_json::from_slice(text.as_slice())
            .map_err(|error| wrong(&format!("attribute `fiberwalk`: {error}")))?;
        let find = |part: &str, name: &str| -> Option<Vec<u32>> {
            let is_named = |layer: &&Layer<_>| layer.attributes.layer_name.as_ref().is_some_and(|known| known == part);
            let channels = &image.layer_data.iter().find(is_named)?.channel_data.list;
            match &channels.iter().find(|channel| channel.name == *name)?.sample_data {
                FlatSamples::U32(samples) => Some(samples.clone()),
                _ => None,
            }
        };
        let stored = Stored::gather(attribute, &find).map_err(|what| wrong(&what))?;
        // A file that was cut or changed shows in its accounts.
        stored.tally.check(stored.tally.walks_per_incident()).map_err(|error| wrong(&error.to_string()))?;
        Ok(stored)
    }

    /// The tally from its images; an error says what is missing or wrong.
    fn gather(
        attribute: Attribute,
        find: &dyn Fn(&str, &str) -> Option<Vec<u32>>,
    ) -> std::result::Result<Stored, String> {
        let Attribute { about, unit, counts, walks, straight } = attribute;
        let (cells, exits) = (about.incident_cells(), about.exit.cells());
        if !walks.is_sound() || about.sides.is_empty() || about.channels.is_empty() || cells == 0 {
            return Err("attribute `fiberwalk` contradicts itself".into());
        }
        let weighed = unit > 1;
        let layout = BinLayout { exit_cells: exits };
        let channels = if weighed { about.channels.len() } else { 1 };
        let starts = about.sides.len() * cells;
        let shares = |all: &Vec<Straight>| all.iter().all(|one| (0.0..=1.0).contains(&one.value) && one.stderr >= 0.0);
        if straight.as_ref().is_some_and(|all| all.len() != starts || !shares(all)) {
            return Err("attribute `fiberwalk` has no share of straight light for each incident cell".into());
        }
        let integers = |part: &str, name: &str, tail: &str, size: usize| -> std::result::Result<Vec<u64>, String> {
            let half = |half: &str| {
                let name = half_name(name, half, tail);
                let missing = || format!("part {part} has no {size} integers {name}");
                find(part, &name).filter(|samples| samples.len() == size).ok_or_else(missing)
            };
            let (low, high) = (half("lo")?, half("hi")?);
            Ok(low.into_iter().zip(high).map(|(low, high)| u64::from(high) << 32 | u64::from(low)).collect())
        };
        let mut bins = Vec::with_capacity(starts * layout.stride());
        let mut moments = Vec::new();
        for side in &about.sides {
            let part = |what: &str| format!("{}.{what}", side.name());
            let tables = [part("reflection"), part("transmission")];
            let of_walks = |part: &String| integers(part, "walks", "", cells * exits);
            let scattered = [of_walks(&tables[0])?, of_walks(&tables[1])?];
            let ends =
                OUTCOMES.map(|(name, outcome)| (integers(&part(name), "walks", "", cells), layout.outcome(outcome)));
            for cell in 0..cells {
                for table in &scattered {
                    bins.extend(&table[cell * exits..(cell + 1) * exits]);
                }
                for (column, _) in &ends {
                    bins.push(column.as_ref().map_err(String::clone)?[cell]);
                }
            }
            if !weighed {
                continue;
            }
            let places = [(&tables[0], exits), (&tables[1], exits), (&part("absorbed"), 1)];
            let mut columns = Vec::new();
            for (name, width) in places {
                for channel in &about.channels {
                    let sums = integers(name, "sum", channel, cells * width)?;
                    columns.push((width, sums, integers(name, "sumsq", channel, cells * width)?));
                }
            }
            for cell in 0..cells {
                for place in columns.chunks(channels) {
                    for bin in cell * place[0].0..(cell + 1) * place[0].0 {
                        moments.extend(
                            place.iter().map(|(_, sum, square)| Moments { sum: sum[bin], square: square[bin] }),
                        );
                    }
                }
            }
        }
        let weights = weighed.then_some(Weights { channels, moments });
        Ok(Stored { about, tally: Tally { coverage: walks, layout, bins, weights, counts, straight } })
    }
}

/// Write `tally.exr`.
pub fn write_tally(file: &mut File, about: &About, tally: &Tally) -> io::Result<()> {
    let attribute = Attribute {
        about: about.clone(),
        unit: tally.unit(),
        counts: tally.counts,
        walks: tally.coverage.clone(),
        straight: tally.straight.clone(),
    };
    // A JSON value has its keys sorted.
    let text = serde_json::to_value(attribute)?.to_string();
    let size = (about.exit.cells(), about.incident_cells());
    write_parts(file, size, parts(about, tally, &text))
}

/// The integers as images.
fn parts(about: &About, tally: &Tally, attribute: &str) -> Layers<AnyChannels<FlatSamples>> {
    let (cells, exits) = (about.incident_cells(), tally.layout.exit_cells);
    let mut parts = Layers::new();
    for (place, side) in about.sides.iter().enumerate() {
        let starts = place * cells..(place + 1) * cells;
        let mut add = |what: &str, width: usize, bins: Vec<(usize, usize)>, counted: bool, weighed: bool| {
            let mut channels = Vec::new();
            if counted {
                let walks = bins.iter().map(|&(start, bin)| tally.of_start(start)[bin]);
                channels.extend(pair("walks", "", walks));
            }
            for (channel, name) in about.channels.iter().enumerate().filter(|_| weighed) {
                let light = |&(start, bin): &(usize, usize)| match bin == 2 * exits {
                    true => tally.absorbed(start, channel),
                    false => tally.light(start, bin, channel),
                };
                let light: Vec<Moments> = bins.iter().map(light).collect();
                channels.extend(pair("sum", name, light.iter().map(|moments| moments.sum)));
                channels.extend(pair("sumsq", name, light.iter().map(|moments| moments.square)));
            }
            let name = format!("{}.{what}", side.name());
            parts.push(layer(&name, (width, bins.len() / width), channels.into_iter(), attribute));
        };
        let table = |first: usize| -> Vec<(usize, usize)> {
            starts.clone().flat_map(|start| (first..first + exits).map(move |bin| (start, bin))).collect()
        };
        add("reflection", exits, table(0), true, true);
        add("transmission", exits, table(exits), true, true);
        for (name, outcome) in OUTCOMES {
            let bin = tally.layout.outcome(outcome);
            add(name, cells, starts.clone().map(|start| (start, bin)).collect(), true, false);
        }
        // Behind the exit cells lies what the fibers kept.
        add("absorbed", cells, starts.clone().map(|start| (start, 2 * exits)).collect(), false, true);
    }
    parts
}

/// The channel of one half, `lo` or `hi`, of numbers.
fn half_name(name: &str, half: &str, tail: &str) -> String {
    if tail.is_empty() { format!("{name}.{half}") } else { format!("{name}.{half}.{tail}") }
}

/// Low and high words of numbers, as two channels.
fn pair(name: &str, tail: &str, numbers: impl Iterator<Item = u64> + Clone) -> [(String, FlatSamples); 2] {
    let half = |half: &str, shift: u32| {
        let words = numbers.clone().map(|number| (number >> shift) as u32).collect();
        (half_name(name, half, tail), FlatSamples::U32(words))
    };
    [half("lo", 0), half("hi", 32)]
}
