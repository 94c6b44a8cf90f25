//! Settings of model and instrument.

use super::refusals::{
    CLOTH, EXIT, FEW, INCIDENT, MEASURE, SPECTRUM, another, check_measured, refuse, refuse_arguments, refuse_edits,
    refuse_lines, spectral, summary,
};
use crate::common::program::Place;

/// Every new thing at once, and its absence in turn.
#[test]
fn colours_kinds_bases_and_both_sides_are_measured() {
    let two = another("silk", "absorption_per_mm = 2\n");
    let four: String = ["silk", "flax", "hemp"].iter().map(|name| another(name, "absorption_per_mm = 2\n")).collect();
    let both = "[measure]\nsides = [\"back\", \"front\"]\n";
    for (lines, channels, sides) in [
        (String::new(), 31, 1),
        ("[measure]\nwavelengths_nm = [400, 550.5, 700]\n".into(), 3, 1),
        (two, 31, 1),
        (format!("{four}{both}"), 31, 2),
        (format!("[model]\nlength_over_radius = 2\n{both}"), 31, 2),
    ] {
        let place = spectral("s.csv", &lines);
        place.write("s.csv", SPECTRUM);
        check_measured(&place, channels, sides);
    }
    let grey = "ior = 1.5\nabsorption_per_mm = 0.4";
    let rgb = "ior = 1.5\nabsorption_per_mm = { rgb = [0, 7.0, 1e5] }";
    let fine = "density_g_per_cm3 = 1.5\nfineness_dtex = 1.7";
    for (old, new, channels) in [("ior = 1.5", grey, 1), ("ior = 1.5", rgb, 3), ("radius_um = 10", fine, 1)] {
        let place = Place::new();
        place.write("cloth.toml", CLOTH.replace(old, new));
        check_measured(&place, channels, 1);
    }
    for (more, sides) in [("back", 1), ("front", 1), ("front,back", 2), ("[\"back\"]", 1), ("back, back", 1)] {
        let place = Place::new();
        place.write("cloth.toml", CLOTH);
        let outcome = place.run(&[&MEASURE[..], &FEW[..], &["--sides", more]].concat());
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        assert_eq!(summary(&place)["sides"].as_object().map(|found| found.len()), Some(sides), "{more}");
    }
}

#[test]
fn an_axis_must_point_somewhere() {
    let what = "but must be three numbers [x, y, z] that are not all 0";
    let axis = |value: &str| format!("\"aligned\"\naxis = {value}");
    refuse_edits(&[
        ("\"isotropic\"", "\"aligned\"", "7:1: [sheet.fibers] needs `axis`"),
        ("\"isotropic\"", &axis("[0, 0, 0]"), &format!("11:8: `sheet.fibers.axis` is [0, 0, 0], {what}")),
        ("\"isotropic\"", &axis("[1, 0]"), &format!("11:8: `sheet.fibers.axis` is [1, 0], {what}")),
        ("\"isotropic\"", &axis("[1e-300, 0, 0]"), &format!("11:8: `sheet.fibers.axis` is [1e-300, 0, 0], {what}")),
        (
            "\"isotropic\"",
            &axis("[1, nan, 0]"),
            "11:12: `sheet.fibers.axis` is nan, but must be a number from -1000000 to 1000000",
        ),
        (
            "\"isotropic\"",
            &axis("[1, 0, 0]\nspread_deg = 91"),
            "12:14: `sheet.fibers.spread_deg` is 91, but must be a number from 0 to 90",
        ),
        (
            "\"isotropic\"",
            "\"planar\"\nspread_deg = 5",
            "11:14: `axis` and `spread_deg` belong to orientation = \"aligned\"",
        ),
        (
            "\"isotropic\"",
            "\"\"\"iso\ntropic\"\"\"",
            "10:15: `sheet.fibers.orientation`: unknown value \"iso\\ntropic\", did you mean `isotropic`?; allowed: \
             isotropic, planar, aligned",
        ),
    ]);
}

#[test]
fn what_is_not_available_yet_is_refused_by_name() {
    let cells = "belongs to a [weave] or a [knit]; leave it out";
    refuse_edits(&[
        ("ior = 1.5", "ior = 1.5\nroughness_deg = 1", "5:1: `roughness_deg` is not available yet"),
        ("ior = 1.5", "ior = 1.5\ncross_section = {}", "5:1: `cross_section` is not available yet"),
    ]);
    refuse_lines(&[
        (
            "[model]\nplacement = \"carried-void\"\ntracking = \"tabulated\"",
            "12:13: `placement` \"carried-void\" does not go with `tracking` \"tabulated\", whose table has the cell of the ray \
             and not that of the fiber's axis; take \"null-collision\", or placement \"at-hit\"",
        ),
        ("[model]\ncells = [32, 32, 16]", &format!("12:1: `cells` {cells}")),
        ("[model]\ncone_deg = 2", &format!("12:1: `cone_deg` {cells}")),
        ("[measure]\nincident = \"klem\"", &format!("12:12: `measure.incident` is \"klem\", but must be {INCIDENT}")),
        (
            "[measure]\nincident = \"polar:90x46\"",
            &format!("12:12: `measure.incident` is \"polar:90x46\", but must be {INCIDENT}"),
        ),
        ("[measure]\nexit = \"polar:91x36\"", &format!("12:8: `measure.exit` is \"polar:91x36\", but must be {EXIT}")),
    ]);
}

