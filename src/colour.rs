//! Spectra and colours: the CIE 1931 observer under illuminant D65, and the linear light of sRGB.
//!
//! Sources: CIE 15:2018 (observer and illuminant, 380 to 780 nm by 5); IEC 61966-2-1 (sRGB). Colours are linear maps of channels, so a map is
//! kept as its columns, one a channel.

use std::sync::LazyLock;

/// The observer and the illuminant: nm, x̄, ȳ, z̄, D65.
const TABLE: &str = include_str!("../assets/colour/cie1931_d65.csv");
/// XYZ of a perfect white under D65, and linear sRGB of XYZ (IEC 61966-2-1).
const SRGB: [[f64; 3]; 3] =
    [[3.2406255, -1.537208, -0.4986286], [-0.9689307, 1.8757561, 0.0415175], [0.0557101, -0.2040211, 1.0569959]];
/// XYZ of linear sRGB (IEC 61966-2-1).
const XYZ: [[f64; 3]; 3] = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];

static ROWS: LazyLock<Vec<[f64; 5]>> = LazyLock::new(|| {
    let number = |text: &str| text.parse().unwrap_or(0.0);
    let row = |line: &str| {
        let mut numbers = line.split(',').map(number);
        [(); 5].map(|()| numbers.next().unwrap_or(0.0))
    };
    TABLE.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).map(row).collect()
});

/// What the channels of a table are.
#[derive(Clone, Debug, PartialEq)]
pub enum Channels {
    /// One, for all wavelengths.
    Grey,
    /// Linear red, green and blue of sRGB.
    Rgb,
    /// Wavelengths in nm, ascending.
    Spectral(Vec<f64>),
}

impl Channels {
    /// What names of channels say: `Y`; `R`, `G`, `B`; or wavelengths such as `T.550,000000nm`. None for other names.
    pub fn from_names(names: &[String]) -> Option<Channels> {
        match names.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            [] => None,
            ["Y"] => Some(Channels::Grey),
            ["R", "G", "B"] => Some(Channels::Rgb),
            ref names => {
                let wavelength =
                    |name: &&str| name.strip_prefix("T.")?.strip_suffix("nm")?.replace(',', ".").parse::<f64>().ok();
                let found = names.iter().map(wavelength).collect::<Option<Vec<f64>>>()?;
                let ascending = found.windows(2).all(|pair| pair[0] < pair[1]);
                ascending.then_some(Channels::Spectral(found))
            }
        }
    }

    /// X, Y, Z of a unit of each channel, seen by the CIE 1931 observer under D65; Y of a perfect white is 1.
    ///
    /// Spectra are linear between their wavelengths and constant beyond them.
    pub fn to_xyz(&self) -> Vec<[f64; 3]> {
        match self {
            Channels::Grey => vec![white()],
            Channels::Rgb => [0, 1, 2].map(|channel| XYZ.map(|row| row[channel])).to_vec(),
            Channels::Spectral(wavelengths) => {
                let scale = 1.0 / ROWS.iter().map(|row| row[2] * row[4]).sum::<f64>();
                let mut weights = vec![[0.0; 3]; wavelengths.len()];
                for [nm, x, y, z, light] in ROWS.iter() {
                    for (channel, share) in between(wavelengths, *nm) {
                        for (weight, bar) in weights[channel].iter_mut().zip([x, y, z]) {
                            *weight += share * bar * light * scale;
                        }
                    }
                }
                weights
            }
        }
    }

    /// Linear red, green and blue of sRGB of a unit of each channel; a perfect white is 1, 1, 1.
    pub fn to_rgb(&self) -> Vec<[f64; 3]> {
        match self {
            Channels::Grey => vec![[1.0; 3]],
            Channels::Rgb => vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            Channels::Spectral(_) => {
                // A white must be white: take what the rounding of the tables leaves out of each of the three.
                let rgb: Vec<_> = self.to_xyz().into_iter().map(linear_srgb).collect();
                let sums = [0, 1, 2].map(|k| rgb.iter().map(|column: &[f64; 3]| column[k]).sum::<f64>());
                rgb.into_iter().map(|column| [0, 1, 2].map(|k| column[k] / sums[k])).collect()
            }
        }
    }
}

