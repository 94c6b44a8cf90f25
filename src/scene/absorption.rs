//! `absorption_per_mm` and the colour channels that follow from it.

use super::load::read_beside;
use super::reader::{Allowed, Document, Value};
use crate::error::Result;
use std::path::Path;

/// Most channels of one run.
pub const MAX_CHANNELS: usize = 128;
/// Wavelengths in nm.
pub(super) const WAVELENGTH: Allowed = Allowed::from(1.0, 1e6);
/// No spectrum is as long as this, in bytes.
const MAX_BYTES: u64 = 1 << 20;
/// Absorption in 1/mm: a fiber of 1 µm still lets light through at the upper end.
const RANGE: Allowed = Allowed::from(0.0, 1e5);
/// What `absorption_per_mm` may be.
const FORMS: &str = "a number from 0 to 100000, { rgb = [r, g, b] } or { spectrum = \"file.csv\" }";

/// Absorption coefficient of a kind of fiber in 1/mm, as the file gives it.
#[derive(Clone, Debug, PartialEq)]
pub enum Absorption {
    /// The same in all channels.
    Grey(f64),
    /// Red, green, blue.
    Rgb([f64; 3]),
    /// Pairs of wavelength in nm, ascending, and absorption.
    Spectrum(Vec<[f64; 2]>),
}

impl Absorption {
    /// The least in 1/mm, of any colour or wavelength.
    pub fn least(&self) -> f64 {
        match self {
            Absorption::Grey(sigma) => *sigma,
            Absorption::Rgb(sigmas) => sigmas.iter().copied().fold(f64::INFINITY, f64::min),
            Absorption::Spectrum(points) => points.iter().map(|[_, sigma]| *sigma).fold(f64::INFINITY, f64::min),
        }
    }
}

/// Why kinds of fiber have no common channels.
#[derive(Debug)]
pub(super) struct Clash {
    /// The kind whose absorption is at fault; none when the wavelengths are.
    pub kind: Option<String>,
    /// What was found and what is allowed.
    pub message: String,
}

/// Colour channels of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Channels {
    /// `Y`; or `R`, `G`, `B`; or `T.550,000000nm` and so on (Fichet, Pacanowski, Wilkie, JCGT 10(3), 2021).
    pub names: Vec<String>,
    /// Absorption in 1/mm of each kind of fiber of the cloth (ascending index) in each channel.
    pub absorption: Vec<Vec<f64>>,
}

impl Channels {
    /// Whether no fiber absorbs anything.
    pub fn lossless(&self) -> bool {
        self.absorption.iter().flatten().all(|sigma| *sigma == 0.0)
    }
}

pub(super) fn read_absorption(value: &Value, folder: Option<&Path>) -> Result<Absorption> {
    let Ok(table) = value.table() else {
        return value.number(RANGE).map(Absorption::Grey).map_err(|_| value.expected(FORMS));
    };
    table.expect_keys(&["rgb", "spectrum"], &[])?;
    match (table.get("rgb"), table.get("spectrum")) {
        (Some(rgb), None) => {
            let what = "three numbers [red, green, blue] from 0 to 100000";
            let items = rgb.as_array().filter(|items| items.len() == 3).ok_or_else(|| rgb.expected(what))?;
            Ok(Absorption::Rgb([items[0].number(RANGE)?, items[1].number(RANGE)?, items[2].number(RANGE)?]))
        }
        (None, Some(file)) => {
            let (path, bytes) = read_beside(&file, "the spectrum", folder, MAX_BYTES)?;
            let refuse = |why: &str| file.error(format!("cannot read the spectrum `{}`: {why}", path.display()));
            let text = String::from_utf8(bytes).map_err(|_| refuse("it is not UTF-8 text"))?;
            read_spectrum(&Document { file: path.display().to_string(), source: &text }).map(Absorption::Spectrum)
        }
        _ => Err(value.expected(FORMS)),
    }
}

/// Lines `nm, 1/mm`; a line of names before them and lines that start with # are passed over.
fn read_spectrum(document: &Document) -> Result<Vec<[f64; 2]>> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    let (mut offset, mut named) = (0, false);
    for line in document.source.split_inclusive('\n') {
        let start = offset;
        offset += line.len();
        // Spreadsheets write a byte order mark.
        let line = line.trim_start_matches('\u{feff}').trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let fields: Vec<Option<f64>> = line.split(',').map(|field| field.trim().parse().ok()).collect();
        if points.is_empty() && !named && fields.len() == 2 && fields.iter().all(Option::is_none) {
            named = true;
            continue;
        }
        let point = match fields[..] {
            [Some(nm), Some(sigma)] if WAVELENGTH.holds(nm) && RANGE.holds(sigma) => Some([nm, sigma]),
            _ => None,
        };
        let Some([nm, sigma]) = point else {
            let what = "a wavelength from 1 to 1000000 nm, a comma, a number from 0 to 100000 in 1/mm";
            let found = if line.chars().count() > 60 { "a line".into() } else { format!("`{line}`") };
            return Err(document.error(start, format!("{found} must be {what}")));
        };
        if points.last().is_some_and(|last| last[0] >= nm) {
            return Err(document.error(start, format!("wavelength {nm} must be above the one before")));
        }
        points.push([nm, sigma]);
    }
    if points.is_empty() { Err(document.error(0, "the spectrum has no line `nm, 1/mm`")) } else { Ok(points) }
}

