//! `bsdf.exr`, read back by two programs that share no code with this one, against `summary.json`.

use super::measured::{FlatLayer, Measured, Part, WALKS, WEIGHT, read, sample};
use crate::common::program::Place;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::path::Path;
use std::process::Command;

const EXIT: f64 = 16.0;
const PRESET: &str = include_str!("../../../assets/cloths/nonwoven.toml");
/// Half a unit in the last place of a 32-bit float, relative.
const ROUNDING: f64 = f32::EPSILON as f64 / 2.0;

/// A part's header as the program exrheader prints it.
#[derive(Debug, PartialEq)]
struct Header {
    name: String,
    channels: Vec<String>,
    window: String,
    attribute: Value,
}

/// Read the headers of a file with exrheader.
fn headers(path: &Path) -> Vec<Header> {
    let output = Command::new("exrheader").arg(path).output();
    let output = output.unwrap_or_else(|error| panic!("exrheader: {error}: run tools/setup.sh"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("the header is UTF-8");
    text.split("\n part ").skip(1).map(header).collect()
}

fn header(part: &str) -> Header {
    let value = |start: &str| {
        let line = part.lines().find_map(|line| line.strip_prefix(start));
        line.unwrap_or_else(|| panic!("exrheader shows no `{start}` in part {part}")).trim()
    };
    let quoted = |start: &str| value(start).trim_start_matches('"').trim_end_matches('"').to_owned();
    let attribute = value("fiberwalk (type string):");
    let attribute = attribute.strip_prefix('"').and_then(|text| text.strip_suffix('"')).expect("a text is in quotes");
    Header {
        name: quoted("name (type string):"),
        channels: part.lines().filter_map(|line| line.strip_prefix("    ")).map(String::from).collect(),
        window: value("dataWindow (type box2i):").to_owned(),
        attribute: serde_json::from_str(attribute).expect("the attribute is JSON"),
    }
}

/// Hold the headers against what was measured.
fn check_headers(found: &[Header], measured: &Measured, incident: usize, attribute: &Value) -> Result<(), String> {
    let names: Vec<&str> = found.iter().map(|header| header.name.as_str()).collect();
    ensure(measured.parts().iter().map(|part| &part.0).eq(&names), || format!("the parts are {names:?}"))?;
    for header in found {
        let Header { name, channels, window, .. } = header;
        let [columns, rows] = size(name, incident);
        let expected = format!("(0 0) - ({} {})", columns - 1, rows - 1);
        ensure(*window == expected, || format!("{name}: the window is {window}, not {expected}"))?;
        let kinds: Vec<[&str; 2]> = channels.iter().map(|line| first_two(line)).collect();
        let expected = measured.labels();
        ensure(expected.iter().map(|label| [label, "32-bit floating-point"]).eq(kinds), || {
            format!("{name}: the channels are {channels:?}")
        })?;
        ensure(header.attribute == *attribute, || format!("{name}: the attribute is {}", header.attribute))?;
    }
    Ok(())
}

fn first_two(line: &str) -> [&str; 2] {
    let mut words = line.split(", ");
    [(); 2].map(|()| words.next().unwrap_or_default())
}

/// Columns and rows of a part.
fn size(part: &str, incident: usize) -> [usize; 2] {
    if part.ends_with(".direct") { [incident, 1] } else { [(EXIT * EXIT) as usize, incident] }
}

/// Hold the pixels against the summary.
fn check_pixels(found: &[Part], measured: &Measured, attribute: &Value) -> Result<(), String> {
    let names: Vec<&str> = found.iter().map(|part| part.name.as_str()).collect();
    let parts = measured.parts();
    ensure(parts.iter().map(|part| &part.0).eq(&names), || format!("the parts are {names:?}"))?;
    for (part, (_, side, share)) in found.iter().zip(parts) {
        let name = &part.name;
        let summary = measured.summary["sides"][side]["incident"].as_array().expect("the summary lists directions");
        let [columns, rows] = size(name, summary.len());
        ensure([part.columns, part.rows] == [columns, rows], || format!("{name}: {}×{}", part.columns, part.rows))?;
        ensure(part.attribute == *attribute, || format!("{name}: the attribute is {}", part.attribute))?;
        let labels: Vec<&String> = part.channels.keys().collect();
        ensure(measured.labels().iter().eq(labels.iter().copied()), || format!("{name}: the channels are {labels:?}"))?;
        for (label, channel) in &part.channels {
            let right = channel.kind == "float32" && channel.shape == [rows, columns];
            ensure(right, || format!("{name}: {label} is {} of shape {:?}", channel.kind, channel.shape))?;
        }
        // A direct pixel is a share of the walks; the others are shares over a projected solid angle.
        let direct = share == "direct";
        let (solid_angle, unit) = if direct { (1.0, 1.0) } else { (PI / (EXIT * EXIT), measured.unit) };
        for channel in &measured.channels {
            let [values, errors] = [&part.channels[channel], &part.channels[&format!("stderr.{channel}")]];
            let cells = values.pixels.iter().flatten().zip(errors.pixels.iter().flatten());
            for (value, error) in cells {
                check_cell(value * solid_angle, error * solid_angle, unit)
                    .map_err(|message| format!("{name} {channel}: {message}"))?;
            }
            for (cell, entry) in summary.iter().enumerate() {
                let total = &entry[share][channel];
                let checked = if direct {
                    check_total(&values.pixels[0][cell..=cell], &errors.pixels[0][cell..=cell], 1.0, total)
                } else {
                    check_total(&values.pixels[cell], &errors.pixels[cell], solid_angle, total)
                };
                checked.map_err(|message| format!("{side}: {share} of incident cell {cell}, {channel}: {message}"))?;
            }
        }
    }
    Ok(())
}

/// A share must be a whole number of units of light, with an error that weights from 0 to 1 can have; whole walks have
/// the binomial one.
fn check_cell(share: f64, error: f64, unit: f64) -> Result<(), String> {
    let counted = (share * WALKS as f64 * unit).round() / (WALKS as f64 * unit);
    ensure((share - counted).abs() <= 1.01 * ROUNDING * counted, || {
        format!("{share} is not a share of {WALKS} walks")
    })?;
    let most = binomial_error(counted);
    // Equal weights of all walks have no error.
    let least = if unit == 1.0 || counted == 0.0 { most } else { 0.0 };
    let room = 1.01 * ROUNDING * most;
    ensure(error >= least - room && error <= most + room, || {
        format!("the stderr of {share} is {error}, not {least} to {most}")
    })
}

/// The sum of the pixels must be the total of the summary, and so must be the sum of their second moments.
fn check_total(pixels: &[f64], errors: &[f64], solid_angle: f64, total: &Value) -> Result<(), String> {
    let [value, error] = ["value", "stderr"].map(|key| total[key].as_f64().unwrap_or(f64::NAN));
    let sum: f64 = pixels.iter().sum::<f64>() * solid_angle;
    ensure((sum - value).abs() <= 1.01 * ROUNDING * value, || format!("the pixels give {sum}, the summary {value}"))?;
    if value == 0.0 || value == 1.0 {
        return ensure(error == 1.0 / WALKS as f64, || {
            format!("the stderr of {value} is {error}, not that of one walk")
        });
    }
    // ⟨w²⟩ = σ²(W − 1) + ⟨w⟩²; a walk leaves in one cell, so its square counts once.
    let square = |value: f64, error: f64| error * error * (WALKS as f64 - 1.0) + value * value;
    let lit = pixels.iter().zip(errors).filter(|(pixel, _)| **pixel > 0.0);
    let squares: f64 = lit.map(|(pixel, error)| square(pixel * solid_angle, error * solid_angle)).sum();
    let expected = square(value, error);
    ensure((squares - expected).abs() <= 4.0 * ROUNDING * expected, || {
        format!("the stderr of {value} is {error}: a second moment of {expected}, but the pixels give {squares}")
    })
}

/// √(P(1 − P)/(W − 1)); none and all of the walks have the error of one.
fn binomial_error(share: f64) -> f64 {
    let walks = WALKS as f64;
    if share == 0.0 || share == 1.0 { 1.0 / walks } else { (share * (1.0 - share) / (walks - 1.0)).sqrt() }
}

/// The shares of every incident direction and channel, and of their mean, must be all of the light.
fn check_shares(measured: &Measured) {
    for (side, found) in measured.summary["sides"].as_object().expect("sides by name") {
        let incident = found["incident"].as_array().expect("the summary lists directions");
        for entry in incident.iter().chain([&found["hemispherical"]]) {
            for channel in &measured.channels {
                let share = |key: &str| entry[key][channel]["value"].as_f64().expect("a share is a number");
                let shares = ["reflectance", "transmittance", "direct", "absorptance"].map(share);
                let sum = shares.iter().sum::<f64>() + entry["lost"].as_f64().expect("a share is a number");
                assert!((sum - 1.0).abs() < 1e-12, "{side}, {channel}: {shares:?} and lost add up to {sum}");
            }
        }
    }
}

fn ensure(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}

#[test]
fn a_table_over_the_disc_reads_back_as_it_was_measured() {
    let measured = Measured::preset();
    let attribute = measured.attribute(PRESET, json!(8));
    assert_eq!(measured.incident().len(), 64);
    check_headers(&headers(&measured.exr()), &measured, 64, &attribute).expect("exrheader shows what was measured");
    check_pixels(&read(&measured.exr()), &measured, &attribute).expect("the pixels are what was measured");
}

#[test]
fn a_list_of_directions_reads_back_as_it_was_measured() {
    let measured = Measured::listed();
    let attribute = measured.attribute(PRESET, json!([[30.0, 10.0], [60.0, 100.0]]));
    let angle = |cell: usize, key: &str| measured.incident()[cell][key].as_f64().expect("an angle is a number");
    for (cell, [theta, phi]) in [[30.0, 10.0], [60.0, 100.0]].into_iter().enumerate() {
        assert!((angle(cell, "theta_deg") - theta).abs() < 1e-9 && (angle(cell, "phi_deg") - phi).abs() < 1e-9);
    }
    check_headers(&headers(&measured.exr()), &measured, 2, &attribute).expect("exrheader shows what was measured");
    check_pixels(&read(&measured.exr()), &measured, &attribute).expect("the pixels are what was measured");
}

#[test]
fn a_cloth_file_beyond_ascii_survives_byte_for_byte() {
    let name = "name = \"spunlace α\\t10 µm\" # offset α, \u{1F9F5}, \"quoted\" \\n\r\n";
    let cloth = format!("{name}{}", PRESET.split_once("g/m2\"\n").expect("the preset starts with its name").1);
    let measured = Measured::new("α µ.toml", Some(cloth.as_bytes()), &["--incident", "2"]);
    assert_eq!(measured.summary["name"], "spunlace α\t10 µm");
    let attribute = measured.attribute(&cloth, json!(2));
    check_headers(&headers(&measured.exr()), &measured, 4, &attribute).expect("exrheader shows the cloth file");
    check_pixels(&read(&measured.exr()), &measured, &attribute).expect("the attribute holds the cloth file");
}

#[test]
fn the_model_is_told_with_its_defaults() {
    let model = |length: Value| {
        json!({
            "medium": "implicit", "tracking": "null-collision", "placement": "at-hit", "packing": "separate",
            "direct": "walks", "first_hit": "medium", "memory": "none", "directions": 1024, "length_over_radius": length,
        })
    };
    let preset = Measured::listed();
    assert_eq!(preset.summary["model"], model(Value::Null));
    assert_eq!(preset.summary["base_exits"], 0);
    let (coloured, _) = Measured::coloured("1", "", &["Y"]);
    assert_eq!(coloured.summary["model"], model(json!(20.0)));
    assert!(coloured.summary["base_exits"].as_u64() > Some(0), "light leaves through bases");
}

#[test]
fn a_cloth_in_three_colours_lit_from_both_sides_reads_back_as_it_was_measured() {
    let (measured, text) = Measured::coloured("{ rgb = [18.0, 7.0, 0] }", "", &["B", "G", "R"]);
    check_coloured(&measured, &text);
}

#[test]
fn a_cloth_with_a_spectrum_reads_back_as_it_was_measured() {
    // The library orders names of channels by their letters, so 1000 comes before 450.5.
    let channels = ["T.1000,000000nm", "T.450,500000nm", "T.550,000000nm"];
    let place = Place::new();
    place.write("dye.csv", "nm, 1/mm\n400, 40\n550, 10\n1000, 1\n");
    let file = place.path("dye.csv");
    let colour = format!("{{ spectrum = {:?} }}", file.to_str().expect("the path is a text"));
    let (measured, text) = Measured::coloured(&colour, "wavelengths_nm = [450.5, 550, 1000]\n", &channels);
    check_coloured(&measured, &text);
    let dark = |channel: &str| {
        measured.summary["sides"]["back"]["hemispherical"]["absorptance"][channel]["value"].as_f64().expect("a number")
    };
    assert!(dark(channels[1]) > dark(channels[2]) && dark(channels[2]) > dark(channels[0]));
}

fn check_coloured(measured: &Measured, text: &str) {
    let attribute = measured.attribute(text, json!(4));
    assert_eq!(measured.parts().len(), 6);
    check_headers(&headers(&measured.exr()), measured, 16, &attribute).expect("exrheader shows what was measured");
    let parts = read(&measured.exr());
    check_pixels(&parts, measured, &attribute).expect("the pixels are what was measured");
    check_shares(measured);
    // Channels must not be copies of one another, nor sides.
    let pixels = |part: usize, channel: usize| &parts[part].channels[&measured.channels[channel]].pixels;
    assert!(pixels(0, 0) != pixels(0, 1) && pixels(0, 1) != pixels(0, 2) && pixels(0, 0) != pixels(3, 0));
}

/// Hold the integers of `tally.exr`, read by the OpenEXR library, against the values of `bsdf.exr`.
fn check_tally(measured: &Measured, sums: &[Part]) -> Result<(), String> {
    let table = read(&measured.exr());
    let sides = if table.len() > 3 { vec!["front", "back"] } else { vec!["front"] };
    for part in sides.iter().flat_map(|side| ["reflection", "transmission"].map(|what| format!("{side}.{what}"))) {
        let find = |parts: &'_ [Part]| parts.iter().position(|known| known.name == part).expect("the part is there");
        let (values, sums) = (&table[find(&table)], &sums[find(sums)]);
        for channel in &measured.channels {
            let word = |half: &str| &sums.channels[&format!("sum.{half}.{channel}")];
            let (low, high) = (word("lo"), word("hi"));
            ensure(low.kind == "uint32" && high.kind == "uint32", || format!("{}, {}", low.kind, high.kind))?;
            let rows = values.channels[channel].pixels.iter().zip(low.pixels.iter().zip(&high.pixels));
            for (value, (low, high)) in rows.flat_map(|(v, (l, h))| v.iter().zip(l.iter().zip(h))) {
                let sum = low + high * 2f64.powi(32);
                let expected = sum / (measured.unit * WALKS as f64) * EXIT * EXIT / PI;
                let off = (value - expected).abs();
                ensure(off <= 2.0 * ROUNDING * expected, || format!("{part}: {value} and a sum of {sum}"))?;
            }
        }
    }
    Ok(())
}

#[test]
fn the_integers_of_the_tally_are_those_of_the_table() {
    let (coloured, _) = Measured::coloured("{ rgb = [18.0, 7.0, 0] }", "", &["B", "G", "R"]);
    for measured in [coloured, Measured::preset()] {
        let mut parts = read(&measured.place.path("result/tally.exr"));
        assert_eq!(parts[0].attribute["unit"], measured.unit);
        assert_eq!(
            parts[0].attribute["walks"],
            json!([{ "seed": 7, "engine": "cpu", "adapter": "f64", "walks": [[0, WALKS]] }])
        );
        check_tally(&measured, &parts).expect("the integers are those of the table");
        let name = format!("sum.lo.{}", measured.channels[0]);
        parts[1].channels.get_mut(&name).expect("the channel is there").pixels[3][5] += 1.0;
        check_tally(&measured, &parts).expect_err("one unit more shows");
    }
}

#[test]
fn one_wrong_weight_does_not_pass() {
    let (measured, text) = Measured::coloured("{ rgb = [18.0, 7.0, 0] }", "", &["B", "G", "R"]);
    let attribute = measured.attribute(&text, json!(4));
    let check = |path: &Path| check_pixels(&read(path), &measured, &attribute);
    let unit = PI / (EXIT * EXIT);
    let lit =
        |layer: &mut FlatLayer| (0..4096).find(|index| *sample(layer, 1, *index) > 0.0).expect("some cell has light");
    let lighter = measured.damaged(|parts| {
        let cell = lit(&mut parts[3]);
        let whole = WALKS as f64 * WEIGHT * unit;
        let units = (f64::from(*sample(&mut parts[3], 1, cell)) * whole).round() - 16.0;
        *sample(&mut parts[3], 1, cell) = (units / whole) as f32;
    });
    let complaint = check(&lighter).expect_err("a cell short of sixteen units of light is seen");
    assert!(complaint.starts_with("back: reflectance of incident cell 0, G: the pixels give "), "{complaint}");
    let surer = measured.damaged(|parts| {
        let cell = lit(&mut parts[4]);
        *sample(&mut parts[4], 4, cell) *= 0.99;
    });
    let complaint = check(&surer).expect_err("an error too small by 1 % is seen");
    assert!(complaint.starts_with("back: transmittance of incident cell 0, G: the stderr of "), "{complaint}");
    let swapped = measured.damaged(|parts| {
        let name = |parts: &mut [FlatLayer], at: usize| parts[at].attributes.layer_name.take();
        let (front, back) = (name(parts, 0), name(parts, 3));
        (parts[0].attributes.layer_name, parts[3].attributes.layer_name) = (back, front);
        parts.swap(0, 3);
    });
    assert!(check(&swapped).is_err_and(|complaint| complaint.starts_with("front: reflectance of incident cell 0")));
}

#[test]
fn one_wrong_float_does_not_pass() {
    let measured = Measured::listed();
    let attribute = measured.attribute(PRESET, json!([[30.0, 10.0], [60.0, 100.0]]));
    let check = |path: &Path| check_pixels(&read(path), &measured, &attribute);
    let whole = measured.damaged(|_| ());
    assert_eq!(check(&whole), Ok(()), "a copy without damage passes");
    // Move the light of one walk out of one cell, with the error that belongs to the rest.
    let unit = PI / (EXIT * EXIT);
    let lighter = measured.damaged(|parts| {
        let share = f64::from(*sample(&mut parts[0], 0, 100)) * unit - 1.0 / WALKS as f64;
        *sample(&mut parts[0], 0, 100) = (share / unit) as f32;
        *sample(&mut parts[0], 1, 100) = (binomial_error(share) / unit) as f32;
    });
    let complaint = check(&lighter).expect_err("a cell short of one walk is seen");
    assert!(complaint.starts_with("front: reflectance of incident cell 0, Y: the pixels give "), "{complaint}");
    let nudged = measured.damaged(|parts| *sample(&mut parts[1], 0, 300) *= 1.0 + 4.0 * f32::EPSILON);
    let complaint = check(&nudged).expect_err("a cell off by four units in the last place is seen");
    assert!(complaint.contains("is not a share of 2000 walks"), "{complaint}");
    let surer = measured.damaged(|parts| *sample(&mut parts[1], 1, 300) *= 0.99);
    let complaint = check(&surer).expect_err("an error too small by 1 % is seen");
    assert!(complaint.starts_with("front.transmission Y: the stderr of "), "{complaint}");
    let direct = measured.damaged(|parts| *sample(&mut parts[2], 0, 1) += 1.0 / WALKS as f32);
    assert!(check(&direct).is_err_and(|complaint| complaint.starts_with("front.direct Y: ")));
}

#[test]
fn a_wrong_header_does_not_pass() {
    let measured = Measured::listed();
    let attribute = measured.attribute(PRESET, json!([[30.0, 10.0], [60.0, 100.0]]));
    let swapped = measured.damaged(|parts| parts.swap(0, 1));
    assert!(
        check_headers(&headers(&swapped), &measured, 2, &attribute)
            .is_err_and(|complaint| complaint.starts_with("the parts"))
    );
    assert!(check_pixels(&read(&swapped), &measured, &attribute).is_err());
    let whole = headers(&measured.exr());
    assert!(
        check_headers(&whole, &measured, 3, &attribute).is_err_and(|complaint| complaint.contains("the window is"))
    );
    let other = measured.attribute(&PRESET.replacen('6', "9", 1), json!([[30.0, 10.0], [60.0, 100.0]]));
    assert!(check_headers(&whole, &measured, 2, &other).is_err_and(|complaint| complaint.contains("the attribute is")));
}
