//! The mean of light and of its way back.

use super::estimate::{Component, Estimate};
use super::table::Bsdf;
use crate::scene::Side;

/// How far a component was from its reverse, before and after, as √Σ(F − F′)²/√ΣFF′ over pairs of incident cells: noise included.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Halves {
    /// As it was measured.
    pub before: f64,
    /// As it is now.
    pub after: f64,
}

/// Give light from cell to cell, F = f ΩΩ′, the mean of both ways: a reflection with its own transpose, transmission from the front with that from
/// the back. Where several exit cells lie in an incident one, they keep their proportions.
///
/// Errors are halved in quadrature where exit and incident cells are the same, and follow the values elsewhere, which states them too large.
/// None for listed directions, for transmission with one side lit, and when an exit cell lies in several incident cells.
pub fn average_halves(table: &mut Bsdf, component: Component, side: Side) -> Option<Halves> {
    let incident = table.goniometer.incident_basis()?.clone();
    let inside = table.goniometer.exit.inside(&incident)?;
    let other = match (component, side) {
        (Component::Reflection, side) => side,
        (Component::Transmission, Side::Front) => Side::Back,
        (Component::Transmission, Side::Back) => Side::Front,
    };
    let place =
        |table: &Bsdf, side| table.tables().iter().position(|part| (part.side, part.component) == (side, component));
    let (here, there) = (place(table, side)?, place(table, other)?);
    let (cells, exits, channels) = (incident.cells(), inside.len(), table.channels.len());
    let size = |cell: usize| incident.projected_solid_angle(cell);
    let exit_size: Vec<f64> = (0..exits).map(|exit| table.goniometer.exit.projected_solid_angle(exit)).collect();
    let mut groups = vec![Vec::new(); cells];
    inside.iter().enumerate().for_each(|(exit, cell)| groups[*cell].push(exit));
    let light = |table: &Bsdf, part: usize, channel: usize, from: usize, to: usize| -> f64 {
        let f =
            |exit: &usize| table.tables()[part].f[(from * exits + exit) * channels + channel].value * exit_size[*exit];
        groups[to].iter().map(f).sum::<f64>() * size(from)
    };
    let residual = |table: &Bsdf| {
        let (mut square, mut all) = (0.0, 0.0);
        for (channel, from, to) in pairs(channels, cells) {
            let (forth, back) = (light(table, here, channel, from, to), light(table, there, channel, to, from));
            square += (forth - back).powi(2);
            all += forth * back;
        }
        if all > 0.0 { f64::sqrt(square / all) } else { 0.0 }
    };
    let before = residual(table);
    let old = table.clone();
    for (channel, from, to) in pairs(channels, cells) {
        let ways = [(here, from, to), (there, to, from)];
        let seen = ways.map(|(part, from, to)| light(&old, part, channel, from, to));
        let mean = (seen[0] + seen[1]) / 2.0;
        let errors = ways.map(|(part, from, to)| {
            let exit = groups[to][0];
            old.tables()[part].f[(from * exits + exit) * channels + channel].stderr * exit_size[exit] * size(from)
        });
        for ((part, from, to), seen) in ways.into_iter().zip(seen) {
            for exit in &groups[to] {
                let scale = exit_size[*exit] * size(from);
                let estimate = &mut table.tables_mut()[part].f[(from * exits + exit) * channels + channel];
                *estimate = match groups[to].len() {
                    1 => Estimate { value: mean / scale, stderr: errors[0].hypot(errors[1]) / 2.0 / scale },
                    _ if seen > 0.0 => {
                        let factor = mean / seen;
                        let was = old.tables()[part].f[(from * exits + exit) * channels + channel];
                        Estimate { value: was.value * factor, stderr: was.stderr * factor.max(1.0) }
                    }
                    _ => Estimate { value: mean / (size(from) * size(to)), ..*estimate },
                };
            }
        }
    }
    Some(Halves { before, after: residual(table) })
}

fn pairs(channels: usize, cells: usize) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..channels)
        .flat_map(move |channel| (0..cells).flat_map(move |from| (0..cells).map(move |to| (channel, from, to))))
}
