//! Where the error of a configuration comes from, part by part.

use super::averaging::{Averaged, Averaging};
use super::configuration::{Configuration, Extent};
use super::trial::Trial;
use crate::bsdf::{Distance, Estimate, block_noise, distance};
use crate::error::Result;
use crate::goniometer::Tally;
use crate::scene::Scene;
use crate::walk::Engine;
use serde::{Deserialize, Serialize};

/// Why there is nothing to hold cells against.
pub(super) const NO_FINER_CELLS: &str = "there are no finer cells";
/// Realizations whose media are held against the medium of their mean.
pub const AVERAGED: u64 = 8;

/// A part of the error, measured by changing one thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    /// Too few walks.
    Noise,
    /// Too few directions, and a cone around them: against four times the directions without a cone.
    Directions,
    /// Cells too large: against half the edge. What finer cells still would change is not in it.
    Cells,
    /// One medium for many realizations: the mean over media of single ones against the medium of their mean.
    Averaging,
    /// What no medium knows of its fibers: the finest medium against the fibers themselves.
    Medium,
    /// All but the noise: the configuration against the fibers themselves.
    Total,
}

impl Part {
    /// All parts, in the order in which they are told.
    pub const ALL: [Part; 6] = [Part::Noise, Part::Directions, Part::Cells, Part::Averaging, Part::Medium, Part::Total];

    /// Its word.
    pub fn name(self) -> &'static str {
        match self {
            Part::Noise => "noise",
            Part::Directions => "directions",
            Part::Cells => "cells",
            Part::Averaging => "averaging",
            Part::Medium => "medium",
            Part::Total => "total",
        }
    }
}

/// A difference as a share of the scattered light, as E tells it, with its standard error and bounds a standard error away.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// How much it is.
    pub value: f64,
    /// Its standard error; where nothing was found, what noise may hide.
    pub stderr: f64,
    /// It a standard error lower, and one higher.
    pub bounds: [f64; 2],
}

impl From<Distance> for Deviation {
    fn from(distance: Distance) -> Deviation {
        let Estimate { value, stderr } = distance.estimate();
        Deviation { value, stderr, bounds: distance.bounds() }
    }
}

impl From<Estimate> for Deviation {
    fn from(Estimate { value, stderr }: Estimate) -> Deviation {
        Deviation { value, stderr, bounds: [(value - stderr).max(0.0), value + stderr] }
    }
}

impl Deviation {
    /// The root of the sum of the squares of two independent ones.
    pub fn with(self, other: Deviation) -> Deviation {
        let value = self.value.hypot(other.value);
        let bounds = [0, 1].map(|i| self.bounds[i].hypot(other.bounds[i]));
        Deviation { value, stderr: bounds[1] - value, bounds }
    }
}

/// One line of the budget.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BudgetPart {
    /// Which part.
    pub part: Part,
    /// What was held against what.
    pub change: String,
    /// How much it is; none where it does not apply or could not be measured.
    pub size: Option<Deviation>,
    /// Why there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
}

/// The error of a configuration by its parts. They do not add up: each is a distance in its own direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Budget {
    /// The configuration.
    pub configuration: String,
    /// Walks of each start that the noise is of.
    pub walks: u64,
    /// The parts, in the order of [`Part::ALL`].
    pub parts: Vec<BudgetPart>,
}

/// Blocks of walks through a configuration that differs from another in one thing, or why there are none.
pub type Blocks<'a> = std::result::Result<&'a [Tally], String>;

