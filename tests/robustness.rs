//! Bad input: what the program says of it, its exit code, and that it leaves nothing behind.

mod program;

use program::{Outcome, Place, finish};
use std::io::{BufRead, BufReader};
use std::process::Stdio;

const CLOTH: &str = r#"name = "sheet"
[fiber.wool]
radius_um = 10
ior = 1.5
[sheet]
thickness_um = 500
[[sheet.fibers]]
fiber = "wool"
length_density_per_mm2 = 100
orientation = "isotropic"
"#;
const FEW: [&str; 4] = ["--walks", "10", "--engine", "cpu"];
/// What hides every Vulkan driver from the loader.
const NO_DRIVER: [(&str, &str); 2] = [("VK_DRIVER_FILES", "/nonexistent"), ("VK_ICD_FILENAMES", "/nonexistent")];
const NO_ADAPTER: &str = "the gpu engine needs a Vulkan, Metal or DX12 driver with the default limits of WebGPU, but no \
                          adapter was found; on Debian-like \
                          systems the packages mesa-vulkan-drivers and libvulkan1 bring a software adapter";
const INCIDENT: &str = "the N of an N×N disc basis, a whole number from 1 to 64, \"klems\", rings × sectors such as \"polar:18x36\", at most \
     4096 cells, or a list of directions [[theta, phi], …]";
const EXIT: &str = "the N of an N×N disc basis, a whole number from 1 to 256, \"klems\", or rings × sectors such as \"polar:18x36\", at \
     most 90 × 360";

/// A spectrum as a spreadsheet writes it.
const SPECTRUM: &str = "\u{feff}# Measured on a film.\r\nnm, 1/mm\r\n400, 0.5\r\n700, 20\r\n";
const MEASURE: [&str; 2] = ["measure", "cloth.toml"];

/// Run the program; it must end with a code and one line, and leave every file as it was.
fn refuse(place: &Place, arguments: &[&str], code: i32, message: &str) {
    let before = place.contents();
    let outcome = place.run(arguments);
    check_refusal(&outcome, code, message);
    assert!(place.contents() == before, "{arguments:?} changed files");
}

fn check_refusal(outcome: &Outcome, code: i32, message: &str) {
    let Outcome { code: found, stdout, stderr } = outcome;
    assert_eq!((stderr.as_str(), stdout.as_str(), *found), (format!("error: {message}\n").as_str(), "", Some(code)));
}

/// Texts of a cloth file, and what is said of each after the file's name.
fn refuse_texts(cases: &[(&str, &str)]) {
    for (text, message) in cases {
        let place = Place::new();
        place.write("cloth.toml", text);
        refuse(&place, &["measure", "cloth.toml"], 2, &format!("cloth.toml:{message}"));
    }
}

/// The cloth file with one thing replaced, and what is said of it.
fn refuse_edits(cases: &[(&str, &str, &str)]) {
    let edited = cases.iter().map(|(old, new, _)| {
        assert_eq!(CLOTH.matches(old).count(), 1, "`{old}` must be there once");
        CLOTH.replace(old, new)
    });
    let texts: Vec<String> = edited.collect();
    refuse_texts(&texts.iter().zip(cases).map(|(text, case)| (text.as_str(), case.2)).collect::<Vec<_>>());
}

/// Lines after the cloth file's ten, and what is said of them.
fn refuse_lines(cases: &[(&str, &str)]) {
    let texts: Vec<String> = cases.iter().map(|(lines, _)| format!("{CLOTH}{lines}\n")).collect();
    refuse_texts(&texts.iter().zip(cases).map(|(text, case)| (text.as_str(), case.1)).collect::<Vec<_>>());
}

/// Arguments after `measure nonwoven`, and what is said of them.
fn refuse_arguments(code: i32, cases: &[(&[&str], &str)]) {
    for (arguments, message) in cases {
        refuse(&Place::new(), &[&["measure", "nonwoven"], *arguments].concat(), code, message);
    }
}

