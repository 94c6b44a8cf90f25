//! `bsdf.exr`: one part for each component, one row for each incident cell, one column for each exit cell.

use super::provenance::attribute;
use crate::bsdf::{Component, Estimate, direct, values};
use crate::measure::Measurement;
use crate::scene::Scene;
use exr::prelude::*;
use std::fs::File;
use std::io::{self, BufWriter};

pub(super) type Part = Layer<AnyChannels<FlatSamples>>;

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
        let direct = |_| -> Vec<Estimate> { starts.clone().map(|start| direct(tally, start)).collect() };
        let name = |what: &str| format!("{}.{what}", side.name());
        let channels = &scene.channels.names;
        let (reflection, transmission) = (Component::Reflection, Component::Transmission);
        parts.push(part(&name("reflection"), size, channels, |channel| table(reflection, channel), &attribute));
        parts.push(part(&name("transmission"), size, channels, |channel| table(transmission, channel), &attribute));
        parts.push(part(&name("direct"), (cells, 1), channels, direct, &attribute));
    }
    write_parts(file, size, parts)
}

/// Write parts as a file whose window has a size.
pub(super) fn write_parts(
    file: &mut File,
    size: (usize, usize),
    parts: Layers<AnyChannels<FlatSamples>>,
) -> io::Result<()> {
    let image = Image::from_layers(ImageAttributes::new(IntegerBounds::from_dimensions(size)), parts);
    image.write().to_buffered(BufWriter::new(file)).map_err(|error| match error {
        Error::Io(error) => error,
        other => io::Error::other(other.to_string()),
    })
}

/// A part of named channels, with the attribute `fiberwalk`.
pub(super) fn layer(
    name: &str,
    size: (usize, usize),
    channels: impl Iterator<Item = (String, FlatSamples)>,
    attribute: &str,
) -> Part {
    let channels = channels
        .map(|(name, samples)| AnyChannel { quantize_linearly: false, ..AnyChannel::new(name.as_str(), samples) });
    let channels = AnyChannels::sort(channels.collect());
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let mut attributes = LayerAttributes::named(name);
    // The JSON goes in as UTF-8 bytes: the file format does not say more of a string.
    let text = Text::from_bytes_unchecked(attribute.bytes().collect());
    attributes.other.insert(Text::from("fiberwalk"), AttributeValue::Text(text));
    Layer::new(size, attributes, encoding, channels)
}

/// One part: every channel and its standard error, a channel at a time.
fn part(
    name: &str,
    size: (usize, usize),
    names: &[String],
    estimates: impl Fn(usize) -> Vec<Estimate>,
    attribute: &str,
) -> Part {
    let channels = names.iter().enumerate().flat_map(|(channel, name)| {
        let estimates = estimates(channel);
        let samples = |of: fn(&Estimate) -> f64| FlatSamples::F32(estimates.iter().map(|e| of(e) as f32).collect());
        let values = (name.clone(), samples(|estimate| estimate.value));
        let errors = (format!("stderr.{name}"), samples(|estimate| estimate.stderr));
        [values, errors]
    });
    layer(name, size, channels, attribute)
}
