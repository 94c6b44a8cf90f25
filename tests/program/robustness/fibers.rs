//! What a fiber may be: absorption, fineness, length.

use super::refusals::{
    CLOTH, MEASURE, SPECTRUM, another, refuse, refuse_absorption, refuse_edits, refuse_lines, spectral,
};
use crate::common::program::Place;

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
