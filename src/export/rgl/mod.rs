//! `.bsdf` of the RGL (Dupuy and Jakob 2018) for `measured` of Mitsuba 3 and pbrt-v4: reflection, one side a file.
//!
//! f cos θ is stored as it is: `ndf` is 1, `sigma` ¼ and `jacobian` 1, which makes the factor between them 1 in every loader. `vndf` is then a
//! change of variables only: the density that the half vector has when wo is cosine-distributed. Sources: mitsuba3 `src/bsdfs/measured.cpp`,
//! pbrt-v4 `src/pbrt/bxdfs.cpp`, brdf-loader `powitacq.inl`.

mod half;
mod loaded;
mod tensor;
mod warp;

use super::fit::{Smooth, SmoothRow, balance, check, near};
use super::format::{File, Job, Written};
use crate::bsdf::{Bsdf, Component, Scattering};
use crate::colour::{Channels, between};
use crate::goniometer::Basis;
use glam::{DVec2, DVec3};
use half::{Half, bilinear};
use loaded::Loader;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use tensor::Field;

/// Nodes of wi along θ, and along φ with both ends of the turn.
const THETAS: usize = 13;
const PHIS: usize = 33;
/// Nodes along an edge of the change of variables, and of the values.
const WARP: usize = 96;
const VALUES: usize = 48;
/// Places along an edge of the disc of wo at which the light of a node is summed.
const PLACES: u32 = 48;
/// Wavelengths in nm beyond which no renderer asks.
const SPAN: [f64; 2] = [360.0, 830.0];
/// Ends of the bands of blue, green and red in nm; in between they pass into each other.
const BANDS: [[f64; 2]; 3] = [[SPAN[0], 490.0], [510.0, 575.0], [595.0, SPAN[1]]];

/// What the format leaves out of a table.
pub fn notes() -> Vec<String> {
    vec![
        "reflection only: renderers have no place for measured transmission; the Mitsuba plugin reads bsdf.exr and has both".into(),
        "for light that touches no fiber put the material into a mask: opacity = 1 - openness".into(),
    ]
}

/// Write a file of each kind for every lit side, materials to paste, and read them again.
pub fn write(job: &Job) -> Written {
    let mut written = Written::default();
    let reflections = job.table.tables().iter().filter(|part| part.component == Component::Reflection);
    for part in reflections {
        let side = part.side.name();
        for (kind, values) in
            [("rgb", rgb(job.table, job.channels, part)), ("spectral", spectral(job.table, job.channels, part))]
        {
            let name = format!("{}_{side}_{kind}.bsdf", job.stem);
            let bytes = file(job, &values);
            let loader = Loader::read(&bytes, part.side, &values.back);
            let table = if kind == "rgb" {
                job.table.in_channels(["R", "G", "B"], &job.channels.to_rgb())
            } else {
                job.table.clone()
            };
            if let Some(loader) = loader {
                written.checks.push((name.clone(), check(&table, job.incident, &loader)));
            }
            written.files.push(File { name, bytes });
        }
        let materials = [("pbrt", pbrt(job, side)), ("xml", mitsuba(job, side))];
        written.files.extend(materials.map(|(extension, text)| File {
            name: format!("{}_{side}.{extension}", job.stem),
            bytes: text.into_bytes(),
        }));
    }
    written
}

/// A material to paste into a scene of pbrt-v4.
fn pbrt(job: &Job, side: &str) -> String {
    format!(
        "# {}: the {side}, reflection only. x of the shading frame is the weft.\n\
         MakeNamedMaterial \"{stem}_{side}\"\n    \"string type\" \"measured\"\n    \"string filename\" \"{stem}_{side}_spectral.bsdf\"\n",
        job.title.replace(['\n', '\r'], " "),
        stem = job.stem
    )
}

