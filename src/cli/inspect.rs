//! `fiberwalk inspect`.

mod woven;
mod yarns;

use super::{one_line, print};
use fiberwalk::cloth::{DrawnFor, FiberGrid};
use fiberwalk::measure::{EngineChoice, Prepared, choose, memory, prepare};
use fiberwalk::plan::{EngineClass, Extent, plan};
use fiberwalk::report::WIDTHS;
use fiberwalk::results::ResultFolder;
use fiberwalk::scene::{Orientation, Packing, Scene, Sheet, Source, Structure};
use fiberwalk::{Error, Result};
use glam::DVec3;
use std::fmt::Write;
use std::path::PathBuf;

/// Say what a cloth and its model are, without measuring it; draw a weave: weave.png
#[derive(clap::Args)]
pub struct Arguments {
    /// Cloth file, or a preset: charmeuse, denim, dimout, felt, gabardine, jersey, linen, lining, muslin,
    /// nonwoven, rib, sheer, voile
    cloth: String,
    /// Folder of the picture of a weave or a knit [default: the file's stem or the preset's name]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Width of the picture of a weave or a knit in pixels [default: 1600]
    #[arg(long, value_name = "PIXELS", value_parser = width, allow_negative_numbers = true)]
    width: Option<usize>,
    /// Tolerance for which the plan is shown [default: 5%]
    #[arg(long, value_name = "SHARE", value_parser = super::measure::share, allow_hyphen_values = true)]
    tolerance: Option<f64>,
}

fn width(text: &str) -> std::result::Result<usize, String> {
    let number = text.parse().ok().filter(|width| WIDTHS.contains(width));
    number.ok_or_else(|| format!("must be a whole number from {} to {}", WIDTHS.start(), WIDTHS.end()))
}

/// Run the command.
pub fn run(arguments: &Arguments) -> Result<()> {
    let source = Source::find(&arguments.cloth)?;
    let scene = Scene::parse(&source)?;
    let drawn = arguments.output.is_some() || arguments.width.is_some();
    if let (Structure::Sheet(_), true) = (&scene.structure, drawn) {
        let message = "a sheet has no yarns to draw: leave out -o and --width";
        return Err(Error::Input(message.into()));
    }
    let folder = arguments.output.clone().unwrap_or_else(|| PathBuf::from(&source.stem));
    if let Some(name) = woven::picture_name(&scene.structure) {
        ResultFolder::check(&folder, name)?;
    }
    // Rays through the fibers show nothing here.
    let prepared = prepare(&Scene { model: scene.model.without_rays(), ..scene.clone() })?;
    let plan = planned(&scene, arguments.tolerance.unwrap_or(0.05))?;
    if let Some(cloth) = &prepared.cloth {
        return woven::run(&scene, cloth, &prepared, &plan, &folder, arguments.width.unwrap_or(1600));
    }
    let sheet = scene.sheet()?;
    let tables = format!("memory           tables {}\n", beside_fibers(&scene, &prepared)?);
    print(&(cloth(&scene, sheet) + &medium(&scene, &prepared) + &tables + &results(&scene, &prepared) + &plan))
}

/// What `measure` would choose for a tolerance, and why; pilots are walked, the run is not. Nothing where the file says how the cloth
/// is to be modelled.
fn planned(scene: &Scene, tolerance: f64) -> Result<String> {
    if scene.model.chosen {
        return Ok("plan             none: the file says how the cloth is modelled\n".into());
    }
    let engine = choose(EngineChoice::Auto, None)?;
    let extent = Extent::of(scene)?;
    let (plan, _) = plan(scene, &extent, tolerance, (&engine, EngineClass::of(&engine)), 1, true, false)?;
    Ok(format!(
        "plan             for a tolerance of {:.3} %: {}; {}\n",
        100.0 * tolerance,
        one_line(&plan.chosen),
        plan.reason
    ))
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

/// The medium that a sheet becomes.
fn medium(scene: &Scene, prepared: &Prepared) -> String {
    let Prepared { tables, .. } = prepared;
    let (entries, grid) = (tables.patches.len(), scene.model.directions);
    format!(
        "{}tentative depth  {:.3} along the normal\n\
         tables           {entries} entries of 16 bytes from a grid of {grid} directions\n",
        light(scene, prepared),
        tables.depth()
    )
}

/// What light meets, and how well the tables know it.
fn light(scene: &Scene, prepared: &Prepared) -> String {
    let Prepared { specific_length, tables, .. } = prepared;
    let mut text = String::new();
    let radius = |kind: usize| scene.fibers[kind].radius;
    for theta in [0.0, 30.0, 60.0f64] {
        // Light from the middle between x and y.
        let (sin, cos) = theta.to_radians().sin_cos();
        let m = -DVec3::new(sin / 2f64.sqrt(), sin / 2f64.sqrt(), cos);
        let depth = specific_length.mean_visible_area(m, radius) * specific_length.cells.thickness / cos;
        let direct = match tables.cells {
            None => format!(", direct light {:.3e}", (-depth).exp()),
            // Light finds its way where the cloth is thin: the mean depth does not tell how much.
            Some(_) => " on average".into(),
        };
        let _ = writeln!(text, "light at {theta:2}°      optical depth {depth:.3}{direct}");
    }
    let percent = 100.0 * specific_length.spread_error;
    if percent > 0.0 {
        let _ = writeln!(text, "direction grid   smears the bundles; the largest error of H found is {percent:.2} %");
    }
    if let Some(visible) = &tables.visible {
        let (n, percent) = (visible.n, 100.0 * visible.error);
        let _ = writeln!(text, "table of H       {n} × {n} rays; the largest error of H found is {percent:.2} %");
    }
    text
}

/// What the run will take.
fn results(scene: &Scene, prepared: &Prepared) -> String {
    let Prepared { tables, goniometer, .. } = prepared;
    format!(
        "results          {} incident × {} exit cells, at most {:.1} MiB of memory besides the program\n",
        goniometer.starts(),
        2 * goniometer.exit.cells(),
        memory(&scene.model, tables, goniometer) as f64 / f64::from(1 << 20)
    )
}

/// The size of the tables, and that of a realization of the fibers that the explicit model would use in their place. They are laid at
/// random, which is quick: of yarns separate ones have about as many pieces, of a sheet more, since they bend.
fn beside_fibers(scene: &Scene, prepared: &Prepared) -> Result<String> {
    let realizer = prepared.realizer(scene, Packing::Random, DrawnFor::Fibers)?;
    let drawn = realizer.draw(0)?;
    let [pieces, grid] = FiberGrid::of(&drawn)?.bytes();
    let mib = |bytes: usize| bytes as f64 / f64::from(1 << 20);
    Ok(format!(
        "{:.1} MiB; of the explicit model {:.1} MiB a realization, {:.1} of pieces and {:.1} of the grid that finds them",
        mib(prepared.tables.bytes()),
        mib(pieces + grid),
        mib(pieces),
        mib(grid)
    ))
}
