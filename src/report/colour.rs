//! Colours of fibers.

use crate::scene::{Absorption, Fiber, Yarn};
use std::f64::consts::PI;

/// Linear red, green and blue, 0 to 1.
pub type Colour = [f32; 3];

/// Mean cosine of the angle by which a fiber turns light, found from the walks: see [`pile`].
const FORWARD: f64 = 0.76;
/// Red, green and blue as bands of wavelengths in nm.
const BANDS: [[f64; 2]; 3] = [[600.0, 700.0], [500.0, 600.0], [400.0, 500.0]];

/// Colour of an endless pile of a kind of fiber in linear red, green and blue.
///
/// A crossing keeps ω = exp(−σ·πR/2) of the light, with the mean chord πR/2 of a fiber seen from the side; a pile reflects
/// (1 − s)/(1 + s) with s = √((1 − ω)/(1 − gω)), the two-stream solution with the forward cosine g = 0.76. That comes
/// within a tenth of what walks through 3 mm of planar fibers of index 1.55 find, from 0.07 to 0.75 (`tests/cloth/picture.rs`).
/// A spectrum is averaged over 400 to 500, 500 to 600 and 600 to 700 nm: rough, and no colorimetry. A fiber that does not
/// absorb is white.
pub fn pile(fiber: &Fiber) -> Colour {
    let reflect = |sigma: f64| {
        let kept = (-sigma * PI * fiber.radius / 2.0).exp();
        let s = ((1.0 - kept) / (1.0 - FORWARD * kept)).sqrt();
        ((1.0 - s) / (1.0 + s)) as f32
    };
    match &fiber.absorption {
        Absorption::Grey(sigma) => [reflect(*sigma); 3],
        Absorption::Rgb(sigma) => sigma.map(reflect),
        Absorption::Spectrum(points) => BANDS.map(|[from, to]| {
            let steps = (0..=10).map(|step| from + (to - from) * f64::from(step) / 10.0);
            steps.map(|nm| reflect(near(points, nm))).sum::<f32>() / 11.0
        }),
    }
}

/// Colour of a yarn: the mean of its fibers.
pub fn blend(yarn: &Yarn, colours: &[Colour]) -> Colour {
    let mean = |channel: usize| yarn.blend.iter().map(|(kind, share)| colours[*kind][channel] * *share as f32).sum();
    [mean(0), mean(1), mean(2)]
}

/// Absorption between the lines of a spectrum; beyond them that of the nearest.
fn near(points: &[[f64; 2]], nm: f64) -> f64 {
    let above = points.partition_point(|point| point[0] < nm);
    match (above.checked_sub(1).and_then(|below| points.get(below)), points.get(above)) {
        (Some([from, low]), Some([to, high])) => low + (high - low) * (nm - from) / (to - from),
        (Some([_, sigma]), None) | (None, Some([_, sigma])) => *sigma,
        (None, None) => 0.0,
    }
}

/// Between two colours.
pub fn mix(a: Colour, b: Colour, share: f32) -> Colour {
    [0, 1, 2].map(|channel| a[channel] + (b[channel] - a[channel]) * share)
}

/// Linear light → the bytes of an sRGB image (IEC 61966-2-1).
pub fn encode(colour: Colour) -> [u8; 3] {
    colour.map(|light| {
        let light = light.clamp(0.0, 1.0);
        let value = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
        (255.0 * value).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fiber(absorption: Absorption) -> Fiber {
        Fiber { name: "f".into(), radius: 0.006, ior: 1.5, density: None, absorption }
    }

    #[test]
    fn a_clear_fiber_is_white_and_an_absorbing_one_dark() {
        assert_eq!(pile(&fiber(Absorption::Grey(0.0))), [1.0; 3]);
        assert!(pile(&fiber(Absorption::Grey(1e5)))[0] < 1e-3);
        let [red, green, blue] = pile(&fiber(Absorption::Rgb([70.0, 35.0, 12.0])));
        assert!(red < green && green < blue);
    }

    #[test]
    fn a_spectrum_has_its_bands() {
        // Absorbs below 500 nm only; beyond its lines it goes on as it ends.
        let points = vec![[450.0, 40.0], [499.0, 40.0], [501.0, 0.0], [650.0, 0.0]];
        let [red, green, blue] = pile(&fiber(Absorption::Spectrum(points)));
        assert!(red == 1.0 && green > 0.9 && blue < 0.4, "{red} {green} {blue}");
        assert_eq!(near(&[[400.0, 1.0], [500.0, 3.0]], 425.0), 1.5);
    }

    #[test]
    fn light_is_encoded_as_srgb() {
        assert_eq!(encode([0.0, 1.0, 2.0]), [0, 255, 255]);
        // Half of the light is 188 of 255.
        assert_eq!(encode([0.5; 3]), [188; 3]);
    }
}
