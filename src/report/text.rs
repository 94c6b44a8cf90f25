//! Letters.

use super::colour::{Colour, encode};
use super::image::Image;
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Noto Sans Mono at one of its heights.
#[derive(Clone, Copy, Debug)]
pub struct Font {
    weight: FontWeight,
    size: RasterHeight,
}

impl Font {
    /// The largest font of at most this height in pixels, or the smallest there is.
    pub fn new(height: usize, bold: bool) -> Font {
        let sizes = [RasterHeight::Size32, RasterHeight::Size24, RasterHeight::Size20];
        let size = sizes.into_iter().find(|size| size.val() <= height).unwrap_or(RasterHeight::Size16);
        Font { weight: if bold { FontWeight::Bold } else { FontWeight::Regular }, size }
    }

    /// Height of a line in pixels.
    pub fn height(self) -> usize {
        self.size.val()
    }

    /// Width of a text in pixels.
    pub fn width(self, text: &str) -> usize {
        text.chars().count() * get_raster_width(self.weight, self.size)
    }

    /// A text that is at most so wide, in pixels: what is too much is left out for two dots.
    pub fn fit(self, text: &str, width: usize) -> String {
        let most = width / get_raster_width(self.weight, self.size);
        if text.chars().count() <= most {
            return text.into();
        }
        let kept: String = text.chars().take(most.saturating_sub(2)).collect();
        kept + ".."
    }

    /// Write a text with its upper left corner at a place; a letter that the font lacks becomes a question mark.
    pub fn write(self, image: &mut Image, [left, top]: [usize; 2], text: &str, colour: Colour) {
        let ink = encode(colour);
        let mut pen = left;
        for letter in text.chars() {
            let raster =
                get_raster(plain(letter), self.weight, self.size).or_else(|| get_raster('?', self.weight, self.size));
            let Some(raster) = raster else { continue };
            for (row, line) in raster.rows().enumerate() {
                for (column, cover) in line.iter().enumerate().filter(|(_, cover)| **cover > 0) {
                    let (x, y) = (pen + column, top + row);
                    let [width, height] = image.size();
                    if x < width && y < height {
                        let under = image.pixel(x, y);
                        let mix = |channel: usize| {
                            let (under, ink) = (f32::from(under[channel]), f32::from(ink[channel]));
                            (under + (ink - under) * f32::from(*cover) / 255.0).round() as u8
                        };
                        image.set(x, y, [mix(0), mix(1), mix(2)]);
                    }
                }
            }
            pen += raster.width();
        }
    }
}

/// The nearest letter that the font has: dashes, primes and the like.
fn plain(letter: char) -> char {
    match letter {
        '−' | '–' | '—' | '‐' => '-',
        '’' | '‘' => '\'',
        '“' | '”' => '"',
        'μ' => 'µ',
        other => other,
    }
}
