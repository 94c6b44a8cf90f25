//! A matrix over the full basis of Klems.

use super::material::rad;
use super::xml::{Block, Colours, Head, blocks, direction, document, observed};
use crate::bsdf::{Bsdf, Component};
use crate::export::fit::{Loaded, check, fit, fit_direct};
use crate::export::format::{File, Job, Written};
use crate::goniometer::{Basis, RingBasis};
use crate::scene::Side;
use glam::DVec2;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Patches of the basis.
const PATCHES: usize = 145;

/// Write the file, its scene description, and read it again.
pub fn write(job: &Job) -> Written {
    let (table, colours) = observed(job.table, job.channels);
    let klems = Basis::Rings(RingBasis::klems());
    let mut data = Vec::new();
    let mut straight = BTreeMap::new();
    let mut open: f64 = 0.0;
    for part in table.tables() {
        let transmitted = part.component == Component::Transmission;
        let direct: Vec<f64> = table.direct(part.side).iter().map(|estimate| estimate.value).collect();
        let direct = fit_direct(&direct, job.incident, &klems);
        if transmitted {
            open = direct.iter().copied().fold(open, f64::max);
            straight.insert(part.side, direct.clone());
        }
        let fitted = fit(&table, part, job.incident, &klems, &klems);
        for (wavelength, channel) in wavelengths(colours) {
            let mut f = fitted[channel].f.clone();
            if transmitted {
                for (cell, direct) in direct.iter().enumerate() {
                    let exit = half_turn(&klems, cell);
                    f[cell * PATCHES + exit] += direct / klems.projected_solid_angle(exit);
                }
            }
            data.push(Block { wavelength, direction: direction(part.side, part.component), data: matrix(&klems, &f) });
        }
    }
    let head = Head { name: job.title, thickness: job.thickness, openness: job.openness() };
    let basis =
        "<ColumnAngleBasis>LBNL/Klems Full</ColumnAngleBasis>\n<RowAngleBasis>LBNL/Klems Full</RowAngleBasis>\n";
    let text = document(&head, &structure(), basis, &data);
    let loaded = Matrices::read(&text, colours, straight);
    let checked = check(&table, job.incident, &loaded);
    let name = format!("{}_klems.xml", job.stem);
    let scene = rad(job.stem, &name, job.title, open > 0.0);
    Written {
        checks: vec![(name.clone(), checked)],
        files: vec![
            File { name, bytes: text.into_bytes() },
            File { name: format!("{}_klems.rad", job.stem), bytes: scene.into_bytes() },
        ],
    }
}

/// Names of the quantities and the channels that they are.
fn wavelengths(colours: Colours) -> Vec<(&'static str, usize)> {
    match colours {
        Colours::Grey => vec![("Visible", 0)],
        Colours::Xyz => vec![("Visible", 1), ("CIE-X", 0), ("CIE-Z", 2)],
    }
}

/// The patch on the other side of the normal: where undeflected light leaves, and the number of an incident patch in the file.
fn half_turn(klems: &Basis, cell: usize) -> usize {
    klems.cell_of(-klems.centre(cell).truncate())
}

/// Rows of the file are exit patches, columns incident ones, named by where their light travels.
fn matrix(klems: &Basis, f: &[f64]) -> String {
    let columns: Vec<usize> = (0..PATCHES).map(|column| half_turn(klems, column)).collect();
    let mut text = String::new();
    for exit in 0..PATCHES {
        for incident in &columns {
            let _ = write!(text, "{:.6e}, ", f[incident * PATCHES + exit]);
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    text
}

fn structure() -> String {
    let mut text = String::from(
        "<IncidentDataStructure>Columns</IncidentDataStructure>\n<AngleBasis>\n<AngleBasisName>LBNL/Klems Full</AngleBasisName>\n",
    );
    for (index, ring) in RingBasis::klems().rings().iter().enumerate() {
        let [low, high] = ring.edges.map(|square| square.sqrt().asin().to_degrees());
        let middle = if index == 0 { 0.0 } else { (low + high) / 2.0 };
        let _ = write!(
            text,
            "<AngleBasisBlock>\n<Theta>{middle:.1}</Theta>\n<nPhis>{}</nPhis>\n<ThetaBounds>\n<LowerTheta>{low:.1}</LowerTheta>\n\
             <UpperTheta>{high:.1}</UpperTheta>\n</ThetaBounds>\n</AngleBasisBlock>\n",
            ring.sectors
        );
    }
    text + "</AngleBasis>\n"
}

/// The file as Radiance evaluates it: a number for each pair of patches.
struct Matrices {
    klems: Basis,
    /// By component, each channel: rows are exit patches.
    values: BTreeMap<&'static str, Vec<Vec<f64>>>,
    /// What was put on the diagonal of transmission.
    straight: BTreeMap<Side, Vec<f64>>,
}

impl Matrices {
    fn read(text: &str, colours: Colours, straight: BTreeMap<Side, Vec<f64>>) -> Matrices {
        let names = [Side::Front, Side::Back].into_iter().flat_map(|side| {
            [Component::Reflection, Component::Transmission].map(|component| direction(side, component))
        });
        let mut values = BTreeMap::new();
        for name in names {
            let of = |wanted: &str| -> Option<Vec<f64>> {
                let (_, _, data) =
                    blocks(text).find(|(wavelength, direction, _)| (*wavelength, *direction) == (wanted, name))?;
                let numbers: Vec<f64> = data
                    .split([',', ' ', '\n'])
                    .filter_map(|word| word.parse().ok())
                    .map(|f: f64| f.max(0.0))
                    .collect();
                (numbers.len() == PATCHES * PATCHES).then_some(numbers)
            };
            let mut channels = vec![Vec::new(); wavelengths(colours).len()];
            let read = wavelengths(colours).into_iter().map(|(wavelength, channel)| Some((channel, of(wavelength)?)));
            if let Some(read) = read.collect::<Option<Vec<_>>>() {
                read.into_iter().for_each(|(channel, numbers)| channels[channel] = numbers);
                values.insert(name, channels);
            }
        }
        Matrices { klems: Basis::Rings(RingBasis::klems()), values, straight }
    }
}

impl Loaded for Matrices {
    fn has(&self, side: Side, component: Component) -> bool {
        self.values.contains_key(direction(side, component))
    }

    fn f(&self, side: Side, component: Component, wi: DVec2, wo: DVec2) -> Vec<f64> {
        let (travels, exit) = (self.klems.cell_of(-wi), self.klems.cell_of(wo));
        let of = |values: &Vec<f64>| {
            let mut f = values[exit * PATCHES + travels];
            if component == Component::Transmission && exit == travels {
                f -= self.straight[&side][self.klems.cell_of(wi)] / self.klems.projected_solid_angle(exit);
            }
            f
        };
        self.values[direction(side, component)].iter().map(of).collect()
    }
}

/// What the format leaves out of a table.
pub fn notes(table: &Bsdf, incident: &Basis) -> Vec<String> {
    let klems = Basis::Rings(RingBasis::klems());
    let mut notes = Vec::new();
    if *incident != klems || table.goniometer.exit != klems {
        notes.push(
            "cells are joined and cut to the 145 patches of Klems; measure --incident klems --exit klems avoids that"
                .into(),
        );
    }
    notes.push("light that touches no fiber stands on the diagonal of transmission".into());
    notes
}
