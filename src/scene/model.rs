//! `[model]`: how the cloth is modelled.

use super::reader::{Allowed, Document, Table, Value};
use crate::error::Result;
use serde::{Serialize, Serializer};
use toml::de::DeValue;

/// How the next collision is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tracking {
    /// Tentative events at the rate of a majorant, accepted with probability |m × p|: exact for H and h/H.
    NullCollision,
    /// Collisions at the rate H(m) of a table, and fibers accepted with probability |m × p| (the paper).
    Tabulated,
}

/// Where the next flight starts after a hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Placement {
    /// At the hit point (the paper).
    AtHit,
    /// Where light leaves the fiber; collisions come at the rate H of the cell that holds the fiber's axis.
    Carried,
    /// The same, at the rate H/(1 − v) of that cell: fibers that do not overlap.
    CarriedDense,
    /// The same, at the rate H of that cell times e/(1 − c) of the cell of the hit; e is the share of fiber surface that lies
    /// in no other fiber, c the share of the volume that fibers cover.
    CarriedVoid,
}

/// The words of the cloth file.
const PLACEMENTS: [(&str, Placement); 4] = [
    ("at-hit", Placement::AtHit),
    ("carried", Placement::Carried),
    ("carried-dense", Placement::CarriedDense),
    ("carried-void", Placement::CarriedVoid),
];

impl Placement {
    /// Its word in the cloth file.
    pub fn name(self) -> &'static str {
        PLACEMENTS.iter().find(|(_, placement)| *placement == self).map_or("", |(name, _)| name)
    }
}

/// How the fibers of a realization are laid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Packing {
    /// Independently of each other, so that they may overlap.
    #[default]
    Random,
    /// Pushed apart until none runs into another.
    Separate,
}

impl Packing {
    /// How fibers are laid, and whether they overlap, in words.
    pub fn description(self) -> &'static str {
        match self {
            Packing::Random => "laid at random, so they may overlap",
            Packing::Separate => "moved apart, so they do not overlap",
        }
    }
}

/// What the light goes through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Medium {
    /// A statistical medium (the paper).
    #[default]
    Implicit,
    /// The fibers themselves, in many realizations.
    Explicit,
}

/// Where the share of the light comes from that touches no fiber.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direct {
    /// Counted among the walks.
    Walks,
    /// Straight rays through the fibers of realizations; the walks say where the rest goes.
    Straight,
}

/// What walks through a medium meet first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FirstHit {
    /// A fiber of the medium, by a flight like all others.
    Medium,
    /// A fiber of a realization, by a straight ray.
    Fibers,
}

/// What walks through a medium remember after a hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Memory {
    /// Nothing: all fibers are drawn anew (the paper).
    None,
    /// The last flight, where no fiber is, and the fiber that it set out from.
    Flight,
}

/// The model's settings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Model {
    /// What the light goes through.
    pub medium: Medium,
    /// How the next collision is drawn.
    pub tracking: Tracking,
    /// Where the next flight starts.
    pub placement: Placement,
    /// Whether that was asked for; if not, it goes by the packing.
    #[serde(skip)]
    pub placement_chosen: bool,
    /// Whether any setting was asked for that a planner would choose: all but the packing and the length of fibers.
    #[serde(skip)]
    pub chosen: bool,
    /// Where the share of the light comes from that touches no fiber.
    pub direct: Direct,
    /// What walks meet first.
    pub first_hit: FirstHit,
    /// What walks remember after a hit.
    pub memory: Memory,
    /// Whether that was asked for; if not, it goes by the placement.
    #[serde(skip)]
    pub memory_chosen: bool,
    /// How the fibers of a realization are laid.
    pub packing: Packing,
    /// Seed of the realizations, which is that of the run.
    #[serde(skip)]
    pub seed: u64,
    /// Cells of the direction grid, a square number.
    pub directions: u32,
    /// Length of the approximating cylinder over its radius (paper §2); infinite for none, written as null in JSON.
    pub length_over_radius: f64,
    /// Cells of the repeat of a weave or a knit along x, y and z; none for the program's choice.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cells: Option<[u32; 3]>,
    /// Half angle ω in radians of the cone that a direction of a weave or a knit is gathered from (paper §5); none for a sheet.
    #[serde(rename = "cone_deg", serialize_with = "in_degrees", skip_serializing_if = "Option::is_none")]
    pub cone: Option<f64>,
}

