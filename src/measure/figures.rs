//! How fast each engine is on this machine: measured once, and kept in the user's cache folder.

use super::run::{Prepared, prepare};
use crate::error::{Error, Result};
use crate::scene::{Scene, Source};
use crate::walk::{Engine, WalkPlan};
use etcetera::BaseStrategy;
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The standard run: isotropic fibers, H·d = 2 R L d π/4 = 4, light from 30°.
const CLOTH: &str = r#"
[fiber.test]
radius_um = 10
ior = 1.5
[sheet]
thickness_um = 1000
[[sheet.fibers]]
fiber = "test"
length_density_per_mm2 = 254.64790894703253
orientation = "isotropic"
[measure]
incident = [[30, 20]]
"#;
/// Walks that compile and warm, and as many that tell how many to time.
const FIRST: u64 = 4096;
/// Time in seconds that the timed walks are to take.
const TIMED: f64 = 0.05;

/// Walks a second of an engine in the standard run, a sheet of depth 4. Takes some 0.1 s and what the driver needs to
/// compile the kernel.
///
/// # Errors
/// The engine's own.
pub fn standard_rate(engine: &dyn Engine) -> Result<f64> {
    let source = Source { file: "standard".into(), stem: "standard".into(), text: CLOTH.into(), folder: None };
    let Prepared { tables, goniometer, .. } = prepare(&Scene::parse(&source)?)?;
    let time = |walks: u64| -> Result<f64> {
        let started = Instant::now();
        engine.run(&tables, &goniometer, &WalkPlan::new(1, walks), &mut |_| {})?;
        Ok(started.elapsed().as_secs_f64().max(1e-9))
    };
    time(FIRST)?;
    let seconds = time(FIRST)?;
    let walks = ((FIRST as f64 * TIMED / seconds) as u64).clamp(FIRST, 1 << 24);
    Ok(walks as f64 / time(walks)?)
}

/// Figures by name, in a file that may be missing, damaged or read-only: it only saves time. The default keeps nothing.
#[derive(Default)]
pub struct Figures {
    path: Option<PathBuf>,
    known: BTreeMap<String, f64>,
    trouble: Option<String>,
}

impl Figures {
    /// Those of the user, in the cache folder of the system.
    pub fn of_user() -> Figures {
        let folder = etcetera::base_strategy::choose_native_strategy().ok().map(|strategy| strategy.cache_dir());
        Figures::in_folder(folder.map(|folder| folder.join("fiberwalk")).as_deref())
    }

    /// Those in a folder; nothing is kept without one.
    pub fn in_folder(folder: Option<&Path>) -> Figures {
        let path = folder.map(|folder| folder.join(concat!("engines-", env!("CARGO_PKG_VERSION"), ".json")));
        let known = path.as_deref().map(read).unwrap_or_default();
        Figures { path, known, trouble: None }
    }

    /// The figure of an engine, from an earlier measurement or a new one. `name` says all that it depends on: engine,
    /// adapter, driver with its version, threads.
    ///
    /// # Errors
    /// Those of `measured`.
    pub fn of(&mut self, name: &str, measured: impl FnOnce() -> Result<f64>) -> Result<f64> {
        match self.known.get(name) {
            Some(figure) => Ok(*figure),
            None => self.keep(name, measured()?),
        }
    }

    /// Keep a figure, in place of an older one.
    ///
    /// # Errors
    /// [`Error::Failed`] when it is not a positive number.
    pub fn keep(&mut self, name: &str, figure: f64) -> Result<f64> {
        if !sound(&figure) {
            return Err(Error::Failed(format!("the standard run gave {figure} walks a second")));
        }
        if let Some(path) = &self.path {
            // Another process may have kept others in the meantime.
            self.known.extend(read(path).into_iter().filter(|(other, _)| other != name));
            self.known.insert(name.to_owned(), figure);
            self.trouble = write(path, &self.known).err().map(|error| format!("{}: {error}", path.display()));
        }
        Ok(figure)
    }

