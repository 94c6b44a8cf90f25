//! Which presets can be laid with separate fibers, and what it takes: `cargo bench --bench packing -- [PRESET …]`.

use fiberwalk::cloth::{Cloth, DrawnFor, Realization, Realizer};
use fiberwalk::scene::{PRESETS, Packing, Scene, Source};
use std::time::Instant;

fn length(drawn: &Realization) -> f64 {
    drawn.fibers.iter().flat_map(|fiber| fiber.pieces(drawn.period)).map(|piece| piece.length).sum()
}

fn main() {
    let named: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    println!("| preset | v | densest yarn | pieces | result | sweeps | s | deepest | covered | length |");
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for (name, _) in PRESETS.iter().filter(|(name, _)| named.is_empty() || named.iter().any(|word| word == name)) {
        let scene = Scene::parse(&Source::find(name).expect("it is a preset")).expect("it is right");
        let random = Realizer::new(&scene, Packing::Random, DrawnFor::Medium).expect("it can be laid out");
        let before = random.draw(0).expect("nothing is refused");
        let densest = Cloth::new(&scene).map_or("-".into(), |cloth| format!("{:.2}", cloth.statistics().densest));
        let start = Instant::now();
        let found = random.draw_separate(0);
        let seconds = start.elapsed().as_secs_f64();
        let row = match &found {
            Ok((after, found)) => {
                let pieces: usize = after.fibers.iter().map(|fiber| fiber.points.len() - 1).sum();
                let (deepest, covered) = (found.penetration, found.covered);
                let longer = length(after) / length(&before);
                format!(
                    "{pieces} | reached | {} | {seconds:.2} | {deepest:.4} | {covered:.4} | × {longer:.4}",
                    found.sweeps
                )
            }
            Err(error) => format!("- | {error} | - | {seconds:.2} | - | - | -"),
        };
        println!("| {name} | {:.3} | {densest} | {row} |", before.volume_fraction());
    }
}