/// Seed of a run where nothing else is said.
pub const SEED: u64 = 1;

/// The cone of a cloth of yarns where the file does not say, in radians: directions are kept as they were counted.
const CONE: f64 = 0.0;
const KEYS: [&str; 10] = [
    "tracking",
    "placement",
    "packing",
    "direct",
    "first_hit",
    "memory",
    "directions",
    "length_over_radius",
    "cells",
    "cone_deg",
];
/// The first ones, which a sheet has as well.
const KEYS_OF_SHEETS: usize = 8;

impl Default for Model {
    fn default() -> Model {
        Model {
            medium: Medium::Implicit,
            tracking: Tracking::NullCollision,
            placement: Placement::AtHit,
            placement_chosen: false,
            chosen: false,
            direct: Direct::Walks,
            first_hit: FirstHit::Medium,
            memory: Memory::None,
            memory_chosen: false,
            packing: Packing::Random,
            seed: SEED,
            directions: 1024,
            length_over_radius: f64::INFINITY,
            cells: None,
            cone: None,
        }
    }
}

impl Model {
    /// The settings of a cloth of yarns or a sheet where the file does not say.
    pub fn of(of_yarns: bool) -> Model {
        let mut model = Model::default();
        if of_yarns {
            (model.cone, model.direct, model.first_hit) = (Some(CONE), Direct::Straight, FirstHit::Fibers);
        } else {
            model.packing = Packing::Separate;
        }
        model.settle();
        model
    }

    /// Whether it sends straight rays through realizations.
    pub fn wants_rays(&self) -> bool {
        self.direct == Direct::Straight || self.first_hit == FirstHit::Fibers
    }

    /// The same with first hits and direct light of the medium's own.
    pub fn without_rays(self) -> Model {
        Model { direct: Direct::Walks, first_hit: FirstHit::Medium, ..self }
    }

    /// The placement that comes nearest to fibers of the packing, of those that go with the tracking.
    pub fn usual_placement(&self) -> Placement {
        match (self.tracking, self.packing, self.cone) {
            (Tracking::Tabulated, ..) | (_, Packing::Separate, None) => Placement::AtHit,
            (_, Packing::Random, _) => Placement::Carried,
            (_, Packing::Separate, Some(_)) => Placement::CarriedVoid,
        }
    }

    /// Choose the placement and the memory that are not asked for: the placement that comes nearest to fibers of the packing.
    pub(crate) fn settle(&mut self) {
        if !self.placement_chosen {
            self.placement = self.usual_placement();
        }
        if !self.memory_chosen {
            let remembers = self.cone.is_some() && self.placement != Placement::AtHit;
            self.memory = if remembers { Memory::Flight } else { Memory::None };
        }
    }

    pub(super) fn read(&mut self, table: &Table) -> Result<()> {
        let of_yarns = self.cone.is_some();
        let elsewhere = "belongs to a [weave] or a [knit]; leave it out";
        let (known, planned) = if of_yarns { KEYS.split_at(KEYS.len()) } else { KEYS.split_at(KEYS_OF_SHEETS) };
        table.expect_keys(known, &planned.iter().map(|key| (*key, elsewhere)).collect::<Vec<_>>())?;
        for key in known {
            if let Some(value) = table.get(key) {
                self.set(key, &value)?;
            }
        }
        let culprit = table.get("placement").or_else(|| table.get("memory"));
        match (self.conflict(), culprit) {
            (Some(message), Some(value)) => Err(value.error(message)),
            _ => Ok(()),
        }
    }

    /// Why these settings do not go together, if they do not.
    pub fn conflict(&self) -> Option<String> {
        if self.placement == Placement::AtHit && self.memory == Memory::Flight {
            return Some(
                "`memory` \"flight\" does not go with `placement` \"at-hit\", whose flights set out from inside a fiber; take \"none\", \
                 or placement \"carried\""
                    .into(),
            );
        }
        let carried = self.placement != Placement::AtHit && self.tracking == Tracking::Tabulated;
        carried.then(|| {
            format!(
                "`placement` \"{}\" does not go with `tracking` \"tabulated\", whose table has the cell of the ray and not that \
                 of the fiber's axis; take \"null-collision\", or placement \"at-hit\"",
                self.placement.name()
            )
        })
    }