/// X, Y, Z of a perfect white under D65, by the tables; Y is 1.
pub fn white() -> [f64; 3] {
    let sum = |k: usize| ROWS.iter().map(|row| row[k] * row[4]).sum::<f64>();
    [1, 2, 3].map(|k| sum(k) / sum(2))
}

/// Linear sRGB of X, Y, Z; colours outside of its gamut have numbers below 0.
pub fn linear_srgb(xyz: [f64; 3]) -> [f64; 3] {
    SRGB.map(|row| row.iter().zip(xyz).map(|(a, b)| a * b).sum())
}

/// The places of a grid between which a value lies, with their shares; beyond the ends the nearest.
pub fn between(grid: &[f64], value: f64) -> Vec<(usize, f64)> {
    let above = grid.partition_point(|node| *node <= value);
    match (above.checked_sub(1), grid.get(above)) {
        (Some(below), Some(next)) => {
            let share = (value - grid[below]) / (next - grid[below]);
            vec![(below, 1.0 - share), (above, share)]
        }
        (Some(last), None) => vec![(last, 1.0)],
        (None, _) => vec![(0, 1.0)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn names_say_what_channels_are() {
        assert_eq!(Channels::from_names(&names(&["Y"])), Some(Channels::Grey));
        assert_eq!(Channels::from_names(&names(&["R", "G", "B"])), Some(Channels::Rgb));
        let spectral = Channels::from_names(&names(&["T.450,500000nm", "T.550,000000nm"]));
        assert_eq!(spectral, Some(Channels::Spectral(vec![450.5, 550.0])));
        for wrong in [&["B", "G", "R"][..], &["T.550,000000nm", "T.450,500000nm"], &["X"], &[]] {
            assert_eq!(Channels::from_names(&names(wrong)), None);
        }
    }

    #[test]
    fn a_white_is_white_however_finely_it_is_sampled() {
        // Chromaticity of D65: x = 0.3127, y = 0.3290 (CIE 15).
        let [x, y, z] = white();
        assert!((x / (x + y + z) - 0.3127).abs() < 1e-4 && (y / (x + y + z) - 0.3290).abs() < 1e-4, "{x} {z}");
        for count in [1, 2, 31] {
            let wavelengths = (0..count).map(|i| 400.0 + 300.0 * f64::from(i) / f64::from(count)).collect();
            let columns = Channels::Spectral(wavelengths);
            let sum = |columns: &[[f64; 3]]| [0, 1, 2].map(|k| columns.iter().map(|column| column[k]).sum::<f64>());
            assert!(sum(&columns.to_xyz()).iter().zip(white()).all(|(a, b)| (a - b).abs() < 1e-12));
            assert!(sum(&columns.to_rgb()).iter().all(|light| (light - 1.0).abs() < 1e-12));
        }
    }

    #[test]
    fn the_map_to_srgb_is_the_inverse_of_the_map_from_it() {
        for channel in 0..3 {
            let back = linear_srgb(XYZ.map(|row| row[channel]));
            for (k, light) in back.iter().enumerate() {
                assert!((light - if k == channel { 1.0 } else { 0.0 }).abs() < 1e-3, "{back:?}");
            }
        }
    }

    #[test]
    fn bands_have_the_colours_that_they_have() {
        let channels = Channels::Spectral((0..31).map(|i| 400.0 + 10.0 * f64::from(i)).collect());
        let rgb = channels.to_rgb();
        let band = |from: usize, to: usize| [0, 1, 2].map(|k| rgb[from..to].iter().map(|c| c[k]).sum::<f64>());
        let [red, green, blue] = [band(21, 31), band(11, 17), band(0, 9)];
        assert!(red[0] > 0.5 && red[0] > 4.0 * red[1].abs() && red[0] > 4.0 * red[2].abs(), "{red:?}");
        assert!(green[1] > 0.4 && green[1] > 2.0 * green[0].abs() && green[1] > 2.0 * green[2].abs(), "{green:?}");
        assert!(blue[2] > 0.7 && blue[2] > 4.0 * blue[0].abs() && blue[2] > 4.0 * blue[1].abs(), "{blue:?}");
    }
}
