//! The encounter of a ray with an infinite circular cylinder.

use super::fresnel::reflectance;
use glam::DVec3;
use std::f64::consts::PI;

/// How light left a fiber.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Unit vector.
    pub direction: DVec3,
    /// Length of the way inside, in radii.
    pub path: f64,
    /// Whether it left through a base and not through the side.
    pub through_base: bool,
    /// From where the ray met the fiber to where the light leaves it, in radii.
    pub displacement: DVec3,
}

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

    /// Let the light pass, in a cylinder whose bases lie `half_length` radii from the hit on both sides.
    ///
    /// `number` is uniform in (0, 1); it draws the number of chords, and what is left of it draws at which base the
    /// light leaves, if it does. A base that totally reflects turns the axial component round, and so does one that
    /// reflects by chance.
    pub fn pass(&self, number: f64, half_length: f64) -> Passage {
        let chords = self.chords(number);
        let path = self.path_length(chords);
        // Count the bases that the light would meet along its way.
        let along = path * self.axial.abs() / self.ior;
        let bases = ((along + half_length) / (2.0 * half_length)).floor();
        let sign = |bases: f64| if bases % 2.0 == 0.0 { 1.0 } else { -1.0 };
        let side = |sign: f64, along: f64| Passage {
            direction: self.exit_direction(chords, sign),
            path,
            through_base: false,
            displacement: self.rim(chords) - self.rim(0) + self.p * (along * self.axial.signum()),
        };
        if chords == 0 || half_length.is_infinite() || bases < 1.0 {
            return side(1.0, along);
        }
        // Fold the way along the axis between the bases that reflect.
        let folded = sign(bases) * (along - 2.0 * half_length * bases);
        let sine_square = self.ior * self.ior - self.axial * self.axial;
        if sine_square >= 1.0 {
            return side(sign(bases), folded);
        }
        // The rest of the number is uniform inside the interval that drew the chords.
        let f = self.reflectance;
        let inside = (1.0 - number) / ((1.0 - f) * f.powf(chords as f64 - 1.0));
        let left = ((inside - f) / (1.0 - f)).clamp(1e-12, 1.0);
        let base = reflectance((1.0 - sine_square).sqrt(), self.ior);
        let reflected = if base > 0.0 { (left.ln() / base.ln()).floor() } else { 0.0 };
        if reflected >= bases {
            return side(sign(bases), folded);
        }
        // Leave through base number `reflected` + 1: Snell at a plane keeps the transverse azimuth of that chord.
        let path = (2.0 * reflected + 1.0) * half_length * self.ior / self.axial.abs();
        let chord = (path / self.path_length(1)).ceil().max(1.0);
        let azimuth = PI + self.azimuth - self.refracted_azimuth + self.turn(chord as u64 - 1);
        let axial = (1.0 - sine_square).sqrt().copysign(self.axial) * sign(reflected);
        let transverse = (self.e1 * azimuth.cos() + self.e2 * azimuth.sin()) * sine_square.sqrt();
        // The base is met part of the way along that chord.
        let part = path / self.path_length(1) - (chord - 1.0);
        let inside = self.rim(chord as u64 - 1).lerp(self.rim(chord as u64), part);
        let shift = self.p * (half_length * self.axial.signum() * sign(reflected));
        Passage {
            direction: self.p * axial + transverse,
            path,
            through_base: true,
            displacement: inside - self.rim(0) + shift,
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

    /// The direction in which light leaves through the side after `chords` chords: its axial part is (m·p)p, times a
    /// `sign` of −1 when bases have turned it round an odd number of times.
    pub fn exit_direction(&self, chords: u64, sign: f64) -> DVec3 {
        let turn = 2.0 * self.azimuth + self.turn(chords);
        self.p * (self.axial * sign) + (self.e1 * turn.cos() + self.e2 * turn.sin()) * self.transverse
    }

    /// Where light leaves after `chords` chords: azimuth on the surface, and shift along p from the hit, in radii.
    pub fn exit_point(&self, chords: u64) -> (f64, f64) {
        (self.azimuth + self.turn(chords), self.path_length(chords) * self.axial / self.ior)
    }

    /// Where the light meets the surface after `chords` chords, off the axis, in radii.
    fn rim(&self, chords: u64) -> DVec3 {
        let azimuth = self.azimuth + self.turn(chords);
        self.e1 * azimuth.cos() + self.e2 * azimuth.sin()
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
    fn light_moves_as_its_path_says() {
        let (m, p) = (DVec3::new(0.36, -0.48, -0.8), DVec3::new(0.0, 0.6, 0.8));
        for (number, half_length) in [(0.01, 50.0), (0.6, 50.0), (0.999, 50.0), (0.6, 1.3), (0.999, 0.4), (0.99, 0.7)] {
            let encounter = Encounter::new(m, p, 0.3, 1.2);
            let start = encounter.rim(0);
            let passage = encounter.pass(number, half_length);
            let end = start + passage.displacement;
            let (along, across) = (end.dot(p), end - p * end.dot(p));
            if passage.through_base {
                assert!((along.abs() - half_length).abs() < 1e-9 && across.length() <= 1.0, "{end}");
            } else {
                assert!((across.length() - 1.0).abs() < 1e-9 && along.abs() <= half_length, "{end}");
                // It leaves outwards.
                assert!(passage.direction.dot(across) > 0.0);
            }
            // The straight way is no longer than the folded one.
            assert!(passage.displacement.length() <= passage.path + 1e-9);
        }
    }

    #[test]
    fn index_one_changes_nothing() {
        let m = DVec3::new(0.36, -0.48, -0.8);
        for offset in [-0.999, -0.3, 0.0, 0.7, 0.999_999_8] {
            let encounter = Encounter::new(m, DVec3::new(0.0, 0.6, 0.8), offset, 1.0);
            assert_eq!(encounter.chords(0.5), 1);
            assert!((encounter.exit_direction(1, 1.0) - m).length() < 1e-9);
        }
    }
}
