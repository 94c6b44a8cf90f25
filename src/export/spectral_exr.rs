//! Images of the exit disc in OpenEXR, one part for each of some incident cells: for pictures and slices, not for renderers.
//!
//! Channels of wavelengths are those of Fichet, Pacanowski and Wilkie, "An OpenEXR Layout for Spectral Images", JCGT 10(3), 2021, with R, G, B
//! beside them for viewers. A pixel is a place of the projected disc, x to the right and y upwards, as it is seen from the front.

use super::fit::{Check, Sums};
use super::format::{File, Job, Written};
use crate::bsdf::{Component, Scattering};
use crate::colour::Channels;
use crate::error::{Error, Result};
use exr::prelude::*;
use glam::DVec2;
use std::io::Cursor;

/// Pixels along an edge.
const EDGE: usize = 128;
/// Polar angles near which slices are taken, in degrees, along the weft and along the warp.
const THETAS: [f64; 6] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0];

/// What the format leaves out of a table.
pub fn notes() -> Vec<String> {
    vec![
        "slices for viewers: the incident cells nearest to 0, 15, 30, 45, 60 and 75° along the weft and the warp, f in sr⁻¹ without errors".into(),
        "there is no place for light that touches no fiber, and it is left out".into(),
    ]
}

/// Write a file for each component and side and read it again.
///
/// # Errors
/// [`Error::Failed`] when the library cannot make the file.
pub fn write(job: &Job) -> Result<Written> {
    let mut written = Written::default();
    for part in job.table.tables() {
        let component = if part.component == Component::Reflection { "reflection" } else { "transmission" };
        let name = format!("{}_{}_{component}.exr", job.stem, part.side.name());
        let failed = |error: exr::error::Error| Error::Failed(format!("{name} cannot be made: {error}"));
        let slices = slices(job);
        let layers: Layers<AnyChannels<FlatSamples>> = slices.iter().map(|cell| layer(job, part, *cell)).collect();
        let image = Image::from_layers(ImageAttributes::new(IntegerBounds::from_dimensions((EDGE, EDGE))), layers);
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).map_err(failed)?;
        let bytes = bytes.into_inner();
        let check = read(job, part, &slices, &bytes).map_err(failed)?;
        written.checks.push((name.clone(), check));
        written.files.push(File { name, bytes });
    }
    Ok(written)
}

/// Incident cells of the slices.
fn slices(job: &Job) -> Vec<usize> {
    let along = |axis: DVec2| THETAS.map(|theta| job.incident.cell_of(axis * theta.to_radians().sin()));
    let mut cells = [along(DVec2::X), along(DVec2::Y)].concat();
    cells.sort_unstable();
    cells.dedup();
    cells
}

/// The exit cell of a pixel; none outside of the disc.
fn cell_of(job: &Job, pixel: usize) -> Option<usize> {
    let at = |i: usize| (2 * i + 1) as f64 / EDGE as f64 - 1.0;
    let wo = DVec2::new(at(pixel % EDGE), -at(pixel / EDGE));
    (wo.length() < 1.0).then(|| job.table.goniometer.exit.cell_of(wo))
}

/// Names and values by exit cell of the channels of a slice, the table's own and R, G, B.
fn channels(job: &Job, part: &Scattering, cell: usize) -> Vec<(String, Vec<f64>)> {
    let (exits, count) = (job.table.goniometer.exit.cells(), job.table.channels.len());
    let own = |channel: usize| -> Vec<f64> {
        (0..exits).map(|exit| part.f[(cell * exits + exit) * count + channel].value).collect()
    };
    let names = job.table.channels.iter().cloned().enumerate();
    let mut channels: Vec<(String, Vec<f64>)> = names.map(|(channel, name)| (name, own(channel))).collect();
    if let Channels::Spectral(_) = job.channels {
        let rgb = job.channels.to_rgb();
        let mixed = |k: usize| -> Vec<f64> {
            let mix = |exit: usize| channels.iter().zip(&rgb).map(|((_, values), rgb)| rgb[k] * values[exit]).sum();
            (0..exits).map(mix).collect()
        };
        let colours = [0, 1, 2].map(|k| (["R", "G", "B"][k].to_owned(), mixed(k)));
        channels.extend(colours);
    }
    channels
}

fn layer(job: &Job, part: &Scattering, cell: usize) -> Layer<AnyChannels<FlatSamples>> {
    let pixels: Vec<Option<usize>> = (0..EDGE * EDGE).map(|pixel| cell_of(job, pixel)).collect();
    let channel = |(name, values): (String, Vec<f64>)| {
        let samples = pixels.iter().map(|cell| cell.map_or(0.0, |cell| values[cell] as f32)).collect();
        AnyChannel { quantize_linearly: false, ..AnyChannel::new(name.as_str(), FlatSamples::F32(samples)) }
    };
    let channels = AnyChannels::sort(channels(job, part, cell).into_iter().map(channel).collect());
    let mut attributes = LayerAttributes::named(name(job, cell).as_str());
    attributes.other.insert(Text::from("spectralLayoutVersion"), AttributeValue::Text(Text::from("1.0")));
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    Layer::new((EDGE, EDGE), attributes, encoding, channels)
}

/// The name of a slice: its incident cell and the angles of its middle.
fn name(job: &Job, cell: usize) -> String {
    let wi = job.incident.centre(cell);
    let [theta, phi] = [wi.z.min(1.0).acos(), wi.y.atan2(wi.x)].map(f64::to_degrees);
    format!("cell {cell} theta {theta:.2} phi {phi:.2}")
}

/// Hold the pixels against the table, each against the cell that it lies in.
fn read(job: &Job, part: &Scattering, slices: &[usize], bytes: &[u8]) -> exr::error::Result<Check> {
    let reader =
        exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let image = reader.from_buffered(Cursor::new(bytes))?;
    let (exits, count) = (job.table.goniometer.exit.cells(), job.table.channels.len());
    let mut sums = Sums::default();
    for (layer, cell) in image.layer_data.iter().zip(slices) {
        for (channel, name) in job.table.channels.iter().enumerate() {
            let found = layer.channel_data.list.iter().find(|known| known.name == *name.as_str());
            let Some(FlatSamples::F32(samples)) = found.map(|found| &found.sample_data) else {
                return Err(exr::error::Error::Invalid("a channel is missing".into()));
            };
            let mut seen = std::collections::BTreeMap::new();
            for (pixel, value) in samples.iter().enumerate() {
                if let Some(exit) = cell_of(job, pixel) {
                    let mean = seen.entry(exit).or_insert((0.0, 0.0));
                    *mean = (mean.0 + f64::from(*value), mean.1 + 1.0);
                }
            }
            let mut light = 0.0;
            for (exit, (value, pixels)) in seen {
                let estimate = part.f[(cell * exits + exit) * count + channel];
                let solid_angle = job.table.goniometer.exit.projected_solid_angle(exit);
                sums.compare(value / pixels, estimate, solid_angle);
                light += (value / pixels - estimate.value) * solid_angle;
            }
            sums.light = sums.light.max(f64::abs(light));
        }
    }
    Ok(sums.check())
}
