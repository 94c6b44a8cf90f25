//! The program as a user meets it: commands, their output, their files.

use crate::common::program::CACHE;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn fiberwalk(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fiberwalk"));
    command.args(arguments).current_dir(folder).env("XDG_RUNTIME_DIR", folder).env("XDG_CACHE_HOME", CACHE);
    command.output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("output is UTF-8")
}

/// Run a measurement and read its summary.
fn measure(folder: &Path, arguments: &[&str]) -> (Output, Value) {
    let output = fiberwalk(folder, &[&["measure"], arguments].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let name = text(&output.stdout).lines().last().expect("the last line names the summary").to_owned();
    let summary = std::fs::read_to_string(folder.join(name)).expect("the summary is there");
    (output, serde_json::from_str(&summary).expect("the summary is JSON"))
}

/// Largest resident memory of a run in MiB.
fn peak_mib(folder: &Path, arguments: &[&str]) -> f64 {
    let (_, summary) = measure(folder, &[arguments, &["--force"]].concat());
    summary["peak_bytes"].as_u64().expect("Linux tells the peak") as f64 / f64::from(1 << 20)
}

/// What the program takes for itself is told apart from what a driver takes for its device, its compiler and its threads.
#[test]
fn the_default_measurement_takes_little_memory_of_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let peak = |arguments: &[&str]| peak_mib(folder.path(), arguments);
    // Without a driver all is the program's own.
    let own = peak(&["felt", "--engine", "cpu", "--tolerance", "30%"]);
    assert!(own < 48.0, "{own:.0} MiB");
    // The least run has the driver with the same kernel.
    let driver = peak(&["felt", "--engine", "gpu", "--walks", "16", "--incident", "2", "--exit", "4"]);
    let whole = peak(&["felt", "--engine", "gpu", "--tolerance", "20%"]);
    println!(
        "of its own {own:.0} MiB; with a driver {whole:.0} MiB, of which {driver:.0} MiB are there before there is anything to do"
    );
    assert!(whole < driver + 48.0, "{whole:.0} MiB with a driver that takes {driver:.0}");
    // A sheet with more exit cells takes more: the figures are alive.
    let fine = ["felt", "--engine", "cpu", "--walks", "16", "--incident", "24", "--exit", "128"];
    assert!(peak(&fine) > own + 50.0);
}

#[test]
fn results_go_to_stdout_and_notes_to_stderr() {
    let folder = tempfile::tempdir().expect("a folder");
    let (output, summary) = measure(folder.path(), &["nonwoven", "--walks", "500", "--engine", "cpu"]);
    let (results, notes) = (text(&output.stdout), text(&output.stderr));
    assert!(results.starts_with("light from"), "{results}");
    assert_eq!(results.lines().filter(|line| line.contains('±')).count(), 4, "hemispherical, 0, 30, 60 degrees");
    assert!(results.contains("nonwoven/bsdf.exr"), "the default folder is the preset's name:\n{results}");
    assert!(notes.contains("engine: cpu on") && notes.contains("asked for"), "{notes}");
    assert_eq!(summary["walks"], 64 * 500);
    assert_eq!(summary["walks_per_incident"], 500);
    assert_eq!(summary["model"]["directions"], 1024);
    assert_eq!(summary["sides"]["front"]["incident"].as_array().map(Vec::len), Some(64));
    let (quiet, _) = measure(folder.path(), &["nonwoven", "--walks", "500", "--engine", "cpu", "--quiet", "--force"]);
    assert_eq!(text(&quiet.stderr), "");
}

