//! The built program, run in an empty folder of its own.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// The cache of all runs: what was measured or compiled for one serves the others, and the user's own is left alone.
pub const CACHE: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/cache");

/// What a run left behind it.
#[derive(Debug)]
pub struct Outcome {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

/// A working folder, and one beside it for the files that are nobody's business.
pub struct Place {
    home: TempDir,
}

impl Place {
    pub fn new() -> Place {
        let home = tempfile::tempdir().expect("a temporary folder can be made");
        for folder in ["work", "scratch", "runtime"] {
            std::fs::create_dir(home.path().join(folder)).expect("a folder can be made");
        }
        Place { home }
    }

    /// A path below the working folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.home.path().join("work").join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().expect("a file has a folder")).expect("a folder can be made");
        std::fs::write(path, bytes).expect("a file can be written");
    }

    /// The program with its arguments, ready to start; stdin is empty.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_fiberwalk"));
        command.args(arguments).current_dir(self.path("")).stdin(Stdio::null());
        command.env("XDG_RUNTIME_DIR", self.home.path().join("runtime"));
        command.env("TMPDIR", self.home.path().join("scratch")).env("XDG_CACHE_HOME", CACHE);
        command
    }

    /// Run the program and wait for it.
    pub fn run(&self, arguments: &[&str]) -> Outcome {
        finish(self.command(arguments))
    }

    /// Everything on disk that the program could have left, by its name: the bytes of a file, none for a folder.
    pub fn contents(&self) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
        let mut found = BTreeMap::new();
        for folder in ["work", "scratch"] {
            collect(&self.home.path().join(folder), &mut found);
        }
        found
    }
}

/// Start a command and wait for it.
pub fn finish(mut command: Command) -> Outcome {
    let output = command.output().expect("the program can be started");
    let text = |bytes| String::from_utf8(bytes).expect("the program writes UTF-8");
    Outcome { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

fn collect(folder: &Path, found: &mut BTreeMap<PathBuf, Option<Vec<u8>>>) {
    for entry in std::fs::read_dir(folder).expect("a folder can be listed") {
        let path = entry.expect("a folder can be listed").path();
        if path.is_dir() {
            collect(&path, found);
            found.insert(path, None);
        } else {
            // A link that leads nowhere has no bytes.
            let bytes = std::fs::read(&path).ok();
            found.insert(path, bytes);
        }
    }
}
