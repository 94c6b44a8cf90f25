//! A plan is replayed: the files are the same, whatever the clock said.

use crate::common::program::CACHE;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// A mesh of single filaments, which no medium is right for, and a sheet, whose medium costs nothing.
const MESH: &str = "[fiber.a]\nradius_um = 30\nior = 1.5\n[yarn.a]\nfiber = \"a\"\nfibers_per_ply = 1\nwidth_um = 64\nheight_um = 64\n\
                    [weave]\ndraft = [\"X.\", \".X\"]\nwarp = [\"a\"]\nweft = [\"a\"]\nends_per_cm = 80\npicks_per_cm = 80\n";
const SHEET: &str = "[fiber.f]\nradius_um = 10\nior = 1.5\n[sheet]\nthickness_um = 400\n[[sheet.fibers]]\nfiber = \"f\"\n\
                     length_density_per_mm2 = 400\norientation = \"isotropic\"\n[model]\npacking = \"random\"\n";

fn measure(folder: &Path, arguments: &[&str]) -> Output {
    let all = [&["measure"][..], arguments, &["--incident", "4", "--exit", "8", "--quiet", "--force"]].concat();
    let mut command = Command::new(env!("CARGO_BIN_EXE_fiberwalk"));
    command.env("XDG_RUNTIME_DIR", folder).env("XDG_CACHE_HOME", CACHE);
    command.args(all).current_dir(folder).output().expect("the program runs")
}

#[test]
fn a_run_by_the_plan_of_another_has_its_files_and_another_cloth_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("it is there");
    let summary = |name: &str| -> Value {
        let mut value: Value = serde_json::from_slice(&read(&format!("{name}/summary.json"))).expect("it is JSON");
        let fields = value.as_object_mut().expect("an object");
        for clock in ["seconds", "walks_per_second", "collisions_per_second", "peak_bytes", "choice"] {
            fields.remove(clock);
        }
        value
    };
    for (name, cloth, medium, tolerance) in [("mesh", MESH, "explicit", "10%"), ("sheet", SHEET, "implicit", "5%")] {
        let file = format!("{name}.toml");
        std::fs::write(folder.path().join(&file), cloth).expect("it can be written");
        let again = format!("{name}-again");
        assert!(measure(folder.path(), &[&file, "--tolerance", tolerance]).status.success());
        assert!(measure(folder.path(), &[&file, "--plan", name, "-o", &again]).status.success());
        assert_eq!(summary(name)["model"]["medium"], medium);
        assert_eq!(summary(name), summary(&again), "{name}");
        for table in ["bsdf.exr", "tally.exr"] {
            assert!(read(&format!("{name}/{table}")) == read(&format!("{again}/{table}")), "{name}: {table}");
        }
        // Another seed gives other walks by the same plan.
        assert!(measure(folder.path(), &[&file, "--plan", name, "-o", &again, "--seed", "2"]).status.success());
        assert_eq!(summary(name)["plan"], summary(&again)["plan"]);
        assert!(read(&format!("{name}/tally.exr")) != read(&format!("{again}/tally.exr")));
    }
    for (arguments, told) in [
        (["mesh.toml", "--plan", "sheet"], "is of another cloth"),
        (["mesh.toml", "--plan", "nothing"], "nothing/summary.json: cannot read the plan"),
    ] {
        let output = measure(folder.path(), &[&arguments[..], &["-o", "x"]].concat());
        assert_eq!(output.status.code(), Some(2));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains(told) && said.lines().count() == 1, "{said}");
        assert!(!folder.path().join("x").exists());
    }
}
