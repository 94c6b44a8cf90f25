//! From a file name to a checked scene.

use super::absorption::{Absorption, Channels, Clash, resolve};
use super::measure::Measure;
use super::model::Model;
use super::presets::{PRESETS, preset};
use super::reader::{Document, Table, Value, closest};
use super::sheet::{Fiber, Sheet, read_fibers};
use super::structure::{Structure, read_structure};
use crate::error::{Error, Result};
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use toml::de::DeTable;

/// No cloth file is as long as this, in bytes.
const MAX_BYTES: u64 = 1 << 20;

/// A cloth file's text and where it came from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The file as the user named it, or `preset NAME`.
    pub file: String,
    /// The file's stem or the preset's name: the default name of the result folder.
    pub stem: String,
    /// The TOML text.
    pub text: String,
    /// Where files that it names lie; none for a preset.
    pub folder: Option<PathBuf>,
}

impl Source {
    /// Read a cloth file, or take a preset by its name. A file of that name goes first.
    ///
    /// # Errors
    /// [`Error::File`] when a file cannot be read, [`Error::Input`] when there is neither file nor preset.
    pub fn find(cloth: &str) -> Result<Source> {
        let path = Path::new(cloth);
        // A folder of that name is the result of an earlier run.
        if let (false, Some(text)) = (path.is_file(), preset(cloth)) {
            return Ok(Source { file: format!("preset {cloth}"), stem: cloth.into(), text: text.into(), folder: None });
        }
        if !path.exists() {
            let names: Vec<&str> = PRESETS.iter().map(|(name, _)| *name).collect();
            let hint = closest(cloth, &names).map(|name| format!(", did you mean `{name}`?")).unwrap_or_default();
            let names = names.join(", ");
            return Err(Error::Input(format!("no cloth file or preset `{cloth}`{hint}; presets: {names}")));
        }
        if path.is_dir() {
            return Err(Error::Input(format!("{cloth} is a folder, not a cloth file")));
        }
        let file = |source| Error::File { action: "read the cloth file", path: path.into(), source };
        let bytes = read_at_most(path, MAX_BYTES).map_err(file)?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(Error::Input(format!("{cloth} is longer than {} KiB: not a cloth file", MAX_BYTES >> 10)));
        }
        let text = String::from_utf8(bytes).map_err(|error| {
            let valid = String::from_utf8_lossy(&error.as_bytes()[..error.utf8_error().valid_up_to()]).into_owned();
            let document = Document { file: cloth.into(), source: &valid };
            document.error(valid.len(), "a byte that is not UTF-8 text; save the file as UTF-8")
        })?;
        let stem = path.file_stem().map_or_else(|| cloth.to_owned(), |stem| stem.to_string_lossy().into_owned());
        let folder = path.parent().map(Path::to_owned);
        Ok(Source { file: cloth.into(), stem, text, folder })
    }
}

/// Read the file that a value names, beside the cloth file: its path and its bytes.
pub(super) fn read_beside(value: &Value, what: &str, folder: Option<&Path>, most: u64) -> Result<(PathBuf, Vec<u8>)> {
    let name = value.string()?;
    let path = folder.map_or_else(|| Path::new(name).to_owned(), |folder| folder.join(name));
    let refuse = |why: String| value.error(format!("cannot read {what} `{}`: {why}", path.display()));
    let bytes = read_at_most(&path, most).map_err(|source| refuse(source.to_string()))?;
    if bytes.len() as u64 > most {
        return Err(refuse(format!("it is longer than {} KiB", most >> 10)));
    }
    Ok((path, bytes))
}

/// The bytes of a file, and at most one too many.
fn read_at_most(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A checked cloth file: lengths in mm, angles in radians, every value finite and inside its range.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// What the user calls the cloth.
    pub name: String,
    /// The text it was read from.
    pub text: String,
    /// Kinds of fiber, in the order of their names.
    pub fibers: Vec<Fiber>,
    /// The sheet, the weave or the knit.
    pub structure: Structure,
    /// Colour channels, and what each kind of fiber of the cloth absorbs in them.
    pub channels: Channels,
    /// How it is modelled.
    pub model: Model,
    /// How it is measured.
    pub measure: Measure,
}

impl Scene {
    /// Read and check a cloth file's text.
    ///
    /// # Errors
    /// [`Error::Scene`] with line and column, what was found and what is allowed.
    pub fn parse(source: &Source) -> Result<Scene> {
        let document = Document { file: source.file.clone(), source: &source.text };
        let parsed = DeTable::parse(&source.text).map_err(|error| document.malformed(&error))?;
        let root = Table::root(&document, &parsed);
        let keys = ["name", "fiber", "yarn", "sheet", "weave", "knit", "model", "measure"];
        root.expect_keys(&keys, &[])?;
        let name = root.get("name").map_or(Ok(source.stem.as_str()), |value| value.string())?.to_owned();
        let fibers = read_fibers(&root.require("fiber")?.table()?, source.folder.as_deref())?;
        let structure = read_structure(&root, &fibers, source.folder.as_deref())?;
        let mut model = Model::of(!matches!(structure, Structure::Sheet(_)));
        model.directions = structure.usual_directions();
        if let Some(value) = root.get("model") {
            model.read(&value.table()?)?;
        }
        let mut measure = Measure::default();
        if let Some(value) = root.get("measure") {
            measure.read(&value.table()?)?;
        }
        let used = structure.kinds();
        let kinds: Vec<(&str, &Absorption)> =
            used.iter().map(|&kind| (fibers[kind].name.as_str(), &fibers[kind].absorption)).collect();
        let channels = resolve(&kinds, &measure.wavelengths).map_err(|Clash { kind, message }| {
            let place = match &kind {
                Some(kind) => root.at(&["fiber", kind, "absorption_per_mm"]),
                None => root.at(&["measure", "wavelengths_nm"]),
            };
            place.map_or_else(|| root.error(&message), |value| value.error(&message))
        })?;
        Ok(Scene { name, text: source.text.clone(), fibers, structure, channels, model, measure })
    }

    /// Indices of the kinds of fiber that the cloth has, ascending.
    pub fn kinds(&self) -> Vec<usize> {
        self.structure.kinds()
    }

    /// The sheet.
    ///
    /// # Errors
    /// [`Error::Input`] when the cloth is woven or knitted.
    pub fn sheet(&self) -> Result<&Sheet> {
        match &self.structure {
            Structure::Sheet(sheet) => Ok(sheet),
            _ => Err(Error::Input("a cloth of yarns is no sheet; describe a [sheet]".into())),
        }
    }
}
