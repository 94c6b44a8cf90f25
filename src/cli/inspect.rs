//! `fiberwalk inspect`.

mod woven;

use super::{one_line, print};
use fiberwalk::measure::{Prepared, memory, prepare};
use fiberwalk::report::WIDTHS;
use fiberwalk::scene::{Orientation, Scene, Sheet, Source, Structure};
use fiberwalk::{Error, Result};
use glam::DVec3;
use std::fmt::Write;
use std::path::PathBuf;

/// Say what a cloth and its model are, without measuring it; draw a weave: weave.png
#[derive(clap::Args)]
pub struct Arguments {
    /// Cloth file, or a preset: charmeuse, denim, felt, nonwoven, voile
    cloth: String,
    /// Folder of the picture of a weave [default: the file's stem or the preset's name]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Width of the picture of a weave in pixels [default: 1600]
    #[arg(long, value_name = "PIXELS", value_parser = width, allow_negative_numbers = true)]
    width: Option<usize>,
}

fn width(text: &str) -> std::result::Result<usize, String> {
    let number = text.parse().ok().filter(|width| WIDTHS.contains(width));
    number.ok_or_else(|| format!("must be a whole number from {} to {}", WIDTHS.start(), WIDTHS.end()))
}

/// Run the command.
pub fn run(arguments: &Arguments) -> Result<()> {
    let source = Source::find(&arguments.cloth)?;
    let scene = Scene::parse(&source)?;
    if let Structure::Weave(_) = &scene.structure {
        let folder = arguments.output.clone().unwrap_or_else(|| PathBuf::from(&source.stem));
        return woven::run(&scene, &folder, arguments.width.unwrap_or(1600));
    }
    if arguments.output.is_some() || arguments.width.is_some() {
        let message = "a sheet has no weave to draw: leave out -o and --width";
        return Err(Error::Input(message.into()));
    }
    let prepared = prepare(&scene)?;
    let sheet = scene.sheet()?;
    print(&(cloth(&scene, sheet) + &medium(&scene, sheet, &prepared) + &sizes(&scene, &prepared)))
}

/// The cloth as the file says it.
fn cloth(scene: &Scene, sheet: &Sheet) -> String {
    let mut text = format!("{}\n", one_line(&scene.name));
    for part in &sheet.fibers {
        let fiber = &scene.fibers[part.fiber];
        let orientation = match part.orientation {
            Orientation::Isotropic => "isotropic".into(),
            Orientation::Planar => "planar".into(),
            Orientation::Aligned { axis, spread } => {
                format!("aligned to [{:.3}, {:.3}, {:.3}] ± {:.1}°", axis.x, axis.y, axis.z, spread.to_degrees())
            }
        };
        let name = one_line(&fiber.name);
        let (radius, ior, density) = ((fiber.radius * 1e9).round() / 1e6, fiber.ior, part.length_density);
        let _ =
            writeln!(text, "fibers           {name}: radius {radius} µm, index {ior}, {density} mm/mm³, {orientation}");
    }
    text += &channels(scene);
    let _ = writeln!(text, "thickness        {} mm", sheet.thickness);
    let _ = writeln!(text, "volume fraction  {:.4}", sheet.volume_fraction(&scene.fibers));
    text + &areal_mass(sheet.areal_mass(&scene.fibers))
}

/// The colour channels of the result.
fn channels(scene: &Scene) -> String {
    let names = &scene.channels.names;
    let channels = match &names[..] {
        [first, .., last] if names.len() > 3 => format!("{} from {first} to {last}", names.len()),
        _ => names.join(", "),
    };
    let absorbing = if scene.channels.lossless() { ", nothing is absorbed" } else { "" };
    format!("channels         {channels}{absorbing}\n")
}

/// A mass of an area in g/m², if it is known.
fn areal_mass(mass: Option<f64>) -> String {
    let mass = mass.map_or("unknown: a fiber has no density_g_per_cm3".into(), |mass| format!("{mass:.1} g/m²"));
    format!("areal mass       {mass}\n")
}

/// The medium that it becomes.
fn medium(scene: &Scene, sheet: &Sheet, prepared: &Prepared) -> String {
    let Prepared { specific_length, tables, .. } = prepared;
    let mut text = String::new();
    for theta in [0.0, 30.0, 60.0f64] {
        // Light from the middle between x and y.
        let (sin, cos) = theta.to_radians().sin_cos();
        let m = -DVec3::new(sin / 2f64.sqrt(), sin / 2f64.sqrt(), cos);
        let depth = specific_length.visible_area(m, |kind| scene.fibers[kind].radius) * sheet.thickness;
        let direct = (-depth / cos).exp();
        let _ = writeln!(text, "light at {theta:2}°      optical depth {:.3}, direct light {direct:.3e}", depth / cos);
    }
    let _ = writeln!(text, "tentative depth  {:.3} along the normal", tables.depth());
    if specific_length.spread_error > 0.0 {
        let error = 100.0 * specific_length.spread_error;
        let _ =
            writeln!(text, "direction grid   smears the spread bundles; the largest error of H found is {error:.2} %");
    }
    text
}

/// What the run will take.
fn sizes(scene: &Scene, prepared: &Prepared) -> String {
    let Prepared { tables, goniometer, .. } = prepared;
    let mib = |bytes: usize| bytes as f64 / f64::from(1 << 20);
    format!(
        "tables           {} entries of 16 bytes from a grid of {} directions\n\
         results          {} incident × {} exit cells, at most {:.1} MiB of memory besides the program\n",
        tables.patches.len(),
        scene.model.directions,
        goniometer.starts(),
        2 * goniometer.exit.cells(),
        mib(memory(tables, goniometer))
    )
}
