//! Every command of the README and of docs: they run as they are written, on cloths with coarse cells and with few walks.
//!
//! `FIBERWALK_DOCUMENTED=whole` runs them as they stand, on the cloths themselves; `tools/long-tests.sh` does.

use crate::common::program::{Outcome, Place, finish};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What a cloth of yarns is given that says nothing of its model.
const COARSE: &str = "\n[model]\ncells = [20, 20, 8]\ndirections = 256\ndirect = \"walks\"\nfirst_hit = \"medium\"\n";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// README.md and all pages of docs, by their names.
fn pages() -> Vec<(String, String)> {
    let docs = std::fs::read_dir(root().join("docs")).expect("docs are there").map(|entry| entry.expect("one").path());
    let markdown = docs.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    let mut paths: Vec<PathBuf> =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(|name| root().join(name)).to_vec();
    paths.extend(markdown);
    paths.sort();
    paths
        .into_iter()
        .map(|path| (path.file_name().expect("a name").to_string_lossy().into_owned(), read(&path)))
        .collect()
}

/// Commands of a page: lines of indented blocks, and what stands between backticks.
fn commands(page: &str) -> Vec<String> {
    let page = page.replace("; do\n", "; do ").replace("\n    done", "; done").replace("|\n", "| ");
    let block = |line: &str| line.strip_prefix("    ").map(|line| line.trim().to_owned());
    let mut found: Vec<String> = page.lines().filter_map(block).collect();
    let plain: String = page.lines().filter(|line| !line.starts_with("    ")).map(|line| format!("{line}\n")).collect();
    found.extend(plain.split('`').skip(1).step_by(2).map(|code| code.replace('\n', " ")));
    let starts = ["fiberwalk ", "cargo ", "for cloth in ", "bash ", "python "];
    found.retain(|line| starts.iter().any(|start| line.starts_with(start)));
    found.iter().flat_map(|line| unrolled(line)).filter(|line| !is_synopsis(line)).collect()
}

/// A loop over cloths as single commands.
fn unrolled(line: &str) -> Vec<String> {
    let plain = |line: &str| line.split('#').next().unwrap_or_default().trim().to_owned();
    let Some(rest) = line.strip_prefix("for cloth in ") else { return vec![plain(line)] };
    let (cloths, body) = rest.split_once("; do ").unwrap_or_else(|| panic!("not a loop over cloths: {line}"));
    let body = body.trim_end_matches("done").trim().trim_end_matches(';');
    let all = cloths
        .split_whitespace()
        .flat_map(|cloth| body.split(" && ").map(|one| one.trim().replace("$cloth", cloth)).collect::<Vec<_>>());
    all.collect()
}

/// Words in capitals stand for something, and what follows a few spaces is said of a command.
fn is_synopsis(line: &str) -> bool {
    let holder = |word: &str| word.len() > 1 && word.chars().all(|c| c.is_ascii_uppercase());
    let words = line.split(|c: char| !c.is_ascii_alphanumeric() && c != '.').filter(|word| !word.is_empty());
    line.contains("   ")
        || line.contains("[-")
        || line.contains("$")
        || words.clone().any(holder)
        || words.clone().count() < 2
        || (line.starts_with("fiberwalk ") && words.clone().count() == 2 && !line.contains("engines"))
        || line.ends_with(" A B")
}

/// Arguments as a shell parts them.
fn words(line: &str) -> Vec<String> {
    let quoted = line.split('"').enumerate();
    let parts = quoted.flat_map(|(i, part)| {
        if i % 2 == 1 { vec![part.to_owned()] } else { part.split_whitespace().map(str::to_owned).collect() }
    });
    parts.collect()
}

/// A folder that has the cloths, whole or with coarse cells.
struct Shop {
    place: Place,
    whole: bool,
}

impl Shop {
    fn new() -> Shop {
        let shop =
            Shop { place: Place::new(), whole: std::env::var("FIBERWALK_DOCUMENTED").is_ok_and(|how| how == "whole") };
        for (from, to) in
            [("assets/cloths", ""), ("assets/weaves", "assets/weaves/"), ("assets/mitsuba", "assets/mitsuba/")]
        {
            for entry in std::fs::read_dir(root().join(from)).expect("assets are there") {
                let path = entry.expect("one").path();
                let name = path.file_name().expect("a name").to_string_lossy().into_owned();
                if path.is_file() {
                    let text = read(&path);
                    let coarse = !shop.whole && name.ends_with(".toml") && !text.contains("[sheet]");
                    assert!(!coarse || !text.contains("[model]"), "{name} says how it is modelled");
                    shop.place.write(&format!("{to}{name}"), text + if coarse { COARSE } else { "" });
                }
            }
        }
        shop
    }

