//! What `fiberwalk inspect` says of yarns.

use super::super::one_line;
use fiberwalk::cloth::Cloth;
use fiberwalk::scene::{Scene, Spread, Yarn};
use std::fmt::Write;

/// The kinds of fiber and the yarns that the threads are made of.
pub fn yarns(scene: &Scene, cloth: &Cloth) -> String {
    let mut text = String::new();
    for kind in cloth.used_kinds() {
        let fiber = &scene.fibers[kind];
        let (name, radius) = (one_line(&fiber.name), micro(fiber.radius));
        let _ = writeln!(text, "fibers           {name}: radius {radius} µm, index {}", fiber.ior);
    }
    for yarn in cloth.used_yarns().into_iter().map(|yarn| &cloth.yarns()[yarn]) {
        let (name, width, height) = (one_line(&yarn.name), micro(yarn.width), micro(yarn.height));
        let fill = yarn.packing(&scene.fibers);
        let _ =
            writeln!(text, "yarn             {name}: {}, {width} × {height} µm, fill {fill:.3}", fibers(scene, yarn));
        text += &disorder(yarn);
    }
    text
}

/// How many fibers of which kinds a yarn has.
fn fibers(scene: &Scene, yarn: &Yarn) -> String {
    let kinds =
        yarn.counts().into_iter().map(|(kind, count)| format!("{count} {}", one_line(&scene.fibers[kind].name)));
    let plies = if yarn.plies == 1 { String::new() } else { format!(" in {} plies", yarn.plies) };
    format!("{}{plies}", kinds.collect::<Vec<_>>().join(" + "))
}

/// Hairs, loops and migration of a yarn.
fn disorder(yarn: &Yarn) -> String {
    let mut text = String::new();
    let length = |spread: &Spread| format!("{} ± {} µm", micro(spread.mean), micro(spread.deviation));
    let degrees = |angle: f64| (angle.to_degrees() * 1e6).round() / 1e6;
    if let Some(hairs) = yarn.flyaways.and_then(|flyaways| flyaways.hairs) {
        let rise = format!("{} ± {}°", degrees(hairs.rise.mean), degrees(hairs.rise.deviation));
        let _ =
            writeln!(text, "  hairs          {} on a mm, {} long, rising {rise}", hairs.per_mm, length(&hairs.length));
    }
    if let Some(loops) = yarn.flyaways.and_then(|flyaways| flyaways.loops) {
        let span = format!("{:.0} µm of yarn each", loops.span * 1e3);
        let _ = writeln!(text, "  loops          {} on a mm, {} high, {span}", loops.per_mm, length(&loops.height));
    }
    if let Some(migration) = yarn.migration {
        let ([low, high], swings) = (migration.radius, migration.periods_per_turn);
        let way = format!("{low} to {high} of a fiber's distance from its ply's centre");
        let _ = writeln!(text, "  migration      {way}, {swings} swings a turn");
    }
    text
}

/// mm → µm, without the noise of the conversion.
fn micro(length: f64) -> f64 {
    (length * 1e9).round() / 1e6
}
