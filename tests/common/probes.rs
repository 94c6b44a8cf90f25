//! What calls of single functions of the kernel share.

use super::SplitMix;
use glam::DVec3;

/// Calls of one test.
pub const CALLS: usize = 1 << 14;

/// One rounding of an f32 near 1.
pub const ULP: f64 = 1.2e-7;

pub fn words(random: &mut SplitMix) -> [u32; 4] {
    [random.word(), random.word()].map(|word| [word as u32, (word >> 32) as u32]).concat().try_into().expect("four")
}

pub fn vector(words: [u32; 4]) -> DVec3 {
    DVec3::new(
        f64::from(f32::from_bits(words[0])),
        f64::from(f32::from_bits(words[1])),
        f64::from(f32::from_bits(words[2])),
    )
}

pub fn bits(v: DVec3, last: f32) -> [u32; 4] {
    [(v.x as f32).to_bits(), (v.y as f32).to_bits(), (v.z as f32).to_bits(), last.to_bits()]
}

/// The vector as f32 holds it.
pub fn rounded(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}
