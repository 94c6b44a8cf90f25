//! What the cloth is: a sheet, a weave or a knit.

use super::knit::{Knit, read_knit};
use super::reader::Table;
use super::sheet::{Fiber, MAX_KINDS, Sheet, read_sheet};
use super::weave::{Weave, read_weave};
use super::yarn::{Yarn, read_yarns};
use crate::error::Result;
use std::path::Path;

/// What the cloth is.
#[derive(Clone, Debug, PartialEq)]
pub enum Structure {
    /// A statistically homogeneous sheet.
    Sheet(Sheet),
    /// A woven cloth.
    Weave(Weave),
    /// A knitted cloth.
    Knit(Knit),
}

impl Structure {
    /// Indices of the kinds of fiber that it has, ascending.
    pub fn kinds(&self) -> Vec<usize> {
        match self {
            Structure::Sheet(sheet) => sheet.kinds(),
            Structure::Weave(weave) => weave.kinds(),
            Structure::Knit(knit) => knit.kinds(),
        }
    }

    /// Whether it has yarns whose fibers all run along them, without twist.
    pub fn untwisted(&self) -> bool {
        let yarns = match self {
            Structure::Sheet(_) => return false,
            Structure::Weave(weave) => &weave.yarns,
            Structure::Knit(knit) => std::slice::from_ref(&knit.yarn),
        };
        yarns.iter().all(Yarn::untwisted)
    }

    /// Cells of the grid of directions where the file does not say. Filaments without twist lie in a few directions, which cost
    /// little and whose lobes are sharp; fibers of twisted yarns are spread by their twist.
    pub fn usual_directions(&self) -> u32 {
        match self {
            Structure::Sheet(_) => 1024,
            Structure::Weave(_) | Structure::Knit(_) if self.untwisted() => 16384,
            Structure::Weave(_) | Structure::Knit(_) => 4096,
        }
    }
}

/// Read the one structure that the file describes; files that it names lie in the folder.
pub(super) fn read_structure(root: &Table, fibers: &[Fiber], folder: Option<&Path>) -> Result<Structure> {
    let yarns = || read_yarns(&root.require("yarn")?.table()?, fibers);
    let (structure, name, place) = match (root.get("sheet"), root.get("weave"), root.get("knit")) {
        (Some(sheet), None, None) => {
            if let Some(yarn) = root.get("yarn") {
                return Err(yarn.error("[yarn] belongs to a [weave] or a [knit], and the file has none"));
            }
            (Structure::Sheet(read_sheet(&sheet.table()?, fibers)?), "sheet", root.at(&["sheet", "fibers"]))
        }
        (None, Some(weave), None) => {
            let table = weave.table()?;
            (Structure::Weave(read_weave(&table, yarns()?, folder)?), "weave", Some(weave))
        }
        (None, None, Some(knit)) => (Structure::Knit(read_knit(&knit.table()?, yarns()?)?), "knit", Some(knit)),
        (None, None, None) => return Err(root.error("the file needs a [sheet], a [weave] or a [knit]")),
        (_, weave, knit) => {
            let message = "a cloth is one of [sheet], [weave] and [knit]";
            return Err(knit.or(weave).map_or_else(|| root.error(message), |second| second.error(message)));
        }
    };
    let found = structure.kinds().len();
    if found > MAX_KINDS {
        let message = format!("the {name} has {found} kinds of fiber; allowed: 1 to {MAX_KINDS}");
        return Err(place.map_or_else(|| root.error(&message), |value| value.error(&message)));
    }
    Ok(structure)
}
