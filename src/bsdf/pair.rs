//! The light of one pool in two tallies: whether it is enough to be tested, and how probable its difference is.

use super::significance::{binomial_tail, normal_tail};
use crate::goniometer::Moments;

/// Least number of walks that each tally is expected to have where light is tested.
const LEAST_COUNTED: f64 = 25.0;
/// Least effective number, (Σw)²/Σw², where walks have weights.
const LEAST_EFFECTIVE: f64 = 400.0;

/// One pool in both tallies.
pub(super) struct Pair {
    /// Walks, and their light in units of one walk's, both over their design effects.
    walks: [f64; 2],
    sums: [f64; 2],
    /// Whether walks are all or nothing in both.
    counted: bool,
    /// Mean weight and mean square of all walks.
    pub value: f64,
    pub square: f64,
}

impl Pair {
    /// So many walks of both with so much light, in units of theirs, and the design effects of its sum.
    pub fn new(walks: [u64; 2], light: [Moments; 2], units: [u64; 2], effects: [f64; 2]) -> Pair {
        let both = [0, 1];
        let total = (walks[0] + walks[1]).max(1) as f64;
        let sums = both.map(|i| light[i].sum as f64 / units[i] as f64);
        let squares = both.map(|i| light[i].square as f64 / (units[i] as f64).powi(2));
        Pair {
            walks: both.map(|i| walks[i] as f64 / effects[i]),
            sums: both.map(|i| sums[i] / effects[i]),
            counted: both.iter().all(|&i| light[i].square == light[i].sum * units[i]),
            value: (sums[0] + sums[1]) / total,
            square: (squares[0] + squares[1]) / total,
        }
    }

    /// What the smaller tally is expected to hold, over what is asked for.
    pub fn enough(&self) -> f64 {
        let fewer = self.walks[0].min(self.walks[1]);
        if self.value == 0.0 {
            0.0
        } else if self.counted {
            fewer * self.value.min(1.0 - self.value) / LEAST_COUNTED
        } else {
            fewer * self.value * self.value / self.square / LEAST_EFFECTIVE
        }
    }

    /// Whether it can be tested.
    pub fn tells(&self) -> bool {
        self.enough() >= 1.0
    }

    /// The share of A less that of B.
    fn difference(&self) -> f64 {
        self.sums[0] / self.walks[0] - self.sums[1] / self.walks[1]
    }

    /// Standard deviation of the difference if both are of the same light, as the test takes it.
    pub fn deviation(&self) -> f64 {
        let reciprocals: f64 = self.walks.iter().map(|walks| 1.0 / walks).sum();
        let variance =
            if self.counted { self.value.min(1.0 - self.value) } else { self.square - self.value * self.value };
        (variance * reciprocals).sqrt()
    }

    /// Probability of so large a difference.
    ///
    /// Counts: of the walks that both have here (or elsewhere, when that is the smaller number), each belongs to A with
    /// probability N_A/(N_A + N_B). Weights: the normal law with the variance of both together.
    pub fn probability(&self) -> f64 {
        if !self.counted {
            return normal_tail(self.difference() / self.deviation());
        }
        let counts = if self.value > 0.5 { [0, 1].map(|i| self.walks[i] - self.sums[i]) } else { self.sums };
        binomial_tail(counts[0], counts[0] + counts[1], self.walks[0] / (self.walks[0] + self.walks[1]))
    }
}

/// χ² of the cells and pools of some incoming light, no two of which hold the same light.
#[derive(Default)]
pub(super) struct ChiSquare {
    /// How many there are.
    pub cells: usize,
    /// Σ Δ²/⟨w²⟩, Σ Δ⟨w⟩/⟨w²⟩, Σ ⟨w⟩²/⟨w²⟩.
    sums: [f64; 3],
}

impl ChiSquare {
    /// Take in one of them.
    pub fn add(&mut self, pair: &Pair) {
        let (difference, Pair { value, square, .. }) = (pair.difference(), pair);
        self.cells += 1;
        let parts = [difference * difference, difference * value, value * value];
        self.sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part / square);
    }

    /// χ² = Δᵀ Σ⁻¹ Δ with Σ = (diag⟨w²⟩ − ⟨w⟩⟨w⟩ᵀ)(1/N_A + 1/N_B), inverted by Sherman and Morrison; and its degrees of
    /// freedom; of so many walks over their design effects.
    pub fn value(&self, walks: [f64; 2]) -> (f64, usize) {
        let [own, mixed, filled] = self.sums;
        let scale = 1.0 / (1.0 / walks[0] + 1.0 / walks[1]);
        let rest = 1.0 - filled;
        if self.cells == 0 {
            (0.0, 0)
        } else if rest * walks[0].min(walks[1]) < LEAST_COUNTED {
            // Next to nothing is left outside of these cells: their differences add up to 0.
            (own * scale, self.cells - 1)
        } else {
            ((own + mixed * mixed / rest) * scale, self.cells)
        }
    }
}
