//! Draw the fronts of all woven presets on one page: `cargo run --release --example presets -- assets/figures/presets.png`

use fiberwalk::cloth::Cloth;
use fiberwalk::report::contact_sheet;
use fiberwalk::scene::{PRESETS, Scene, Source, Structure};
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("name the picture, such as presets.png")?;
    let mut woven = Vec::new();
    for (name, _) in PRESETS {
        let scene = Scene::parse(&Source::find(name)?)?;
        if let Structure::Weave(_) = scene.structure {
            woven.push((Cloth::new(&scene)?, scene));
        }
    }
    let cloths: Vec<_> = woven.iter().map(|(cloth, scene)| (cloth, scene)).collect();
    contact_sheet(&cloths, 920).write_png(BufWriter::new(File::create(file)?))?;
    Ok(())
}
