//! Arguments, adapters, folders and results.

use super::refusals::{CLOTH, EXIT, FEW, NO_ADAPTER, NO_DRIVER, check_refusal, refuse, refuse_arguments};
use crate::common::program::{Outcome, Place, finish};
use std::io::{BufRead, BufReader};
use std::process::Stdio;

#[test]
fn wrong_arguments_are_refused_on_one_line() {
    let walks = "for '--walks <N>': must be a whole number from 1 to 281474976710656";
    let share = "for '--tolerance <SHARE>': must be a share from 0.001% to 100%, such as 5% or 0.05";
    let seed = "for '--seed <S>': must be a whole number from 0 to 18446744073709551615";
    refuse_arguments(
        2,
        &[
            (&["--walks", "0"], &format!("invalid value '0' {walks}")),
            (&["--walks", "-1"], &format!("invalid value '-1' {walks}")),
            (&["--walks", "abc"], &format!("invalid value 'abc' {walks}")),
            (&["--walks", "1e6"], &format!("invalid value '1e6' {walks}")),
            (&["--walks", "18446744073709551615"], &format!("invalid value '18446744073709551615' {walks}")),
            (
                &["--walks", "281474976710656"],
                "--walks 281474976710656 is too many for 64 incident cells; allowed: 1 to 4398046511104",
            ),
            (&["--tolerance", "0"], &format!("invalid value '0' {share}")),
            (&["--tolerance", "nan"], &format!("invalid value 'nan' {share}")),
            (&["--tolerance", "101%"], &format!("invalid value '101%' {share}")),
            (
                &["--time", "-1s"],
                "invalid value '-1s' for '--time <SECONDS>': must be a time from 0.001s to 10000000s, such as 60s",
            ),
            (
                &["--time", "1", "--tolerance", "5%"],
                "the argument '--time <SECONDS>' cannot be used with '--tolerance <SHARE>'",
            ),
            (&["--walks"], "a value is required for '--walks <N>' but none was supplied"),
            (&["--seed", "-1"], &format!("invalid value '-1' {seed}")),
            (&["--engine", "foo"], "invalid value 'foo' for '--engine <ENGINE>'; [possible values: auto, gpu, cpu]"),
            (&["--walk", "3"], "unexpected argument '--walk' found; tip: a similar argument exists: '--walks'"),
            (&["--bogus"], "unexpected argument '--bogus' found; tip: to pass '--bogus' as a value, use '-- --bogus'"),
            (&["felt"], "unexpected argument 'felt' found"),
            (&["--seed", "1", "--seed", "2"], "the argument '--seed <S>' cannot be used multiple times"),
        ],
    );
    refuse(&Place::new(), &["measure"], 2, "the following required arguments were not provided: <CLOTH>");
    refuse(
        &Place::new(),
        &["measur"],
        2,
        "unrecognized subcommand 'measur'; tip: a similar subcommand exists: 'measure'",
    );
}

#[test]
fn an_adapter_that_is_not_there_is_a_fault_of_the_device() {
    refuse_arguments(
        2,
        &[
            (&["--engine", "cpu", "--adapter", "nosuch"], "--adapter belongs to the gpu engine, not to --engine cpu"),
            (&["--adapter", ""], "--adapter needs a part of an adapter's name; `fiberwalk engines` lists them"),
        ],
    );
    for engine in ["auto", "gpu"] {
        let place = Place::new();
        let Outcome { code, stdout, stderr } =
            place.run(&["measure", "felt", "--engine", engine, "--adapter", "nosuch"]);
        // The adapters that there are differ from machine to machine.
        let start = "error: an adapter named `nosuch` was asked for, but there is only: ";
        assert!(stderr.starts_with(start) && stderr.lines().count() == 1 && stdout.is_empty(), "{stderr}");
        assert_eq!(code, Some(3));
        assert!(place.contents().is_empty(), "{engine} left files");
    }
}

