//! Counter-based random numbers: Threefry4x32 with 13 rounds.
//!
//! Salmon, Moraes, Dror, Shaw, "Parallel Random Numbers: As Easy as 1, 2, 3", SC11, 2011. Adds, rotations and
//! exclusive-ors only, so WGSL and Rust agree bit for bit, and any walk can be replayed alone.

/// What a call of the generator is for: the last word of its counter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Purpose {
    /// One tentative event of a walk.
    Event = 0,
    /// The start direction of a walk inside its incident cell.
    Start = 1,
    /// Rounding of a walk's weights to fixed point.
    Exit = 2,
    /// Russian roulette of a walk.
    Roulette = 3,
    /// The realization that a walk goes on through.
    Realization = 4,
}

const ROUNDS: usize = 13;
const PARITY: u32 = 0x1BD1_1BDA;
const ROTATIONS: [(u32, u32); 8] = [(10, 26), (11, 21), (13, 27), (23, 5), (6, 20), (17, 11), (25, 10), (18, 20)];

/// Encrypt a counter with a key: Threefry4x32-13.
pub fn threefry(key: [u32; 4], counter: [u32; 4]) -> [u32; 4] {
    let schedule = [key[0], key[1], key[2], key[3], PARITY ^ key[0] ^ key[1] ^ key[2] ^ key[3]];
    let mut x = [0, 1, 2, 3].map(|i| counter[i].wrapping_add(schedule[i]));
    for round in 0..ROUNDS {
        // Mix neighbours in even rounds, across in odd ones.
        let (first, second) = if round % 2 == 0 { (1, 3) } else { (3, 1) };
        let (turn_first, turn_second) = ROTATIONS[round % 8];
        x[0] = x[0].wrapping_add(x[first]);
        x[first] = x[first].rotate_left(turn_first) ^ x[0];
        x[2] = x[2].wrapping_add(x[second]);
        x[second] = x[second].rotate_left(turn_second) ^ x[2];
        // Inject the key after each fourth round.
        if round % 4 == 3 {
            let injection = round / 4 + 1;
            for (i, word) in x.iter_mut().enumerate() {
                *word = word.wrapping_add(schedule[(injection + i) % 5]);
            }
            x[3] = x[3].wrapping_add(injection as u32);
        }
    }
    x
}

/// The 128 bits of one event of one walk.
///
/// Key = (seed low, seed high, 0, 0); counter = (walk low, walk high, event, purpose).
pub fn draw(seed: u64, walk: u64, event: u32, purpose: Purpose) -> [u32; 4] {
    let halves = |value: u64| [value as u32, (value >> 32) as u32];
    let [seed_low, seed_high] = halves(seed);
    let [walk_low, walk_high] = halves(walk);
    threefry([seed_low, seed_high, 0, 0], [walk_low, walk_high, event, purpose as u32])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threefry_gives_the_known_answers() {
        let ones = [u32::MAX; 4];
        assert_eq!(threefry([0; 4], [0; 4]), [0x531c_7e4f, 0x3949_1ee5, 0x2c85_5a92, 0x3d6a_bf9a]);
        assert_eq!(threefry(ones, ones), [0xc418_9358, 0x1c9c_c83a, 0xd588_1c67, 0x6a0a_89e0]);
        let counter = [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344];
        let key = [0xa409_3822, 0x299f_31d0, 0x082e_fa98, 0xec4e_6c89];
        assert_eq!(threefry(key, counter), [0x4aa7_1d8f, 0x7347_38c2, 0x431f_c6a8, 0xae6d_ebf1]);
    }

    #[test]
    fn every_word_of_seed_walk_event_and_purpose_has_its_own_place() {
        let plain = draw(1, 2, 3, Purpose::Event);
        let others = [
            draw(1 << 32, 2, 3, Purpose::Event),
            draw(1, 2 << 32, 3, Purpose::Event),
            draw(2, 1, 3, Purpose::Event),
            draw(1, 3, 2, Purpose::Event),
            draw(1, 2, 3, Purpose::Start),
            draw(1, 2, 1, Purpose::Event),
        ];
        for (i, other) in others.iter().enumerate() {
            assert_ne!(plain, *other, "variant {i} repeats the stream");
        }
    }
}
