//! Light of nodes such that incident cells get what the table has.

use super::overlap::even;
use crate::goniometer::Basis;
use glam::DVec2;

/// Places along an edge of an incident cell.
const PLACES: u32 = 4;
/// Steps of the iteration, each of which takes away most of what is left.
const STEPS: usize = 60;

/// For each node of wi the share of light that it must have, so that every incident cell has on the average what the table has, where
/// `blend` gives the nodes around a projection (x, y) of wi with their shares.
///
/// Multiplicative steps from the light that the nodes have (Richardson 1972, Lucy 1974): what is positive stays so.
pub fn balance(
    incident: &Basis,
    blend: &dyn Fn(DVec2) -> Vec<(usize, f64)>,
    wanted: &[f64],
    nodes: &[f64],
) -> Vec<f64> {
    let each = 1.0 / f64::from(PLACES * PLACES);
    let around = |cell: usize| -> Vec<(usize, f64)> {
        let places = even(PLACES).map(|place| incident.direction(cell, place).truncate());
        places.flat_map(blend).map(|(node, share)| (node, share * each)).collect()
    };
    let cells: Vec<Vec<(usize, f64)>> = (0..incident.cells()).map(around).collect();
    let mut sums = vec![0.0; nodes.len()];
    cells.iter().flatten().for_each(|(node, share)| sums[*node] += share);
    let mut light = nodes.to_vec();
    for _ in 0..STEPS {
        let mut factors = vec![0.0; nodes.len()];
        for (cell, wanted) in cells.iter().zip(wanted) {
            let has: f64 = cell.iter().map(|(node, share)| share * light[*node]).sum();
            let ratio = if has > 0.0 { (wanted / has).max(0.0) } else { 1.0 };
            cell.iter().for_each(|(node, share)| factors[*node] += share * ratio);
        }
        for ((light, factor), sum) in light.iter_mut().zip(factors).zip(&sums) {
            *light *= if *sum > 0.0 { factor / sum } else { 1.0 };
        }
    }
    light
}
