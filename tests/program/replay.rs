//! A plan is replayed: the files are the same, whatever the clock said.

use crate::common::program::{Outcome, Place};
use serde_json::Value;

/// A mesh of single filaments, which no medium is right for, and a sheet, whose medium costs nothing.
const MESH: &str = "[fiber.a]\nradius_um = 30\nior = 1.5\n[yarn.a]\nfiber = \"a\"\nfibers_per_ply = 1\nwidth_um = 64\nheight_um = 64\n\
                    [weave]\ndraft = [\"X.\", \".X\"]\nwarp = [\"a\"]\nweft = [\"a\"]\nends_per_cm = 80\npicks_per_cm = 80\n";
const SHEET: &str = "[fiber.f]\nradius_um = 10\nior = 1.5\n[sheet]\nthickness_um = 400\n[[sheet.fibers]]\nfiber = \"f\"\n\
                     length_density_per_mm2 = 400\norientation = \"isotropic\"\n[model]\npacking = \"random\"\n";

fn measure(place: &Place, arguments: &[&str]) -> Outcome {
    place.run(&[&["measure"][..], arguments, &["--incident", "4", "--exit", "8", "--quiet", "--force"]].concat())
}

#[test]
fn a_run_by_the_plan_of_another_has_its_files_and_another_cloth_is_refused() {
    let place = Place::new();
    let read = |name: &str| std::fs::read(place.path(name)).expect("it is there");
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
        place.write(&file, cloth);
        let again = format!("{name}-again");
        assert!(measure(&place, &[&file, "--tolerance", tolerance]).code == Some(0));
        assert!(measure(&place, &[&file, "--plan", name, "-o", &again]).code == Some(0));
        assert_eq!(summary(name)["model"]["medium"], medium);
        assert_eq!(summary(name), summary(&again), "{name}");
        for table in ["bsdf.exr", "tally.exr"] {
            assert!(read(&format!("{name}/{table}")) == read(&format!("{again}/{table}")), "{name}: {table}");
        }
        // Another seed gives other walks by the same plan.
        assert!(measure(&place, &[&file, "--plan", name, "-o", &again, "--seed", "2"]).code == Some(0));
        assert_eq!(summary(name)["plan"], summary(&again)["plan"]);
        assert!(read(&format!("{name}/tally.exr")) != read(&format!("{again}/tally.exr")));
    }
    for (arguments, told) in [
        (["mesh.toml", "--plan", "sheet"], "is of another cloth"),
        (["mesh.toml", "--plan", "nothing"], "nothing/summary.json: cannot read the plan"),
    ] {
        let output = measure(&place, &[&arguments[..], &["-o", "x"]].concat());
        assert_eq!(output.code, Some(2));
        let said = output.stderr;
        assert!(said.contains(told) && said.lines().count() == 1, "{said}");
        assert!(!place.path("x").exists());
    }
}
