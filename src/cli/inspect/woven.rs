//! `fiberwalk inspect` of a cloth of yarns.

use super::super::{one_line, print};
use super::yarns::yarns;
use super::{areal_mass, beside_fibers, channels, light, results};
use fiberwalk::Result;
use fiberwalk::cloth::{Cloth, Shape, Statistics};
use fiberwalk::distribution::Voids;
use fiberwalk::measure::Prepared;
use fiberwalk::report::cloth_picture;
use fiberwalk::results::ResultFolder;
use fiberwalk::scene::{Scene, Structure};
use std::fmt::Write;
use std::path::Path;

/// Draw the cloth into a folder, and say what the cloth is and where its picture lies.
pub fn run(scene: &Scene, cloth: &Cloth, prepared: &Prepared, plan: &str, folder: &Path, width: usize) -> Result<()> {
    let figures = cloth.statistics();
    let picture = cloth_picture(cloth, scene, width);
    let name = picture_name(&scene.structure).unwrap_or_default();
    let file = ResultFolder::add(folder, name, |file| picture.image.write_png(file))?;
    let blocks = [
        format!("{}\n", one_line(&scene.name)),
        repeat(cloth),
        yarns(scene, cloth),
        channels(scene),
        shape(cloth, &figures, picture.openness),
        mass(&figures),
        sizes(&figures),
        medium(scene, prepared)?,
        results(scene, prepared),
        plan.to_owned(),
        format!("{}\n", file.display()),
    ];
    print(&blocks.concat())
}

/// The file that shows the yarns of a cloth; none of a sheet.
pub fn picture_name(structure: &Structure) -> Option<&'static str> {
    match structure {
        Structure::Weave(_) => Some("weave.png"),
        Structure::Knit(_) => Some("knit.png"),
        Structure::Sheet(_) => None,
    }
}

/// The repeat and the setting of the threads.
fn repeat(cloth: &Cloth) -> String {
    let size = cloth.size();
    let [along, up] = cloth.spacing().to_array().map(|spacing| (1e6 * 10.0 / spacing).round() / 1e6);
    let (counts, setting) = match (cloth.weave(), cloth.knit()) {
        (Some(weave), _) => (
            format!("{} ends × {} picks", weave.ends.len(), weave.picks.len()),
            format!("{along} ends/cm, {up} picks/cm"),
        ),
        (_, knit) => {
            let wales = knit.map_or(1, |knit| knit.wales());
            let s = if wales == 1 { "" } else { "s" };
            (format!("{wales} wale{s} × 1 course"), format!("{along} wales/cm, {up} courses/cm"))
        }
    };
    let draft = cloth.weave().and_then(|weave| weave.wif.as_ref());
    let draft = draft.map_or(String::new(), |file| format!("draft            of {}\n", one_line(file)));
    format!("{draft}repeat           {counts}, {:.4} × {:.4} mm\nsetting          {setting}\n", size.x, size.y)
}

/// The shape of the threads and what they cover.
fn shape(cloth: &Cloth, figures: &Statistics, openness: f64) -> String {
    let threads = match figures.shape {
        Shape::Woven { crimp, steepest, .. } => {
            let [warp, weft] = crimp.map(|crimp| 100.0 * crimp);
            let [steep_warp, steep_weft] = steepest.map(f64::to_degrees);
            format!(
                "crimp            warp {warp:.2} %, weft {weft:.2} %\n\
                 steepest slope   warp {steep_warp:.1}°, weft {steep_weft:.1}°; there the fill is up to {:.3}\n",
                figures.densest
            )
        }
        Shape::Knitted { loop_length, stitch_density, steepest, tightest } => format!(
            "loops            {loop_length:.4} mm of yarn each, {:.2} in a cm²\n\
             tightest bend    radius {:.1} µm; on its inside the fill is up to {:.3}\n\
             steepest slope   {:.1}°\n",
            100.0 * stitch_density,
            1e3 * tightest,
            figures.densest,
            steepest.to_degrees(),
        ),
    };
    // Rounding leaves a trace of either sign where yarns just touch.
    let penetration = (figures.penetration * 1e6).round().max(0.0) / 1e3;
    format!(
        "{threads}cover factor     {:.4} and open {:.4} by the yarns' outlines; open {openness:.3} by the drawn fibers\n\
         thickness        {:.4} mm\n\
         yarns overlap    {penetration} µm at most\n",
        figures.cover_factor,
        figures.openness,
        cloth.thickness(),
    )
}

/// How much fiber there is.
fn mass(figures: &Statistics) -> String {
    format!("volume fraction  {:.4} on average\n", figures.volume_fraction) + &areal_mass(figures.areal_mass)
}

/// What a realization takes.
fn sizes(figures: &Statistics) -> String {
    format!("realization      {} fibers in {} straight pieces\n", figures.fibers, figures.pieces)
}

/// The medium that it becomes.
fn medium(scene: &Scene, prepared: &Prepared) -> Result<String> {
    let Prepared { specific_length, tables, gathering, .. } = prepared;
    let [nx, ny, nz] = specific_length.cells.counts;
    let edges = specific_length.cells.edges() * 1e3;
    let mut text = String::new();
    if let Some(gathering) = gathering {
        let [lx, ly, lz] = gathering.list_counts;
        let _ = writeln!(
            text,
            "cells            {nx} × {ny} × {nz} of {:.1} × {:.1} × {:.1} µm, {} of them hold fiber, {:.3} of a cell at most\n\
             directions       {} lists for {lx} × {ly} × {lz} cells, {} entries, from a grid of {}\n\
             counted          {} realizations, standard error of f {:.1} % of its root mean square",
            edges.x,
            edges.y,
            edges.z,
            gathering.filled,
            gathering.largest_fraction,
            tables.lists.len(),
            tables.patches.len(),
            scene.model.directions,
            gathering.realizations,
            100.0 * gathering.error,
        );
    }
    if let Some(Voids { free_surface, covered, largest, error }) =
        gathering.as_ref().and_then(|gathering| gathering.voids)
    {
        let _ = writeln!(
            text,
            "voids            {free_surface:.3} of the surface free, {covered:.3} of the volume covered, factor {largest:.2} at most \
             ± {:.1} %",
            100.0 * error
        );
    }
    if let Some(warning) = gathering.as_ref().and_then(|gathering| gathering.warning()) {
        let _ = writeln!(text, "warning          {warning}");
    }
    text += &light(scene, prepared);
    let _ = writeln!(text, "tables           {}", beside_fibers(scene, prepared)?);
    Ok(text)
}
