//! Programs of tests in the Python environment that tools/setup.sh makes.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Run a program of `tests/program/exports` on an input in JSON, and read what it prints as JSON.
pub fn run(program: &str, input: &Value) -> Value {
    let python = root().join("target/venv/bin/python");
    let mut command = Command::new(&python);
    command
        .arg("-B")
        .arg(root().join("tests/program/exports").join(program))
        .env("PYTHONPATH", root().join("assets/mitsuba"));
    let child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.unwrap_or_else(|error| panic!("{}: {error}: run tools/setup.sh", python.display()));
    let mut stdin = child.stdin.take().expect("it has an input");
    let text = input.to_string();
    let writer = std::thread::spawn(move || std::io::Write::write_all(&mut stdin, text.as_bytes()));
    let output = child.wait_with_output().expect("it ends");
    let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{program}: {complaint}\n(does a module lack? run tools/setup.sh)");
    writer.join().expect("it does not panic").expect("the input is read");
    let text = String::from_utf8_lossy(&output.stdout);
    // What libraries say comes first.
    let line = text.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or_default();
    serde_json::from_str(line).unwrap_or_else(|error| panic!("{program} prints JSON last ({error}): {text}"))
}

/// A program of Radiance that comes with the wheel pyradiance.
pub fn radiance(name: &str) -> PathBuf {
    let lib = root().join("target/venv/lib");
    let versions =
        std::fs::read_dir(&lib).unwrap_or_else(|error| panic!("{}: {error}: run tools/setup.sh", lib.display()));
    let mut places =
        versions.filter_map(|version| Some(version.ok()?.path().join("site-packages/pyradiance/bin").join(name)));
    places.find(|path| path.is_file()).unwrap_or_else(|| panic!("no {name} of pyradiance: run tools/setup.sh"))
}
