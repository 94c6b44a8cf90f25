//! `bsdf.exr`, read back by two programs that share no code with this one, against `summary.json`.

mod program;

use exr::prelude::{AnyChannels, FlatSamples, Image, Layers, ReadChannels, ReadLayers, WritableImage};
use program::Place;
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;
use std::process::Command;

const WALKS: u64 = 2000;
const EXIT: f64 = 16.0;
const PRESET: &str = include_str!("../assets/cloths/nonwoven.toml");
const PARTS: [&str; 3] = ["front.reflection", "front.transmission", "front.direct"];
const SHARES: [&str; 3] = ["reflectance", "transmittance", "direct"];
/// Half a unit in the last place of a 32-bit float, relative.
const ROUNDING: f64 = f32::EPSILON as f64 / 2.0;

/// A result folder and what its summary says.
struct Measured {
    place: Place,
    summary: Value,
}

impl Measured {
    /// Measure a cloth with a few walks on the processor.
    fn new(cloth: &str, text: Option<&[u8]>, more: &[&str]) -> Measured {
        let place = Place::new();
        if let Some(text) = text {
            place.write(cloth, text);
        }
        let walks = WALKS.to_string();
        let common = ["measure", cloth, "--walks", &walks, "--engine", "cpu", "--seed", "7", "-o", "result"];
        let outcome = place.run(&[&common[..], more].concat());
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        assert!(outcome.stdout.ends_with("\nresult/bsdf.exr\nresult/summary.json\n"), "{}", outcome.stdout);
        let files = place.contents().into_iter().filter(|(path, bytes)| bytes.is_some() && !path.ends_with(cloth));
        let files: Vec<_> = files.map(|(path, _)| path).collect();
        assert_eq!(files, ["bsdf.exr", "summary.json"].map(|file| place.path("result").join(file)));
        let summary = std::fs::read(place.path("result/summary.json")).expect("the summary is there");
        let summary = serde_json::from_slice(&summary).expect("the summary is JSON");
        Measured { place, summary }
    }

    fn preset() -> Measured {
        Measured::new("nonwoven", None, &[])
    }

    fn listed() -> Measured {
        Measured::new("nonwoven", None, &["--incident", "[[30, 10], [60, 100]]"])
    }

    fn exr(&self) -> std::path::PathBuf {
        self.place.path("result/bsdf.exr")
    }

    /// What the attribute must say of a cloth and of its incident directions.
    fn attribute(&self, cloth: &str, incident: Value) -> Value {
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "cloth": cloth,
            "model": { "tracking": "null-collision", "placement": "at-hit", "directions": 1024 },
            "incident": incident,
            "exit": 16,
            "seed": 7,
            "walks": self.incident().len() as u64 * WALKS,
            "engine": "cpu",
            "adapter": self.summary["adapter"],
        })
    }

    fn incident(&self) -> &[Value] {
        self.summary["sides"]["front"]["incident"].as_array().expect("the summary lists incident directions")
    }

    /// A copy of the file with one change, written by the library that wrote it.
    fn damaged(&self, damage: impl FnOnce(&mut Vec<FlatLayer>)) -> std::path::PathBuf {
        let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
        let mut image: Image<Layers<AnyChannels<FlatSamples>>> =
            reader.all_layers().all_attributes().from_file(self.exr()).expect("the file can be read");
        let mut layers: Vec<FlatLayer> = image.layer_data.drain(..).collect();
        damage(&mut layers);
        image.layer_data.extend(layers);
        let path = self.place.path("damaged.exr");
        image.write().to_file(&path).expect("a copy can be written");
        path
    }
}

type FlatLayer = exr::prelude::Layer<AnyChannels<FlatSamples>>;

/// One pixel of a part's channel: 0 is Y, 1 is stderr.Y.
fn sample(layer: &mut FlatLayer, channel: usize, index: usize) -> &mut f32 {
    let FlatSamples::F32(samples) = &mut layer.channel_data.list[channel].sample_data else {
        panic!("the samples are not 32-bit floats");
    };
    &mut samples[index]
}

/// A part as the OpenEXR library's Python module gives it.
#[derive(Debug, Deserialize)]
struct Part {
    name: String,
    columns: usize,
    rows: usize,
    attribute: Value,
    channels: BTreeMap<String, Channel>,
}

#[derive(Debug, Deserialize)]
struct Channel {
    #[serde(rename = "type")]
    kind: String,
    shape: [usize; 2],
    pixels: Vec<Vec<f64>>,
    row_sums: Vec<f64>,
}