/// A material to paste into a scene of Mitsuba 3, RGB variants; spectral ones take the other file.
fn mitsuba(job: &Job, side: &str) -> String {
    let title = job.title.replace("--", "- -").replace(['\n', '\r', '<', '>'], " ");
    let measured = format!(
        "<bsdf type=\"measured\">\n        <string name=\"filename\" value=\"{}_{side}_rgb.bsdf\"/>\n    </bsdf>",
        job.stem
    );
    let inner = if job.is_open() {
        format!(
            "<bsdf type=\"mask\" id=\"{}_{side}\">\n    <float name=\"opacity\" value=\"{:.5}\"/>\n    {measured}\n</bsdf>",
            job.stem,
            1.0 - job.openness()
        )
    } else {
        measured.replacen("<bsdf ", &format!("<bsdf id=\"{}_{side}\" ", job.stem), 1)
    };
    format!(
        "<!-- {title}: the {side}, reflection only; dp/du is the weft. Spectral variants take {}_{side}_spectral.bsdf. -->\n{inner}\n",
        job.stem
    )
}

/// Values of a file by channel as functions, and how they make the channels of the table again.
struct Values {
    /// f of each channel.
    f: Vec<Smooth>,
    /// nm of each; empty for red, green and blue.
    wavelengths: Vec<f64>,
    /// Light of each channel by incident cell of the table.
    light: Vec<Vec<f64>>,
    /// Luminance of each channel.
    luminance: Vec<f64>,
    /// By channel of the file, its share of the channels that are held against the table.
    back: Vec<Vec<f64>>,
}

/// f of each channel, and its light by incident cell.
fn smooth(table: &Bsdf, part: &Scattering) -> (Vec<Smooth>, Vec<Vec<f64>>) {
    let exit = &table.goniometer.exit;
    let incident = table.goniometer.incident_basis();
    let channels = 0..if incident.is_some() { table.channels.len() } else { 0 };
    let one = |channel| {
        (Smooth::new(incident.unwrap_or(exit), exit, &table.values(part, channel)), table.shares(part, channel))
    };
    channels.map(one).unzip()
}

/// Linear red, green and blue; what lies outside of the gamut is cut.
fn rgb(table: &Bsdf, channels: &Channels, part: &Scattering) -> Values {
    let coloured = table.in_channels(["R", "G", "B"], &channels.to_rgb());
    let (f, light) =
        coloured.table(part.side, part.component).map_or_else(Default::default, |part| smooth(&coloured, part));
    Values {
        f,
        light,
        wavelengths: Vec::new(),
        luminance: vec![0.2126, 0.7152, 0.0722],
        back: (0..3).map(|k| (0..3).map(|to| if k == to { 1.0 } else { 0.0 }).collect()).collect(),
    }
}

/// A spectrum: the table's own, constant beyond its ends; of red, green and blue three bands that have their colour under D65.
fn spectral(table: &Bsdf, channels: &Channels, part: &Scattering) -> Values {
    let (own, light) = smooth(table, part);
    match channels {
        Channels::Grey => Values {
            f: vec![own[0].clone(), own[0].clone()],
            light: vec![light[0].clone(), light[0].clone()],
            wavelengths: SPAN.to_vec(),
            luminance: vec![0.5; 2],
            back: vec![vec![0.5]; 2],
        },
        Channels::Rgb => {
            let wavelengths: Vec<f64> = BANDS.iter().flatten().copied().collect();
            let shown = Channels::Spectral(wavelengths.clone()).to_rgb();
            // Red, green and blue of the bands, blue first.
            let columns = [0, 1, 2].map(|band| [0, 1, 2].map(|k| shown[2 * band][k] + shown[2 * band + 1][k]));
            let bands = glam::DMat3::from_cols_array_2d(&columns).inverse();
            let mixed = table.in_channels(["B", "G", "R"], &bands.to_cols_array_2d());
            let part = mixed.table(part.side, part.component);
            let (f, light) = part.map_or_else(Default::default, |part| smooth(&mixed, part));
            Values {
                f: f.iter().flat_map(|band| [band.clone(), band.clone()]).collect(),
                light: light.iter().flat_map(|band| [band.clone(), band.clone()]).collect(),
                luminance: Channels::Spectral(wavelengths.clone()).to_xyz().iter().map(|xyz| xyz[1]).collect(),
                wavelengths,
                back: shown.iter().map(|rgb| rgb.to_vec()).collect(),
            }
        }
        Channels::Spectral(own_wavelengths) => {
            let count = own_wavelengths.len();
            let mut wavelengths = own_wavelengths.clone();
            let (mut f, mut light) = (own, light);
            let unit = |to: usize| (0..count).map(|k| if k == to { 1.0 } else { 0.0 }).collect();
            let mut back: Vec<Vec<f64>> = (0..count).map(unit).collect();
            if wavelengths[0] > SPAN[0] {
                wavelengths.insert(0, SPAN[0]);
                f.insert(0, f[0].clone());
                light.insert(0, light[0].clone());
                back.insert(0, vec![0.0; count]);
            }
            if wavelengths[wavelengths.len() - 1] < SPAN[1] {
                wavelengths.push(SPAN[1]);
                f.push(f[f.len() - 1].clone());
                light.push(light[light.len() - 1].clone());
                back.push(vec![0.0; count]);
            }
            let luminance = Channels::Spectral(wavelengths.clone()).to_xyz().iter().map(|xyz| xyz[1]).collect();
            Values { f, light, wavelengths, luminance, back }
        }
    }
}

