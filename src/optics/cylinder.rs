//! The encounter of a ray with an infinite circular cylinder.

use super::fresnel::reflectance;
use glam::DVec3;
use std::f64::consts::PI;

/// A ray that has hit a fiber, with everything that the closed form needs.
///
/// All lengths are in fiber radii. Azimuths are in the frame e1 = ((m·p)p − m)/|m×p|, e2 = m×p/|m×p| (paper §4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encounter {
    p: DVec3,
    e1: DVec3,
    e2: DVec3,
    axial: f64,
    transverse: f64,
    ior: f64,
    /// γi: azimuth of the outward normal at the hit, sin γi = α.
    pub azimuth: f64,
    refracted_azimuth: f64,
    /// F: the reflectance of every interface that this light meets.
    pub reflectance: f64,
}

impl Encounter {
    /// Set up the encounter of ray `m` with a fiber along `p`, hit at `offset` α ∈ (−1, 1).
    ///
    /// |m × p| must not be 0: such a ray hits no fiber.
    pub fn new(m: DVec3, p: DVec3, offset: f64, ior: f64) -> Encounter {
        let axial = m.dot(p);
        let across = m.cross(p);
        let transverse = across.length();
        let azimuth = offset.asin();
        // Refract in the cross-section: sin γt = α |m×p| / √(η² − (m·p)²).
        let bent = offset * transverse / (ior * ior - axial * axial).sqrt();
        Encounter {
            p,
            e1: (p * axial - m) / transverse,
            e2: across / transverse,
            axial,
            transverse,
            ior,
            azimuth,
            refracted_azimuth: bent.clamp(-1.0, 1.0).asin(),
            reflectance: reflectance(transverse * azimuth.cos(), ior),
        }
    }

    /// The number of chords k that a uniform number in (0, 1) draws; 0 is reflection at the surface.
    ///
    /// P(0) = F, P(k) = (1 − F)² F^(k−1): P(at least k) = (1 − F) F^(k−1) is held against 1 − number.
    pub fn chords(&self, number: f64) -> u64 {
        let rest = 1.0 - number;
        let entered = 1.0 - self.reflectance;
        if rest >= entered { 0 } else { 1 + ((rest / entered).ln() / self.reflectance.ln()) as u64 }
    }

    /// The direction in which light leaves after `chords` chords: its axial part stays (m·p)p.
    pub fn exit_direction(&self, chords: u64) -> DVec3 {
        let turn = 2.0 * self.azimuth + self.turn(chords);
        self.p * self.axial + (self.e1 * turn.cos() + self.e2 * turn.sin()) * self.transverse
    }

    /// Where light leaves after `chords` chords: azimuth on the surface, and shift along p from the hit, in radii.
    pub fn exit_point(&self, chords: u64) -> (f64, f64) {
        (self.azimuth + self.turn(chords), self.path_length(chords) * self.axial / self.ior)
    }

    /// Length of the way inside the fiber, in radii: each chord is 2 cos γt / √(1 − (m·p)²/η²).
    pub fn path_length(&self, chords: u64) -> f64 {
        let axial = self.axial / self.ior;
        chords as f64 * 2.0 * self.refracted_azimuth.cos() / (1.0 - axial * axial).sqrt()
    }

    /// Azimuth passed over by `chords` chords.
    fn turn(&self, chords: u64) -> f64 {
        chords as f64 * (PI - 2.0 * self.refracted_azimuth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chords_have_the_stated_probabilities() {
        let encounter = Encounter::new(-DVec3::Z, DVec3::new(0.6, 0.0, 0.8), 0.9, 1.5);
        let f = encounter.reflectance;
        let steps = 1_000_000;
        let mut counts = [0.0; 4];
        for i in 0..steps {
            let k = encounter.chords((f64::from(i) + 0.5) / f64::from(steps)) as usize;
            if k < counts.len() {
                counts[k] += 1.0 / f64::from(steps);
            }
        }
        let stated = [f, (1.0 - f).powi(2), (1.0 - f).powi(2) * f, (1.0 - f).powi(2) * f * f];
        for (k, (count, stated)) in counts.iter().zip(stated).enumerate() {
            assert!((count - stated).abs() < 3e-6, "k = {k}: {count} for {stated}");
        }
    }

    #[test]
    fn index_one_changes_nothing() {
        let m = DVec3::new(0.36, -0.48, -0.8);
        for offset in [-0.999, -0.3, 0.0, 0.7, 0.999_999_8] {
            let encounter = Encounter::new(m, DVec3::new(0.0, 0.6, 0.8), offset, 1.0);
            assert_eq!(encounter.chords(0.5), 1);
            assert!((encounter.exit_direction(1) - m).length() < 1e-9);
        }
    }
}
