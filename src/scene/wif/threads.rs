//! The threads of one system: how many, of which colour, how far apart.

use super::lines::{Entry, Sections};
use crate::error::Result;
use std::collections::BTreeMap;

/// An inch in mm.
const INCH: f64 = 25.4;

/// The ends or the picks, as the file gives them.
#[derive(Debug)]
pub struct Threads<'a> {
    /// `WARP` or `WEFT`.
    pub section: &'static str,
    /// How many there are at most; none where the file does not say.
    pub count: Option<u32>,
    colour: Option<u32>,
    colours: BTreeMap<u32, u32>,
    /// Length of a unit in mm.
    unit: Option<f64>,
    spacing: Option<Entry<'a>>,
    spacings: BTreeMap<u32, Entry<'a>>,
}

/// The distance of the threads of a system.
#[derive(Debug)]
pub enum Spacing {
    /// All alike, in mm.
    Even(f64),
    /// The file does not say.
    Missing,
    /// The file says what cannot be used, and why.
    Refused(crate::Error),
}

impl<'a> Threads<'a> {
    /// Read what the file says of a system.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) at a line that cannot be understood.
    pub fn read(sections: &Sections<'a>, [section, colours, spacings]: [&'static str; 3]) -> Result<Threads<'a>> {
        let whole = |key| sections.named(section, key)?.map(|entry| sections.whole(&entry)).transpose();
        let colours = sections.counted(colours)?;
        let colours = colours.into_iter().map(|(number, entry)| Ok((number, sections.whole(&entry)?)));
        let unit = match sections.named(section, "Units")? {
            Some(entry) => Some(match entry.value.to_ascii_lowercase().as_str() {
                // A tenth of a point; 72 points are an inch.
                "decipoints" => INCH / 720.0,
                "inches" | "inch" | "in" => INCH,
                "centimeters" | "centimetres" | "cm" => 10.0,
                _ => return Err(sections.at(&entry, "must be decipoints, inches or centimeters")),
            }),
            None => None,
        };
        let spacing = sections.named(section, "Spacing")?;
        let spacings = sections.counted(spacings)?;
        for entry in spacing.iter().chain(spacings.values()) {
            sections.length(entry)?;
        }
        Ok(Threads {
            section,
            count: whole("Threads")?.filter(|count| *count > 0),
            colour: whole("Color")?,
            colours: colours.collect::<Result<_>>()?,
            unit,
            spacing,
            spacings,
        })
    }

    /// Index of the colour of a thread.
    pub fn colour(&self, number: u32) -> Option<u32> {
        self.colours.get(&number).copied().or(self.colour)
    }

    /// The distance of some of the threads, all alike or not at all; 0 says as much as no line.
    pub fn spacing(&self, sections: &Sections, numbers: &[u32]) -> Spacing {
        let mut common: Option<(f64, &Entry)> = None;
        for number in numbers {
            let entry = self.spacings.get(number).or(self.spacing.as_ref());
            let length = entry.and_then(|entry| Some((sections.length(entry).ok().filter(|mm| *mm > 0.0)?, entry)));
            let Some((length, entry)) = length else { return Spacing::Missing };
            match common {
                Some((first, _)) if (length - first).abs() > 1e-9 * first => {
                    let key = if self.section == "WARP" { "ends_per_cm" } else { "picks_per_cm" };
                    let message = format!(
                        "the threads before it have a Spacing of {first}, but all must have one; `{key}` in the cloth file \
                         sets it"
                    );
                    return Spacing::Refused(sections.at(entry, &message));
                }
                Some(_) => {}
                None => common = Some((length, entry)),
            }
        }
        let Some((length, entry)) = common else { return Spacing::Missing };
        let Some(unit) = self.unit else {
            let message = format!("[{}] needs Units=decipoints, inches or centimeters", self.section);
            return Spacing::Refused(sections.at(entry, &message));
        };
        let mm = length * unit;
        if !(0.01..=100.0).contains(&mm) {
            return Spacing::Refused(sections.at(entry, &format!("is {mm} mm, but must be from 0.01 to 100 mm")));
        }
        Spacing::Even(mm)
    }
}
