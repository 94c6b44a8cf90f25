//! What both kinds of XML file have in common.

use crate::bsdf::{Bsdf, Component};
use crate::colour::{Channels, white};
use crate::scene::Side;
use std::fmt::Write;

/// Longest name that Radiance keeps.
const LONGEST: usize = 127;

/// What the file says of colour: Y alone, or three numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colours {
    /// Y: the cloth is grey.
    Grey,
    /// X, Y and Z under D65, relative to those of a perfect white: what is neutral has X = Y = Z, as Radiance's white has.
    Xyz,
}

/// The table in the channels of the file: Y, or X, Y, Z.
pub fn observed(table: &Bsdf, channels: &Channels) -> (Bsdf, Colours) {
    match channels {
        Channels::Grey => (table.in_channels(["Y"], &[[1.0]]), Colours::Grey),
        _ => {
            let white = white();
            let relative = |xyz: [f64; 3]| [0, 1, 2].map(|k| xyz[k] / white[k]);
            let columns: Vec<[f64; 3]> = channels.to_xyz().into_iter().map(relative).collect();
            (table.in_channels(["X", "Y", "Z"], &columns), Colours::Xyz)
        }
    }
}

/// The name of a component: the face of the cloth is the back of WINDOW.
pub fn direction(side: Side, component: Component) -> &'static str {
    match (component, side) {
        (Component::Reflection, Side::Front) => "Reflection Back",
        (Component::Reflection, Side::Back) => "Reflection Front",
        (Component::Transmission, Side::Front) => "Transmission Back",
        (Component::Transmission, Side::Back) => "Transmission Front",
    }
}

/// One quantity of one component.
pub struct Block {
    /// `Visible`, `CIE-X`, `CIE-Z`, `CIE-u` or `CIE-v`.
    pub wavelength: &'static str,
    /// As [`direction`] names it.
    pub direction: &'static str,
    /// The numbers as text.
    pub data: String,
}

/// What a file says of the cloth.
pub struct Head<'a> {
    /// Its name.
    pub name: &'a str,
    /// In mm, if it is known.
    pub thickness: Option<f64>,
    /// Share of light along the normal that touches no fiber.
    pub openness: f64,
}

/// The whole file: what the cloth is, the structure of the data, the blocks with the tags of their basis.
pub fn document(head: &Head, structure: &str, basis: &str, blocks: &[Block]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <WindowElement xmlns=\"http://windows.lbl.gov\" xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" \
         xsi:schemaLocation=\"http://windows.lbl.gov http://windows.lbl.gov/BSDF-v1.4.xsd\">\n\
         <WindowElementType>System</WindowElementType>\n<FileType>BSDF</FileType>\n<Optical>\n<Layer>\n<Material>\n",
    );
    let _ = writeln!(text, "<Name>{}</Name>", escaped(head.name));
    let _ = writeln!(text, "<Manufacturer>fiberwalk {}</Manufacturer>", env!("CARGO_PKG_VERSION"));
    text += "<DeviceType>Woven shade</DeviceType>\n";
    if let Some(thickness) = head.thickness {
        let _ = writeln!(text, "<Thickness unit=\"Millimeter\">{thickness:.4}</Thickness>");
    }
    text += "<Width unit=\"Millimeter\">1000</Width>\n<Height unit=\"Millimeter\">1000</Height>\n";
    // Of heat fiberwalk knows nothing: these are the values of WINDOW's template.
    text += "<ThermalConductivity>1</ThermalConductivity>\n<EmissivityFront>0.9</EmissivityFront>\n\
             <EmissivityBack>0.9</EmissivityBack>\n<TIR>0.1</TIR>\n";
    let _ = writeln!(text, "<EffectiveOpennessFraction>{:.5}</EffectiveOpennessFraction>", head.openness);
    let _ = writeln!(text, "</Material>\n<Geometry format=\"MGF\"/>\n<DataDefinition>\n{structure}</DataDefinition>");
    for Block { wavelength, direction, data } in blocks {
        let detector = match *wavelength {
            "CIE-X" => "ASTM E308 1931 X.dsp",
            "CIE-Z" => "ASTM E308 1931 Z.dsp",
            _ => "ASTM E308 1931 Y.dsp",
        };
        let _ = write!(
            text,
            "<WavelengthData>\n<LayerNumber>System</LayerNumber>\n<Wavelength unit=\"Integral\">{wavelength}</Wavelength>\n\
             <SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>\n<DetectorSpectrum>{detector}</DetectorSpectrum>\n\
             <WavelengthDataBlock>\n<WavelengthDataDirection>{direction}</WavelengthDataDirection>\n{basis}\
             <ScatteringDataType>BTDF</ScatteringDataType>\n<ScatteringData>\n{data}</ScatteringData>\n\
             </WavelengthDataBlock>\n</WavelengthData>\n"
        );
    }
    text + "</Layer>\n</Optical>\n</WindowElement>\n"
}

/// The blocks of a file that [`document`] made: wavelength, direction, data.
pub fn blocks(text: &str) -> impl Iterator<Item = (&str, &str, &str)> {
    text.split("<WavelengthData>").skip(1).filter_map(|block| {
        Some((
            inside(block, "<Wavelength unit=\"Integral\">")?,
            inside(block, "<WavelengthDataDirection>")?,
            inside(block, "<ScatteringData>")?,
        ))
    })
}

/// The text behind a tag, up to the next one.
fn inside<'a>(text: &'a str, tag: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(tag)?;
    rest.split('<').next().map(str::trim)
}

/// A text on one line as XML has it, no longer than Radiance keeps.
fn escaped(text: &str) -> String {
    let mut result = String::new();
    for c in text.chars().map(|c| if c.is_control() { ' ' } else { c }) {
        let entity = match c {
            '&' => "&amp;".to_owned(),
            '<' => "&lt;".to_owned(),
            '>' => "&gt;".to_owned(),
            '"' => "&quot;".to_owned(),
            c => c.to_string(),
        };
        if result.len() + entity.len() > LONGEST {
            break;
        }
        result += &entity;
    }
    result
}
