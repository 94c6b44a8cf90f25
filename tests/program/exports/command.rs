//! The command `export`: what it says, what it refuses, and that no format loses light.

use super::made::{lobes, written};
use crate::common::program::Place;
use fiberwalk::export::Format;
use fiberwalk::scene::BasisChoice;

/// Measure the nonwoven with few walks.
fn measured(more: &[&str]) -> Place {
    let place = Place::new();
    let common = ["measure", "nonwoven", "--walks", "200", "--engine", "cpu", "--quiet"];
    let outcome = place.run(&[&common[..], more].concat());
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    place
}

#[test]
fn what_cannot_be_written_is_said_before_anything_is() {
    let place = measured(&["--incident", "[[30, 0]]"]);
    let before = place.contents();
    let refused = |arguments: &[&str], message: &str| {
        let outcome = place.run(arguments);
        assert_eq!((outcome.code, outcome.stdout.as_str()), (Some(2), ""), "{arguments:?}");
        let last = outcome.stderr.lines().last().unwrap_or_default().to_owned();
        assert!(last.starts_with(&format!("error: {message}")), "{last}");
        assert!(place.contents() == before, "{arguments:?} changed files");
    };
    refused(
        &["export", "nonwoven", "--to", "csv,klems"],
        "klems needs light from the whole hemisphere, but this result has a list",
    );
    refused(&["export", "nonwoven"], "the following required arguments were not provided: --to <FORMATS>");
    refused(&["export", "nonwoven", "--to", "merl"], "invalid value 'merl' for '--to <FORMATS>'");
    refused(&["export", "nowhere", "--to", "csv"], "nowhere: cannot read the tally: ");
    let outcome = place.run(&["export", "nonwoven", "--to", "csv"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    assert!(outcome.stdout.starts_with("nonwoven/export/nonwoven.csv\n  read again: "), "{}", outcome.stdout);
}

#[test]
fn a_file_in_the_way_is_named() {
    let place = measured(&["--incident", "2", "--exit", "2"]);
    place.write("nonwoven/export", "in the way");
    let outcome = place.run(&["export", "nonwoven", "--to", "csv"]);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (Some(2), ""));
    assert!(
        outcome.stderr.ends_with("error: nonwoven/export is not a folder: files go there, so move it away\n"),
        "{}",
        outcome.stderr
    );
}

#[test]
fn halves_are_averaged_only_where_that_can_be_told() {
    let place = measured(&["--incident", "2", "--exit", "2"]);
    let outcome = place.run(&["export", "nonwoven", "--to", "csv", "--reciprocal"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    let mut lines = outcome.stdout.lines();
    assert!(
        lines.next().is_some_and(|line| line.starts_with("reciprocal: front reflection differed from its reverse by "))
    );
    let one_side = "reciprocal: front transmission stays as it is: the other side was not lit";
    assert!(lines.next().is_some_and(|line| line.starts_with(one_side)), "{}", outcome.stdout);
}

#[test]
fn every_format_has_all_of_the_light_and_finds_its_own_cells_again() {
    let table = lobes(BasisChoice::Disc(4), BasisChoice::Disc(16));
    for format in Format::ALL {
        let (_, made) = written(&table, format);
        assert!(!made.checks.is_empty(), "{format:?} is read again");
        for (name, check) in &made.checks {
            println!("{name}: E = {:.2} %, light off by {:.1e}", 100.0 * check.relative, check.light);
            let (exact, light) = match format {
                Format::Csv | Format::SpectralExr => (1e-5, 1e-6),
                // Half an error of a table that has next to none.
                Format::TensorTree => (1e-3, 1e-4),
                // Cells of another shape, or means of what is linear.
                Format::Klems => (0.12, 0.03),
                _ => (0.09, 0.01),
            };
            assert!(check.cells > 1000 && check.relative < exact && check.light < light, "{name}: {check:?}");
        }
    }
}
