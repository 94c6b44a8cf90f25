//! The floors of the crate hold: data flows down once, engines do not know of each other, and each outside library stays
//! in its rooms.

use std::fs;
use std::path::{Path, PathBuf};

/// Rooms from the ground up; a room may use rooms of earlier floors and itself.
const FLOORS: &[&[&str]] = &[
    &["error", "concentric", "colour"],
    &["scene"],
    &["cloth"],
    &["distribution"],
    &["tables", "goniometer"],
    &["walk", "optics"],
    &["reference", "explicit", "gpu"],
    &["bsdf"],
    &["measure"],
    &["results"],
    &["plan"],
    &["report", "export"],
    &["cli", "main", "lib"],
];

/// Libraries and the only rooms that may name them.
const LIBRARIES: &[(&str, &[&str])] = &[
    ("wgpu", &["gpu"]),
    ("naga", &["gpu"]),
    ("bytemuck", &["gpu"]),
    ("exr", &["results", "export"]),
    ("toml", &["scene"]),
    ("clap", &["cli"]),
    ("indicatif", &["cli"]),
    ("rayon", &["cloth", "reference", "explicit", "distribution", "tables", "measure", "plan", "export"]),
    ("statrs", &["bsdf"]),
    ("rand", &["cloth"]),
    ("png", &["report"]),
    ("etcetera", &["measure"]),
    ("goblin", &["gpu"]),
    ("noto_sans_mono_bitmap", &["report"]),
];

fn floor(room: &str) -> usize {
    FLOORS.iter().position(|rooms| rooms.contains(&room)).unwrap_or_else(|| panic!("room `{room}` stands on no floor"))
}

/// Words that follow `prefix` in code, comments left out.
fn paths(text: &str, prefix: &str) -> Vec<String> {
    let code = text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n");
    let mut found = Vec::new();
    for (at, _) in code.match_indices(prefix) {
        let rest = &code[at + prefix.len()..];
        let word = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
        match rest.strip_prefix('{') {
            Some(list) => found.extend(list.split('}').next().unwrap_or_default().split(',').map(|w| word(w.trim()))),
            None => found.push(word(rest)),
        }
    }
    found
}

/// What a file of a room uses that it must not.
fn trespass(room: &str, text: &str) -> Option<String> {
    let prefix = if FLOORS.last().is_some_and(|top| top.contains(&room)) { "fiberwalk::" } else { "crate::" };
    let known = |used: &String| FLOORS.iter().any(|rooms| rooms.contains(&used.as_str()));
    for used in paths(text, prefix).into_iter().filter(known) {
        if used != room && floor(&used) >= floor(room) {
            return Some(format!("`{room}` uses `{used}`, which is not on an earlier floor"));
        }
    }
    let names = |library: &str| {
        let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
        let path = format!("{library}::");
        code.clone().any(|line| {
            line.match_indices(&path)
                .any(|(at, _)| !line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':'))
        })
    };
    let library = LIBRARIES.iter().find(|(library, rooms)| !rooms.contains(&room) && names(library));
    library.map(|(library, rooms)| format!("`{room}` uses {library}, which belongs to {rooms:?}"))
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("the source is there").map(|entry| entry.expect("it can be read").path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

#[test]
fn no_room_uses_a_later_floor_or_a_foreign_library() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut seen = 0;
    for path in files(&source) {
        let inner = path.strip_prefix(&source).expect("it is inside");
        let first = inner.components().next().expect("it has a name").as_os_str().to_string_lossy().into_owned();
        let room = first.trim_end_matches(".rs");
        let text = fs::read_to_string(&path).expect("it can be read");
        if room != "lib" {
            assert_eq!(trespass(room, &text), None, "{}", path.display());
        }
        seen += 1;
    }
    assert!(seen > 30, "only {seen} files were looked at");
}

#[test]
fn a_trespass_is_noticed() {
    assert!(trespass("reference", "use crate::gpu::Gpu;").is_some());
    assert!(trespass("scene", "use crate::{error::Result, tables::SamplingTables};").is_some());
    assert!(trespass("bsdf", "let x = crate::measure::run();").is_some());
    assert!(trespass("measure", "fn f(d: &wgpu::Device) {}").is_some());
    assert!(trespass("goniometer", "use crate::distribution::DirectionGrid;\n// crate::gpu is fine here").is_none());
}
