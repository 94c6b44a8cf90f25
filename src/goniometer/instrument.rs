//! The instrument: where light comes from, and the bin of every exit.

use super::basis::Basis;
use super::tally::{BinLayout, Outcome};
use crate::scene::{Incident, Measure, Side};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// The incident basis.
#[derive(Clone, Debug, PartialEq)]
pub enum Incidence {
    /// Cells; rays are uniform in projected solid angle inside their cell.
    Cells(Basis),
    /// Collimated directions, unit vectors to where the light comes from.
    Listed(Vec<DVec3>),
}

/// The instrument: lit sides × incident cells × exit cells.
///
/// A *start* is an incident cell of a lit side; start number = side·incident cells + cell, lit sides in their order.
#[derive(Clone, Debug, PartialEq)]
pub struct Goniometer {
    /// Where light comes from, on each lit side.
    pub incidence: Incidence,
    /// Where it is counted, by reflection and by transmission.
    pub exit: Basis,
    /// The lit sides, front first.
    pub sides: Vec<Side>,
}

impl Goniometer {
    /// The instrument that a scene asks for.
    pub fn new(measure: &Measure) -> Goniometer {
        let incidence = match &measure.incident {
            Incident::Cells(choice) => Incidence::Cells(Basis::new(*choice)),
            Incident::List(angles) => {
                Incidence::Listed(angles.iter().map(|&[theta, phi]| from_angles(theta, phi)).collect())
            }
        };
        Goniometer { incidence, exit: Basis::new(measure.exit), sides: measure.sides.clone() }
    }

    /// Number of incident cells or listed directions of one side.
    pub fn incident_cells(&self) -> usize {
        match &self.incidence {
            Incidence::Cells(basis) => basis.cells(),
            Incidence::Listed(directions) => directions.len(),
        }
    }

    /// Number of starts.
    pub fn starts(&self) -> usize {
        self.sides.len() * self.incident_cells()
    }

    /// The cells that light comes from; none of listed directions.
    pub fn incident_basis(&self) -> Option<&Basis> {
        match &self.incidence {
            Incidence::Cells(basis) => Some(basis),
            Incidence::Listed(_) => None,
        }
    }

    /// The part that a start has in the mean over its lit side: its projected solid angle over π, of listed directions an equal one.
    pub fn weight(&self, start: usize) -> f64 {
        let cell = start % self.incident_cells();
        match &self.incidence {
            Incidence::Cells(basis) => basis.projected_solid_angle(cell) / PI,
            Incidence::Listed(directions) => 1.0 / directions.len() as f64,
        }
    }

    /// The lit side of a start.
    pub fn side(&self, start: usize) -> Side {
        self.sides[start / self.incident_cells()]
    }

    /// wi at a place of [0, 1]² inside the incident cell of a start; a listed direction is the same at every place.
    ///
    /// Light on the back comes from −z; its (x, y) are those of the same cell on the front.
    pub fn start_direction(&self, start: usize, place: DVec2) -> DVec3 {
        let cell = start % self.incident_cells();
        let wi = match &self.incidence {
            Incidence::Cells(basis) => basis.direction(cell, place),
            Incidence::Listed(directions) => directions[cell],
        };
        match self.side(start) {
            Side::Front => wi,
            Side::Back => wi.with_z(-wi.z),
        }
    }

    /// wi in the middle of the incident cell of a start.
    pub fn centre(&self, start: usize) -> DVec3 {
        self.start_direction(start, DVec2::splat(0.5))
    }

    /// θ from the lit side's normal, and φ from +x, of the middle of a start's incident cell, in radians.
    pub fn angles(&self, start: usize) -> [f64; 2] {
        let wi = self.centre(start);
        [wi.z.abs().min(1.0).acos(), wi.y.atan2(wi.x)]
    }

    /// How the bins of one start are laid out.
    pub fn layout(&self) -> BinLayout {
        BinLayout { exit_cells: self.exit.cells() }
    }

    /// The bin of a walk that left the sheet along `m`, or the lost bin when `m` is not a unit vector.
    ///
    /// The side is the sign of m_z; `touched` tells whether the light met a fiber.
    pub fn exit_bin(&self, lit: Side, m: DVec3, touched: bool) -> usize {
        let layout = self.layout();
        let square = m.length_squared();
        if !(square > 0.99 && square < 1.01) {
            return layout.outcome(Outcome::Lost);
        }
        if !touched {
            return layout.outcome(Outcome::Direct);
        }
        let cell = self.exit.cell_of(m.truncate());
        if (m.z > 0.0) == (lit == Side::Front) { layout.reflection(cell) } else { layout.transmission(cell) }
    }
}

/// The unit vector at polar angle θ and azimuth φ, in radians.
fn from_angles(theta: f64, phi: f64) -> DVec3 {
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::BasisChoice;

    fn disc(n: u32) -> Basis {
        Basis::new(BasisChoice::Disc(n))
    }

    #[test]
    fn what_is_not_a_direction_is_lost() {
        let incidence = Incidence::Cells(disc(2));
        let goniometer = Goniometer { incidence, exit: disc(4), sides: vec![Side::Front] };
        let lost = goniometer.layout().outcome(Outcome::Lost);
        assert_eq!(goniometer.exit_bin(Side::Front, DVec3::ZERO, true), lost);
        assert_eq!(goniometer.exit_bin(Side::Front, DVec3::splat(f64::NAN), true), lost);
        assert_eq!(goniometer.exit_bin(Side::Front, DVec3::new(0.0, 0.0, 1.2), false), lost);
        assert_eq!(goniometer.exit_bin(Side::Front, -DVec3::Z, false), goniometer.layout().outcome(Outcome::Direct));
    }

    #[test]
    fn the_back_is_lit_in_the_frame_of_the_front() {
        let incidence = Incidence::Cells(disc(4));
        let goniometer = Goniometer { incidence, exit: disc(4), sides: vec![Side::Front, Side::Back] };
        assert_eq!(goniometer.starts(), 32);
        let (front, back) = (goniometer.centre(5), goniometer.centre(16 + 5));
        assert_eq!(back, front.with_z(-front.z));
        assert_eq!(goniometer.angles(5), goniometer.angles(16 + 5));
        let up = goniometer.layout().transmission(goniometer.exit.cell_of(front.truncate()));
        assert_eq!(
            goniometer.exit_bin(Side::Back, front, true),
            up,
            "light from below that leaves upwards went through"
        );
    }
}