/// A cloth file with the absorption in a spectrum's file on line 5, and more lines after its eleven.
fn spectral(spectrum: &str, lines: &str) -> Place {
    let place = Place::new();
    let absorption = format!("ior = 1.5\nabsorption_per_mm = {{ spectrum = \"{spectrum}\" }}");
    place.write("cloth.toml", format!("{}{lines}", CLOTH.replace("ior = 1.5", &absorption)));
    place
}

/// Another kind of fiber and its share of the sheet.
fn another(name: &str, line: &str) -> String {
    format!(
        "[fiber.{name}]\nradius_um = 5\nior = 1.5\n{line}[[sheet.fibers]]\nfiber = \"{name}\"\n\
         length_density_per_mm2 = 1\norientation = \"planar\"\n"
    )
}

/// Values of `absorption_per_mm`, and what is said of them.
fn refuse_absorption(cases: &[(&str, &str)]) {
    let edits: Vec<String> = cases.iter().map(|(value, _)| format!("ior = 1.5\nabsorption_per_mm = {value}")).collect();
    let edits: Vec<_> = edits.iter().zip(cases).map(|(new, case)| ("ior = 1.5", new.as_str(), case.1)).collect();
    refuse_edits(&edits);
}

fn summary(place: &Place) -> serde_json::Value {
    let text = std::fs::read(place.path("cloth/summary.json")).expect("the summary is there");
    serde_json::from_slice(&text).expect("the summary is JSON")
}

/// Measure `cloth.toml`; it must give that many channels and sides.
fn check_measured(place: &Place, channels: usize, sides: usize) {
    let outcome = place.run(&[&MEASURE[..], &FEW[..]].concat());
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    let summary = summary(place);
    let lit = summary["sides"].as_object().expect("sides by name");
    assert_eq!(lit.len(), sides);
    for side in lit.values() {
        assert_eq!(side["hemispherical"]["reflectance"].as_object().map(|found| found.len()), Some(channels));
    }
}

#[test]
fn a_name_that_is_neither_file_nor_preset_is_refused_with_the_presets() {
    let presets = "presets: charmeuse, denim, dimout, felt, gabardine, jersey, linen, lining, muslin, nonwoven, rib, \
                   sheer, voile";
    for (cloth, message) in [
        ("nosuch.toml", format!("no cloth file or preset `nosuch.toml`; {presets}")),
        ("nonwovn", format!("no cloth file or preset `nonwovn`, did you mean `nonwoven`?; {presets}")),
        ("Felt", format!("no cloth file or preset `Felt`, did you mean `felt`?; {presets}")),
        ("", format!("no cloth file or preset ``; {presets}")),
        ("a\nb\u{1b}[31m", format!("no cloth file or preset `a\\nb\\u{{1b}}[31m`; {presets}")),
    ] {
        refuse(&Place::new(), &["measure", cloth], 2, &message);
    }
}

#[test]
fn what_is_no_text_file_is_refused() {
    let place = Place::new();
    place.write("folder/inside", "");
    refuse(&place, &["measure", "folder"], 2, "folder is a folder, not a cloth file");
    refuse(&place, &["measure", "."], 2, ". is a folder, not a cloth file");
    place.write("latin1.toml", [CLOTH.as_bytes(), "name = \"α ".as_bytes(), b"\xfc\"\n"].concat());
    let message = "latin1.toml:11:11: a byte that is not UTF-8 text; save the file as UTF-8";
    refuse(&place, &["measure", "latin1.toml"], 2, message);
    place.write("long.toml", vec![b'\n'; (1 << 20) + 1]);
    refuse(&place, &["measure", "long.toml"], 2, "long.toml is longer than 1024 KiB: not a cloth file");
}

