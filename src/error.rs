//! The one error type: whose fault it is decides the exit code of the program.

use std::io;
use std::path::PathBuf;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Everything that can go wrong, in the user's words.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A cloth file is wrong at a known place.
    #[error("{file}:{line}:{column}: {message}")]
    Scene {
        /// The file as the user named it, or `preset NAME`.
        file: String,
        /// 1-based line.
        line: usize,
        /// 1-based column, in characters.
        column: usize,
        /// What was found and what is allowed.
        message: String,
    },
    /// An argument, a file name or a request cannot be used.
    #[error("{0}")]
    Input(String),
    /// A file cannot be read or written.
    #[error("{}: cannot {action}: {source}", path.display())]
    File {
        /// What was to be done: `read the cloth file`, `write`.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// No device, or a device that cannot do what is needed.
    #[error("{needed}, but {found}")]
    Device {
        /// What the run needs.
        needed: String,
        /// What is there.
        found: String,
    },
    /// A shader does not compile: a fault of this program.
    #[error("shaders/{part}:{line}:{column}: {message}")]
    Shader {
        /// The part of the shader text.
        part: String,
        /// 1-based line in that part.
        line: usize,
        /// 1-based column in that line.
        column: usize,
        /// The compiler's message.
        message: String,
    },
    /// Counts made by an engine do not add up: the result would be wrong.
    #[error("the {engine} engine's account does not close: {message}")]
    Account {
        /// Which engine counted.
        engine: String,
        /// Which identity failed, with both sides.
        message: String,
    },
    /// A comparison or a self-test failed.
    #[error("{0}")]
    Failed(String),
}

impl Error {
    /// Exit code of the program: 1 a check failed, 2 the input is wrong, 3 the device cannot do it.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Account { .. } | Error::Failed(_) => 1,
            Error::Scene { .. } | Error::Input(_) | Error::File { .. } => 2,
            Error::Device { .. } | Error::Shader { .. } => 3,
        }
    }
}
