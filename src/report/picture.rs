//! The picture of a woven or knitted cloth.

use super::colour::{Colour, blend, encode, pile};
use super::depth::Depth;
use super::draft;
use super::image::Image;
use super::layout::{Layout, Panel};
use super::marks::{heights, round, scale_bar};
use super::shade::{FINE, Tile, cut, face};
use super::view::Face;
use crate::cloth::{Cloth, System};
use crate::scene::{Scene, Stitch, Weave};
use std::ops::RangeInclusive;

/// Widths that a picture may have, in pixels.
pub const WIDTHS: RangeInclusive<usize> = 600..=3200;

pub(super) const PAPER: Colour = [1.0; 3];
pub(super) const INK: Colour = [0.03; 3];
/// What is seen through openings: a chequered ground that no pile of fibers is like.
const GROUND: [Colour; 2] = [[0.16, 0.24, 0.31], [0.21, 0.30, 0.38]];
/// What lies around a cut.
const AROUND: Colour = [0.46, 0.53, 0.60];
/// Where a wale is cut, in its widths: through one side of its loops, whose middles lie at a half.
const BESIDE: f64 = 0.3;
/// Yarns that are named under the title.
const NAMED: usize = 3;

/// A picture and where its parts lie.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The image.
    pub image: Image,
    /// The front: x to the right from x = 0, y up from y = 0.
    pub front: Panel,
    /// The back, turned about the warp: the same piece of cloth with x to the left, up to x = 0 at the right rim; y up.
    pub back: Panel,
    /// The cuts along the warp (y to the right) and along the weft (x to the right), z up.
    pub cuts: [Panel; 2],
    /// Share of the front where no fiber is seen: more than what the outlines of the yarns leave open, since fibers do not
    /// reach all of their rims.
    pub openness: f64,
}

/// Draw both faces of a cloth, two cuts, and the draft of a weave, from the fibers of one realization (seed 1, number 0).
/// A weave is cut along its first end and its first pick, a knit through one side of its first loop and through the
/// middles of a course.
///
/// The width in pixels is brought into [`WIDTHS`]; the height follows. The same cloth and width give the same picture.
pub fn cloth_picture(cloth: &Cloth, scene: &Scene, width: usize) -> Picture {
    let layout = Layout::new(cloth, width.clamp(*WIDTHS.start(), *WIDTHS.end()));
    let colours: Vec<Colour> = cloth.kinds().iter().map(pile).collect();
    let yarns: Vec<Colour> = cloth.yarns().iter().map(|yarn| blend(yarn, &colours)).collect();
    let [front, back, warp, weft] = buffers(cloth, &layout);
    let mut image = Image::new(layout.size[0], layout.size[1], PAPER);
    header(&mut image, &layout, cloth, &scene.name, &yarns);

    // The faces; the back shows the same piece of cloth, turned.
    let spacing = cloth.spacing();
    let shaded = |depth: &Depth| face(depth, &colours, layout.front.per_mm, spacing.min_element(), cloth.thickness());
    lay_face(&mut image, &layout.front, &shaded(&front), 0);
    lay_face(&mut image, &layout.back, &shaded(&back), -(layout.back.width as i64));
    above(&mut image, &layout, &layout.front, "front");
    let turned = if cloth.knit().is_some() { "back, turned about a wale" } else { "back, turned about the warp" };
    above(&mut image, &layout, &layout.back, turned);
    scale_bar(&mut image, layout.body, layout.margin, &layout.front);

    // The cuts.
    let names = match cloth.knit() {
        None => ["cut along the warp, through the first end", "cut along the weft, through the first pick"],
        Some(_) => {
            ["cut along a wale, through one side of its loops", "cut along a course, through the legs of its loops"]
        }
    };
    let reaches = spacing.to_array();
    for (((panel, depth), name), reach) in layout.cuts.iter().zip([warp, weft]).zip(names).zip(reaches) {
        let tile = cut(&depth, &colours, AROUND, depth.plane(), reach);
        for row in 0..panel.height {
            for column in 0..panel.width {
                let colour = tile.over(column as i64, (panel.height - 1 - row) as i64, AROUND);
                image.set(panel.left + column, panel.top + row, encode(colour));
            }
        }
        above(&mut image, &layout, panel, name);
        heights(&mut image, &layout, panel, cloth.thickness());
    }
    scale_bar(&mut image, layout.body, layout.margin, &layout.cuts[1]);
    Picture { image, front: layout.front, back: layout.back, cuts: layout.cuts, openness: front.openness() }
}