/// The channels of named kinds of fiber; the error is a message without a place.
pub(super) fn resolve(kinds: &[(&str, &Absorption)], wavelengths: &[f64]) -> std::result::Result<Channels, Clash> {
    let named =
        |pick: fn(&Absorption) -> bool| kinds.iter().find(|(_, absorption)| pick(absorption)).map(|(name, _)| name);
    let rgb = named(|absorption| matches!(absorption, Absorption::Rgb(_)));
    let spectrum = named(|absorption| matches!(absorption, Absorption::Spectrum(_)));
    match (rgb, spectrum) {
        (Some(rgb), Some(spectrum)) => Err(Clash {
            kind: Some((*rgb).into()),
            message: format!(
                "fiber `{rgb}` absorbs in rgb and fiber `{spectrum}` by a spectrum; allowed: one of the two in a cloth"
            ),
        }),
        (_, Some(_)) => {
            let default: Vec<f64> = (40..=70).map(|tens| f64::from(tens * 10)).collect();
            let by_default = wavelengths.is_empty();
            let wavelengths = if by_default { &default } else { wavelengths };
            // The decimal separator is a comma: a dot would start a layer.
            let names = wavelengths.iter().map(|nm| format!("T.{}nm", format!("{nm:.6}").replace('.', ","))).collect();
            let of_kind = |(name, absorption): &(&str, &Absorption)| {
                let asked = wavelengths.iter();
                asked.map(|nm| at(absorption, *nm).ok_or_else(|| outside(name, absorption, *nm, by_default))).collect()
            };
            Ok(Channels { names, absorption: kinds.iter().map(of_kind).collect::<std::result::Result<_, _>>()? })
        }
        _ if !wavelengths.is_empty() => Err(Clash {
            kind: None,
            message: "`wavelengths_nm` has no use: no fiber of the cloth has a spectrum".into(),
        }),
        (Some(_), None) => {
            let of_kind = |(_, absorption): &(&str, &Absorption)| match absorption {
                Absorption::Rgb(rgb) => rgb.to_vec(),
                Absorption::Grey(grey) => vec![*grey; 3],
                Absorption::Spectrum(_) => unreachable!("no kind has a spectrum"),
            };
            Ok(Channels {
                names: ["R", "G", "B"].map(String::from).to_vec(),
                absorption: kinds.iter().map(of_kind).collect(),
            })
        }
        (None, None) => {
            let of_kind = |(_, absorption): &(&str, &Absorption)| match absorption {
                Absorption::Grey(grey) => vec![*grey],
                _ => unreachable!("all kinds are grey"),
            };
            Ok(Channels { names: vec!["Y".into()], absorption: kinds.iter().map(of_kind).collect() })
        }
    }
}

/// Linear interpolation inside the spectrum, none outside.
fn at(absorption: &Absorption, nm: f64) -> Option<f64> {
    let points = match absorption {
        Absorption::Grey(grey) => return Some(*grey),
        Absorption::Rgb(_) => return None,
        Absorption::Spectrum(points) => points,
    };
    let above = points.iter().position(|point| point[0] >= nm)?;
    let [high_nm, high] = points[above];
    if high_nm == nm {
        return Some(high);
    }
    let [low_nm, low] = *points.get(above.checked_sub(1)?)?;
    Some(low + (high - low) * (nm - low_nm) / (high_nm - low_nm))
}

fn outside(name: &str, absorption: &Absorption, nm: f64, by_default: bool) -> Clash {
    let range = match absorption {
        Absorption::Spectrum(points) => format!("{} to {} nm", points[0][0], points[points.len() - 1][0]),
        _ => "no wavelength".into(),
    };
    let message = format!("{nm} nm lies outside of the spectrum of fiber `{name}`; allowed: {range}");
    if by_default {
        let message = format!("{message}; without `wavelengths_nm` they are 400 to 700 nm by 10");
        Clash { kind: Some(name.into()), message }
    } else {
        Clash { kind: None, message }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spectra_are_read_between_their_lines_and_not_beyond() {
        let document = Document { file: "s.csv".into(), source: "nm, 1/mm\n400, 1\n# dip\n500,3\n" };
        let spectrum = Absorption::Spectrum(read_spectrum(&document).expect("it is a spectrum"));
        assert_eq!(at(&spectrum, 425.0), Some(1.5));
        assert_eq!((at(&spectrum, 400.0), at(&spectrum, 500.0)), (Some(1.0), Some(3.0)));
        assert_eq!((at(&spectrum, 399.0), at(&spectrum, 501.0)), (None, None));
        let channels = resolve(&[("a", &spectrum), ("b", &Absorption::Grey(7.0))], &[450.0]).expect("inside");
        assert_eq!(channels.names, ["T.450,000000nm"]);
        assert_eq!(channels.absorption, [[2.0], [7.0]]);
        assert!(resolve(&[("a", &spectrum)], &[]).is_err_and(|clash| clash.kind.as_deref() == Some("a")));
    }

    #[test]
    fn a_wrong_line_of_a_spectrum_is_named() {
        for (source, place) in
            [("400, 1\n450; 2\n", "s.csv:2:1"), ("400, 1\r\n300, 2\r\n", "s.csv:2:1"), ("400,-1", "s.csv:1:1")]
        {
            let error = read_spectrum(&Document { file: "s.csv".into(), source }).expect_err(source);
            assert!(error.to_string().starts_with(place), "{error}");
        }
    }

    #[test]
    fn grey_is_broadcast_to_rgb_and_rgb_does_not_mix_with_spectra() {
        let rgb = Absorption::Rgb([1.0, 2.0, 3.0]);
        let channels = resolve(&[("a", &Absorption::Grey(5.0)), ("b", &rgb)], &[]).expect("they mix");
        assert_eq!(channels.names, ["R", "G", "B"]);
        assert_eq!(channels.absorption, [vec![5.0; 3], vec![1.0, 2.0, 3.0]]);
        assert!(resolve(&[("a", &rgb), ("b", &Absorption::Spectrum(vec![[400.0, 1.0]]))], &[]).is_err());
    }
}
