//! f between the middles of cells.

use crate::colour::between;
use crate::goniometer::{Basis, Ring};
use glam::DVec2;
use std::f64::consts::TAU;

/// One channel of a component as a function: linear between the middles of cells, in the coordinates of the basis, on both sides.
///
/// Each incident cell is scaled so that all of its light stays.
#[derive(Clone, Debug)]
pub struct Smooth {
    incident: Basis,
    exit: Basis,
    f: Vec<f64>,
}

/// Places along an edge of an exit cell at which the light is summed.
const PLACES: u32 = 4;

impl Smooth {
    /// From f in sr⁻¹ by incident and exit cell.
    pub fn new(incident: &Basis, exit: &Basis, f: &[f64]) -> Smooth {
        let exits = exit.cells();
        // What each cell weighs in the sum over the hemisphere of what is linear between them.
        let mut weights = vec![0.0; exits];
        for cell in 0..exits {
            let each = exit.projected_solid_angle(cell) / f64::from(PLACES * PLACES);
            for place in super::overlap::even(PLACES) {
                let near = near(exit, exit.direction(cell, place).truncate());
                near.into_iter().for_each(|(cell, share)| weights[cell] += share * each);
            }
        }
        let scaled = |row: &[f64]| -> Vec<f64> {
            let all: f64 = row.iter().enumerate().map(|(cell, f)| f * exit.projected_solid_angle(cell)).sum();
            let smooth: f64 = row.iter().zip(&weights).map(|(f, weight)| f * weight).sum();
            let factor = if smooth > 0.0 { all / smooth } else { 1.0 };
            row.iter().map(|f| f * factor).collect()
        };
        let f = f.chunks_exact(exits).flat_map(scaled).collect();
        Smooth { incident: incident.clone(), exit: exit.clone(), f }
    }

    /// f for light from one direction.
    pub fn from(&self, wi: DVec2) -> SmoothRow<'_> {
        let exits = self.exit.cells();
        let mut row = vec![0.0; exits];
        for (cell, share) in near(&self.incident, wi) {
            let cells = &self.f[cell * exits..(cell + 1) * exits];
            row.iter_mut().zip(cells).for_each(|(sum, f)| *sum += share * f);
        }
        SmoothRow { exit: &self.exit, f: row }
    }
}

/// f for light from one direction.
pub struct SmoothRow<'a> {
    exit: &'a Basis,
    f: Vec<f64>,
}

impl SmoothRow<'_> {
    /// f at the projection (x, y) of wo, in sr⁻¹.
    pub fn at(&self, wo: DVec2) -> f64 {
        self.sum(&near(self.exit, wo))
    }

    /// f of cells with shares, as [`near`] gives them.
    pub fn sum(&self, near: &[(usize, f64)]) -> f64 {
        near.iter().map(|(cell, share)| share * self.f[*cell]).sum()
    }

    /// The exit cells.
    pub fn exit(&self) -> &Basis {
        self.exit
    }

    /// Σ f Ω over the cells: the share of the light.
    pub fn light(&self) -> f64 {
        self.f.iter().enumerate().map(|(cell, f)| f * self.exit.projected_solid_angle(cell)).sum()
    }
}

/// The cells whose middles are around a projection (x, y), with shares that add up to 1.
pub fn near(basis: &Basis, projection: DVec2) -> Vec<(usize, f64)> {
    match basis {
        Basis::Disc(disc) => {
            let n = disc.n as usize;
            let place = disc.place(projection) - 0.5;
            let along = |t: f64| {
                let low = t.floor().clamp(0.0, (n - 1) as f64);
                let share = (t - low).clamp(0.0, 1.0);
                [(low as usize, 1.0 - share), ((low as usize + 1).min(n - 1), share)]
            };
            let rows = along(place.y);
            along(place.x).iter().flat_map(|(x, a)| rows.map(|(y, b)| (y * n + x, a * b))).collect()
        }
        Basis::Rings(rings) => {
            let middle = |ring: &Ring| {
                let [inner, outer] = ring.edges.map(|square| square.sqrt().asin());
                (inner + outer) / 2.0
            };
            let middles: Vec<f64> = rings.rings().iter().map(middle).collect();
            let theta = projection.length().min(1.0).asin();
            let turn = projection.y.atan2(projection.x) / TAU;
            let around = |(ring, share): (usize, f64)| {
                let Ring { first, sectors, shift, .. } = rings.rings()[ring];
                let place = turn * f64::from(sectors) + shift - 0.5;
                let low = place.floor();
                let cell =
                    |k: f64| first as usize + (k.rem_euclid(f64::from(sectors)) as usize).min(sectors as usize - 1);
                [(cell(low), share * (1.0 - (place - low))), (cell(low + 1.0), share * (place - low))]
            };
            between(&middles, theta).into_iter().flat_map(around).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::BasisChoice;

    const CHOICES: [BasisChoice; 4] =
        [BasisChoice::Disc(6), BasisChoice::Disc(1), BasisChoice::Klems, BasisChoice::Polar { rings: 5, sectors: 7 }];

    #[test]
    fn a_cell_is_all_that_counts_in_its_middle_and_shares_add_up() {
        for basis in CHOICES.map(Basis::new) {
            for cell in 0..basis.cells() {
                let place = basis.direction(cell, DVec2::new(0.3, 0.8)).truncate();
                let sum: f64 = near(&basis, place).iter().map(|(_, share)| share).sum();
                assert!((sum - 1.0).abs() < 1e-12);
                if let Basis::Disc(_) = basis {
                    let most =
                        near(&basis, basis.centre(cell).truncate()).into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
                    assert!(most.is_some_and(|(found, share)| found == cell && share > 1.0 - 1e-9));
                }
            }
        }
    }

    #[test]
    fn light_stays_and_a_constant_stays_constant() {
        for (incident, exit) in CHOICES.iter().flat_map(|a| CHOICES.map(|b| (Basis::new(*a), Basis::new(b)))) {
            let flat = Smooth::new(&incident, &exit, &vec![0.25; incident.cells() * exit.cells()]);
            let f: Vec<f64> = (0..incident.cells() * exit.cells()).map(|i| 1.0 + (i as f64 * 0.7).sin()).collect();
            let smooth = Smooth::new(&incident, &exit, &f);
            let wi = DVec2::new(0.4, -0.5);
            let row = smooth.from(wi);
            let mut sum = 0.0;
            for cell in 0..exit.cells() {
                for place in super::super::overlap::even(PLACES) {
                    let wo = exit.direction(cell, place).truncate();
                    assert!((flat.from(wi).at(wo) - 0.25).abs() < 1e-9);
                    sum += row.at(wo) * exit.projected_solid_angle(cell) / f64::from(PLACES * PLACES);
                }
            }
            let expected: f64 = near(&incident, wi)
                .iter()
                .map(|(cell, share)| {
                    let row = &f[cell * exit.cells()..(cell + 1) * exit.cells()];
                    share * row.iter().enumerate().map(|(o, f)| f * exit.projected_solid_angle(o)).sum::<f64>()
                })
                .sum();
            assert!((sum - expected).abs() < 1e-9, "{sum} for {expected}");
        }
    }
}
