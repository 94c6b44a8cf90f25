//! f at the nodes of four angles, linear between them, as libbsdf has it.
//!
//! Sources: libbsdf, `SphericalCoordinateSystem.h`, `SpecularCoordinateSystem.h`, `LinearInterpolator.cpp`, `Btdf.h`: transmitted light is laid on
//! the upper hemisphere by its (x, y).

use super::balance::balance;
use super::smooth::Smooth;
use crate::colour::between;
use crate::goniometer::{Basis, DiscBasis};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Places along an edge of the disc of wo at which the light of a node is summed.
const PLACES: u32 = 40;

/// The angles of the nodes, ascending, in degrees: polar and azimuth of wi, polar and azimuth of wo.
#[derive(Clone, Debug)]
pub struct Grid {
    /// One list for each angle; azimuths go over the whole turn, both ends included.
    pub axes: [Vec<f64>; 4],
    /// The angles of wo are those about the direction of mirrored or undeflected light, and not about the normal.
    pub specular: bool,
}

/// Even steps from 0 to a last angle.
pub fn steps(last: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| last * i as f64 / (count - 1) as f64).collect()
}

fn spherical(theta: f64, phi: f64) -> DVec3 {
    let [theta, phi] = [theta, phi].map(f64::to_radians);
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// Polar angle and azimuth in degrees, the latter from 0 to 360.
fn angles(v: DVec3) -> [f64; 2] {
    let theta = v.truncate().length().atan2(v.z).to_degrees();
    [theta, v.y.atan2(v.x).to_degrees().rem_euclid(360.0)]
}

fn lifted(projection: DVec2) -> DVec3 {
    projection.extend((1.0 - projection.length_squared()).max(0.0).sqrt())
}

impl Grid {
    /// Values of a node of wi: polar angles of wo run fastest, azimuths of wo slower.
    pub fn exits(&self) -> usize {
        self.axes[2].len() * self.axes[3].len()
    }

    /// Nodes of wi: polar angles run fastest.
    pub fn starts(&self) -> impl Iterator<Item = [f64; 2]> + Clone + '_ {
        self.axes[1].iter().flat_map(|phi| self.axes[0].iter().map(|theta| [*theta, *phi]))
    }

    /// The projection of a node of wi.
    pub fn start(&self, [theta, phi]: [f64; 2]) -> DVec2 {
        spherical(theta, phi).truncate()
    }

    /// wo of two angles, for a node of wi.
    fn exit(&self, [theta, phi]: [f64; 2], out: [f64; 2]) -> DVec3 {
        let wo = spherical(out[0], out[1]);
        if !self.specular {
            return wo;
        }
        // Turn by θ in the plane of incidence, from the normal to the mirror direction, then by φ.
        let turned = DVec2::from_angle(theta.to_radians()).rotate(DVec2::new(wo.x, wo.z));
        DVec2::from_angle(phi.to_radians()).rotate(DVec2::new(turned.x, wo.y)).extend(turned.y)
    }

    /// The two angles of wo.
    fn out(&self, [theta, phi]: [f64; 2], wo: DVec3) -> [f64; 2] {
        if !self.specular {
            return angles(wo);
        }
        let turned = DVec2::from_angle(-phi.to_radians()).rotate(wo.truncate());
        let plane = DVec2::from_angle(-theta.to_radians()).rotate(DVec2::new(turned.x, wo.z));
        angles(DVec3::new(plane.x, turned.y, plane.y))
    }

    /// f at the nodes of wo for every node of wi, scaled so that every incident cell has the light that it has in the table, as a loader
    /// sums it.
    pub fn rows(&self, smooth: &Smooth, incident: &Basis, wanted: &[f64]) -> Vec<Vec<f64>> {
        let starts: Vec<[f64; 2]> = self.starts().collect();
        let nodes: Vec<f64> = starts.iter().map(|start| smooth.from(self.start(*start)).light()).collect();
        // Both ends of the turn are one node, and so are all azimuths along the normal.
        let (polar, turn) = (self.axes[0].len(), self.axes[1].len());
        let one = |index: usize| match (index % polar, index / polar) {
            (0, _) => 0,
            (theta, phi) => phi % (turn - 1) * polar + theta,
        };
        let blend =
            |wi: DVec2| self.around(angles(lifted(wi))).map(|(index, share)| (one(index), share)).collect::<Vec<_>>();
        let light = balance(incident, &blend, wanted, &nodes);
        (0..starts.len()).into_par_iter().map(|index| self.row(smooth, starts[index], light[one(index)])).collect()
    }

    /// The nodes of wi around two angles, with their shares.
    fn around(&self, start: [f64; 2]) -> impl Iterator<Item = (usize, f64)> + use<> {
        let polar = self.axes[0].len();
        let thetas = between(&self.axes[0], start[0]);
        between(&self.axes[1], start[1]).into_iter().flat_map(move |(azimuth, a)| {
            thetas.clone().into_iter().map(move |(index, b)| (azimuth * polar + index, a * b))
        })
    }

    /// f at the nodes of wo for a node of wi, scaled to its light.
    ///
    /// Below the horizon stands what is at the horizon: nobody reads it, but it is interpolated with.
    fn row(&self, smooth: &Smooth, start: [f64; 2], light: f64) -> Vec<f64> {
        let row = smooth.from(self.start(start));
        let mut values = Vec::with_capacity(self.exits());
        for phi in &self.axes[3] {
            for theta in &self.axes[2] {
                let wo = self.exit(start, [*theta, *phi]);
                let projection = wo.truncate();
                let above = if wo.z > 0.0 { projection } else { projection.normalize_or_zero() };
                values.push(row.at(above).max(0.0));
            }
        }
        let disc = DiscBasis { n: PLACES };
        let seen: f64 =
            (0..disc.cells()).map(|cell| self.at_exit(&values, start, Basis::Disc(disc).centre(cell))).sum::<f64>()
                * disc.projected_solid_angle();
        let factor = if seen > 0.0 { light.max(0.0) / seen } else { 1.0 };
        values.iter().map(|value| value * factor).collect()
    }

    /// The nodes of wo around a direction, with their shares.
    fn around_exit(&self, start: [f64; 2], wo: DVec3) -> impl Iterator<Item = (usize, f64)> + use<> {
        let [theta, phi] = self.out(start, wo);
        let polar = self.axes[2].len();
        let thetas = between(&self.axes[2], theta);
        between(&self.axes[3], phi).into_iter().flat_map(move |(azimuth, a)| {
            thetas.clone().into_iter().map(move |(index, b)| (azimuth * polar + index, a * b))
        })
    }

    /// f of a row at wo.
    fn at_exit(&self, row: &[f64], start: [f64; 2], wo: DVec3) -> f64 {
        self.around_exit(start, wo).map(|(index, share)| share * row[index]).sum()
    }

    /// The nodes of wi and of wo around two projections, with their shares: linear in all four angles.
    pub fn reads(&self, wi: DVec2, wo: DVec2) -> Vec<(usize, usize, f64)> {
        let start = angles(lifted(wi));
        // Angles about the mirror direction are those of wi itself, not of the nodes.
        let exits: Vec<(usize, f64)> = self.around_exit(start, lifted(wo)).collect();
        let pairs = self.around(start).flat_map(|(row, a)| exits.iter().map(move |(node, b)| (row, *node, a * b)));
        pairs.collect()
    }
}