/// Read a file with the OpenEXR library's Python module.
fn read(path: &Path) -> Vec<Part> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let python = root.join("target/venv/bin/python");
    let output = Command::new(&python).arg(root.join("tests/read_exr.py")).arg(path).output();
    let output = output.unwrap_or_else(|error| panic!("{}: {error}: run tools/setup.sh", python.display()));
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaint}\n(does a module lack? run tools/setup.sh)");
    serde_json::from_slice(&output.stdout).expect("read_exr.py prints JSON")
}

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
fn check_headers(found: &[Header], incident: usize, attribute: &Value) -> Result<(), String> {
    let names: Vec<&str> = found.iter().map(|header| header.name.as_str()).collect();
    ensure(names == PARTS, || format!("the parts are {names:?}"))?;
    for header in found {
        let Header { name, channels, window, .. } = header;
        let [columns, rows] = size(name, incident);
        let expected = format!("(0 0) - ({} {})", columns - 1, rows - 1);
        ensure(*window == expected, || format!("{name}: the window is {window}, not {expected}"))?;
        let kinds: Vec<[&str; 2]> = channels.iter().map(|line| first_two(line)).collect();
        let expected = ["Y", "stderr.Y"].map(|channel| [channel, "32-bit floating-point"]);
        ensure(kinds == expected, || format!("{name}: the channels are {channels:?}"))?;
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
    if part == "front.direct" { [incident, 1] } else { [(EXIT * EXIT) as usize, incident] }
}

/// Hold the pixels against the summary.
fn check_pixels(found: &[Part], summary: &[Value], attribute: &Value) -> Result<(), String> {
    let names: Vec<&str> = found.iter().map(|part| part.name.as_str()).collect();
    ensure(names == PARTS, || format!("the parts are {names:?}"))?;
    for (part, share) in found.iter().zip(SHARES) {
        let name = &part.name;
        let [columns, rows] = size(name, summary.len());
        ensure([part.columns, part.rows] == [columns, rows], || format!("{name}: {}×{}", part.columns, part.rows))?;
        ensure(part.attribute == *attribute, || format!("{name}: the attribute is {}", part.attribute))?;
        let channels: Vec<&String> = part.channels.keys().collect();
        ensure(channels == ["Y", "stderr.Y"], || format!("{name}: the channels are {channels:?}"))?;
        for (label, channel) in &part.channels {
            let right = channel.kind == "float32" && channel.shape == [rows, columns];
            ensure(right, || format!("{name}: {label} is {} of shape {:?}", channel.kind, channel.shape))?;
        }
        let [values, errors] = [&part.channels["Y"], &part.channels["stderr.Y"]];
        // A direct pixel is a share of the walks; the others are shares over a projected solid angle.
        let unit = if share == "direct" { 1.0 } else { PI / (EXIT * EXIT) };
        for (value, error) in values.pixels.iter().flatten().zip(errors.pixels.iter().flatten()) {
            check_cell(value * unit, error * unit).map_err(|message| format!("{name}: {message}"))?;
        }
        let sums = if share == "direct" { values.pixels[0].clone() } else { values.row_sums.clone() };
        for (cell, sum) in sums.iter().enumerate() {
            let place = format!("{share} of incident cell {cell}");
            check_total(sum * unit, &summary[cell][share]["Y"]).map_err(|message| format!("{place}: {message}"))?;
        }
    }
    Ok(())
}

/// A share must be a whole number of walks, with the binomial error of its mean.
fn check_cell(share: f64, error: f64) -> Result<(), String> {
    let count = (share * WALKS as f64).round();
    let counted = count / WALKS as f64;
    ensure((share - counted).abs() <= 1.01 * ROUNDING * counted, || {
        format!("{share} is not a share of {WALKS} walks")
    })?;
    let expected = binomial_error(counted);
    ensure((error - expected).abs() <= 1.01 * ROUNDING * expected, || {
        format!("the stderr of {share} is {error}, not {expected}")
    })
}

/// The sum of the pixels must be the total of the summary, with the binomial error of the sum.
fn check_total(sum: f64, total: &Value) -> Result<(), String> {
    let [value, error] = ["value", "stderr"].map(|key| total[key].as_f64().unwrap_or(f64::NAN));
    ensure((sum - value).abs() <= 1.01 * ROUNDING * value, || format!("the pixels give {sum}, the summary {value}"))?;
    let expected = binomial_error(value);
    ensure((error - expected).abs() <= 1e-12, || format!("the stderr of {value} is {error}, not {expected}"))
}

/// √(P(1 − P)/(W − 1)); none and all of the walks have the error of one.
fn binomial_error(share: f64) -> f64 {
    let walks = WALKS as f64;
    if share == 0.0 || share == 1.0 { 1.0 / walks } else { (share * (1.0 - share) / (walks - 1.0)).sqrt() }
}

fn ensure(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}

#[test]
fn a_table_over_the_disc_reads_back_as_it_was_measured() {
    let measured = Measured::preset();
    let attribute = measured.attribute(PRESET, json!(8));
    assert_eq!(measured.incident().len(), 64);
    check_headers(&headers(&measured.exr()), 64, &attribute).expect("exrheader shows what was measured");
    check_pixels(&read(&measured.exr()), measured.incident(), &attribute).expect("the pixels are what was measured");
}

#[test]
fn a_list_of_directions_reads_back_as_it_was_measured() {
    let measured = Measured::listed();
    let attribute = measured.attribute(PRESET, json!([[30.0, 10.0], [60.0, 100.0]]));
    let angle = |cell: usize, key: &str| measured.incident()[cell][key].as_f64().expect("an angle is a number");
    for (cell, [theta, phi]) in [[30.0, 10.0], [60.0, 100.0]].into_iter().enumerate() {
        assert!((angle(cell, "theta_deg") - theta).abs() < 1e-9 && (angle(cell, "phi_deg") - phi).abs() < 1e-9);
    }
    check_headers(&headers(&measured.exr()), 2, &attribute).expect("exrheader shows what was measured");
    check_pixels(&read(&measured.exr()), measured.incident(), &attribute).expect("the pixels are what was measured");
}

#[test]
fn a_cloth_file_beyond_ascii_survives_byte_for_byte() {
    let name = "name = \"spunlace α\\t10 µm\" # offset α, \u{1F9F5}, \"quoted\" \\n\r\n";
    let cloth = format!("{name}{}", PRESET.split_once("g/m2\"\n").expect("the preset starts with its name").1);
    let measured = Measured::new("α µ.toml", Some(cloth.as_bytes()), &["--incident", "2"]);
    assert_eq!(measured.summary["name"], "spunlace α\t10 µm");
    let attribute = measured.attribute(&cloth, json!(2));
    check_headers(&headers(&measured.exr()), 4, &attribute).expect("exrheader shows the cloth file");
    check_pixels(&read(&measured.exr()), measured.incident(), &attribute).expect("the attribute holds the cloth file");
}

#[test]
fn one_wrong_float_does_not_pass() {
    let measured = Measured::listed();
    let attribute = measured.attribute(PRESET, json!([[30.0, 10.0], [60.0, 100.0]]));
    let check = |path: &Path| check_pixels(&read(path), measured.incident(), &attribute);
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
    assert!(complaint.starts_with("reflectance of incident cell 0: the pixels give "), "{complaint}");
    let nudged = measured.damaged(|parts| *sample(&mut parts[1], 0, 300) *= 1.0 + 4.0 * f32::EPSILON);
    let complaint = check(&nudged).expect_err("a cell off by four units in the last place is seen");
    assert!(complaint.contains("is not a share of 2000 walks"), "{complaint}");
    let surer = measured.damaged(|parts| *sample(&mut parts[1], 1, 300) *= 0.99);
    let complaint = check(&surer).expect_err("an error too small by 1 % is seen");
    assert!(complaint.starts_with("front.transmission: the stderr of "), "{complaint}");
    let direct = measured.damaged(|parts| *sample(&mut parts[2], 0, 1) += 1.0 / WALKS as f32);
    assert!(check(&direct).is_err_and(|complaint| complaint.starts_with("front.direct: ")));
}

#[test]
fn a_wrong_header_does_not_pass() {
    let measured = Measured::listed();
    let attribute = measured.attribute(PRESET, json!([[30.0, 10.0], [60.0, 100.0]]));
    let swapped = measured.damaged(|parts| parts.swap(0, 1));
    assert!(
        check_headers(&headers(&swapped), 2, &attribute).is_err_and(|complaint| complaint.starts_with("the parts"))
    );
    assert!(check_pixels(&read(&swapped), measured.incident(), &attribute).is_err());
    let whole = headers(&measured.exr());
    assert!(check_headers(&whole, 3, &attribute).is_err_and(|complaint| complaint.contains("the window is")));
    let other = measured.attribute(&PRESET.replacen('6', "9", 1), json!([[30.0, 10.0], [60.0, 100.0]]));
    assert!(check_headers(&whole, 2, &other).is_err_and(|complaint| complaint.contains("the attribute is")));
}