/// The nodes of wi: θ from the normal to the horizon, φ over the whole turn.
fn nodes() -> ([f64; THETAS], [f64; PHIS]) {
    let even = |i: usize, n: usize| i as f64 / (n - 1) as f64;
    (std::array::from_fn(|i| FRAC_PI_2 * even(i, THETAS)), std::array::from_fn(|i| -PI + 2.0 * PI * even(i, PHIS)))
}

/// The bytes of a file.
fn file(job: &Job, values: &Values) -> Vec<u8> {
    let (thetas, phis) = nodes();
    let pairs: Vec<(f64, f64)> = phis.iter().flat_map(|phi| thetas.iter().map(|theta| (*phi, *theta))).collect();
    let count = values.f.len();
    let light = balanced(job.incident, values);
    let slice = |(index, (phi, theta)): (usize, &(f64, f64))| {
        let light: Vec<f64> = light.iter().map(|nodes| nodes[one(index)]).collect();
        Slice::new(*phi, *theta, values, &light)
    };
    let slices: Vec<Slice> = pairs.par_iter().enumerate().map(slice).collect();
    let join = |of: fn(&Slice) -> &Vec<f32>| slices.iter().flat_map(of).copied().collect::<Vec<f32>>();
    let as_floats = |list: &[f64]| list.iter().map(|value| *value as f32).collect::<Vec<f32>>();
    let mut fields = vec![
        Field::bytes("description", format!("{}; fiberwalk {}", job.title, env!("CARGO_PKG_VERSION")).into_bytes()),
        Field::floats("phi_i", &[PHIS], as_floats(&phis)),
        Field::floats("theta_i", &[THETAS], as_floats(&thetas)),
        Field::floats("ndf", &[2, 2], vec![1.0; 4]),
        Field::floats("sigma", &[2, 2], vec![0.25; 4]),
        Field::floats("vndf", &[PHIS, THETAS, WARP, WARP], join(|slice| &slice.vndf)),
        Field::floats("luminance", &[PHIS, THETAS, VALUES, VALUES], join(|slice| &slice.luminance)),
        Field::bytes("jacobian", vec![1]),
    ];
    let shape = [PHIS, THETAS, count, VALUES, VALUES];
    if values.wavelengths.is_empty() {
        fields.push(Field::floats("rgb", &shape, join(|slice| &slice.values)));
    } else {
        fields.push(Field::floats("spectra", &shape, join(|slice| &slice.values)));
        fields.push(Field::floats("wavelengths", &[count], as_floats(&values.wavelengths)));
    }
    tensor::write(&fields)
}

