//! Draw the fronts of all presets on one page, weaves, knits, sheets:
//! `cargo run --release --example presets -- assets/figures/presets.png`

use fiberwalk::cloth::Cloth;
use fiberwalk::report::contact_sheet;
use fiberwalk::scene::{PRESETS, Scene, Source, Structure};
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("name the picture, such as presets.png")?;
    let mut laid = Vec::new();
    for (name, _) in PRESETS {
        let scene = Scene::parse(&Source::find(name)?)?;
        let cloth = match scene.structure {
            Structure::Sheet(_) => None,
            Structure::Weave(_) | Structure::Knit(_) => Some(Cloth::new(&scene)?),
        };
        laid.push((cloth, scene));
    }
    laid.sort_by_key(|(_, scene)| match scene.structure {
        Structure::Weave(_) => 0,
        Structure::Knit(_) => 1,
        Structure::Sheet(_) => 2,
    });
    let cloths: Vec<_> = laid.iter().map(|(cloth, scene)| (cloth.as_ref(), scene)).collect();
    contact_sheet(&cloths, 920).write_png(BufWriter::new(File::create(file)?))?;
    Ok(())
}
