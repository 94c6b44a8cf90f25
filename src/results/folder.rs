//! Where results go, and how nothing is left half-written.

use super::about::About;
use super::exr::write_bsdf;
use super::summary::summary;
use super::tally::{TALLY, write_tally};
use crate::error::{Error, Result};
use crate::measure::Measurement;
use crate::scene::Scene;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// The files of a result.
const FILES: [&str; 3] = ["bsdf.exr", TALLY, "summary.json"];

/// A folder that was seen to take files.
#[derive(Debug)]
pub struct ResultFolder {
    path: PathBuf,
    /// The first folder that had to be made: it goes again when nothing is written.
    made: Option<PathBuf>,
    written: bool,
}

impl ResultFolder {
    /// See that the folder can be made and written to; it is there only once there is a result.
    ///
    /// # Errors
    /// [`Error::Input`] when it holds a result and `force` is not set, or when a file or folder is in the way;
    /// [`Error::File`] when it cannot be written.
    pub fn prepare(path: &Path, force: bool) -> Result<ResultFolder> {
        let shown = path.display();
        check_place(path, &FILES)?;
        if let (false, Some(file)) = (force, FILES.iter().find(|file| path.join(file).exists())) {
            let message =
                format!("{shown} holds a result already ({file}): --force replaces it, -o names another folder");
            return Err(Error::Input(message));
        }
        let mut folder = ResultFolder { path: path.into(), made: None, written: false };
        folder.make()?;
        folder.temporary()?;
        // Leave nothing behind should the run be stopped.
        folder.unmake();
        Ok(folder)
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Write all files of a measurement; all are whole before the first takes its place.
    ///
    /// # Errors
    /// [`Error::File`] when a file cannot be written. While files are being made none has changed; when the move of one
    /// fails, no summary is left beside a table that it does not describe.
    pub fn write(mut self, scene: &Scene, measurement: &Measurement) -> Result<()> {
        self.make()?;
        let mut bsdf = self.temporary()?;
        write_bsdf(bsdf.as_file_mut(), scene, measurement).map_err(|source| self.failed(source))?;
        let mut tally = self.temporary()?;
        write_tally(tally.as_file_mut(), &About::new(scene), &measurement.tally)
            .map_err(|source| self.failed(source))?;
        let mut text = self.temporary()?;
        text.write_all(summary(scene, measurement).as_bytes()).map_err(|source| self.failed(source))?;
        // The summary goes first and comes last.
        match std::fs::remove_file(self.path.join("summary.json")) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => return Err(self.failed(source)),
            _ => {}
        }
        for (file, name) in [bsdf, tally, text].into_iter().zip(FILES) {
            file.persist(self.path.join(name)).map_err(|failed| self.failed(failed.error))?;
        }
        self.written = true;
        Ok(())
    }

    /// See that nothing is in the way of a file of this name in a folder, before what goes into it is made.
    ///
    /// # Errors
    /// [`Error::Input`] when a file or folder is.
    pub fn check(path: &Path, name: &str) -> Result<()> {
        check_place(path, &[name])
    }

    /// Write one more file into a folder, beside a result or without one; an older file of the name is replaced.
    ///
    /// # Errors
    /// [`Error::Input`] when a file or folder is in the way, [`Error::File`] when the file cannot be written; then there
    /// is no part of it, and no folder that was not there before.
    pub fn add(path: &Path, name: &str, write: impl FnOnce(&mut File) -> std::io::Result<()>) -> Result<PathBuf> {
        check_place(path, &[name])?;
        let mut folder = ResultFolder { path: path.into(), made: None, written: false };
        folder.make()?;
        let mut file = folder.temporary()?;
        write(file.as_file_mut()).map_err(|source| folder.failed(source))?;
        file.persist(folder.path.join(name)).map_err(|failed| folder.failed(failed.error))?;
        folder.written = true;
        Ok(folder.path.join(name))
    }

    /// Make the folder and those that it lies in, and note the first that was missing.
    fn make(&mut self) -> Result<()> {
        let missing = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
        self.made = self.path.ancestors().take_while(missing).last().map(PathBuf::from);
        std::fs::create_dir_all(&self.path).map_err(|source| self.failed(source))
    }

    /// Remove the folders that were made, from the innermost out, those that are empty.
    fn unmake(&mut self) {
        let Some(made) = self.made.take() else { return };
        for folder in self.path.ancestors() {
            // A folder that was not made, or that has something in it, is not removed.
            let _ = std::fs::remove_dir(folder);
            if folder == made {
                break;
            }
        }
    }

    fn temporary(&self) -> Result<NamedTempFile> {
        // Temporary files are private; results are files like any other.
        let made = tempfile::Builder::new().prefix(".fiberwalk-").make_in(&self.path, |path| File::create_new(path));
        made.map_err(|source| self.failed(source))
    }

    fn failed(&self, source: std::io::Error) -> Error {
        Error::File { action: "write the result", path: self.path.clone(), source }
    }
}

impl Drop for ResultFolder {
    /// Take away the folders that were made for a result that did not come.
    fn drop(&mut self) {
        if !self.written {
            self.unmake();
        }
    }
}

/// See that no file lies where the folder is to be, and no folder where its files are to be.
fn check_place(path: &Path, files: &[&str]) -> Result<()> {
    let shown = path.display();
    if path.symlink_metadata().is_ok() && !path.is_dir() {
        return Err(Error::Input(format!("{shown} is not a folder: -o names the folder of the result")));
    }
    if let Some(file) = files.iter().find(|file| path.join(file).is_dir()) {
        return Err(Error::Input(format!("{shown} holds a folder named {file}: -o names another folder")));
    }
    Ok(())
}
