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
    let cells = 0..tally.incident_cells();
    let size = (goniometer.exit.cells(), tally.incident_cells());
    let table = |component| cells.clone().flat_map(move |cell| values(tally, goniometer, component, cell));
    let direct = cells.clone().map(|cell| probability(tally.direct(cell), tally.walks_per_incident));
    let parts = [
        part("front.reflection", size, table(Component::Reflection), &attribute),
        part("front.transmission", size, table(Component::Transmission), &attribute),
        part("front.direct", (tally.incident_cells(), 1), direct, &attribute),
    ];
    let window = IntegerBounds::from_dimensions(size);
    let image = Image::from_layers(ImageAttributes::new(window), parts.into_iter().collect::<Layers<_>>());
    image.write().to_buffered(BufWriter::new(file)).map_err(|error| match error {
        Error::Io(error) => error,
        other => io::Error::other(other.to_string()),
    })
}

/// One part: the grey channel and its standard error.
fn part(name: &str, size: (usize, usize), estimates: impl Iterator<Item = Estimate>, attribute: &str) -> Part {
    let (values, errors): (Vec<f32>, Vec<f32>) =
        estimates.map(|estimate| (estimate.value as f32, estimate.stderr as f32)).unzip();
    let channels = [("Y", values), ("stderr.Y", errors)].map(|(name, samples)| AnyChannel {
        quantize_linearly: false,
        ..AnyChannel::new(name, FlatSamples::F32(samples))
    });
    let channels = AnyChannels::sort(channels.into_iter().collect());
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let mut attributes = LayerAttributes::named(name);
    // The JSON goes in as UTF-8 bytes: the file format does not say more of a string.
    let text = Text::from_bytes_unchecked(attribute.bytes().collect());
    attributes.other.insert(Text::from("fiberwalk"), AttributeValue::Text(text));
    Layer::new(size, attributes, encoding, channels)
}
