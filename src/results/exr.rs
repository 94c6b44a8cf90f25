//! `bsdf.exr`: one part for each component, one row for each incident cell, one column for each exit cell.

use super::provenance::attribute;
use crate::bsdf::{Component, Estimate, probability, values};
use crate::measure::Measurement;
use crate::scene::Scene;
use exr::prelude::*;
use std::fs::File;
use std::io::{self, BufWriter};

type Part = Layer<AnyChannels<FlatSamples>>;

/// Write the tables of a measurement.
pub fn write_bsdf(file: &mut File, scene: &Scene, measurement: &Measurement) -> io::Result<()> {
    let Measurement { goniometer, tally, .. } = measurement;
    let attribute = attribute(scene, measurement).to_string();
    let cells = goniometer.incident_cells();
    let size = (goniometer.exit.cells(), cells);
    let mut parts: Layers<AnyChannels<FlatSamples>> = Layers::new();
    for (place, side) in goniometer.sides.iter().enumerate() {
        let starts = place * cells..(place + 1) * cells;
        let table = |component, channel| -> Vec<Estimate> {
            let row = |start| values(tally, goniometer, component, start, channel);
            starts.clone().flat_map(row).collect()
        };
        let direct = |_| -> Vec<Estimate> {
            starts.clone().map(|start| probability(tally.direct(start), tally.walks_per_incident())).collect()
        };
        let name = |what: &str| format!("{}.{what}", side.name());
        let channels = Names { names: &scene.channels.names, told_apart: tally.channels() };
        let (reflection, transmission) = (Component::Reflection, Component::Transmission);
        parts.push(part(&name("reflection"), size, &channels, |channel| table(reflection, channel), &attribute));
        parts.push(part(&name("transmission"), size, &channels, |channel| table(transmission, channel), &attribute));
        parts.push(part(&name("direct"), (cells, 1), &channels, direct, &attribute));
    }
    let window = IntegerBounds::from_dimensions(size);
    let image = Image::from_layers(ImageAttributes::new(window), parts);
    image.write().to_buffered(BufWriter::new(file)).map_err(|error| match error {
        Error::Io(error) => error,
        other => io::Error::other(other.to_string()),
    })
}

/// Names of channels, and how many of them differ: lossless fibers have one table under all names.
struct Names<'a> {
    names: &'a [String],
    told_apart: usize,
}

/// One part: every channel and its standard error, a channel at a time.
fn part(
    name: &str,
    size: (usize, usize),
    names: &Names,
    estimates: impl Fn(usize) -> Vec<Estimate>,
    attribute: &str,
) -> Part {
    let channels = names.names.iter().enumerate().flat_map(|(channel, name)| {
        let estimates = estimates(channel.min(names.told_apart - 1));
        let samples = |of: fn(&Estimate) -> f64| FlatSamples::F32(estimates.iter().map(|e| of(e) as f32).collect());
        let values = (name.clone(), samples(|estimate| estimate.value));
        let errors = (format!("stderr.{name}"), samples(|estimate| estimate.stderr));
        [values, errors]
            .map(|(name, samples)| AnyChannel { quantize_linearly: false, ..AnyChannel::new(name.as_str(), samples) })
    });
    let channels: Vec<_> = channels.collect();
    let channels = AnyChannels::sort(channels.into_iter().collect());
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let mut attributes = LayerAttributes::named(name);
    // The JSON goes in as UTF-8 bytes: the file format does not say more of a string.
    let text = Text::from_bytes_unchecked(attribute.bytes().collect());
    attributes.other.insert(Text::from("fiberwalk"), AttributeValue::Text(text));
    Layer::new(size, attributes, encoding, channels)
}