/// f of rows, one for each node of wi, as [`Grid::reads`] says.
pub fn sum(rows: &[Vec<f64>], reads: &[(usize, usize, f64)]) -> f64 {
    reads.iter().map(|(row, node, share)| share * rows[*row][*node]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::BasisChoice;

    fn grids() -> [Grid; 2] {
        let axes = [steps(90.0, 7), steps(360.0, 9), steps(90.0, 13), steps(360.0, 25)];
        let mut around = axes.clone();
        around[2] = steps(180.0, 37);
        [Grid { axes, specular: false }, Grid { axes: around, specular: true }]
    }

    #[test]
    fn angles_name_the_direction_that_they_are_of() {
        for grid in grids() {
            for (start, out) in [([30.0, 45.0], [20.0, 75.0]), ([80.0, 315.0], [5.0, 190.0])] {
                let back = grid.out(start, grid.exit(start, out));
                assert!((back[0] - out[0]).abs() < 1e-9 && (back[1] - out[1]).abs() < 1e-9, "{back:?}");
            }
        }
        // About the mirror direction: θ = 0 is that direction itself.
        let mirror = grids()[1].exit([30.0, 40.0], [0.0, 0.0]);
        let expected = spherical(30.0, 220.0);
        assert!((mirror - expected).length() < 1e-12);
    }

    #[test]
    fn light_stays_and_lies_where_it_is() {
        let basis = Basis::new(BasisChoice::Disc(8));
        // Only the quarter x > 0, y > 0 is lit.
        let lit = |cell: usize| if basis.centre(cell).truncate().min_element() > 0.0 { 1.0 } else { 0.0 };
        let f: Vec<f64> = (0..64).flat_map(|_| (0..64).map(lit)).collect();
        let smooth = Smooth::new(&basis, &basis, &f);
        for grid in grids() {
            let rows = grid.rows(&smooth, &basis, &[std::f64::consts::FRAC_PI_4; 64]);
            let wi = DVec2::new(0.3, -0.4);
            let disc = DiscBasis { n: 60 };
            let mean = |quarter: [f64; 2]| -> f64 {
                let cells = (0..disc.cells()).map(|cell| Basis::Disc(disc).centre(cell).truncate());
                let inside = cells.filter(|wo| wo.x * quarter[0] > 0.0 && wo.y * quarter[1] > 0.0);
                inside.map(|wo| sum(&rows, &grid.reads(wi, wo))).sum::<f64>() * disc.projected_solid_angle()
            };
            let all = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(mean);
            assert!((all.iter().sum::<f64>() - std::f64::consts::FRAC_PI_4).abs() < 0.01, "{all:?}");
            assert!(all[0] > 0.8 * all.iter().sum::<f64>(), "{all:?}");
        }
    }
}
