//! Where the parts of the picture lie.

use super::text::Font;
use crate::cloth::Cloth;
use glam::DVec2;

/// Least and largest height of the cloth in a cut, in sides of a face.
const FLATTEST: f64 = 0.12;
const HIGHEST: f64 = 0.5;
/// Stitches of a knit along the side of a face.
const STITCHES: f64 = 5.0;

/// A part of the image that shows cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel {
    /// Its left column.
    pub left: usize,
    /// Its top row.
    pub top: usize,
    /// Its columns.
    pub width: usize,
    /// Its rows.
    pub height: usize,
    /// Pixels of a repeat to the right and up: whole numbers, which the cloth is stretched to by half a pixel at most.
    pub repeat: [usize; 2],
    /// Columns to a mm.
    pub per_mm: f64,
}

impl Panel {
    /// The pixel of the image, as its column and row, of a point so many repeats to the right and up of the lower left
    /// corner.
    pub fn pixel(&self, point: DVec2) -> [usize; 2] {
        let right = (point.x * self.repeat[0] as f64).floor() as usize;
        let up = (point.y * self.repeat[1] as f64).floor() as usize;
        [self.left + right, (self.top + self.height).saturating_sub(1 + up)]
    }
}

/// Places and sizes in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    pub size: [usize; 2],
    pub margin: usize,
    pub title: Font,
    pub body: Font,
    /// Left, top and side of the square that the draft may take.
    pub draft: [usize; 3],
    /// Top of the lines under the title.
    pub facts: usize,
    pub front: Panel,
    pub back: Panel,
    /// The cuts along the warp and along the weft.
    pub cuts: [Panel; 2],
    /// Rows between the rim of a cut and the cloth.
    pub room: usize,
}

impl Layout {
    /// Lay out a picture of this width for a cloth.
    pub fn new(cloth: &Cloth, width: usize) -> Layout {
        let unit = width as f64 / 1600.0;
        let scaled = |pixels: f64| (pixels * unit).round() as usize;
        let (title, body) = (Font::new(scaled(34.0), true), Font::new(scaled(24.0), false));
        let (margin, gap, line) = (scaled(32.0), scaled(10.0), body.height() + scaled(8.0));
        let square = (title.height() + 3 * line).max(scaled(130.0));
        let draft = [width - margin - square, margin, square];
        let facts = margin + title.height() + gap;

        // The faces, side by side.
        let window = window(cloth);
        let side = (width - 3 * margin) / 2;
        let per_mm = side as f64 / window;
        let top = margin + square + gap + line;
        let pixels = |per_mm: f64| cloth.period().to_array().map(|size| (size * per_mm).round().max(1.0) as usize);
        let front = Panel { left: margin, top, width: side, height: side, repeat: pixels(per_mm), per_mm };
        let back = Panel { left: 2 * margin + side, ..front };

        // The cuts, one under the other: the same stretch of cloth, or a part of it if it would be too flat to be read.
        let gutter = body.width("0.000 mm ");
        let wide = width - 2 * margin - gutter;
        let (whole, upright) = (wide as f64 / window, side as f64 / cloth.thickness());
        let per_mm = whole.max(FLATTEST * upright).min(4.0 * whole).min(HIGHEST * upright);
        let room = scaled(14.0);
        let high = (cloth.thickness() * per_mm).ceil() as usize + 2 * room;
        let [right, up] = pixels(per_mm);
        let first = top + side + 2 * line + 3 * gap;
        let cut = |top: usize, repeat: usize| {
            let repeat = [repeat, high];
            Panel { left: margin + gutter, top, width: wide, height: high, repeat, per_mm }
        };
        let cuts = [cut(first, up), cut(first + high + gap + line, right)];
        let size = [width, cuts[1].top + high + line + gap + margin];
        Layout { size, margin, title, body, draft, facts, front, back, cuts, room }
    }

    /// Rows of a line of text.
    pub fn line(&self) -> usize {
        self.body.height() + (self.margin / 4).max(2)
    }
}

/// Side of the stretch of cloth that is shown in mm: two repeats of the longer way, more of a small draft, one of a large;
/// of a knit so many stitches.
pub fn window(cloth: &Cloth) -> f64 {
    let Some(weave) = cloth.weave() else { return STITCHES * cloth.spacing().max_element() };
    let repeats = match weave.ends.len().max(weave.picks.len()) {
        0..=2 => 3.0,
        3..=32 => 2.0,
        _ => 1.0,
    };
    repeats * cloth.period().max_element()
}