    /// Why the figures could not be kept, if so.
    pub fn trouble(&self) -> Option<&str> {
        self.trouble.as_deref()
    }
}

fn sound(figure: &f64) -> bool {
    figure.is_finite() && *figure > 0.0
}

/// What a file has of sound figures.
fn read(path: &Path) -> BTreeMap<String, f64> {
    let text = fs::read(path).unwrap_or_default();
    let values: BTreeMap<String, serde_json::Value> = serde_json::from_slice(&text).unwrap_or_default();
    let figures = values.into_iter().filter_map(|(name, value)| Some((name, value.as_f64()?)));
    figures.filter(|(_, figure)| sound(figure)).collect()
}

/// Write all figures beside the file and move them there, so that no reader sees half of them.
fn write(path: &Path, figures: &BTreeMap<String, f64>) -> std::io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(serde_json::to_string_pretty(figures)?.as_bytes())?;
    file.persist(path)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::Reference;

    /// The file of the figures in a folder.
    fn file(folder: &Path) -> PathBuf {
        Figures::in_folder(Some(folder)).path.expect("a folder has a file")
    }

    #[test]
    fn a_figure_is_measured_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let below = folder.path().join("new/folder");
        let mut figures = Figures::in_folder(Some(&below));
        assert_eq!(figures.of("a", || Ok(3.0)).expect("it is measured"), 3.0);
        assert_eq!(figures.trouble(), None);
        let mut again = Figures::in_folder(Some(&below));
        assert_eq!(again.of("a", || panic!("it is known")).expect("it is known"), 3.0);
        assert_eq!(again.of("b", || Ok(5.0)).expect("it is measured"), 5.0);
        // The first reader does not know of the second one's figure, and does not lose it.
        figures.keep("a", 4.0).expect("it is sound");
        let mut last = Figures::in_folder(Some(&below));
        assert_eq!([last.of("a", || Ok(0.0)).ok(), last.of("b", || Ok(0.0)).ok()], [Some(4.0), Some(5.0)]);
    }

    #[test]
    fn a_damaged_file_is_measured_anew_and_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        for damaged in ["", "{\"a\": 3.0", "[]", "{\"a\": -3.0}", "{\"a\": \"fast\"}", "{\"a\": 1e999}", "\u{0}\u{1}"] {
            fs::write(file(folder.path()), damaged).expect("it can be written");
            assert_eq!(
                Figures::in_folder(Some(folder.path())).of("a", || Ok(7.0)).expect("measured"),
                7.0,
                "{damaged}"
            );
            assert_eq!(read(&file(folder.path())), BTreeMap::from([("a".to_owned(), 7.0)]));
        }
        // What is sound stays.
        fs::write(file(folder.path()), "{\"a\": 3.0, \"b\": null}").expect("it can be written");
        assert_eq!(Figures::in_folder(Some(folder.path())).of("a", || panic!("it is known")).expect("known"), 3.0);
    }

    #[test]
    fn where_nothing_can_be_kept_figures_are_measured_and_it_is_told() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("file"), "").expect("it can be written");
        let mut figures = Figures::in_folder(Some(&folder.path().join("file/below")));
        assert_eq!(figures.of("a", || Ok(2.0)).expect("it is measured"), 2.0);
        assert!(figures.trouble().is_some_and(|trouble| trouble.contains("file/below")), "{:?}", figures.trouble());
        let mut without = Figures::in_folder(None);
        assert_eq!((without.of("a", || Ok(2.0)).ok(), without.trouble()), (Some(2.0), None));
    }

    #[test]
    fn a_figure_is_a_positive_number_and_faults_are_the_engines_own() {
        let mut figures = Figures::in_folder(None);
        for unsound in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(figures.of("a", || Ok(unsound)).is_err());
        }
        let fault = figures.of("a", || Err(Error::Input("fault".into()))).expect_err("it is passed on");
        assert_eq!(fault.to_string(), "fault");
        assert!(standard_rate(&Reference).expect("the f64 engine is right") > 0.0);
    }
}
