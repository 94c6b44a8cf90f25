//! Where results go, and how nothing is left half-written.

use super::exr::write_bsdf;
use super::summary::summary;
use crate::error::{Error, Result};
use crate::measure::Measurement;
use crate::scene::Scene;
use std::io::Write;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// The files of a result.
const FILES: [&str; 2] = ["bsdf.exr", "summary.json"];

/// A folder that was seen to take files.
#[derive(Debug)]
pub struct ResultFolder {
    path: PathBuf,
    /// The first folder that had to be made: it goes again when nothing is written.
    made: Option<PathBuf>,
    written: bool,
}

impl ResultFolder {
    /// Make the folder if it is not there, and try to write into it.
    ///
    /// # Errors
    /// [`Error::Input`] when it holds a result and `force` is not set; [`Error::File`] when it cannot be written.
    pub fn prepare(path: &Path, force: bool) -> Result<ResultFolder> {
        if let (false, Some(file)) = (force, FILES.iter().find(|file| path.join(file).exists())) {
            let path = path.display();
            let message =
                format!("{path} holds a result already ({file}): --force replaces it, -o names another folder");
            return Err(Error::Input(message));
        }
        let made = path.ancestors().take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists()).last();
        let folder = ResultFolder { path: path.into(), made: made.map(PathBuf::from), written: false };
        std::fs::create_dir_all(path).map_err(|source| folder.failed(source))?;
        folder.temporary()?;
        Ok(folder)
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Write all files of a measurement; all are whole before the first takes its place.
    ///
    /// # Errors
    /// [`Error::File`] when a file cannot be written; then no file has changed.
    pub fn write(mut self, scene: &Scene, measurement: &Measurement) -> Result<()> {
        let mut bsdf = self.temporary()?;
        write_bsdf(bsdf.as_file_mut(), scene, measurement).map_err(|source| self.failed(source))?;
        let mut text = self.temporary()?;
        text.write_all(summary(scene, measurement).as_bytes()).map_err(|source| self.failed(source))?;
        for (file, name) in [bsdf, text].into_iter().zip(FILES) {
            file.persist(self.path.join(name)).map_err(|failed| self.failed(failed.error))?;
        }
        self.written = true;
        Ok(())
    }

    fn temporary(&self) -> Result<NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".fiberwalk-").permissions_of_plain_files();
        builder.tempfile_in(&self.path).map_err(|source| self.failed(source))
    }

    fn failed(&self, source: std::io::Error) -> Error {
        Error::File { action: "write the result", path: self.path.clone(), source }
    }
}

impl Drop for ResultFolder {
    /// Take away the folders that were made for a result that did not come.
    fn drop(&mut self) {
        if let (false, Some(made)) = (self.written, &self.made) {
            // Folders are removed only while empty, from the innermost out; what does not go stays.
            for folder in self.path.ancestors() {
                if std::fs::remove_dir(folder).is_err() || folder == made {
                    break;
                }
            }
        }
    }
}

/// Temporary files are private; results are files like any other.
trait Permissions {
    fn permissions_of_plain_files(&mut self) -> &mut Self;
}

impl Permissions for tempfile::Builder<'_, '_> {
    #[cfg(unix)]
    fn permissions_of_plain_files(&mut self) -> &mut Self {
        use std::os::unix::fs::PermissionsExt;
        self.permissions(std::fs::Permissions::from_mode(0o666))
    }

    #[cfg(not(unix))]
    fn permissions_of_plain_files(&mut self) -> &mut Self {
        self
    }
}
