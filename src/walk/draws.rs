//! The draw contract: how the 128 bits of one call feed one event. Shared by all engines, so that walks compare one by one.
//!
//! | word | bits | use |
//! |---|---|---|
//! | x | 32 | free path, −log((x + ½)·2⁻³²) |
//! | y | ⌈log₂ n⌉ high | entry of the alias table |
//! | y | the rest | alias threshold |
//! | z | 23 high | accept number, used again after acceptance for Fresnel and the number of chords |
//! | z | 9 low | jitter along the first coordinate of the entry's patch |
//! | w | 23 high | offset α |
//! | w | 9 low | jitter along the second coordinate |
//!
//! n is the number of entries of the cell's list. Of the call that starts a walk, x and y place it inside its incident cell,
//! z and w inside the repeat of the cloth.

use glam::DVec2;

/// The random numbers of one tentative event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventDraws {
    /// Distance to the tentative event in mean free paths, ≥ 0.
    pub free_path: f64,
    /// The word that chooses the table entry.
    pub entry: u32,
    /// Uniform in (0, 1): a tentative event is a collision when this is below |m × p| times the cell's share.
    pub accept: f64,
    /// Offset α of the ray from the fiber axis in radii, uniform in (−1, 1) (paper §4).
    pub offset: f64,
    /// Place inside the entry's patch, uniform in (0, 1)².
    pub jitter: DVec2,
}

impl EventDraws {
    /// Read the numbers of one event from the generator's words.
    pub fn new(words: [u32; 4]) -> EventDraws {
        let [x, y, z, w] = words;
        EventDraws {
            free_path: -((f64::from(x) + 0.5) * 2f64.powi(-32)).ln(),
            entry: y,
            accept: uniform(z),
            offset: 2.0 * uniform(w) - 1.0,
            jitter: DVec2::new(fine(z), fine(w)),
        }
    }
}

/// The place of a walk's start inside its incident cell, uniform in (0, 1)².
pub fn start_draws(words: [u32; 4]) -> DVec2 {
    DVec2::new(uniform(words[0]), uniform(words[1]))
}

/// The place on the lit face where a walk sets out, as shares of the repeat along x and y, uniform in (0, 1)².
pub fn start_place(words: [u32; 4]) -> DVec2 {
    DVec2::new(uniform(words[2]), uniform(words[3]))
}

/// (2k + 1)·2⁻²⁴ with k the 23 high bits: in the open interval, exact in f32 and in f64.
pub fn uniform(word: u32) -> f64 {
    f64::from((word >> 9) * 2 + 1) * 2f64.powi(-24)
}

/// (2k + 1)·2⁻¹⁰ with k the 9 low bits.
fn fine(word: u32) -> f64 {
    f64::from((word & 0x1ff) * 2 + 1) * 2f64.powi(-10)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniforms_stay_inside_the_open_interval() {
        for word in [0, 1, 0x1ff, u32::MAX] {
            let draws = EventDraws::new([word; 4]);
            assert!(draws.free_path >= 0.0 && draws.free_path.is_finite());
            assert!(draws.accept > 0.0 && draws.accept < 1.0);
            assert!(draws.offset > -1.0 && draws.offset < 1.0);
            assert!(draws.jitter.cmpgt(DVec2::ZERO).all() && draws.jitter.cmplt(DVec2::ONE).all());
        }
    }

    #[test]
    fn high_and_low_bits_of_a_word_feed_different_numbers() {
        let draws = EventDraws::new([0, 0, 0x1ff, 0xffff_fe00]);
        assert_eq!(draws.accept, 2f64.powi(-24));
        assert_eq!(draws.jitter.x, 1.0 - 2f64.powi(-10));
        assert_eq!(draws.offset, 1.0 - 2f64.powi(-23));
        assert_eq!(draws.jitter.y, 2f64.powi(-10));
    }
}
