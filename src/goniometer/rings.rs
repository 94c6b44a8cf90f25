//! Cells between circles of equal θ: the basis of Klems and polar grids.
//!
//! Klems, "A New Method for Predicting the Solar Heat Gain of Complex Fenestration Systems", ASHRAE Transactions 100(1), 1994.

use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Rings and sectors of the full basis of Klems: outer edge in degrees, cells.
const KLEMS: [(f64, u32); 9] =
    [(5.0, 1), (15.0, 8), (25.0, 16), (35.0, 20), (45.0, 24), (55.0, 24), (65.0, 24), (75.0, 16), (90.0, 12)];
/// Most rings of a basis.
pub const MOST_RINGS: usize = 128;

/// Rings around the normal, each cut into sectors of equal width; cells are counted from the normal outwards and in a ring by φ.
#[derive(Clone, Debug, PartialEq)]
pub struct RingBasis {
    rings: Vec<Ring>,
}

/// One ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// sin²θ of the inner and the outer edge.
    pub edges: [f64; 2],
    /// Number of its first cell.
    pub first: u32,
    /// Cells.
    pub sectors: u32,
    /// Where φ = 0 lies in the first cell, as a share of its width: 0 at its edge, ½ in its middle.
    pub shift: f64,
}

impl RingBasis {
    /// The full basis of Klems, 145 cells: cell k of a ring of n is centred on φ = 2πk/n.
    pub fn klems() -> RingBasis {
        RingBasis::new(KLEMS.map(|(outer, sectors)| (outer.to_radians(), sectors)), 0.5)
    }

    /// `rings` rings of equal width in θ; cell k of a ring of n spans φ from 2πk/n to 2π(k+1)/n.
    pub fn polar(rings: u32, sectors: u32) -> RingBasis {
        let outer = |ring: u32| FRAC_PI_2 * f64::from(ring + 1) / f64::from(rings);
        RingBasis::new((0..rings).map(|ring| (outer(ring), sectors)), 0.0)
    }

    fn new(rings: impl IntoIterator<Item = (f64, u32)>, shift: f64) -> RingBasis {
        let (mut inner, mut first) = (0.0, 0);
        let ring = |(outer, sectors): (f64, u32)| {
            let ring = Ring { edges: [inner, outer.sin().powi(2)], first, sectors, shift };
            (inner, first) = (ring.edges[1], first + sectors);
            ring
        };
        RingBasis { rings: rings.into_iter().map(ring).collect() }
    }

    /// The rings from the normal outwards.
    pub fn rings(&self) -> &[Ring] {
        &self.rings
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.rings.iter().map(|ring| ring.sectors as usize).sum()
    }

    /// The ring of a cell.
    pub fn ring(&self, cell: usize) -> &Ring {
        let ring = self.rings.partition_point(|ring| ring.first as usize <= cell);
        &self.rings[ring - 1]
    }

    /// Projected solid angle of a cell in sr, π(sin²θ₁ − sin²θ₀)/n.
    pub fn projected_solid_angle(&self, cell: usize) -> f64 {
        let Ring { edges, sectors, .. } = self.ring(cell);
        PI * (edges[1] - edges[0]) / f64::from(*sectors)
    }

    /// The place of the projection (x, y): sectors and rings, whose integer parts are the number of both.
    pub fn place(&self, projection: DVec2) -> DVec2 {
        let square = projection.length_squared();
        let index = self.rings.partition_point(|ring| ring.edges[1] <= square).min(self.rings.len() - 1);
        let ring = &self.rings[index];
        let turn = projection.y.atan2(projection.x) / TAU;
        let sector = (turn * f64::from(ring.sectors) + ring.shift).rem_euclid(f64::from(ring.sectors));
        let depth = (square - ring.edges[0]) / (ring.edges[1] - ring.edges[0]);
        DVec2::new(sector, index as f64 + depth)
    }

    /// The cell that holds a direction, by its projection (x, y).
    pub fn cell_of(&self, projection: DVec2) -> usize {
        let place = self.place(projection);
        let ring = &self.rings[(place.y as usize).min(self.rings.len() - 1)];
        (ring.first + (place.x as u32).min(ring.sectors - 1)) as usize
    }

    /// The unit vector, z ≥ 0, at a place inside a cell, along φ and along sin²θ; a place is in [0, 1]².
    pub fn direction(&self, cell: usize, place: DVec2) -> DVec3 {
        let ring = self.ring(cell);
        let sector = cell as f64 - f64::from(ring.first) - ring.shift + place.x;
        let square = ring.edges[0] + (ring.edges[1] - ring.edges[0]) * place.y;
        let disc = DVec2::from_angle(TAU * sector / f64::from(ring.sectors)) * square.sqrt();
        disc.extend((1.0 - square).max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_lies_in_the_cell_it_was_made_from() {
        for basis in [RingBasis::klems(), RingBasis::polar(18, 36), RingBasis::polar(1, 1), RingBasis::polar(90, 360)] {
            assert!(basis.rings().len() <= MOST_RINGS);
            for cell in 0..basis.cells() {
                for place in [DVec2::new(0.01, 0.99), DVec2::splat(0.5), DVec2::new(0.7, 0.02)] {
                    let direction = basis.direction(cell, place);
                    assert!((direction.length() - 1.0).abs() < 1e-12);
                    assert_eq!(basis.cell_of(direction.truncate()), cell, "{direction}");
                }
            }
        }
    }

    #[test]
    fn cells_of_klems_have_their_published_solid_angles() {
        // Sr, by ring: π(cos²θ₀ − cos²θ₁)/n with the bounds of the basis, to the digits of a published table.
        let published =
            [0.0238639, 0.0233229, 0.0219163, 0.0236222, 0.0223852, 0.0223852, 0.0196852, 0.0219163, 0.0175372];
        let first = [0, 1, 9, 25, 45, 69, 93, 117, 133];
        let klems = RingBasis::klems();
        assert_eq!(klems.cells(), 145);
        for (cell, solid_angle) in first.into_iter().zip(published) {
            assert!((klems.projected_solid_angle(cell) - solid_angle).abs() < 5e-8, "cell {cell}");
        }
        for basis in [klems, RingBasis::polar(7, 5)] {
            let all: f64 = (0..basis.cells()).map(|cell| basis.projected_solid_angle(cell)).sum();
            assert!((all - PI).abs() < 1e-12);
        }
    }

    #[test]
    fn klems_is_centred_and_polar_begins_on_the_axis() {
        let at = |degrees: f64| DVec2::from_angle(degrees.to_radians()) * 42f64.to_radians().sin();
        let klems = RingBasis::klems();
        assert_eq!([-7.4, 0.0, 7.4, 7.6, 352.4].map(|phi| klems.cell_of(at(phi))), [45, 45, 45, 46, 68]);
        let polar = RingBasis::polar(9, 36);
        assert_eq!([-0.1, 0.1, 9.9, 10.1].map(|phi| polar.cell_of(at(phi))), [4 * 36 + 35, 4 * 36, 4 * 36, 4 * 36 + 1]);
    }
}
