//! `fiberwalk curves`.

use super::measure::whole;
use super::{one_line, print};
use clap::ValueEnum;
use fiberwalk::cloth::{Cloth, DrawnFor, OF_USER, Realizer};
use fiberwalk::export::{CurveChoice, CurveFormat, REPEATS, write_curves};
use fiberwalk::results::ResultFolder;
use fiberwalk::scene::{SEED, Scene, Source, Structure, closest};
use fiberwalk::{Error, Result};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Write the fibers of a weave or a knit as curves, as they are drawn for one realization
#[derive(clap::Args)]
pub struct Arguments {
    /// Cloth file, or a preset: charmeuse, denim, dimout, gabardine, jersey, linen, lining, muslin, rib, sheer, voile
    cloth: String,
    /// mitsuba: a text file for its shapes linearcurve (exact) and bsplinecurve (rounded); obj: polylines
    #[arg(long, value_name = "FORMAT")]
    to: Format,
    /// The file [default: the cloth file's stem or the preset's name with .txt or .obj]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Number of the random draw, among those that measure --model explicit sends light through
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = place, allow_negative_numbers = true)]
    realization: u64,
    /// Seed of the random numbers
    #[arg(long, value_name = "S", default_value_t = SEED, value_parser = whole, allow_negative_numbers = true)]
    seed: u64,
    /// How fibers are laid: random, where they may overlap, or separate, where they do not [default: as the cloth file says]
    #[arg(long, value_name = "PACKING")]
    packing: Option<String>,
    /// Repeats along x (the weft, a course) and y (the warp, a wale)
    #[arg(long, value_name = "NxM", default_value = "1x1", value_parser = repeats, allow_negative_numbers = true)]
    repeats: [u32; 2],
    /// Only fibers of this kind, such as one that has a material of its own
    #[arg(long, value_name = "NAME")]
    fiber: Option<String>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    Mitsuba,
    Obj,
}

fn place(text: &str) -> std::result::Result<u64, String> {
    let number = text.parse().ok().filter(|number| *number < OF_USER);
    number.ok_or_else(|| format!("must be a whole number from 0 to {}", OF_USER - 1))
}

fn repeats(text: &str) -> std::result::Result<[u32; 2], String> {
    let number = |text: &str| text.parse().ok().filter(|count| REPEATS.contains(count));
    let pair = text.split_once('x').and_then(|(x, y)| Some([number(x)?, number(y)?]));
    pair.ok_or_else(|| format!("must be two whole numbers from {} to {}, such as 3x2", REPEATS.start(), REPEATS.end()))
}

/// Run the command.
pub fn run(arguments: &Arguments) -> Result<()> {
    let source = Source::find(&arguments.cloth)?;
    let mut scene = Scene::parse(&source)?;
    scene.model.seed = arguments.seed;
    if let Some(text) = &arguments.packing {
        scene.model.set_from_flag("packing", text)?;
    }
    if let Structure::Sheet(_) = &scene.structure {
        let message = "a sheet has no fibers that lie anywhere: it says how many run which way; curves are those of a weave or a knit";
        return Err(Error::Input(message.into()));
    }
    let cloth = Cloth::new(&scene)?;
    let kind = arguments.fiber.as_deref().map(|name| find_kind(&cloth, name)).transpose()?;
    let packing = scene.model.packing;
    let Arguments { realization, seed, repeats, .. } = *arguments;
    let choice = CurveChoice { realization, seed, packing, repeats, kind };
    let drawn = Realizer::of_yarns(cloth.clone(), &scene.model, DrawnFor::Fibers).draw(realization)?;
    let (format, extension) = match arguments.to {
        Format::Mitsuba => (CurveFormat::Mitsuba, "txt"),
        Format::Obj => (CurveFormat::Obj, "obj"),
    };
    let path = arguments.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}.{extension}", source.stem)));
    let counts = write_file(&path, |file| {
        let mut out = BufWriter::with_capacity(1 << 20, file);
        let counts = write_curves(&cloth, &drawn, &scene.name, format, &choice, &mut out)?;
        out.flush()?;
        Ok(counts)
    })?;
    let (size, [nx, ny]) = (cloth.size(), arguments.repeats);
    print(&format!(
        "{}\n{} fibers, {} points, {:.3} mm of fiber in {nx} × {ny} repeats of {:.4} × {:.4} mm, {}\n{}\n",
        one_line(&scene.name),
        counts.fibers,
        counts.points,
        counts.length,
        size.x,
        size.y,
        packing.description(),
        path.display()
    ))
}

/// The kind of fiber that a user names, among those of the threads.
fn find_kind(cloth: &Cloth, name: &str) -> Result<usize> {
    let kinds = cloth.used_kinds();
    let names: Vec<&str> = kinds.iter().map(|&kind| cloth.kinds()[kind].name.as_str()).collect();
    let found = names.iter().position(|known| *known == name);
    found.and_then(|place| kinds.get(place).copied()).ok_or_else(|| {
        let hint = closest(name, &names).map(|best| format!(", did you mean `{best}`?")).unwrap_or_default();
        Error::Input(format!("no thread has fibers named `{name}`{hint}; fibers: {}", names.join(", ")))
    })
}

/// Write a file that takes its place when it is whole.
fn write_file<T>(path: &Path, write: impl FnOnce(&mut std::fs::File) -> std::io::Result<T>) -> Result<T> {
    let shown = path.display();
    let name = path.file_name().and_then(|name| name.to_str()).filter(|_| !path.is_dir());
    let name = name.ok_or_else(|| Error::Input(format!("{shown} is not the name of a file: -o names one")))?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if folder.exists() && !folder.is_dir() {
        return Err(Error::Input(format!("{} is not a folder: -o names a file in one", folder.display())));
    }
    let mut made = None;
    ResultFolder::add(folder, name, |file| {
        made = Some(write(file)?);
        Ok(())
    })?;
    made.ok_or_else(|| Error::Input(format!("{shown} was not written")))
}
