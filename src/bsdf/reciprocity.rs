//! Whether light takes the same way back: f(wi, wo) = f(wo, wi). Flights that start where light leaves a fiber do not, near faces
//! and where densities change: then the residual holds that error of the model.

use super::estimate::{Component, Source};
use super::significance::chi_square_tail;
use crate::goniometer::{Goniometer, Moments, Tally};
use crate::scene::Side;
use serde::Serialize;
use std::f64::consts::PI;

/// Least number of walks, or effective number of weighted ones, in a pair of cells that is counted.
const LEAST: f64 = 25.0;

/// How far a component is from its reverse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Residual {
    /// √max(0, Σ[(P − P')² − σ² − σ'²]) / √Σ PP': what noise does not explain, as a share.
    pub error: f64,
    /// Σ (P − P')²/(σ² + σ'²) over pairs of cells with light enough.
    pub chi_square: f64,
    /// How many such pairs.
    pub pairs: usize,
    /// Probability of so large a χ² if the light were reciprocal.
    pub probability: f64,
}

/// The residual of a component of a lit side in a channel: reflection against its own transpose, transmission against
/// that of the other side transposed; exit cells are pooled to the incident cells.
///
/// Light that goes from a cell to another is P·Ω, with the projected solid angle Ω of the cell that it comes from.
/// None for listed directions, for transmission with one side lit, and when an exit cell lies in several incident cells.
pub fn reciprocity(
    tally: &Tally,
    goniometer: &Goniometer,
    component: Component,
    side: Side,
    channel: usize,
) -> Option<Residual> {
    let incident = goniometer.incident_basis()?;
    let inside = goniometer.exit.inside(incident)?;
    let reverse = match (component, side) {
        (Component::Reflection, side) => side,
        (Component::Transmission, Side::Front) => Side::Back,
        (Component::Transmission, Side::Back) => Side::Front,
    };
    let place = |side| goniometer.sides.iter().position(|lit| *lit == side);
    let (there, here) = (place(side)?, place(reverse)?);
    let cells = incident.cells();
    let forth = pooled(tally, &inside, cells, component, there, channel);
    let back = pooled(tally, &inside, cells, component, here, channel);
    // Relative to the mean, so that shares of equal cells stay what they are.
    let weight = |cell: usize| incident.projected_solid_angle(cell) * cells as f64 / PI;
    let scale = 1.0 / (tally.unit() as f64 * tally.walks_per_incident() as f64);
    // Straight rays may know better how much light meets fibers at all.
    let factor = |start: usize| {
        let Source { walks, share } = Source::new(tally, start, tally.walks_per_incident());
        share.value * tally.walks_per_incident() as f64 / walks as f64
    };
    let (mut excess, mut square) = (0.0, 0.0);
    let mut residual = Residual::default();
    for i in 0..cells {
        // A reflection and its transpose hold each pair twice.
        let others = if side == reverse { i + 1..cells } else { 0..cells };
        for o in others {
            let (p, q) = (forth[i * cells + o], back[o * cells + i]);
            let scales = [(there, i), (here, o)].map(|(side, cell)| factor(side * cells + cell) * weight(cell) * scale);
            let [share_p, share_q] = [p.sum as f64 * scales[0], q.sum as f64 * scales[1]];
            let second = p.square as f64 * scales[0].powi(2) + q.square as f64 * scales[1].powi(2);
            // The two are equal if light is reciprocal, so they have one mean.
            let mean = (share_p + share_q) / 2.0;
            let variance = second - 2.0 * mean * mean / tally.walks_per_incident() as f64;
            let difference = (share_p - share_q).powi(2);
            excess += difference - variance;
            square += share_p * share_q;
            let effective = ((p.sum + q.sum) as f64).powi(2) / ((p.square + q.square) as f64).max(1.0);
            if effective >= LEAST {
                residual.chi_square += difference / variance;
                residual.pairs += 1;
            }
        }
    }
    residual.error = if square > 0.0 { (excess.max(0.0) / square).sqrt() } else { 0.0 };
    residual.probability = chi_square_tail(residual.chi_square, residual.pairs);
    Some(residual)
}

/// Light by incident cell and the incident cell that its exit cell lies in.
fn pooled(
    tally: &Tally,
    inside: &[usize],
    cells: usize,
    component: Component,
    side: usize,
    channel: usize,
) -> Vec<Moments> {
    let first = if component == Component::Reflection { 0 } else { inside.len() };
    let mut light = vec![Moments::default(); cells * cells];
    for cell in 0..cells {
        for (bin, &coarse) in inside.iter().enumerate() {
            let part = tally.light(side * cells + cell, first + bin, channel);
            let sum = &mut light[cell * cells + coarse];
            sum.sum += part.sum;
            sum.square += part.square;
        }
    }
    light
}