#[test]
fn malformed_toml_is_refused_where_it_goes_wrong() {
    let value = "expected one value after `=`: a number, a text in quotes, a list or a table";
    refuse_edits(&[
        ("ior = 1.5", "ior =", &format!("4:6: {value}")),
        ("ior = 1.5", "ior = 1.5 1.6", &format!("4:7: {value}")),
        ("ior = 1.5", "ior 1.5", "4:5: key with no value, expected `=`"),
        ("[sheet]", "[sheet", "5:7: unclosed table, expected `]`"),
        ("\"sheet\"", "\"sheet", "1:14: invalid basic string, expected `\"`"),
        ("ior = 1.5", "ior = 1.5\nior = 1.5", "5:1: duplicate key"),
        ("[sheet]", "[sheet]\n[sheet]", "6:2: duplicate key"),
        ("name = ", "a\0 = ", "1:2: invalid unquoted key, expected letters, numbers, `-`, `_`"),
    ]);
    let nested = format!("name = {}", "[".repeat(100_000));
    refuse_texts(&[(&nested, "1:88: cannot recurse further; max recursion depth met")]);
}

#[test]
fn values_of_a_wrong_type_are_refused() {
    let radius = "3:13: `fiber.wool.radius_um` is";
    let allowed = "but must be a number from 0.1 to 1000";
    refuse_edits(&[
        ("radius_um = 10", "radius_um = \"10\"", &format!("{radius} \"10\", {allowed}")),
        ("radius_um = 10", "radius_um = [10, 11]", &format!("{radius} [10, 11], {allowed}")),
        ("radius_um = 10", "radius_um = true", &format!("{radius} true, {allowed}")),
        ("radius_um = 10", "radius_um = 1979-05-27", &format!("{radius} 1979-05-27, {allowed}")),
        ("radius_um = 10", "radius_um = { rgb = 1 }", &format!("{radius} a table, {allowed}")),
        ("\"sheet\"", "5", "1:8: `name` is 5, but must be a text in quotes"),
        ("\"wool\"", "5", "8:9: `sheet.fibers.fiber` is 5, but must be a text in quotes"),
        (
            "[fiber.wool]",
            "[fiber]",
            "4:7: `fiber.ior` is 1.5, but must be a table: [fiber.NAME] describes a kind of fiber",
        ),
        (
            "[[sheet.fibers]]",
            "[sheet.fibers]",
            "7:1: `sheet.fibers` is a table, but must be a list of tables, [[sheet.fibers]]",
        ),
        ("name = \"sheet\"", "model = 3", "1:9: `model` is 3, but must be a table"),
        ("name = \"sheet\"", "measure = []", "1:11: `measure` is [], but must be a table"),
    ]);
}

#[test]
fn numbers_outside_their_range_are_refused() {
    let radius = "3:13: `fiber.wool.radius_um` is";
    let allowed = "but must be a number from 0.1 to 1000";
    let density = "9:26: `sheet.fibers.length_density_per_mm2` is";
    let positive = "but must be a number above 0 and at most 100000000";
    let thickness = "6:16: `sheet.thickness_um` is";
    let directions = "12:14: `model.directions` is";
    let square = "but must be a square number from 16 to 65536, such as 1024";
    refuse_edits(&[
        ("radius_um = 10", "radius_um = -10", &format!("{radius} -10, {allowed}")),
        ("radius_um = 10", "radius_um = 0", &format!("{radius} 0, {allowed}")),
        ("radius_um = 10", "radius_um = nan", &format!("{radius} nan, {allowed}")),
        ("radius_um = 10", "radius_um = -nan", &format!("{radius} -nan, {allowed}")),
        ("radius_um = 10", "radius_um = inf", &format!("{radius} inf, {allowed}")),
        ("radius_um = 10", "radius_um = 1e999", &format!("{radius} 1e999, {allowed}")),
        ("radius_um = 10", "radius_um = 99999999999999999999", &format!("{radius} 99999999999999999999, {allowed}")),
        ("ior = 1.5", "ior = 0.99", "4:7: `fiber.wool.ior` is 0.99, but must be a number from 1 to 4"),
        ("thickness_um = 500", "thickness_um = 0", &format!("{thickness} 0, but must be a number from 1 to 1000000")),
        ("mm2 = 100", "mm2 = 0", &format!("{density} 0, {positive}")),
        ("mm2 = 100", "mm2 = -1", &format!("{density} -1, {positive}")),
        ("mm2 = 100", "mm2 = 1e9", &format!("{density} 1e9, {positive}")),
        (
            "mm2 = 100",
            "mm2 = 3000",
            "7:1: fibers fill 0.94 of the sheet, but at most 0.9 is possible: lower length_density_per_mm2 or radius_um",
        ),
    ]);
    refuse_lines(&[
        ("[model]\ndirections = 1000000000", &format!("{directions} 1000000000, {square}")),
        ("[model]\ndirections = 1000", &format!("{directions} 1000, {square}")),
        ("[model]\ndirections = 9", &format!("{directions} 9, {square}")),
        ("[model]\ndirections = -16", &format!("{directions} -16, {square}")),
        ("[model]\ndirections = 1024.0", &format!("{directions} 1024.0, {square}")),
    ]);
}