    /// A command of the program with the arguments of a page, made short.
    fn short(&self, arguments: &[String]) -> Vec<String> {
        let mut short = arguments.to_vec();
        let preset = |word: &String| self.place.path(&format!("{word}.toml")).exists();
        if let Some(cloth) = short.get_mut(1).filter(|word| preset(word)) {
            // The result still goes where it went.
            if ["measure", "inspect", "chart", "curves"].contains(&arguments[0].as_str()) && !self.whole {
                *cloth += ".toml";
            }
        }
        if self.whole {
            return short;
        }
        let stop = short.iter().position(|word| ["--walks", "--tolerance", "--time"].contains(&word.as_str()));
        let yarns = short.get(1).is_some_and(|cloth| !["felt.toml", "nonwoven.toml"].contains(&cloth.as_str()));
        if arguments[0] == "inspect" && yarns {
            match short.iter().position(|word| word == "--width") {
                Some(at) => short[at + 1] = "600".into(),
                None => short.extend(["--width", "600"].map(str::to_owned)),
            }
        }
        match (arguments[0].as_str(), stop) {
            ("measure", Some(at)) => short.splice(at..at + 2, ["--walks".into(), "40".into()]).for_each(drop),
            ("measure", None) => short.extend(["--walks".into(), "40".into()]),
            _ => {}
        }
        short
    }

    fn run(&self, arguments: &[String]) -> Outcome {
        let mut arguments = self.short(arguments);
        // A page may show a run twice.
        if arguments[0] == "measure" {
            arguments.push("--force".into());
        }
        self.place.run(&arguments.iter().map(String::as_str).collect::<Vec<_>>())
    }
}

#[test]
fn commands_of_the_program_work_as_they_are_written() {
    let shop = Shop::new();
    let (mut seen, mut ran) = (BTreeSet::new(), 0);
    for (page, text) in pages() {
        for line in commands(&text) {
            let Some(rest) = line.strip_prefix("fiberwalk ").or(line.strip_prefix("cargo run --release -- ")) else {
                continue;
            };
            if !seen.insert(rest.to_owned()) {
                continue;
            }
            let outcome = shop.run(&words(rest));
            // Two models of one cloth may differ, which a comparison says by its code.
            let differ = rest.starts_with("compare ") && outcome.code == Some(1) && outcome.stdout.contains("E = ");
            assert!(outcome.code == Some(0) || differ, "{page}: {line}: {:?}\n{}", outcome.code, outcome.stderr);
            println!("{page}: {line}");
            ran += 1;
        }
    }
    assert!(ran >= 40, "only {ran} commands were found");
    // A command that is wrong is noticed.
    let wrong = shop.run(&words("measure denim --wlaks 20000"));
    assert_eq!(wrong.code, Some(2), "{}", wrong.stderr);
}

#[test]
fn the_scene_of_round_tables_is_drawn_as_it_is_written() {
    let shop = Shop::new();
    let (_, text) = pages().into_iter().find(|(name, _)| name == "export.md").expect("the page is there");
    let drawn: Vec<String> = commands(&text).into_iter().filter(|line| line.starts_with("python assets/")).collect();
    assert!(!drawn.is_empty(), "no scene is drawn");
    for line in commands(&text).iter().filter(|line| line.starts_with("fiberwalk measure")) {
        assert_eq!(shop.run(&words(line)[1..]).code, Some(0), "{line}");
    }
    for line in drawn {
        let mut arguments = words(&line)[1..].to_vec();
        if !shop.whole {
            // The last of two flags counts.
            arguments.extend(["--width", "64", "--spp", "4"].map(str::to_owned));
        }
        let mut command = Command::new(root().join("target/venv/bin/python"));
        command.arg("-B").args(&arguments).current_dir(shop.place.path(""));
        let outcome = finish(command);
        assert_eq!(outcome.code, Some(0), "{line}: {}", outcome.stderr);
        assert!(shop.place.path(&arguments[1]).exists(), "{line}");
    }
}

/// Whether a command names a bench, an example, a group of tests or a script that is there.
fn names_what_is_there(line: &str) -> bool {
    let arguments = words(line);
    let after =
        |flag: &str| arguments.iter().position(|word| word == flag).and_then(|at| arguments.get(at + 1)).cloned();
    let file = |path: String| root().join(path).is_file();
    let test = after("--test").is_none_or(|name| {
        let group = arguments.iter().find_map(|word| word.strip_suffix("::"));
        let folder = root().join("tests").join(&name);
        folder.join("main.rs").is_file()
            && group.is_none_or(|group| folder.join(format!("{group}.rs")).is_file() || folder.join(group).is_dir())
    });
    let script = arguments[0] != "bash" || file(arguments[1].clone());
    test && script
        && after("--bench").is_none_or(|name| file(format!("benches/{name}.rs")))
        && after("--example")
            .is_none_or(|name| file(format!("examples/{name}.rs")) || file(format!("examples/{name}/main.rs")))
}

#[test]
fn benches_examples_tests_and_scripts_are_there() {
    let mut found = 0;
    for (page, text) in pages() {
        for line in commands(&text).iter().filter(|line| line.contains("cargo ") || line.starts_with("bash ")) {
            assert!(names_what_is_there(line), "{page}: {line}");
            found += 1;
        }
    }
    assert!(found >= 15, "only {found} commands were found");
    for wrong in [
        "cargo bench --bench nosuch",
        "cargo test --test light nosuch::",
        "bash tools/nosuch.sh",
        "cargo run --example nosuch",
    ] {
        assert!(!names_what_is_there(wrong), "{wrong}");
    }
}