/// Draw all fibers of a realization into the four views.
fn buffers(cloth: &Cloth, layout: &Layout) -> [Depth; 4] {
    let [warp, weft] = &layout.cuts;
    let fine = |panel: &Panel| panel.repeat.map(|pixels| pixels * FINE);
    let of_face = |side| Depth::face(cloth, side, fine(&layout.front));
    let of_cut = |system, panel: &Panel| {
        let at = plane(cloth, system);
        let top = layout.room as f64 / panel.per_mm;
        Depth::along(cloth, system, at, [top - panel.height as f64 / panel.per_mm, top], fine(panel))
    };
    let mut buffers =
        [of_face(Face::Front), of_face(Face::Back), of_cut(System::Warp, warp), of_cut(System::Weft, weft)];
    for thread in 0..cloth.threads().len() {
        cloth.realize_thread(1, 0, thread, &mut |piece| buffers.iter_mut().for_each(|buffer| buffer.draw(&piece)));
    }
    buffers
}

/// Where a cut along the threads of a system lies, in mm along x (warp) or y (weft).
fn plane(cloth: &Cloth, system: System) -> f64 {
    match (cloth.knit(), system) {
        (Some(knit), System::Warp) => knit.wale_spacing * BESIDE,
        _ => cloth.threads().iter().find(|thread| thread.system == system).map_or(0.0, |thread| thread.at),
    }
}

/// Lay repeats of a face side by side over the chequered ground.
pub(super) fn lay_face(image: &mut Image, panel: &Panel, tile: &Tile, first: i64) {
    let check = (panel.width / 48).max(4);
    for row in 0..panel.height {
        for column in 0..panel.width {
            let ground = GROUND[(column / check + row / check) % 2];
            let colour = tile.over(first + column as i64, (panel.height - 1 - row) as i64, ground);
            image.set(panel.left + column, panel.top + row, encode(colour));
        }
    }
}

/// Write a name above a panel.
fn above(image: &mut Image, layout: &Layout, panel: &Panel, text: &str) {
    let top = panel.top.saturating_sub(layout.line());
    layout.body.write(image, [panel.left, top], &layout.body.fit(text, panel.width), INK);
}

/// The draft with its legend. Says the columns that it takes, and where the legend starts.
fn drafted(image: &mut Image, layout: &Layout, weave: &Weave, yarns: &[Colour]) -> [usize; 2] {
    let body = layout.body;
    let [left, _, side] = layout.draft;
    let taken = draft::draw(image, layout.draft, weave, yarns);
    let legend = ["draft, black:", "warp over weft"];
    let legend_left = (left + side).saturating_sub(taken + layout.margin / 2 + body.width(legend[1]));
    for (place, text) in legend.iter().enumerate() {
        let left = legend_left + body.width(legend[1]) - body.width(text);
        body.write(image, [left, layout.facts + place * layout.line()], text, INK);
    }
    [taken, legend_left]
}

/// The name, the repeat, the yarns with their colours, and the draft.
fn header(image: &mut Image, layout: &Layout, cloth: &Cloth, name: &str, yarns: &[Colour]) {
    let body = layout.body;
    let [left, top, side] = layout.draft;
    let [taken, legend_left] = match cloth.weave() {
        Some(weave) => drafted(image, layout, weave, yarns),
        None => [0, left + side],
    };
    let room = legend_left.saturating_sub(2 * layout.margin);
    layout.title.write(
        image,
        [layout.margin, top],
        &layout.title.fit(name, (left + side).saturating_sub(taken + 2 * layout.margin)),
        INK,
    );
    let size = cloth.size();
    let repeat = match (cloth.weave(), cloth.knit()) {
        (Some(weave), _) => format!("repeat {} × {}", weave.ends.len(), weave.picks.len()),
        (_, Some(knit)) if knit.stitch == Stitch::Rib => "1 × 1 rib, repeat 2 wales × 1 course".into(),
        _ => "jersey, repeat 1 wale × 1 course".into(),
    };
    let fact = format!("{repeat}, {} × {} mm, {} mm thick", round(size.x), round(size.y), round(size.z));
    body.write(image, [layout.margin, layout.facts], &body.fit(&fact, room), INK);

    // The yarns that are used, each with a swatch.
    let used = cloth.used_yarns();
    let (mut pen, row) = (layout.margin, layout.facts + layout.line());
    let swatch = body.height() * 3 / 4;
    for (place, yarn) in used.iter().enumerate() {
        let text = match place {
            NAMED => format!("and {} more", used.len() - NAMED),
            _ => cloth.yarns()[*yarn].name.clone(),
        };
        let text = body.fit(&text, room / (NAMED + 1));
        if place < NAMED {
            let box_top = row + (body.height() - swatch) / 2;
            image.fill([pen, box_top, swatch, swatch], [0.45; 3]);
            image.fill([pen + 1, box_top + 1, swatch - 2, swatch - 2], yarns[*yarn]);
            pen += swatch + layout.margin / 4;
        }
        body.write(image, [pen, row], &text, INK);
        pen += body.width(&text) + layout.margin;
        if place == NAMED {
            break;
        }
    }
}