#[test]
fn a_file_without_fibers_is_refused() {
    let kind = "[fiber.wool]\nradius_um = 10\nior = 1.5\n";
    refuse_texts(&[
        ("", "1:1: the file needs `fiber`"),
        ("[fiber]\n[sheet]\n", "1:1: the file needs at least one kind of fiber, [fiber.NAME]"),
        (kind, "1:1: the file needs a [sheet], a [weave] or a [knit]"),
        (&format!("{kind}[sheet]\nthickness_um = 500\n"), "4:1: [sheet] needs `fibers`"),
        (
            &format!("{kind}[sheet]\nthickness_um = 500\nfibers = []\n"),
            "6:10: the sheet is empty: it needs at least one [[sheet.fibers]]",
        ),
    ]);
    refuse_edits(&[
        ("radius_um = 10", "", "2:1: [fiber.wool] needs `radius_um`"),
        ("fiber = \"wool\"", "", "7:1: [sheet.fibers] needs `fiber`"),
    ]);
}

#[test]
fn unknown_keys_are_refused_with_the_nearest_one() {
    let part = "allowed: fiber, length_density_per_mm2, orientation, axis, spread_deg";
    let kind = "allowed: radius_um, fineness_dtex, ior, density_g_per_cm3, absorption_per_mm";
    let model = "allowed: tracking, placement, packing, direct, first_hit, memory, directions, length_over_radius";
    let top = "allowed: name, fiber, yarn, sheet, weave, knit, model, measure";
    refuse_edits(&[
        ("name", "nam", &format!("1:1: unknown key `nam` at the top, did you mean `name`?; {top}")),
        ("name", "\"a\\nb\"", &format!("1:1: unknown key `a\\nb` at the top; {top}")),
        ("[fiber.wool]", "[fibre.wool]", &format!("2:2: unknown key `fibre` at the top, did you mean `fiber`?; {top}")),
        ("radius_um", "radius_µm", "3:8: invalid unquoted key, expected letters, numbers, `-`, `_`"),
        ("ior", "IOR", &format!("4:1: unknown key `IOR` in [fiber.wool], did you mean `ior`?; {kind}")),
        (
            "thickness_um",
            "thickness_mm",
            "6:1: unknown key `thickness_mm` in [sheet], did you mean `thickness_um`?; allowed: thickness_um, fibers",
        ),
        ("fiber = ", "colour = ", &format!("8:1: unknown key `colour` in [sheet.fibers]; {part}")),
    ]);
    refuse_lines(&[
        (
            "[model]\nplacment = 1",
            &format!("12:1: unknown key `placment` in [model], did you mean `placement`?; {model}"),
        ),
        (
            "[measure]\nside = 1",
            "12:1: unknown key `side` in [measure], did you mean `sides`?; allowed: sides, incident, exit, \
             wavelengths_nm",
        ),
    ]);
}

#[test]
fn names_of_fibers_must_be_known_and_five_kinds_are_too_many() {
    refuse_edits(&[
        ("\"wool\"", "\"wol\"", "8:9: there is no [fiber.wol], did you mean `wool`?; fibers: wool"),
        ("\"wool\"", "\"silk\"", "8:9: there is no [fiber.silk]; fibers: wool"),
        ("\"wool\"", "\"a\\nb\"", "8:9: there is no [fiber.a\\nb]; fibers: wool"),
    ]);
    let kinds: String = (1..=4).map(|kind| another(&format!("f{kind}"), "")).collect();
    refuse_lines(&[(&kinds, "7:1: the sheet has 5 kinds of fiber; allowed: 1 to 4")]);
}

