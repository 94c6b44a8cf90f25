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
use crate::cloth::Cloth;
use crate::scene::Scene;

/// Cloths side by side.
const COLUMNS: usize = 3;

/// Draw the fronts of cloths in rows of three, each with its name and a scale bar of its own, from the fibers of one
/// realization (seed 1, number 0).
///
/// The width in pixels is brought into [`WIDTHS`]; the height follows.
pub fn contact_sheet(cloths: &[(&Cloth, &Scene)], width: usize) -> Image {
    let width = width.clamp(*WIDTHS.start(), *WIDTHS.end());
    let unit = width as f64 / 920.0;
    let scaled = |pixels: f64| (pixels * unit).round() as usize;
    let (name, body) = (Font::new(scaled(16.0), true), Font::new(scaled(16.0), false));
    let margin = scaled(20.0);
    let side = (width - (COLUMNS + 1) * margin) / COLUMNS;
    // A name, the face, its scale bar.
    let (above, below) = (name.height() + margin / 4, body.height() + margin / 4);
    let high = above + side + below + margin;
    let mut image = Image::new(width, cloths.len().div_ceil(COLUMNS) * high + margin, PAPER);
    for (place, (cloth, scene)) in cloths.iter().enumerate() {
        let (left, row) = (margin + place % COLUMNS * (side + margin), margin + place / COLUMNS * high);
        let per_mm = side as f64 / window(cloth);
        let repeat = cloth.period().to_array().map(|size| (size * per_mm).round().max(1.0) as usize);
        let panel = Panel { left, top: row + above, width: side, height: side, repeat, per_mm };
        name.write(&mut image, [left, row], &name.fit(&scene.name, side), INK);
        front(&mut image, &panel, cloth);
        scale_bar(&mut image, body, margin, &panel);
    }
    image
}

/// Draw the front of a cloth into a panel.
fn front(image: &mut Image, panel: &Panel, cloth: &Cloth) {
    let colours: Vec<Colour> = cloth.kinds().iter().map(pile).collect();
    let mut depth = Depth::face(cloth, Face::Front, panel.repeat.map(|pixels| pixels * FINE));
    for thread in 0..cloth.threads().len() {
        cloth.realize_thread(1, 0, thread, &mut |piece| depth.draw(&piece));
    }
    let spacing = cloth.spacing().min_element();
    lay_face(image, panel, &face(&depth, &colours, panel.per_mm, spacing, cloth.thickness()), 0);
}
