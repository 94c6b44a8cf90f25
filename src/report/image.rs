//! An image of bytes, and its PNG file.

use super::colour::{Colour, encode};
use std::io::{self, Write};

/// An image of red, green and blue bytes, sRGB; rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
}

impl Image {
    /// An image of one colour.
    pub fn new(width: usize, height: usize, colour: Colour) -> Image {
        Image { width, height, pixels: vec![encode(colour); width * height] }
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The bytes of a pixel at a column from the left and a row from the top.
    pub fn pixel(&self, column: usize, row: usize) -> [u8; 3] {
        self.pixels[row * self.width + column]
    }

    /// Set a pixel; one outside is let go.
    pub fn set(&mut self, column: usize, row: usize, bytes: [u8; 3]) {
        if column < self.width && row < self.height {
            self.pixels[row * self.width + column] = bytes;
        }
    }

    /// Fill a rectangle: left, top, width, height; what is outside is let go.
    pub fn fill(&mut self, [left, top, width, height]: [usize; 4], colour: Colour) {
        let bytes = encode(colour);
        for row in top..top + height {
            for column in left..left + width {
                self.set(column, row, bytes);
            }
        }
    }

    /// Write the image as a PNG file.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write_png(&self, writer: impl Write) -> io::Result<()> {
        let mut encoder = png::Encoder::new(writer, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels.as_flattened())?;
        writer.finish()?;
        Ok(())
    }
}