#[test]
fn absorption_is_a_number_or_three_or_a_spectrum() {
    let absorption = "5:21: `fiber.wool.absorption_per_mm` is";
    let forms = "but must be a number from 0 to 100000, { rgb = [r, g, b] } or { spectrum = \"file.csv\" }";
    let rgb = |found: &str| {
        format!(
            "5:29: `fiber.wool.absorption_per_mm.rgb` is {found}, but must be three numbers [red, green, blue] from 0 to 100000"
        )
    };
    let item = "`fiber.wool.absorption_per_mm.rgb` is";
    let allowed = "but must be a number from 0 to 100000";
    refuse_absorption(&[
        ("-0.4", &format!("{absorption} -0.4, {forms}")),
        ("nan", &format!("{absorption} nan, {forms}")),
        ("inf", &format!("{absorption} inf, {forms}")),
        ("1e6", &format!("{absorption} 1e6, {forms}")),
        ("\"0.4\"", &format!("{absorption} \"0.4\", {forms}")),
        ("[1, 2, 3]", &format!("{absorption} [1, 2, 3], {forms}")),
        ("{}", &format!("{absorption} a table, {forms}")),
        ("{ rgb = [1, 2, 3], spectrum = \"s.csv\" }", &format!("{absorption} a table, {forms}")),
        ("{ rgb = [1, 2] }", &rgb("[1, 2]")),
        ("{ rgb = [1, 2, 3, 4] }", &rgb("[1, 2, 3, 4]")),
        ("{ rgb = 5 }", &rgb("5")),
        ("{ rgb = [1, -2, 3] }", &format!("5:33: {item} -2, {allowed}")),
        ("{ rgb = [1, 2, nan] }", &format!("5:36: {item} nan, {allowed}")),
        (
            "{ rbg = [1, 2, 3] }",
            "5:23: unknown key `rbg` in [fiber.wool.absorption_per_mm], did you mean `rgb`?; allowed: rgb, spectrum",
        ),
        ("{ spectrum = 5 }", "5:34: `fiber.wool.absorption_per_mm.spectrum` is 5, but must be a text in quotes"),
    ]);
}

#[test]
fn a_spectrum_that_cannot_be_read_is_refused_where_it_is_named() {
    let missing = "5:34: cannot read the spectrum `s.csv`:";
    refuse_absorption(&[("{ spectrum = \"s.csv\" }", &format!("{missing} No such file or directory (os error 2)"))]);
    let place = spectral("s.csv", "");
    place.write("s.csv", b"400, 1\n\xff\n");
    refuse(&place, &MEASURE, 2, &format!("cloth.toml:{missing} it is not UTF-8 text"));
    place.write("s.csv", vec![b'\n'; (1 << 20) + 1]);
    refuse(&place, &MEASURE, 2, &format!("cloth.toml:{missing} it is longer than 1024 KiB"));
    let place = spectral("folder", "");
    place.write("folder/inside", "");
    let message = "cloth.toml:5:34: cannot read the spectrum `folder`: Is a directory (os error 21)";
    refuse(&place, &MEASURE, 2, message);
    // A name is taken from where the cloth file lies.
    let place = Place::new();
    place.write(
        "here/cloth.toml",
        CLOTH.replace("ior = 1.5", "ior = 1.5\nabsorption_per_mm = { spectrum = \"s.csv\" }"),
    );
    place.write("s.csv", SPECTRUM);
    let message = "here/cloth.toml:5:34: cannot read the spectrum `here/s.csv`: No such file or directory (os error 2)";
    refuse(&place, &["measure", "here/cloth.toml"], 2, message);
}