#[test]
fn settings_of_the_instrument_are_checked_in_file_and_flags() {
    let theta = "but must be a number from 0 to 89.9";
    refuse_lines(&[
        ("[measure]\nincident = [[90, 0]]", &format!("12:14: `theta` is 90, {theta}")),
        ("[measure]\nincident = [[30, 0], [-1, 0]]", &format!("12:23: `theta` is -1, {theta}")),
        (
            "[measure]\nincident = [[30]]",
            "12:13: `measure.incident` is [30], but must be a pair [theta, phi] in degrees",
        ),
        ("[measure]\nincident = []", "12:12: `incident` lists 0 directions; allowed: 1 to 4096"),
        ("[measure]\nincident = 65", &format!("12:12: `measure.incident` is 65, but must be {INCIDENT}")),
        ("[measure]\nexit = 0", &format!("12:8: `measure.exit` is 0, but must be {EXIT}")),
        ("[measure]\nsides = []", "12:9: `measure.sides` is [], but must be a list such as [\"front\", \"back\"]"),
        ("[measure]\nsides = [\"front\", \"left\"]", "12:19: `sides`: unknown side \"left\"; allowed: front, back"),
        ("[measure]\nsides = [1]", "12:10: `measure.sides` is 1, but must be a text in quotes"),
        ("[measure]\nsides = true", "12:9: `measure.sides` is true, but must be a text in quotes"),
    ]);
    let many = format!("[{}]", ["[0, 0]"; 4097].join(", "));
    refuse_arguments(
        2,
        &[
            (&["--incident", "polar:18"], &format!("--incident:1:1: `incident` is polar:18, but must be {INCIDENT}")),
            (&["--exit", "Klems"], &format!("--exit:1:1: `exit` is Klems, but must be {EXIT}")),
            (&["--incident", "0"], &format!("--incident:1:1: `incident` is 0, but must be {INCIDENT}")),
            (&["--incident", "-1"], &format!("--incident:1:1: `incident` is -1, but must be {INCIDENT}")),
            (&["--incident", "30, 0"], &format!("--incident:1:1: `incident` is 30, 0, but must be {INCIDENT}")),
            (&["--incident", "a\nb"], &format!("--incident:1:1: `incident` is a\\nb, but must be {INCIDENT}")),
            (&["--incident", "[[95, 0]]"], &format!("--incident:1:3: `theta` is 95, {theta}")),
            (&["--incident", "[[nan, 0]]"], &format!("--incident:1:3: `theta` is nan, {theta}")),
            (&["--incident", "[[3, 361]]"], "--incident:1:6: `phi` is 361, but must be a number from -360 to 360"),
            (&["--incident", &many], "--incident:1:1: `incident` lists 4097 directions; allowed: 1 to 4096"),
            (&["--exit", "257"], &format!("--exit:1:1: `exit` is 257, but must be {EXIT}")),
            (&["--sides", "left"], "--sides:1:1: `sides`: unknown side \"left\"; allowed: front, back"),
            (&["--sides", "front,"], "--sides:1:1: `sides`: unknown side \"\"; allowed: front, back"),
            (&["--sides", "Front"], "--sides:1:1: `sides`: unknown side \"Front\"; allowed: front, back"),
            (
                &["--tracking", "tables"],
                "--tracking:1:1: `tracking`: unknown value \"tables\"; allowed: null-collision, tabulated",
            ),
            (
                &["--placement", "carry"],
                "--placement:1:1: `placement`: unknown value \"carry\"; allowed: at-hit, carried, carried-dense, \
                 carried-void",
            ),
            (
                &["--tracking", "tabulated", "--placement", "carried"],
                "`placement` \"carried\" does not go with `tracking` \"tabulated\", whose table has the cell of the ray and \
                 not that of the fiber's axis; take \"null-collision\", or placement \"at-hit\"",
            ),
        ],
    );
}

#[test]
fn a_table_too_large_is_refused_and_a_large_one_works() {
    let most = "4096 incident cells with 65536 exit cells on each side take about 12289 MiB of memory, allowed: 4096 MiB; \
                lower `incident` or `exit`";
    refuse_arguments(2, &[(&["--incident", "64", "--exit", "256"], most)]);
    let wavelengths: Vec<u32> = (400..528).collect();
    let place = spectral("s.csv", &format!("[measure]\nwavelengths_nm = {wavelengths:?}\n"));
    place.write("s.csv", SPECTRUM);
    let most = "1024 incident cells with 1024 exit cells on each side and 128 channels take about 10280 MiB of memory, allowed: 4096 MiB; \
                lower `incident` or `exit` or take fewer wavelengths";
    refuse(&place, &["measure", "cloth.toml", "--incident", "32", "--exit", "32"], 2, most);
    let fine = [&["measure", "nonwoven", "--incident", "64", "--exit", "8", "--quiet"], &FEW[..]].concat();
    assert_eq!(Place::new().run(&fine).code, Some(0));
    let fine = [&["measure", "nonwoven", "--incident", "2", "--exit", "256", "--quiet"], &FEW[..]].concat();
    assert_eq!(Place::new().run(&fine).code, Some(0));
}
