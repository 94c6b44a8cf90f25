//! The fronts of several cloths on one page.

use super::colour::{Colour, pile};
use super::depth::Depth;
use super::image::Image;
use super::layout::{Panel, window};
use super::marks::scale_bar;
use super::picture::{INK, PAPER, WIDTHS, lay_face};
use super::shade::{FINE, face};
use super::text::Font;
use super::view::Face;
use crate::cloth::{Cloth, DrawnFor, Realizer};
use crate::scene::{Packing, Scene};
use glam::DVec2;

/// Cloths side by side.
const COLUMNS: usize = 3;
/// Side of the square of a homogeneous sheet that is drawn, in diameters of its thickest fiber.
const SQUARE: f64 = 75.0;
/// How deep one looks into a sheet, and how wide its hollows are, in diameters of its thickest fiber.
const DEEP: f64 = 40.0;
const WIDE: f64 = 4.0;

/// Draw the fronts of cloths in rows of three, each with its name and a scale bar of its own, from the fibers of one
/// realization (seed 1, number 0). A scene without a laid out cloth is a sheet: its fibers are drawn straight and at
/// random, as the model has them. Where rows of three would leave a hole, the last rows have four.
///
/// The width in pixels is brought into [`WIDTHS`]; the height follows.
pub fn contact_sheet(cloths: &[(Option<&Cloth>, &Scene)], width: usize) -> Image {
    let width = width.clamp(*WIDTHS.start(), *WIDTHS.end());
    let unit = width as f64 / 920.0;
    let scaled = |pixels: f64| (pixels * unit).round() as usize;
    let (name, body) = (Font::new(scaled(16.0), true), Font::new(scaled(16.0), false));
    let margin = scaled(20.0);
    let side = |columns: usize| (width - (columns + 1) * margin) / columns;
    // A name, the face, its scale bar.
    let (above, below) = (name.height() + margin / 4, body.height() + margin / 4);
    let high = |columns: usize| above + side(columns) + below + margin;
    let rows = rows(cloths.len());
    let mut image = Image::new(width, rows.iter().map(|columns| high(*columns)).sum::<usize>() + margin, PAPER);
    let (mut top, mut left_over) = (margin, cloths);
    for columns in rows {
        let (row, rest) = left_over.split_at(columns.min(left_over.len()));
        for (place, (cloth, scene)) in row.iter().enumerate() {
            let side = side(columns);
            let left = margin + place * (side + margin);
            name.write(&mut image, [left, top], &name.fit(&scene.name, side), INK);
            let panel = front(&mut image, [left, top + above, side], *cloth, scene);
            scale_bar(&mut image, body, margin, &panel);
        }
        (top, left_over) = (top + high(columns), rest);
    }
    image
}

/// How many cloths each row has.
fn rows(count: usize) -> Vec<usize> {
    let fours = (0..=count / 4).find(|fours| (count - 4 * fours).is_multiple_of(COLUMNS));
    match fours {
        Some(fours) => [vec![COLUMNS; (count - 4 * fours) / COLUMNS], vec![4; fours]].concat(),
        None => vec![COLUMNS; count.div_ceil(COLUMNS)],
    }
}

/// Draw the front of a cloth into a square with this left, top and side.
fn front(image: &mut Image, [left, top, side]: [usize; 3], cloth: Option<&Cloth>, scene: &Scene) -> Panel {
    let colours: Vec<Colour> = scene.fibers.iter().map(pile).collect();
    let coarse = scene.structure.kinds().iter().map(|&kind| 2.0 * scene.fibers[kind].radius).fold(0.0, f64::max);
    // A sheet whose element has too many fibers stays blank.
    let web = if cloth.is_none() { Realizer::new(scene, Packing::Random, DrawnFor::Medium).ok() } else { None };
    let (window, period, spacing, thickness) = match (cloth, &web) {
        (Some(cloth), _) => (window(cloth), cloth.period(), cloth.spacing().min_element(), cloth.thickness()),
        (None, Some(web)) => (SQUARE * coarse, web.period(), WIDE * coarse, DEEP * coarse),
        (None, None) => (SQUARE * coarse, DVec2::splat(SQUARE * coarse), WIDE * coarse, DEEP * coarse),
    };
    let per_mm = side as f64 / window;
    let repeat = period.to_array().map(|size| (size * per_mm).round().max(1.0) as usize);
    let panel = Panel { left, top, width: side, height: side, repeat, per_mm };
    let mut depth = Depth::of_face(period, Face::Front, repeat.map(|pixels| pixels * FINE));
    if let Some(cloth) = cloth {
        for thread in 0..cloth.threads().len() {
            cloth.realize_thread(1, 0, thread, &mut |piece| depth.draw(&piece));
        }
    }
    if let Some(drawn) = web.and_then(|web| web.draw(1).ok()) {
        drawn.pieces().iter().for_each(|piece| depth.draw(piece));
    }
    lay_face(image, &panel, &face(&depth, &colours, per_mm, spacing, thickness), 0);
    panel
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_three_and_four_leave_no_hole() {
        assert_eq!(rows(9), [3, 3, 3]);
        assert_eq!(rows(13), [3, 3, 3, 4]);
        assert_eq!(rows(11), [3, 4, 4]);
        assert_eq!(rows(4), [4]);
        // Of one, two and five there is no other way.
        assert_eq!((rows(1), rows(2), rows(5)), (vec![3], vec![3], vec![3, 3]));
    }
}