#[test]
fn a_wrong_line_of_a_spectrum_is_refused_where_it_stands() {
    let line = |found: &str| {
        format!("{found} must be a wavelength from 1 to 1000000 nm, a comma, a number from 0 to 100000 in 1/mm")
    };
    let long = format!("400, 1{}", "0".repeat(60));
    let empty = "s.csv:1:1: the spectrum has no line `nm, 1/mm`";
    for (text, message) in [
        ("", empty.to_owned()),
        ("nm, 1/mm\n# nothing\n", empty.to_owned()),
        ("400; 1\n", format!("s.csv:1:1: {}", line("`400; 1`"))),
        ("nm, 1/mm\n400, 1\n500 2\n", format!("s.csv:3:1: {}", line("`500 2`"))),
        ("nm, 1/mm\r\n\r\n400, 1\r\n500, 2\r\n600, x\r\n700, 1\r\n", format!("s.csv:5:1: {}", line("`600, x`"))),
        ("400, 1\nnm, 1/mm\n", format!("s.csv:2:1: {}", line("`nm, 1/mm`"))),
        ("nm, 1/mm\nnm, 1/mm\n", format!("s.csv:2:1: {}", line("`nm, 1/mm`"))),
        ("400, 1, 1\n", format!("s.csv:1:1: {}", line("`400, 1, 1`"))),
        ("400\n", format!("s.csv:1:1: {}", line("`400`"))),
        ("400, -1\n", format!("s.csv:1:1: {}", line("`400, -1`"))),
        ("400, nan\n", format!("s.csv:1:1: {}", line("`400, nan`"))),
        ("nan, 1\n400, 1\n", format!("s.csv:1:1: {}", line("`nan, 1`"))),
        ("inf, 1\n", format!("s.csv:1:1: {}", line("`inf, 1`"))),
        ("0, 1\n", format!("s.csv:1:1: {}", line("`0, 1`"))),
        (&long, format!("s.csv:1:1: {}", line("a line"))),
        ("400, 1\n# a dip\n\n400, 2\n", "s.csv:4:1: wavelength 400 must be above the one before".into()),
        ("400, 1\n500, 1\n450, 2\n", "s.csv:3:1: wavelength 450 must be above the one before".into()),
    ] {
        let place = spectral("s.csv", "");
        place.write("s.csv", text);
        refuse(&place, &MEASURE, 2, &message);
    }
}

#[test]
fn wavelengths_must_lie_in_every_spectrum_and_serve_one() {
    let list = "but must be an ascending list of 1 to 128 wavelengths in nm, 0.001 nm or more apart";
    let many: Vec<u32> = (400..529).collect();
    let outside = |nm: &str| format!("{nm} nm lies outside of the spectrum of fiber `wool`; allowed: 400 to 700 nm");
    for (wavelengths, message) in [
        ("[]", format!("13:18: `measure.wavelengths_nm` is [], {list}")),
        ("550", format!("13:18: `measure.wavelengths_nm` is 550, {list}")),
        ("[550, 450]", format!("13:18: `measure.wavelengths_nm` is [550, 450], {list}")),
        ("[550, 550]", format!("13:18: `measure.wavelengths_nm` is [550, 550], {list}")),
        ("[550, 550.0000001]", format!("13:18: `measure.wavelengths_nm` is [550, 550.0000001], {list}")),
        (&format!("{many:?}"), format!("13:18: `measure.wavelengths_nm` is an array, {list}")),
        ("[0]", "13:19: `measure.wavelengths_nm` is 0, but must be a number from 1 to 1000000".into()),
        ("[nan]", "13:19: `measure.wavelengths_nm` is nan, but must be a number from 1 to 1000000".into()),
        ("[399.9, 500]", format!("13:18: {}", outside("399.9"))),
        ("[500, 701]", format!("13:18: {}", outside("701"))),
    ] {
        let place = spectral("s.csv", &format!("[measure]\nwavelengths_nm = {wavelengths}\n"));
        place.write("s.csv", SPECTRUM);
        refuse(&place, &MEASURE, 2, &format!("cloth.toml:{message}"));
    }
    let place = spectral("s.csv", "");
    place.write("s.csv", "400, 1\n690, 2\n");
    let short = "cloth.toml:5:21: 700 nm lies outside of the spectrum of fiber `wool`; allowed: 400 to 690 nm; without \
                 `wavelengths_nm` they are 400 to 700 nm by 10";
    refuse(&place, &MEASURE, 2, short);
    let useless = "12:18: `wavelengths_nm` has no use: no fiber of the cloth has a spectrum";
    refuse_lines(&[("[measure]\nwavelengths_nm = [400]", useless)]);
}

