//! Files that are no cloth files: names, text, types, ranges, unknown keys.

use super::refusals::{CLOTH, another, refuse, refuse_edits, refuse_lines, refuse_texts};
use crate::common::program::Place;

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
