//! `fiberwalk chart`: its files, that it goes on where it stopped, and what it refuses.

use crate::common::program::{Outcome, Place};
use fiberwalk::plan::chart::COLUMNS;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

/// A thin sheet: everything is quick.
const CLOTH: &str = "name = \"a <thin> \\\"sheet\\\" & more\"\n[fiber.f]\nradius_um = 10\nior = 1.5\n[sheet]\nthickness_um = 60\n\
                     [[sheet.fibers]]\nfiber = \"f\"\nlength_density_per_mm2 = 600\norientation = \"planar\"\n[model]\npacking = \"random\"\n";

fn chart(place: &Place, more: &[&str]) -> Outcome {
    place.write("cloth.toml", CLOTH);
    place.run(&[&["chart", "cloth.toml", "--engine", "cpu", "--quiet"][..], more].concat())
}

fn read(place: &Place, file: &str) -> String {
    std::fs::read_to_string(place.path("cloth").join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// Rows of the table by column, all of the same length.
fn table(text: &str) -> Vec<BTreeMap<&str, &str>> {
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().expect("it has a head").split(',').collect();
    assert_eq!(head, COLUMNS);
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            assert_eq!(cells.len(), head.len(), "{line}");
            head.iter().copied().zip(cells).collect()
        })
        .collect()
}

/// Walks of each start that were made, by configuration.
fn made(text: &str) -> BTreeMap<String, u64> {
    let of = |row: BTreeMap<&str, &str>| (row["name"].to_owned(), row["walks_made"].parse().expect("a number"));
    table(text).into_iter().map(of).collect()
}

