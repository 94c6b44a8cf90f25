//! Where a statistical medium stops to be one: `cargo run --release --example few_fibers -- [WALKS]`
//!
//! Plain weaves of yarns of 1 to 200 filaments, all as open, with and without twist, of thin and thick fibers, clear and dyed: E of media with
//! cells of 4 and 1.4 fiber radii against the fibers, by pilots, with the interval at the level of 95 %; how many fibers run through a cell where fibers are,
//! and how many tentative events a walk has.

use fiberwalk::bsdf::Verdict;
use fiberwalk::measure::{EngineChoice, Prepared, choose, prepare};
use fiberwalk::plan::{Beside, Configuration, Extent, Pilot};
use fiberwalk::scene::{Scene, Source};
use std::error::Error;

const NUMBERS: [u32; 8] = [1, 2, 3, 7, 20, 50, 100, 200];
/// Share of a yarn's section that fibers fill; one fiber alone fills more of its own.
const FILL: f64 = 0.55;
/// Width of a yarn over the distance of two.
const COVER: f64 = 0.6;

/// A cloth of yarns of so many filaments of a radius in µm, an absorption in 1/mm.
fn cloth(number: u32, twist: u32, radius: f64, absorption: f64) -> String {
    let fill = if number == 1 { 0.9 } else { FILL };
    let size = 2.0 * radius * (f64::from(number) / fill).sqrt();
    let set = 1e4 / size * COVER;
    format!(
        "[fiber.a]\nradius_um = {radius}\nior = 1.55\nabsorption_per_mm = {absorption}\n[yarn.a]\nfiber = \"a\"\nfibers_per_ply = {number}\n\
         width_um = {size:.2}\nheight_um = {size:.2}\nply_twist_per_m = {twist}\n[weave]\ndraft = [\"X.\", \".X\"]\nwarp = [\"a\"]\nweft = [\"a\"]\n\
         ends_per_cm = {set:.3}\npicks_per_cm = {set:.3}\n"
    )
}

fn main() -> Result<(), Box<dyn Error>> {
    let walks: f64 = std::env::args().nth(1).map_or(Ok(4e5), |word| word.parse())?;
    let engine = choose(EngineChoice::Auto, None)?;
    println!(
        "| filaments | turns/m | radius µm | absorption /mm | events a walk | fibers in a cell of 4 R | E at 4 R | E at 1.4 R |\n|---|---|---|---|---|---|---|---|"
    );
    for (twist, radius, absorption) in [(0, 10.0, 0.0), (400, 10.0, 0.0), (0, 10.0, 20.0), (0, 40.0, 0.0)] {
        for number in NUMBERS {
            let source = Source {
                file: "cloth".into(),
                stem: "cloth".into(),
                text: cloth(number, twist, radius, absorption),
                folder: None,
            };
            let scene = Scene::parse(&source)?;
            let extent = Extent::of(&scene)?;
            let pilot = Pilot::new(&scene, extent.realizer(), 1, |_, _| walks)?;
            let hold = |edge: f64| -> fiberwalk::Result<(Verdict, f64, f64)> {
                let medium = Configuration::of(&scene, &extent).edged(edge).without_rays().apply(&scene, &extent);
                let Prepared { specific_length, tables, .. } = prepare(&medium)?;
                let mut beside = Beside::default();
                let verdict = pilot.hold(&mut beside, &tables, &engine)?;
                // Length in a volume times the area of a cell, in the mean over the surface of fibers.
                let surfaces = || specific_length.values.iter().map(|cell| cell.surface);
                let mean = surfaces().map(|surface| surface * surface).sum::<f64>() / surfaces().sum::<f64>();
                Ok((verdict, beside.events(), mean * 1e-3 * radius * edge * edge))
            };
            let word = |held: &fiberwalk::Result<(Verdict, f64, f64)>| match held {
                Ok((verdict, ..)) => {
                    let [low, high] = verdict.interval().map(|end| 100.0 * end);
                    format!("{:.1} ({low:.1} to {high:.1}) %", 100.0 * verdict.light.error())
                }
                Err(_) => "refused: cells too full".into(),
            };
            let (coarse, fine) = (hold(4.0), hold(1.4));
            let of =
                |place: usize| coarse.as_ref().map_or("—".into(), |held| format!("{:.1}", [held.1, held.2][place]));
            println!(
                "| {number} | {twist} | {radius} | {absorption} | {} | {} | {} | {} |",
                of(0),
                of(1),
                word(&coarse),
                word(&fine)
            );
        }
    }
    Ok(())
}