#[test]
fn shares_of_every_incident_direction_add_up() {
    let folder = tempfile::tempdir().expect("a folder");
    for engine in ["gpu", "cpu"] {
        let incident = ["--incident", "[[0, 0], [30, 45], [60, -20]]"];
        let arguments = [&["felt", "--walks", "3000", "--engine", engine, "--force"][..], &incident].concat();
        let (output, summary) = measure(folder.path(), &arguments);
        assert_eq!(summary["engine"], engine);
        assert_eq!(summary["sides"]["front"]["hemispherical"], Value::Null, "a list has no mean");
        assert_eq!(text(&output.stdout).lines().filter(|line| line.starts_with('θ')).count(), 3);
        let directions = summary["sides"]["front"]["incident"].as_array().expect("a list");
        assert_eq!(directions[1]["theta_deg"], 30.0);
        assert_eq!(directions[2]["phi_deg"], -20.0);
        for entry in directions {
            let share = |key: &str| entry[key]["Y"]["value"].as_f64().expect("a number");
            let sum = share("reflectance") + share("transmittance") + share("direct") + share("absorptance");
            assert!((sum + entry["lost"].as_f64().expect("a number") - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_files_and_another_seed_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = |seed: &str| {
        measure(folder.path(), &["nonwoven", "--walks", "300", "--seed", seed, "--force"]);
        std::fs::read(folder.path().join("nonwoven/bsdf.exr")).expect("the table is there")
    };
    let first = bytes("5");
    assert!(first == bytes("5"), "the same seed gave another table");
    assert!(first != bytes("6"), "another seed gave the same table");
}

#[test]
fn flags_have_their_way_over_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let cloth = "[fiber.f]\nradius_um = 10\nior = 1.5\n[sheet]\nthickness_um = 100\n[[sheet.fibers]]\nfiber = \"f\"\n\
                 length_density_per_mm2 = 100\norientation = \"planar\"\n[measure]\nincident = 4\nexit = 4\n";
    std::fs::write(folder.path().join("my cloth.toml"), cloth).expect("it can be written");
    let (_, plain) = measure(folder.path(), &["my cloth.toml", "--walks", "10", "--engine", "cpu"]);
    assert_eq!(plain["walks"], 160);
    assert_eq!(plain["name"], "my cloth", "without a name the file's stem serves");
    let all =
        ["--incident", "2", "--exit", "3", "--sides", "front", "--tracking", "null-collision", "--placement", "at-hit"];
    let arguments = [&["my cloth.toml", "--walks", "10", "--engine", "cpu", "--force"][..], &all].concat();
    assert_eq!(measure(folder.path(), &arguments).1["walks"], 40);
}

#[test]
fn tracking_is_chosen_by_flag_and_by_file_and_its_error_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let cloth = |model: &str| {
        let text = format!(
            "[fiber.f]\nradius_um = 10\nior = 1.5\n[sheet]\nthickness_um = 100\n[[sheet.fibers]]\nfiber = \"f\"\n\
             length_density_per_mm2 = 100\norientation = \"planar\"\n[measure]\nincident = 4\nexit = 4\n{model}"
        );
        std::fs::write(folder.path().join("sheet.toml"), text).expect("it can be written");
    };
    let told = "a table of H for 64 × 64 rays; the largest error of H found is";
    let inspected = || text(&fiberwalk(folder.path(), &["inspect", "sheet.toml"]).stdout);
    for engine in ["gpu", "cpu"] {
        let run = |more: &[&str]| {
            let arguments = ["sheet.toml", "--walks", "100", "--force", "--engine", engine];
            let (output, summary) = measure(folder.path(), &[&arguments[..], more].concat());
            (text(&output.stderr).contains(told), summary["model"]["tracking"].clone())
        };
        cloth("");
        assert_eq!(run(&[]), (false, "null-collision".into()));
        assert_eq!(run(&["--tracking", "tabulated"]), (true, "tabulated".into()));
        cloth("[model]\ntracking = \"tabulated\"\n");
        assert_eq!(run(&[]), (true, "tabulated".into()));
        assert_eq!(run(&["--tracking", "null-collision"]), (false, "null-collision".into()));
    }
    assert!(inspected().contains("table of H       64 × 64 rays; the largest error of H found is"), "{}", inspected());
    cloth("");
    assert!(!inspected().contains("table of H"), "{}", inspected());
}

#[test]
fn a_dyed_cloth_shows_its_channels_on_both_sides() {
    let folder = tempfile::tempdir().expect("a folder");
    let cloth = |absorption: &str, more: &str| {
        let text = format!(
            "[fiber.f]\nradius_um = 10\nior = 1.5\nabsorption_per_mm = {absorption}\n[sheet]\nthickness_um = 400\n\
             [[sheet.fibers]]\nfiber = \"f\"\nlength_density_per_mm2 = 300\norientation = \"isotropic\"\n{more}"
        );
        std::fs::write(folder.path().join("dyed.toml"), text).expect("it can be written");
    };
    std::fs::write(folder.path().join("f.csv"), "300, 1\n800, 30\n").expect("it can be written");
    let spectrum = "{ spectrum = \"f.csv\" }";
    let three = "[measure]\nwavelengths_nm = [450, 550.5]\n";
    // Of many channels the first, the middle and the last are printed.
    let ends = ["T.400,000000nm", "T.550,000000nm", "T.700,000000nm"];
    for (absorption, more, names, all) in [
        ("5", "", &[][..], 1),
        ("{ rgb = [1, 5, 30] }", "", &["R", "G", "B"], 3),
        (spectrum, three, &["T.450,000000nm", "T.550,500000nm"], 2),
        (spectrum, "", &ends, 31),
    ] {
        for engine in ["gpu", "cpu"] {
            cloth(absorption, more);
            let arguments =
                ["--sides", "front,back", "--incident", "2", "--walks", "500", "--engine", engine, "--force"];
            let (output, summary) = measure(folder.path(), &[&["dyed.toml"][..], &arguments].concat());
            let printed = text(&output.stdout);
            let labels: Vec<&str> = printed.lines().filter(|line| line.starts_with(['f', 'b'])).collect();
            let labelled = |side: &str| match names {
                [] => vec![side.to_owned()],
                names => names.iter().map(|name| format!("{side} {name}")).collect(),
            };
            assert_eq!(labels, [labelled("front"), labelled("back")].concat(), "{printed}");
            for side in ["front", "back"] {
                let mean = &summary["sides"][side]["hemispherical"];
                assert_eq!(mean["absorptance"].as_object().map(|channels| channels.len()), Some(all));
                for (channel, absorbed) in mean["absorptance"].as_object().expect("shares by channel") {
                    assert!(absorbed["value"].as_f64() > Some(0.0) && absorbed["stderr"].as_f64() > Some(0.0));
                    let shares = ["reflectance", "transmittance", "direct", "absorptance"];
                    let sum: f64 = shares.iter().filter_map(|key| mean[key][channel]["value"].as_f64()).sum();
                    assert!((sum + mean["lost"].as_f64().expect("a number") - 1.0).abs() < 1e-12, "{side}, {channel}");
                }
            }
        }
    }
}

#[test]
fn a_new_cloth_file_can_be_inspected_and_measured() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = fiberwalk(folder.path(), &["new", "my cloth"]);
    assert_eq!(text(&output.stdout), "my cloth.toml\n");
    let inspected = text(&fiberwalk(folder.path(), &["inspect", "my cloth.toml"]).stdout);
    // π 0.006² 600 = 0.0679 of the volume, times 0.5 mm and 1.5 g/cm³ = 50.9 g/m².
    for line in ["my cloth\n", "volume fraction  0.0679\n", "areal mass       50.9 g/m²\n"] {
        assert!(inspected.contains(line), "{inspected}");
    }
    // From above planar fibers show H d = 2 R L d = 3.6.
    assert!(inspected.contains("optical depth 3.600, direct light 2.732e-2"), "{inspected}");
    measure(folder.path(), &["my cloth.toml", "--walks", "10", "--engine", "cpu"]);
    // A file is never written over, and a name is not a path.
    let before = std::fs::read(folder.path().join("my cloth.toml")).expect("it is there");
    for name in ["my cloth", "a/b", "", "a\"b"] {
        assert_eq!(fiberwalk(folder.path(), &["new", name]).status.code(), Some(2), "{name}");
    }
    assert_eq!(std::fs::read(folder.path().join("my cloth.toml")).expect("it is there"), before);
}

#[test]
fn a_run_stops_at_its_tolerance_and_when_nothing_scatters() {
    let folder = tempfile::tempdir().expect("a folder");
    let (output, summary) = measure(folder.path(), &["nonwoven", "--tolerance", "20%"]);
    let planned = 100.0 * summary["plan"]["noise"].as_f64().expect("a number");
    assert!(
        text(&output.stderr).contains("for a tolerance of 20 %")
            && text(&output.stderr).contains(&format!("stop: at a noise of {:.0}.", planned.floor())),
        "{}",
        text(&output.stderr)
    );
    let walks = summary["walks_per_incident"].as_u64().expect("a number");
    assert!(walks.is_multiple_of(256) && (10.0..20.0).contains(&planned), "{walks} {planned}");
    let noise = |output: &Output| -> f64 {
        let out = text(&output.stdout);
        let (_, after) = out.split_once("scattered light ").expect("the noise is said");
        after.split_once(" %").expect("in percent").0.parse().expect("a number")
    };
    // No more walks than it takes, beyond the first 4096 of each cell.
    assert!(noise(&output) <= planned + 0.005, "{}", noise(&output));
    assert!(walks == 4096 || noise(&output) > 0.97 * planned, "{walks}: {} of {planned}", noise(&output));
    // Light along exactly aligned fibers meets none.
    let cloth = "[fiber.f]\nradius_um = 10\nior = 1.5\n[sheet]\nthickness_um = 100\n[[sheet.fibers]]\nfiber = \"f\"\n\
                 length_density_per_mm2 = 100\norientation = \"aligned\"\naxis = [0, 0, 1]\n";
    std::fs::write(folder.path().join("clear.toml"), cloth).expect("it can be written");
    let (output, _) = measure(folder.path(), &["clear.toml", "--incident", "[[0, 0]]"]);
    assert!(text(&output.stdout).contains("unknown: nothing scattered"), "{}", text(&output.stdout));
}

/// Separate fibers reflect 0.4549 ± 0.0007 of even light by the medium for them, overlapping ones 0.4395 ± 0.0002.
#[test]
fn a_sheet_is_the_same_under_every_stop_rule() {
    let folder = tempfile::tempdir().expect("a folder");
    let reflected = |arguments: &[&str]| {
        let (output, summary) = measure(folder.path(), &[&["nonwoven", "--force"], arguments].concat());
        let reflected = &summary["sides"]["front"]["hemispherical"]["reflectance"]["Y"];
        let number = |key: &str| reflected[key].as_f64().expect("a number");
        let told = text(&output.stdout).contains("walks through the fibers themselves");
        (number("value"), number("stderr"), summary["model"].clone(), told)
    };
    let rules = [["--walks", "4000"], ["--tolerance", "20%"], ["--time", "0.7s"]];
    let found = rules.map(|rule| reflected(&rule));
    for (rule, (value, stderr, model, told)) in rules.iter().zip(&found) {
        assert_eq!(model, &found[0].2, "{rule:?}");
        assert!((value - 0.4549).abs() < 4.0 * stderr.hypot(0.0007), "{rule:?}: {value} ± {stderr}");
        assert!(told, "{rule:?} is not held against its fibers");
    }
    // Of fibers that may overlap it is another cloth, and the same under every rule as well.
    for rule in &rules[..2] {
        let (value, stderr, ..) = reflected(&[&rule[..], &["--packing", "random"]].concat());
        assert!((value - 0.4395).abs() < 4.0 * stderr.hypot(0.0002), "{rule:?}: {value} ± {stderr}");
        assert!((value - 0.4549).abs() > 8.0 * stderr, "{rule:?}: {value} ± {stderr}");
    }
}

/// Sheets so sparse that a realization has no fiber: all light goes straight through, under every rule and through every model.
#[test]
fn where_there_is_hardly_a_fiber_all_light_is_direct() {
    let folder = tempfile::tempdir().expect("a folder");
    let sheet = |radius: f64, thickness: f64, density: &str| {
        format!(
            "[fiber.f]\nradius_um = {radius}\nior = 1.53\n[sheet]\nthickness_um = {thickness}\n[[sheet.fibers]]\nfiber = \"f\"\n\
             length_density_per_mm2 = {density}\norientation = \"planar\"\n[measure]\nincident = 2\nexit = 4\n"
        )
    };
    for (name, text, least) in
        [("tiny", sheet(6.0, 500.0, "1e-300"), 1.0), ("thin", sheet(1000.0, 1.0, "0.0001"), 0.9999)]
    {
        std::fs::write(folder.path().join(format!("{name}.toml")), text).expect("it can be written");
        for packing in ["separate", "random"] {
            for rule in [&["--walks", "2000"][..], &["--tolerance", "5%"], &["--model", "explicit", "--walks", "2000"]]
            {
                let file = format!("{name}.toml");
                let arguments = [&[&file, "--packing", packing, "--force"][..], rule].concat();
                let direct =
                    measure(folder.path(), &arguments).1["sides"]["front"]["hemispherical"]["direct"]["Y"]["value"]
                        .as_f64();
                assert!(direct >= Some(least), "{arguments:?}: {direct:?}");
            }
        }
    }
}

/// A warning is given where the medium is surely off, and no other.
#[test]
fn a_medium_that_is_off_is_warned_of() {
    let folder = tempfile::tempdir().expect("a folder");
    let cloth = "[fiber.f]\nradius_um = 10\nior = 1.5\n[sheet]\nthickness_um = 200\n[[sheet.fibers]]\nfiber = \"f\"\n\
                 length_density_per_mm2 = 955\norientation = \"isotropic\"\n[measure]\nincident = 4\n";
    std::fs::write(folder.path().join("dense.toml"), cloth).expect("it can be written");
    let warned = |more: &[&str]| {
        let arguments = ["dense.toml", "--walks", "10000", "--packing", "random", "--force"];
        let said = text(&measure(folder.path(), &[&arguments[..], more].concat()).0.stdout);
        assert!(said.contains("walks through the fibers themselves"), "{said}");
        let warning = said.lines().find(|line| line.starts_with("warning: ") && line.contains("of its value"));
        warning.map(str::to_owned)
    };
    assert_eq!(warned(&[]), None, "the medium of overlapping fibers is right for them");
    let warning = warned(&["--placement", "at-hit"]).expect("at-hit is off by a quarter of the hits");
    assert!(warning.ends_with("; placement \"carried\" or --model explicit may mend it"), "{warning}");
}

#[test]
fn a_spread_bundle_says_how_far_the_grid_smears_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let cloth = "[fiber.f]\nradius_um = 10\nior = 1.5\n[sheet]\nthickness_um = 100\n[[sheet.fibers]]\nfiber = \"f\"\n\
                 length_density_per_mm2 = 100\norientation = \"aligned\"\naxis = [1, 0.3, 0]\nspread_deg = 12\n";
    std::fs::write(folder.path().join("spread.toml"), cloth).expect("it can be written");
    let (output, _) = measure(folder.path(), &["spread.toml", "--walks", "10", "--engine", "cpu"]);
    assert!(text(&output.stderr).contains("smears the spread bundles"), "{}", text(&output.stderr));
}
