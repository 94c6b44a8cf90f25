//! What the cloth is: a sheet or a weave.

use super::reader::Table;
use super::sheet::{Fiber, MAX_KINDS, Sheet, read_sheet};
use super::weave::{Weave, read_weave};
use super::yarn::read_yarns;
use crate::error::Result;
use std::path::Path;

/// What the cloth is.
#[derive(Clone, Debug, PartialEq)]
pub enum Structure {
    /// A statistically homogeneous sheet.
    Sheet(Sheet),
    /// A woven cloth.
    Weave(Weave),
}

impl Structure {
    /// Indices of the kinds of fiber that it has, ascending.
    pub fn kinds(&self) -> Vec<usize> {
        match self {
            Structure::Sheet(sheet) => sheet.kinds(),
            Structure::Weave(weave) => weave.kinds(),
        }
    }
}

/// Read the one structure that the file describes; files that it names lie in the folder.
pub(super) fn read_structure(root: &Table, fibers: &[Fiber], folder: Option<&Path>) -> Result<Structure> {
    let (structure, name, place) = match (root.get("sheet"), root.get("weave")) {
        (Some(_), Some(weave)) => return Err(weave.error("a cloth is a [sheet] or a [weave], not both")),
        (None, None) => return Err(root.error("the file needs a [sheet] or a [weave]")),
        (Some(sheet), None) => {
            if let Some(yarn) = root.get("yarn") {
                return Err(yarn.error("[yarn] belongs to a [weave], and the file has none"));
            }
            (Structure::Sheet(read_sheet(&sheet.table()?, fibers)?), "sheet", root.at(&["sheet", "fibers"]))
        }
        (None, Some(weave)) => {
            let table = weave.table()?;
            let yarns = read_yarns(&root.require("yarn")?.table()?, fibers)?;
            (Structure::Weave(read_weave(&table, yarns, folder)?), "weave", Some(weave))
        }
    };
    let found = structure.kinds().len();
    if found > MAX_KINDS {
        let message = format!("the {name} has {found} kinds of fiber; allowed: 1 to {MAX_KINDS}");
        return Err(place.map_or_else(|| root.error(&message), |value| value.error(&message)));
    }
    Ok(structure)
}