/// The first node of those that are one direction: the ends of the turn, and all azimuths along the normal.
fn one(index: usize) -> usize {
    match (index / THETAS, index % THETAS) {
        (_, 0) => 0,
        (phi, theta) => phi % (PHIS - 1) * THETAS + theta,
    }
}

/// By channel, the light that each node must have for the incident cells to have theirs.
fn balanced(incident: &Basis, values: &Values) -> Vec<Vec<f64>> {
    let (thetas, phis) = nodes();
    let blend = |wi: DVec2| -> Vec<(usize, f64)> {
        let around = between(&phis, wi.y.atan2(wi.x)).into_iter().flat_map(|(phi, a)| {
            between(&thetas, wi.length().min(1.0).asin())
                .into_iter()
                .map(move |(theta, b)| (one(phi * THETAS + theta), a * b))
        });
        around.collect()
    };
    let of = |(f, wanted): (&Smooth, &Vec<f64>)| {
        let start = |(phi, theta): (f64, f64)| f.from(DVec2::from_angle(phi) * theta.sin()).light();
        let nodes: Vec<f64> = phis.iter().flat_map(|phi| thetas.map(|theta| start((*phi, theta)))).collect();
        balance(incident, &blend, wanted, &nodes)
    };
    values.f.iter().zip(&values.light).map(of).collect()
}

/// What a file holds for one direction of wi.
struct Slice {
    vndf: Vec<f32>,
    luminance: Vec<f32>,
    values: Vec<f32>,
}

impl Slice {
    fn new(phi: f64, theta: f64, values: &Values, light: &[f64]) -> Slice {
        // Along the normal there is one direction, whatever φ is.
        let phi = if theta == 0.0 { 0.0 } else { phi };
        let wi = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        let half = Half::new(wi);
        let vndf = half.density(WARP);
        let warp = warp::Warp::new(WARP, &vndf);
        let blend = [(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];
        let rows: Vec<_> = values.f.iter().map(|f| f.from(wi.truncate())).collect();
        let node = |k: usize| (k as f64) / (VALUES - 1) as f64;
        let places = (0..VALUES * VALUES).map(|i| {
            let (place, _) = warp.sample(&blend, [node(i % VALUES), node(i / VALUES)]);
            half.exit(place)
        });
        // The directions that are above the horizon, with the exit cells around them.
        let above = |wo: DVec3| match rows.first() {
            Some(row) if wo.z > 0.0 => (wo.z, near(row.exit(), wo.truncate())),
            _ => (0.0, Vec::new()),
        };
        let exits: Vec<(f64, Vec<(usize, f64)>)> = places.map(above).collect();
        let f = |row: &SmoothRow, near: &[(usize, f64)]| row.sum(near).max(0.0);
        let reads = half.reads(&warp, PLACES);
        let mut table: Vec<f32> = Vec::with_capacity(rows.len() * VALUES * VALUES);
        for (row, light) in rows.iter().zip(light) {
            let stored: Vec<f64> = exits.iter().map(|(cosine, near)| f(row, near) * cosine).collect();
            // Sum the light of this node as a loader sees it, and scale it to that of the table.
            let read = |(sample, weight): &([f64; 2], f64)| weight * bilinear(VALUES, *sample, &|index| stored[index]);
            let seen: f64 = reads.iter().map(read).sum();
            let factor = if seen > 0.0 { light.max(0.0) / seen } else { 1.0 };
            table.extend(stored.iter().map(|value| (value * factor) as f32));
        }
        let bright =
            |near: &[(usize, f64)]| rows.iter().zip(&values.luminance).map(|(row, y)| y * f(row, near)).sum::<f64>();
        let mut luminance: Vec<f32> = exits.iter().map(|(_, near)| bright(near).max(0.0) as f32).collect();
        // Sampling needs some density everywhere, however dark it is.
        let floor = 1e-3 * luminance.iter().sum::<f32>() / luminance.len() as f32;
        luminance.iter_mut().for_each(|value| *value = if floor > 0.0 { value.max(floor) } else { 1.0 });
        Slice { vndf, luminance, values: table }
    }
}