/// What a budget is made from: equal numbers of blocks of each.
#[derive(Clone, Debug)]
pub struct Evidence<'a> {
    /// The configuration.
    pub configuration: Configuration,
    /// Its blocks.
    pub base: &'a [Tally],
    /// Those of its refinements, as [`refinements`] has them.
    pub directions: (Configuration, Blocks<'a>),
    /// Of half the edge; none where there are no cells.
    pub cells: (Option<Configuration>, Blocks<'a>),
    /// Of both.
    pub finest: (Configuration, Blocks<'a>),
    /// Of the fibers themselves.
    pub fibers: Blocks<'a>,
    /// Media of single realizations.
    pub averaging: std::result::Result<Averaged, String>,
}

/// The configurations that a budget holds another against: four times the directions and no cone; half the edge, if that can be;
/// and both.
pub fn refinements(base: Configuration, extent: &Extent) -> (Configuration, Option<Configuration>, Configuration) {
    let finer = |configuration: Configuration| {
        configuration.directed((4 * configuration.model.directions).min(1 << 16)).coned(0.0)
    };
    let halved = base.halved(extent);
    (finer(base), halved, finer(halved.unwrap_or(base)))
}

impl Budget {
    /// The budget from blocks of walks.
    ///
    /// # Errors
    /// Those of [`distance`].
    pub fn new(evidence: &Evidence) -> Result<Budget> {
        let Evidence { configuration, base, directions, cells, finest, fibers, averaging } = evidence;
        let name = configuration.name();
        let measured = |a: &Blocks, b: &Blocks| -> Result<std::result::Result<Deviation, String>> {
            Ok(match (a, b) {
                (Ok(a), Ok(b)) => Ok(distance(a, b)?.into()),
                (Err(why), _) | (_, Err(why)) => Err(why.clone()),
            })
        };
        let mut parts = Vec::new();
        let mut add = |part, change: String, size: std::result::Result<Deviation, String>| {
            let (size, missing) = (size.as_ref().ok().copied(), size.err());
            parts.push(BudgetPart { part, change, size, missing });
        };
        let walks = base.iter().map(Tally::walks_per_incident).sum();
        let base = &Ok(*base);
        add(Part::Noise, format!("{walks} walks of each incident direction"), Ok(block_noise(evidence.base)?.into()));
        add(Part::Directions, format!("{name} against {}", directions.0.name()), measured(base, &directions.1)?);
        let finer = cells.0.map_or("half the edge".into(), |configuration| configuration.name());
        add(Part::Cells, format!("{name} against {finer}"), measured(base, &cells.1)?);
        let own = averaging.as_ref().ok().map(|found| Deviation::from(found.of_fibers));
        let off = own.map_or(String::new(), |own| {
            format!(" (off by {:.1} ± {:.1} % against the fibers)", 100.0 * own.value, 100.0 * own.stderr)
        });
        let change = format!("{AVERAGED} media of single realizations{off} against the medium of their mean");
        add(Part::Averaging, change, averaging.clone().map(|found| found.of_mean.into()));
        add(Part::Medium, format!("{} against the fibers", finest.0.name()), measured(&finest.1, fibers)?);
        add(Part::Total, format!("{name} against the fibers"), measured(base, fibers)?);
        Ok(Budget { configuration: name, walks, parts })
    }

    /// Make all walks that the budget of a configuration needs, and the budget: `walks` of each start in each block of every
    /// medium on `engine` and of the fibers themselves. A refinement that is refused for this cloth is left out of it.
    ///
    /// # Errors
    /// Those of the configuration itself and of the fibers, by [`Trial::prepare`] and [`Trial::blocks`].
    pub fn measure(
        scene: &Scene,
        extent: &Extent,
        base: Configuration,
        engine: &dyn Engine,
        seed: u64,
        walks: u64,
    ) -> Result<Budget> {
        let (directions, cells, finest) = refinements(base, extent);
        let blocks = |trial: &Trial| -> Result<Vec<Tally>> {
            let walks = walks.next_multiple_of(trial.step());
            let blocks = trial.blocks(engine, trial.configuration().seed(seed), 0, walks)?;
            Ok(blocks.into_iter().map(|block| block.tally).collect())
        };
        let fibers = blocks(&Trial::prepare(scene, extent, Configuration::usual_fibers(scene))?)?;
        let trial = Trial::prepare(scene, extent, base)?;
        let own = blocks(&trial)?;
        let averaging = Averaging::of(scene, extent, &trial, engine, seed, walks, &fibers);
        drop(trial);
        let refined = |configuration: Option<Configuration>| {
            let configuration = configuration.ok_or(NO_FINER_CELLS)?;
            let trial = Trial::prepare(scene, extent, configuration).map_err(|error| error.to_string())?;
            blocks(&trial).map_err(|error| error.to_string())
        };
        let finer = [Some(directions), cells, Some(finest)].map(refined);
        let [of_directions, of_cells, of_finest] = finer.each_ref().map(|blocks| match blocks {
            Ok(blocks) => Ok(&blocks[..]),
            Err(why) => Err(why.clone()),
        });
        Budget::new(&Evidence {
            configuration: base,
            base: &own,
            directions: (directions, of_directions),
            cells: (cells, of_cells),
            finest: (finest, of_finest),
            fibers: Ok(&fibers),
            averaging,
        })
    }
}