    /// Replace one setting by a flag's text: `tracking`, `placement`, `packing`, `direct`, `first-hit`, `memory`, `directions`, `cells` (such as
    /// `24x24x8`) or `cone` (in degrees), written as in the file or as a bare word.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) naming the flag, what was found and what is allowed.
    pub fn set_from_flag(&mut self, key: &str, text: &str) -> Result<()> {
        let document = Document { file: format!("--{key}"), source: text };
        let word = || toml::Spanned::new(0..text.len(), DeValue::String(text.into()));
        let value = DeValue::parse(text).unwrap_or_else(|_| word());
        let value = Value::alone(&document, key, &value);
        if self.cone.is_none() && ["cells", "cone"].contains(&key) {
            return Err(value.error("it belongs to a woven or knitted cloth; leave it out"));
        }
        self.set(key, &value)
    }

    fn set(&mut self, key: &str, value: &Value) -> Result<()> {
        self.chosen |= !["packing", "length_over_radius"].contains(&key);
        match key {
            "tracking" => {
                let words = [("null-collision", Tracking::NullCollision), ("tabulated", Tracking::Tabulated)];
                self.tracking = value.choice(&words, &[])?;
            }
            "placement" => {
                self.placement = value.choice(&PLACEMENTS, &[])?;
                self.placement_chosen = true;
            }
            "direct" => {
                self.direct = value.choice(&[("walks", Direct::Walks), ("straight", Direct::Straight)], &[])?;
            }
            "first_hit" | "first-hit" => {
                self.first_hit = value.choice(&[("medium", FirstHit::Medium), ("fibers", FirstHit::Fibers)], &[])?;
            }
            "memory" => {
                self.memory = value.choice(&[("none", Memory::None), ("flight", Memory::Flight)], &[])?;
                self.memory_chosen = true;
            }
            "packing" => {
                self.packing = value.choice(&[("random", Packing::Random), ("separate", Packing::Separate)], &[])?;
            }
            "directions" => self.directions = read_directions(value)?,
            "cells" => self.cells = Some(read_cells(value)?),
            "cone_deg" | "cone" => self.cone = Some(value.number(Allowed::from(0.0, 90.0))?.to_radians()),
            _ if value.is_infinite() => self.length_over_radius = f64::INFINITY,
            _ => {
                let number = value.number(Allowed::from(1.0, 1e9));
                self.length_over_radius = number.map_err(|_| value.expected("inf or a number from 1 to 1000000000"))?;
            }
        }
        self.settle();
        Ok(())
    }
}

/// Write radians as degrees.
fn in_degrees<S: Serializer>(radians: &Option<f64>, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    // Without the noise of the conversion.
    radians.map(|radians| (radians.to_degrees() * 1e9).round() / 1e9).serialize(serializer)
}

fn read_cells(value: &Value) -> Result<[u32; 3]> {
    let what = "three whole numbers [nx, ny, nz] from 1 to 256";
    let cells = match (value.as_array(), value.as_string()) {
        (Some(items), _) => items.iter().map(|item| item.integer(1, 256, what)).collect::<Result<Vec<u32>>>()?,
        // A flag parts them by x.
        (None, Some(word)) => {
            let counts = word.split('x').map(|count| count.parse().ok().filter(|count| (1..=256).contains(count)));
            counts.collect::<Option<Vec<u32>>>().ok_or_else(|| value.expected(what))?
        }
        _ => return Err(value.expected(what)),
    };
    cells.try_into().map_err(|_| value.expected(what))
}

fn read_directions(value: &Value) -> Result<u32> {
    let what = "a square number from 16 to 65536, such as 1024";
    let directions = value.integer(16, 65536, what)?;
    if directions.isqrt().pow(2) == directions { Ok(directions) } else { Err(value.expected(what)) }
}
