//! The same light in other cells.

use crate::bsdf::{Bsdf, Scattering};
use crate::goniometer::Basis;
use glam::DVec2;

/// Places at which the finer of two bases is looked up, in all.
const PLACES: f64 = 2e6;

/// Which part of each cell of a basis lies in which cells of another.
struct Overlap {
    /// By target cell: source cells and the share of each that lies here. The shares of a source cell add up to 1.
    parts: Vec<Vec<(usize, f64)>>,
}

impl Overlap {
    fn new(source: &Basis, target: &Basis) -> Overlap {
        if let Some(inside) = source.inside(target) {
            let mut parts = vec![Vec::new(); target.cells()];
            inside.into_iter().enumerate().for_each(|(cell, target)| parts[target].push((cell, 1.0)));
            return Overlap { parts };
        }
        // Look up places of the finer basis in the other: each cell of it is then seen often enough.
        let forth = source.cells() > target.cells();
        let (fine, other) = if forth { (source, target) } else { (target, source) };
        let places = (PLACES / fine.cells() as f64).sqrt().clamp(4.0, 32.0) as u32;
        let mut pairs = std::collections::BTreeMap::new();
        for cell in 0..fine.cells() {
            let weight = fine.projected_solid_angle(cell);
            for place in even(places) {
                let found = other.cell_of(fine.direction(cell, place).truncate());
                *pairs.entry(if forth { (found, cell) } else { (cell, found) }).or_insert(0.0) += weight;
            }
        }
        // Nothing is lost: the shares of a source cell are made to add up to 1.
        let mut sums = vec![0.0; source.cells()];
        pairs.iter().for_each(|((_, source), weight)| sums[*source] += weight);
        let mut parts = vec![Vec::new(); target.cells()];
        pairs.into_iter().for_each(|((target, source), weight)| parts[target].push((source, weight / sums[source])));
        Overlap { parts }
    }
}

/// `n` × `n` even places inside a cell.
pub(super) fn even(n: u32) -> impl Iterator<Item = DVec2> + Clone {
    let middle = move |i: u32| (f64::from(i) + 0.5) / f64::from(n);
    (0..n * n).map(move |i| DVec2::new(middle(i % n), middle(i / n)))
}

/// One channel of a component in other cells.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// f in sr⁻¹ by incident and exit cell.
    pub f: Vec<f64>,
    /// Standard error of a cell; where cells are joined, as if their errors went together.
    pub stderr: Vec<f64>,
}

/// f of every channel of a component in the cells of other bases: light goes to exit cells by the share of projected solid angle
/// that they have in common, and incident cells are averaged by it, so all of the light stays.
pub fn fit(table: &Bsdf, part: &Scattering, from: &Basis, incident: &Basis, exit: &Basis) -> Vec<Fitted> {
    let (rows, columns) = (Overlap::new(from, incident), Overlap::new(&table.goniometer.exit, exit));
    let (source, channels) = (&table.goniometer.exit, table.channels.len());
    let exits = source.cells();
    let fitted = |channel: usize| {
        let at = |cell: usize, bin: usize| &part.f[(cell * exits + bin) * channels + channel];
        // First the exits of every incident cell: shares of light, that is f·Ω.
        let row = |cell: usize| -> Vec<[f64; 2]> {
            let joined = |parts: &Vec<(usize, f64)>| {
                let add = |sum: [f64; 2], &(bin, share): &(usize, f64)| {
                    let (estimate, weight) = (at(cell, bin), share * source.projected_solid_angle(bin));
                    [sum[0] + weight * estimate.value, sum[1] + weight * estimate.stderr]
                };
                parts.iter().fold([0.0; 2], add)
            };
            columns.parts.iter().map(joined).collect()
        };
        let light: Vec<Vec<[f64; 2]>> = (0..from.cells()).map(row).collect();
        let (mut f, mut stderr) = (Vec::new(), Vec::new());
        for parts in &rows.parts {
            let weights = weights(parts, from);
            let mean = |bin: usize, k: usize| -> f64 {
                let sum: f64 = weights.iter().map(|(cell, weight)| weight * light[*cell][bin][k]).sum();
                sum / exit.projected_solid_angle(bin)
            };
            f.extend((0..exit.cells()).map(|bin| mean(bin, 0)));
            stderr.extend((0..exit.cells()).map(|bin| mean(bin, 1)));
        }
        Fitted { f, stderr }
    };
    (0..channels).map(fitted).collect()
}

/// Light that touches no fiber, by cell of another incident basis.
pub fn fit_direct(direct: &[f64], from: &Basis, incident: &Basis) -> Vec<f64> {
    let mean =
        |parts: &Vec<(usize, f64)>| weights(parts, from).iter().map(|(cell, weight)| weight * direct[*cell]).sum();
    Overlap::new(from, incident).parts.iter().map(mean).collect()
}

/// Source cells of a target cell by the projected solid angle that they have in common, together 1.
fn weights(parts: &[(usize, f64)], from: &Basis) -> Vec<(usize, f64)> {
    let common: Vec<(usize, f64)> =
        parts.iter().map(|&(cell, share)| (cell, share * from.projected_solid_angle(cell))).collect();
    let sum: f64 = common.iter().map(|(_, weight)| weight).sum();
    common.into_iter().map(|(cell, weight)| (cell, weight / sum)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::BasisChoice;

    #[test]
    fn no_part_of_a_cell_is_lost_and_sizes_agree() {
        let basis = Basis::new;
        let choices = [
            BasisChoice::Disc(8),
            BasisChoice::Disc(12),
            BasisChoice::Klems,
            BasisChoice::Polar { rings: 9, sectors: 16 },
        ];
        for (source, target) in choices.iter().flat_map(|a| choices.map(|b| (basis(*a), basis(b)))) {
            let overlap = Overlap::new(&source, &target);
            let mut sums = vec![0.0; source.cells()];
            for (cell, parts) in overlap.parts.iter().enumerate() {
                let size: f64 = parts.iter().map(|(s, share)| share * source.projected_solid_angle(*s)).sum();
                let right = target.projected_solid_angle(cell);
                assert!((size / right - 1.0).abs() < 0.03, "cell {cell}: {size} for {right}");
                parts.iter().for_each(|(s, share)| sums[*s] += share);
            }
            assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-12));
        }
    }
}