#[test]
fn rgb_does_not_mix_with_a_spectrum() {
    let place = spectral("s.csv", &another("red", "absorption_per_mm = { rgb = [0, 5, 9] }\n"));
    place.write("s.csv", SPECTRUM);
    let clash = "cloth.toml:15:21: fiber `red` absorbs in rgb and fiber `wool` by a spectrum; allowed: one of the two in \
                 a cloth";
    refuse(&place, &MEASURE, 2, clash);
}

#[test]
fn a_fineness_takes_the_place_of_a_radius() {
    let same = "`fineness_dtex` and `radius_um` say the same thing; give one of them";
    let dtex = "`fiber.wool.fineness_dtex` is";
    let fineness = |dtex: &str| format!("density_g_per_cm3 = 1.5\nfineness_dtex = {dtex}");
    refuse_edits(&[
        ("radius_um = 10", "radius_um = 10\nfineness_dtex = 1.7", &format!("4:17: {same}")),
        ("radius_um = 10", "fineness_dtex = 1.7", "3:17: `fineness_dtex` needs `density_g_per_cm3` to give a radius"),
        (
            "radius_um = 10",
            &fineness("0"),
            &format!("4:17: {dtex} 0, but must be a number above 0 and at most 1000000"),
        ),
        (
            "radius_um = 10",
            &fineness("-1.7"),
            &format!("4:17: {dtex} -1.7, but must be a number above 0 and at most 1000000"),
        ),
        (
            "radius_um = 10",
            &fineness("1e-9"),
            &format!("4:17: {dtex} 1e-9, but must be a fineness that gives a radius from 0.1 to 1000 µm"),
        ),
    ]);
}

#[test]
fn a_fiber_is_at_least_as_long_as_its_radius() {
    let length = "12:22: `model.length_over_radius` is";
    let allowed = "but must be inf or a number from 1 to 1000000000";
    for found in ["0", "-5", "0.5", "nan", "-inf", "1e10", "\"inf\""] {
        refuse_lines(&[(&format!("[model]\nlength_over_radius = {found}"), &format!("{length} {found}, {allowed}"))]);
    }
}

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
    let most = "4096 incident cells with 65536 exit cells on each side take about 12801 MiB of memory, allowed: 4096 MiB; \
                lower `incident` or `exit`";
    refuse_arguments(2, &[(&["--incident", "64", "--exit", "256"], most)]);
    let wavelengths: Vec<u32> = (400..528).collect();
    let place = spectral("s.csv", &format!("[measure]\nwavelengths_nm = {wavelengths:?}\n"));
    place.write("s.csv", SPECTRUM);
    let most = "1024 incident cells with 1024 exit cells on each side and 128 channels take about 10792 MiB of memory, allowed: 4096 MiB; \
                lower `incident` or `exit` or take fewer wavelengths";
    refuse(&place, &["measure", "cloth.toml", "--incident", "32", "--exit", "32"], 2, most);
    let fine = [&["measure", "nonwoven", "--incident", "64", "--exit", "8", "--quiet"], &FEW[..]].concat();
    assert_eq!(Place::new().run(&fine).code, Some(0));
    let fine = [&["measure", "nonwoven", "--incident", "2", "--exit", "256", "--quiet"], &FEW[..]].concat();
    assert_eq!(Place::new().run(&fine).code, Some(0));
}

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
    assert_eq!((code, stderr.lines().count()), (Some(0), 3), "{stderr}");
    let engine = stderr.lines().last().expect("three lines have a last");
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
    assert!(same.stdout.ends_with("\nno difference was found\n"), "{}", same.stdout);
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