#[test]
fn a_chart_has_a_table_a_picture_and_a_page_that_agree() {
    let place = Place::new();
    let outcome = chart(&place, &["--time", "2s"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    assert!(outcome.stdout.contains("error budget of random carried 1024d"), "{}", outcome.stdout);
    assert_eq!(outcome.stderr, "");
    let text = read(&place, "chart.csv");
    let rows = table(&text);
    assert!(rows.iter().any(|row| row["model"] == "explicit") && rows.iter().any(|row| row["own"] == "true"));
    for row in &rows {
        let number = |column: &str| row[column].parse::<f64>().unwrap_or_else(|error| panic!("{column}: {error}"));
        let total = number("noise").hypot(number("model_error"));
        assert!((total / number("total_error") - 1.0).abs() < 1e-4, "{row:?}");
        assert!((number("total_s") - number("prepare_s") - number("seconds")).abs() < 1e-4 * number("total_s"));
        for (low, middle, high) in [
            ("seconds_min", "seconds", "seconds_max"),
            ("total_s_min", "total_s", "total_s_max"),
            ("model_error_low", "model_error", "model_error_high"),
            ("total_error_low", "total_error", "total_error_high"),
        ] {
            assert!(number(low) <= number(middle) && number(middle) <= number(high), "{row:?}");
        }
        // Noise falls with the root of the walks.
        let first = rows.iter().find(|other| other["name"] == row["name"]).expect("it is there");
        let law = |row: &BTreeMap<&str, &str>| {
            row["noise"].parse::<f64>().expect("a number") * row["walks"].parse::<f64>().expect("a number").sqrt()
        };
        assert!((law(row) / law(first) - 1.0).abs() < 1e-4);
        // No row on the front is beaten in both, by the seconds in all and the upper bound of the error.
        let beats = |a: &BTreeMap<&str, &str>| {
            ["total_s", "total_error_high"]
                .iter()
                .all(|column| a[column].parse::<f64>().expect("a number") < number(column))
        };
        assert_eq!(row["pareto"] == "true", !rows.iter().any(beats), "{row:?}");
    }
    let picture = read(&place, "chart.svg");
    let picture = roxmltree::Document::parse(&picture).expect("the picture is XML");
    let marks: Vec<_> = picture.descendants().filter(|node| is_mark(node)).collect();
    assert_eq!(marks.len(), 2 * rows.len(), "each point is in both frames");
    for mark in &marks {
        let title = mark.children().find(|node| node.has_tag_name("title")).and_then(|node| node.text());
        let title = title.expect("a mark says what it is");
        assert!(rows.iter().any(|row| title.starts_with(&format!("{} on cpu", row["name"]))), "{title}");
    }
    let on = marks.iter().filter(|mark| mark.attribute("tabindex") == Some("0")).count();
    let front = |column: &str| rows.iter().filter(|row| row[column] == "true").count();
    assert_eq!(on, front("pareto") + front("pareto_walks"));
    let page = read(&place, "chart.html");
    assert!(page.contains("a &lt;thin&gt; &quot;sheet&quot; &amp; more"));
    // Nothing is fetched from anywhere.
    for word in ["http:", "https:", " src=", " href=", "url(", "@import", "fetch("] {
        assert!(!page.contains(word), "the page has `{word}`");
    }
    assert_eq!(page.matches("<tr class=").count(), rows.len());
    assert!(!page.contains("{title}") && !page.contains("NaN") && !page.contains("inf s"));
}

fn is_mark(node: &roxmltree::Node) -> bool {
    node.attribute("class").is_some_and(|class| class.split(' ').any(|word| word == "m"))
}

#[test]
fn a_chart_goes_on_and_is_not_mixed_with_another() {
    let place = Place::new();
    assert_eq!(chart(&place, &["--time", "1s"]).code, Some(0));
    let first = made(&read(&place, "chart.csv"));
    // More time goes on with the walks that were made.
    let state: serde_json::Value = serde_json::from_str(&read(&place, "chart.state/chart.json")).expect("it is JSON");
    let spent = state["spent"].as_f64().expect("the seconds are kept");
    assert_eq!(chart(&place, &["--time", &format!("{:.3}s", spent + 3.0)]).code, Some(0));
    let second = made(&read(&place, "chart.csv"));
    assert!(first.iter().all(|(name, walks)| second[name] >= *walks));
    assert!(second.values().sum::<u64>() > first.values().sum::<u64>());
    // No more time is no more walks.
    assert_eq!(chart(&place, &["--time", "1s"]).code, Some(0));
    assert_eq!(made(&read(&place, "chart.csv")), second);
    for (more, what) in [
        (&["--seed", "2"][..], "holds a chart of seed 1"),
        (&["--incident", "[[10, 0]]"], "other incident directions"),
        (&["--exit", "4"], "other exit cells"),
    ] {
        let outcome = chart(&place, &[more, &["--time", "4s"]].concat());
        assert_eq!(outcome.code, Some(2), "{}", outcome.stdout);
        assert!(outcome.stderr.contains(what) && outcome.stderr.contains("--force starts anew"), "{}", outcome.stderr);
    }
    assert_eq!(made(&read(&place, "chart.csv")), second);
    // A state that was spoilt is named.
    let file = place.path("cloth/chart.state/random_carried_1024d.json");
    let text = std::fs::read_to_string(&file).expect("there is a state");
    std::fs::write(&file, text.replacen("\"launched\":", "\"launched\":1", 1)).expect("it can be written");
    let outcome = chart(&place, &["--time", "4s"]);
    assert_eq!(outcome.code, Some(2));
    assert!(outcome.stderr.contains("random_carried_1024d.json: not the state of a chart"), "{}", outcome.stderr);
    // Anew, with another seed.
    let outcome = chart(&place, &["--time", "1s", "--seed", "2", "--force"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
}

#[test]
fn a_chart_that_is_killed_loses_no_point() {
    let place = Place::new();
    place.write("cloth.toml", CLOTH);
    let arguments = ["chart", "cloth.toml", "--engine", "cpu", "--quiet", "--time", "600s"];
    let mut child = place.command(&arguments).spawn().expect("the program can be started");
    let points = |folder: &Path| std::fs::read_dir(folder).map_or(0, |files| files.count());
    let waiting = Instant::now();
    let state = place.path("cloth/chart.state");
    while points(&state) < 4 && waiting.elapsed() < Duration::from_secs(120) {
        std::thread::sleep(Duration::from_millis(20));
    }
    child.kill().expect("it can be killed");
    child.wait().expect("it ends");
    let of = |name: &str| std::fs::read(state.join(name)).expect("it is there");
    let before = of("random_fibers_256w.json");
    // Time enough for one visit to each of the least points: what there was is kept.
    let outcome = chart(&place, &["--time", "0.01s"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    assert_eq!(of("random_fibers_256w.json"), before);
    assert!(made(&read(&place, "chart.csv")).len() >= 2);
}

#[test]
fn a_chart_as_json_has_all_points() {
    let place = Place::new();
    place.write("cloth.toml", CLOTH);
    let arguments =
        ["chart", "cloth.toml", "--engine", "cpu", "--json", "--time", "1s", "--incident", "[[0, 0]]", "--exit", "2"];
    let outcome = place.run(&arguments);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    let value: serde_json::Value = serde_json::from_str(&outcome.stdout).expect("stdout is JSON");
    let text = read(&place, "chart.csv");
    let rows = table(&text).len();
    assert_eq!(value["points"].as_array().map(Vec::len), Some(rows));
    assert_eq!(value["budget"]["parts"].as_array().map(Vec::len), Some(6));
    let outcome = place.run(&["chart", "cloth.toml", "--time", "0s"]);
    assert_eq!(outcome.code, Some(2));
    assert!(outcome.stderr.contains("must be a time"), "{}", outcome.stderr);
}
