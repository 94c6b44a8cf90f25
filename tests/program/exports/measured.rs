//! Results of the program, and what the OpenEXR library reads in them.

use crate::common::program::Place;
use exr::prelude::{AnyChannels, FlatSamples, Image, Layers, ReadChannels, ReadLayers, WritableImage};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

pub const WALKS: u64 = 2000;
pub const SHARES: [(&str, &str); 3] =
    [("reflection", "reflectance"), ("transmission", "transmittance"), ("direct", "direct")];
/// Fixed-point units of the light of one walk in a cloth that absorbs.
pub const WEIGHT: f64 = 4096.0;

/// Two kinds of fiber that end, one of an index at which their bases let light out; lit from both sides.
const COLOURED: &str = r#"
[fiber.dyed]
radius_um = 8
ior = 1.55
absorption_per_mm = COLOUR
[fiber.ecru]
fineness_dtex = 1.7
density_g_per_cm3 = 1.52
ior = 1.35
absorption_per_mm = 0.4
[sheet]
thickness_um = 300
[[sheet.fibers]]
fiber = "ecru"
length_density_per_mm2 = 300
orientation = "planar"
[[sheet.fibers]]
fiber = "dyed"
length_density_per_mm2 = 150
orientation = "aligned"
axis = [1, 0.2, 0.3]
[model]
length_over_radius = 20
[measure]
sides = ["front", "back"]
"#;

/// A result folder and what its summary says.
pub struct Measured {
    pub place: Place,
    pub summary: Value,
    /// Names of the channels in the order of their letters, as the file has them.
    pub channels: Vec<String>,
    /// Units of one walk's light.
    pub unit: f64,
}

impl Measured {
    /// Measure a cloth with a few walks on the processor.
    pub fn new(cloth: &str, text: Option<&[u8]>, more: &[&str]) -> Measured {
        let place = Place::new();
        if let Some(text) = text {
            place.write(cloth, text);
        }
        let walks = WALKS.to_string();
        let common = ["measure", cloth, "--walks", &walks, "--engine", "cpu", "--seed", "7", "-o", "result"];
        let outcome = place.run(&[&common[..], more].concat());
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        assert!(
            outcome.stdout.ends_with("\nresult/bsdf.exr\nresult/tally.exr\nresult/summary.json\n"),
            "{}",
            outcome.stdout
        );
        let files = place.contents().into_iter().filter(|(path, bytes)| bytes.is_some() && !path.ends_with(cloth));
        let files: Vec<_> = files.map(|(path, _)| path).collect();
        assert_eq!(files, ["bsdf.exr", "summary.json", "tally.exr"].map(|file| place.path("result").join(file)));
        let summary = std::fs::read(place.path("result/summary.json")).expect("the summary is there");
        let summary = serde_json::from_slice(&summary).expect("the summary is JSON");
        Measured { place, summary, channels: vec!["Y".into()], unit: 1.0 }
    }

    /// Measure a coloured cloth; `lines` are those of `[measure]`.
    pub fn coloured(colour: &str, lines: &str, channels: &[&str]) -> (Measured, String) {
        let text = format!("{}{lines}", COLOURED.replace("COLOUR", colour));
        let measured = Measured::new("coloured.toml", Some(text.as_bytes()), &["--incident", "4"]);
        let channels = channels.iter().map(|name| (*name).to_owned()).collect();
        (Measured { channels, unit: WEIGHT, ..measured }, text)
    }

    /// Parts in the order of the file: names, and the side and share of the summary.
    pub fn parts(&self) -> Vec<(String, &str, &'static str)> {
        let sides = ["front", "back"].into_iter().filter(|side| self.summary["sides"].get(side).is_some());
        sides.flat_map(|side| SHARES.map(|(part, share)| (format!("{side}.{part}"), side, share))).collect()
    }

    /// Names of a part's channels, in the order of their letters.
    pub fn labels(&self) -> Vec<String> {
        let mut labels = self.channels.clone();
        labels.extend(self.channels.iter().map(|name| format!("stderr.{name}")));
        labels.sort();
        labels
    }

    pub fn preset() -> Measured {
        Measured::new("nonwoven", None, &[])
    }

    pub fn listed() -> Measured {
        Measured::new("nonwoven", None, &["--incident", "[[30, 10], [60, 100]]"])
    }

    pub fn exr(&self) -> std::path::PathBuf {
        self.place.path("result/bsdf.exr")
    }

    /// What the attribute must say of a cloth and of its incident directions.
    pub fn attribute(&self, cloth: &str, incident: Value) -> Value {
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "cloth": cloth,
            "model": self.summary["model"],
            "incident": incident,
            "exit": 16,
            "seed": 7,
            "walks": (self.parts().len() / 3 * self.incident().len()) as u64 * WALKS,
            "engine": "cpu",
            "adapter": self.summary["adapter"],
        })
    }

    pub fn incident(&self) -> &[Value] {
        self.summary["sides"]["front"]["incident"].as_array().expect("the summary lists incident directions")
    }

    /// A copy of the file with one change, written by the library that wrote it.
    pub fn damaged(&self, damage: impl FnOnce(&mut Vec<FlatLayer>)) -> std::path::PathBuf {
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

pub type FlatLayer = exr::prelude::Layer<AnyChannels<FlatSamples>>;

/// One pixel of a part's channel: 0 is Y, 1 is stderr.Y.
pub fn sample(layer: &mut FlatLayer, channel: usize, index: usize) -> &mut f32 {
    let FlatSamples::F32(samples) = &mut layer.channel_data.list[channel].sample_data else {
        panic!("the samples are not 32-bit floats");
    };
    &mut samples[index]
}

/// A part as the OpenEXR library's Python module gives it.
#[derive(Debug, Deserialize)]
pub struct Part {
    pub name: String,
    pub columns: usize,
    pub rows: usize,
    pub attribute: Value,
    pub channels: BTreeMap<String, Channel>,
}

#[derive(Debug, Deserialize)]
pub struct Channel {
    #[serde(rename = "type")]
    pub kind: String,
    pub shape: [usize; 2],
    pub pixels: Vec<Vec<f64>>,
}

/// Read a file with the OpenEXR library's Python module.
pub fn read(path: &Path) -> Vec<Part> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let python = root.join("target/venv/bin/python");
    let output = Command::new(&python).arg(root.join("tests/program/exports/read_exr.py")).arg(path).output();
    let output = output.unwrap_or_else(|error| panic!("{}: {error}: run tools/setup.sh", python.display()));
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaint}\n(does a module lack? run tools/setup.sh)");
    serde_json::from_slice(&output.stdout).expect("read_exr.py prints JSON")
}