#[test]
fn without_a_driver_the_cpu_engine_serves_and_says_why() {
    let place = Place::new();
    let mut command = place.command(&["measure", "nonwoven", "--walks", "200"]);
    command.envs(NO_DRIVER);
    let Outcome { code, stdout, stderr } = finish(command);
    assert_eq!((code, stderr.lines().count()), (Some(0), 4), "{stderr}");
    let engine = stderr.lines().nth(2).expect("four lines have a third");
    assert!(engine.starts_with("engine: cpu on ") && engine.ends_with(&format!("; {NO_ADAPTER}")), "{engine}");
    assert!(stdout.ends_with("\nnonwoven/bsdf.exr\nnonwoven/tally.exr\nnonwoven/summary.json\n"), "{stdout}");
    for wish in [["--engine", "gpu"], ["--adapter", "llvm"]] {
        let place = Place::new();
        let mut command = place.command(&[&["measure", "nonwoven"], &wish[..]].concat());
        command.envs(NO_DRIVER);
        check_refusal(&finish(command), 3, NO_ADAPTER);
        assert!(place.contents().is_empty(), "{wish:?} left files");
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_refused_before_the_first_walk() {
    let place = Place::new();
    place.write("file", "");
    place.write("felt", CLOTH);
    place.write("odd/summary.json/inside", "");
    let file = "file is not a folder: -o names the folder of the result";
    refuse(&place, &["measure", "nonwoven", "-o", "file"], 2, file);
    refuse(&place, &["measure", "nonwoven", "-o", "file", "--force"], 2, file);
    let below = "file/a/b: cannot write the result: Not a directory (os error 20)";
    refuse(&place, &["measure", "nonwoven", "-o", "file/a/b"], 2, below);
    let long = format!("new/{}", "x".repeat(300));
    let message = format!("{long}: cannot write the result: File name too long (os error 36)");
    refuse(&place, &["measure", "nonwoven", "-o", &long], 2, &message);
    let own = "felt is not a folder: -o names the folder of the result";
    refuse(&place, &["measure", "felt"], 2, own);
    let odd = "odd holds a folder named summary.json: -o names another folder";
    refuse(&place, &["measure", "nonwoven", "-o", "odd", "--force"], 2, odd);
    refuse(
        &place,
        &["measure", "nonwoven", "-o", ""],
        2,
        "a value is required for '--output <DIR>' but none was supplied",
    );
}

#[test]
fn a_result_is_replaced_only_by_force_and_only_by_a_whole_one() {
    let place = Place::new();
    fn run<'a>(seed: &'a str, more: &[&'a str]) -> Vec<&'a str> {
        [&["measure", "felt", "--seed", seed], &FEW[..], more].concat()
    }
    assert_eq!(place.run(&run("1", &[])).code, Some(0));
    let first = place.contents();
    let holds =
        |file: &str| format!("felt holds a result already ({file}): --force replaces it, -o names another folder");
    refuse(&place, &run("2", &[]), 2, &holds("bsdf.exr"));
    // What fails with --force must not have touched the result.
    refuse(&place, &run("2", &["--force", "--exit", "0"]), 2, &format!("--exit:1:1: `exit` is 0, but must be {EXIT}"));
    assert_eq!(place.run(&run("2", &["--force"])).code, Some(0));
    let second = place.contents();
    assert!(first.keys().eq(second.keys()), "the same files are there: {:?}", second.keys());
    let unlike = |name: &str| first[&place.path(name)] != second[&place.path(name)];
    assert!(unlike("felt/bsdf.exr") && unlike("felt/summary.json"), "another seed gives other files");
    std::fs::remove_file(place.path("felt/bsdf.exr")).expect("the table can be removed");
    refuse(&place, &run("2", &[]), 2, &holds("tally.exr"));
    std::fs::remove_file(place.path("felt/tally.exr")).expect("the tally can be removed");
    refuse(&place, &run("2", &[]), 2, &holds("summary.json"));
}

#[test]
fn a_run_that_is_killed_leaves_nothing() {
    let place = Place::new();
    let mut command = place.command(&["measure", "nonwoven", "--walks", "1000000000", "--engine", "cpu", "-o", "a/b"]);
    let mut child = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().expect("the program starts");
    let notes = BufReader::new(child.stderr.take().expect("stderr is a pipe"));
    // The walks begin after the note on the engine.
    let engine = notes.lines().map_while(Result::ok).find(|line| line.starts_with("engine: "));
    child.kill().and_then(|()| child.wait()).expect("the program can be ended");
    assert!(engine.is_some(), "the run came to its walks");
    assert!(place.contents().is_empty(), "{:?}", place.contents().keys());
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let place = Place::new();
    let mut command = place.command(&[&["measure", "nonwoven", "--quiet"], &FEW[..]].concat());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("the program ends");
    assert_eq!((output.status.code(), String::from_utf8_lossy(&output.stderr).as_ref()), (Some(0), ""));
    assert!(place.path("nonwoven/summary.json").exists(), "the result is there");
}

#[test]
fn results_are_compared_and_what_cannot_be_compared_is_refused() {
    let place = Place::new();
    let measure = |cloth: &str, seed: &str, folder: &str, more: &[&str]| {
        let common = ["measure", cloth, "--walks", "3000", "--quiet", "--incident", "2", "--exit", "4"];
        let outcome = place.run(&[&common[..], &["--seed", seed, "-o", folder], more].concat());
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    };
    measure("felt", "1", "a", &[]);
    measure("felt", "2", "b", &["--engine", "cpu"]);
    measure("nonwoven", "3", "c", &[]);
    measure("felt", "4", "sides", &["--sides", "back"]);
    let compare = |arguments: &[&str]| place.run(&[&["compare"][..], arguments].concat());
    let same = compare(&["a", "b/tally.exr"]);
    assert_eq!((same.code, same.stderr.as_str()), (Some(0), ""), "{}", same.stdout);
    assert!(same.stdout.contains("\nno difference was found; one of "), "{}", same.stdout);
    let other = compare(&["a", "c"]);
    assert_eq!((other.code, other.stderr.as_str()), (Some(1), "error: the results differ\n"), "{}", other.stdout);
    let within = compare(&["a", "b", "--within", "20%"]);
    assert_eq!(within.code, Some(0), "{}", within.stderr);
    let beyond = compare(&["a", "c", "--within", "2%"]);
    assert!(beyond.code == Some(1) && beyond.stderr.contains("larger than the 2.00 % allowed"), "{}", beyond.stderr);
    let told = compare(&["a", "a", "--same-seed"]);
    assert_eq!(told.code, Some(0), "{}", told.stderr);
    let refused = |arguments: &[&str], message: &str| {
        let outcome = compare(arguments);
        assert_eq!((outcome.code, outcome.stdout.as_str()), (Some(2), ""), "{arguments:?}");
        assert!(outcome.stderr.contains(message) && outcome.stderr.lines().count() == 1, "{}", outcome.stderr);
    };
    refused(&["a", "a"], "made with seed 1");
    refused(&["a", "sides"], "differ in lit sides (front and back)");
    refused(&["a", "missing"], "missing: cannot read the tally");
    place.write("torn/tally.exr", "no image");
    refused(&["torn", "a"], "not a tally of this program");
    refused(&["a", "b", "--within", "-1%"], "must be a share");
}

#[test]
fn results_of_too_few_walks_are_not_called_equal() {
    let place = Place::new();
    for (cloth, seed, walks, folder) in [
        ("felt", "1", "3", "a"),
        ("nonwoven", "2", "3", "b"),
        ("felt", "3", "2000", "c"),
        ("nonwoven", "4", "2000", "d"),
    ] {
        let outcome = place.run(&[
            "measure",
            cloth,
            "--walks",
            walks,
            "--quiet",
            "--incident",
            "2",
            "--exit",
            "32",
            "--seed",
            seed,
            "-o",
            folder,
        ]);
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    }
    let few = place.run(&["compare", "a", "b"]);
    assert_eq!((few.code, few.stderr.as_str()), (Some(0), ""), "{}", few.stdout);
    assert!(few.stdout.contains("\ntoo few walks to tell: a total could be tested with some "), "{}", few.stdout);
    // Single cells are still too thin, totals are not.
    let other = place.run(&["compare", "c", "d"]);
    assert_eq!((other.code, other.stderr.as_str()), (Some(1), "error: the results differ\n"), "{}", other.stdout);
    assert!(other.stdout.contains("\ncells     0 of "), "{}", other.stdout);
    assert!(other.stdout.contains(" and 8 of 8 totals of hemispheres of single incident cells\n"), "{}", other.stdout);
}
