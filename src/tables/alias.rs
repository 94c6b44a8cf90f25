//! A packed alias table in integers: one 32-bit word an entry, and the tabulated probabilities are exact.
//!
//! Vose, "A Linear Algorithm for Generating Random Numbers with a Given Distribution", IEEE TSE 17(9), 1991.

/// An alias table of 2ᵏ entries for draws of one 32-bit word.
///
/// Weights are rounded to whole multiples of 2⁻³² of the total (largest remainders), and the table realises these
/// rounded weights exactly.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AliasTable {
    index_bits: u32,
    words: Vec<u32>,
}

impl AliasTable {
    /// Build the table. The weights must be finite, not negative, and not all zero; there is at least one.
    pub fn new(weights: &[f64]) -> AliasTable {
        let size = weights.len().next_power_of_two().max(2);
        let index_bits = size.trailing_zeros();
        let slot = 1u64 << (32 - index_bits);
        let mut mass = quantise(weights, size);
        let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..size).partition(|&i| mass[i] < slot);
        let mut words: Vec<u32> = (0..size).map(|i| pack(index_bits, i, 0)).collect();
        while let Some(low) = small.pop() {
            // Fill the slot of a light entry from a heavy one; integers leave no remainder.
            let Some(&high) = large.last() else { unreachable!("the masses add up to the slots") };
            words[low] = pack(index_bits, high, mass[low]);
            mass[high] -= slot - mass[low];
            if mass[high] < slot {
                large.pop();
                small.push(high);
            }
        }
        AliasTable { index_bits, words }
    }

    /// k: the number of high bits of a draw that choose the slot.
    pub fn index_bits(&self) -> u32 {
        self.index_bits
    }

    /// One word a slot: the alias index in the high k bits, the threshold in the rest.
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    /// The probability of each entry, padding included.
    pub fn probabilities(&self) -> Vec<f64> {
        let bits = 32 - self.index_bits;
        let mut owned = vec![0u64; self.words.len()];
        for (slot, word) in self.words.iter().enumerate() {
            let threshold = u64::from(word & (u32::MAX >> self.index_bits));
            owned[slot] += threshold;
            owned[(word >> bits) as usize] += (1u64 << bits) - threshold;
        }
        owned.into_iter().map(|owned| owned as f64 * 2f64.powi(-32)).collect()
    }

    /// The entry that a uniform word draws.
    pub fn draw(&self, word: u32) -> usize {
        let slot = (word >> (32 - self.index_bits)) as usize;
        let low = u32::MAX >> self.index_bits;
        let packed = self.words[slot];
        if word & low < packed & low { slot } else { (packed >> (32 - self.index_bits)) as usize }
    }
}

fn pack(index_bits: u32, alias: usize, threshold: u64) -> u32 {
    (alias as u32) << (32 - index_bits) | threshold as u32
}

/// Round weights to integers that add up to 2³², by largest remainders; padding gets none.
fn quantise(weights: &[f64], size: usize) -> Vec<u64> {
    let total: f64 = weights.iter().sum();
    let exact: Vec<f64> = weights.iter().map(|weight| weight / total * 2f64.powi(32)).collect();
    let mut mass: Vec<u64> = exact.iter().map(|value| value.floor() as u64).collect();
    let mut missing = (1i64 << 32) - mass.iter().sum::<u64>() as i64;
    let mut order: Vec<usize> = (0..weights.len()).filter(|&i| weights[i] > 0.0).collect();
    order.sort_by(|&i, &j| exact[j].fract().total_cmp(&exact[i].fract()).then(i.cmp(&j)));
    for &i in order.iter().cycle() {
        if missing == 0 {
            break;
        }
        mass[i] = mass[i].saturating_add_signed(missing.signum());
        missing -= missing.signum();
    }
    mass.resize(size, 0);
    mass
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Add up what each entry owns over all slots, in units of 2⁻³².
    fn owned(table: &AliasTable, count: usize) -> Vec<u64> {
        let slot = 1u64 << (32 - table.index_bits());
        let mut owned = vec![0; count];
        for (i, word) in table.words().iter().enumerate() {
            let threshold = u64::from(word & (u32::MAX >> table.index_bits()));
            if threshold > 0 {
                owned[i] += threshold;
            }
            owned[(word >> (32 - table.index_bits())) as usize] += slot - threshold;
        }
        owned
    }

    #[test]
    fn every_entry_owns_its_weight_to_one_part_in_four_billion() {
        for weights in [vec![1.0], vec![3.0, 0.0, 1.0], vec![1.0; 1024], (0..777).map(|i| f64::from(i % 13)).collect()]
        {
            let table = AliasTable::new(&weights);
            let total: f64 = weights.iter().sum();
            for (weight, owned) in weights.iter().zip(owned(&table, weights.len())) {
                let error = owned as f64 - weight / total * 2f64.powi(32);
                assert!(error.abs() <= 1.0, "weight {weight}: off by {error}·2⁻³²");
                assert!(*weight > 0.0 || owned == 0, "a weight of zero is drawn");
            }
            let exact: Vec<f64> =
                owned(&table, table.words().len()).iter().map(|o| *o as f64 * 2f64.powi(-32)).collect();
            assert_eq!(table.probabilities(), exact);
        }
    }

    #[test]
    fn draws_follow_the_weights() {
        let weights = [5.0, 0.0, 2.0, 1.0, 0.5];
        let table = AliasTable::new(&weights);
        let mut counts = [0u32; 5];
        let steps = 1u32 << 16;
        for i in 0..steps {
            counts[table.draw(i << 16 | 0x8000)] += 1;
        }
        for (weight, count) in weights.iter().zip(counts) {
            let expected = weight / 8.5 * f64::from(steps);
            assert!((f64::from(count) - expected).abs() <= 8.0, "{count} for {expected}");
        }
    }
}
