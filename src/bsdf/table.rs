//! The BSDF as a table of values with their errors.

use super::estimate::{Component, Estimate, direct, values};
use crate::colour::Channels;
use crate::goniometer::{Goniometer, Tally};
use crate::scene::Side;

/// f of all lit sides, both components and every channel, and the light that touches no fiber.
#[derive(Clone, Debug)]
pub struct Bsdf {
    /// The bases and the lit sides.
    pub goniometer: Goniometer,
    /// Names of the channels.
    pub channels: Vec<String>,
    tables: Vec<Scattering>,
    direct: Vec<Estimate>,
}

/// One component of a lit side.
#[derive(Clone, Debug)]
pub struct Scattering {
    /// The lit side.
    pub side: Side,
    /// Where the light goes.
    pub component: Component,
    /// f in sr⁻¹ by incident cell, exit cell and channel, the channel running fastest.
    pub f: Vec<Estimate>,
}

impl Bsdf {
    /// The table of a tally; a lossless cloth has the same values in all of its channels.
    pub fn new(tally: &Tally, goniometer: &Goniometer, channels: &[String]) -> Bsdf {
        let cells = goniometer.incident_cells();
        let told_apart = tally.channels();
        let components = [Component::Reflection, Component::Transmission];
        let places = (0..goniometer.sides.len()).flat_map(|place| components.map(|component| (place, component)));
        let tables = places.map(|(place, component)| {
            let row = |start: usize| {
                let columns: Vec<Vec<Estimate>> =
                    (0..told_apart).map(|channel| values(tally, goniometer, component, start, channel)).collect();
                let of = |exit: usize, channel: usize| columns[channel.min(told_apart - 1)][exit];
                (0..goniometer.exit.cells())
                    .flat_map(|exit| (0..channels.len()).map(move |channel| (exit, channel)))
                    .map(|(exit, channel)| of(exit, channel))
                    .collect::<Vec<_>>()
            };
            let f = (place * cells..(place + 1) * cells).flat_map(row).collect();
            Scattering { side: goniometer.sides[place], component, f }
        });
        let tables = tables.collect();
        let direct = (0..goniometer.starts()).map(|start| direct(tally, start)).collect();
        Bsdf { goniometer: goniometer.clone(), channels: channels.to_vec(), tables, direct }
    }

    /// Components of lit sides, front first, reflection before transmission.
    pub fn tables(&self) -> &[Scattering] {
        &self.tables
    }

    /// The same, to be changed.
    pub fn tables_mut(&mut self) -> &mut [Scattering] {
        &mut self.tables
    }

    /// One component of a side; none when that side was not lit.
    pub fn table(&self, side: Side, component: Component) -> Option<&Scattering> {
        self.tables.iter().find(|table| table.side == side && table.component == component)
    }

    /// Share of the light on an incident cell of a side that touches no fiber; the same in all channels.
    pub fn direct(&self, side: Side) -> &[Estimate] {
        let cells = self.goniometer.incident_cells();
        let place = self.goniometer.sides.iter().position(|lit| *lit == side);
        place.map_or(&[], |place| &self.direct[place * cells..(place + 1) * cells])
    }

    /// What the channels are.
    pub fn colours(&self) -> Option<Channels> {
        Channels::from_names(&self.channels)
    }

    /// The table in other channels, each a sum of the old ones: `columns` has for each old channel its share of the new ones.
    ///
    /// Channels share their walks, so errors are added without regard to sign: no error is stated too small.
    pub fn in_channels<const N: usize>(&self, names: [&str; N], columns: &[[f64; N]]) -> Bsdf {
        let mixed = |old: &[Estimate]| -> [Estimate; N] {
            std::array::from_fn(|new| {
                let parts = || old.iter().zip(columns).map(|(estimate, column)| (estimate, column[new]));
                Estimate {
                    value: parts().map(|(estimate, share)| share * estimate.value).sum(),
                    stderr: parts().map(|(estimate, share)| share.abs() * estimate.stderr).sum(),
                }
            })
        };
        let tables = self.tables.iter().map(|table| Scattering {
            side: table.side,
            component: table.component,
            f: table.f.chunks_exact(self.channels.len()).flat_map(mixed).collect(),
        });
        Bsdf {
            goniometer: self.goniometer.clone(),
            channels: names.iter().map(|name| (*name).to_owned()).collect(),
            tables: tables.collect(),
            direct: self.direct.clone(),
        }
    }

    /// Values of one channel of a component, by incident and exit cell.
    pub fn values(&self, table: &Scattering, channel: usize) -> Vec<f64> {
        table.f.iter().skip(channel).step_by(self.channels.len()).map(|estimate| estimate.value).collect()
    }

    /// Share of the light of each incident cell that a component has in a channel.
    pub fn shares(&self, table: &Scattering, channel: usize) -> Vec<f64> {
        let exits = self.goniometer.exit.cells();
        let share = |row: &[f64]| -> f64 {
            let flux = |(exit, f): (usize, &f64)| f * self.goniometer.exit.projected_solid_angle(exit);
            row.iter().enumerate().map(flux).sum()
        };
        self.values(table, channel).chunks_exact(exits).map(share).collect()
    }
}
