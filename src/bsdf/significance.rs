//! Tails of the distributions that tests of equality need.

use statrs::function::beta::beta_reg;
use statrs::function::erf::{erfc, erfc_inv};
use statrs::function::gamma::gamma_ur;

/// Probability of a count at least as far in its tail as `a` of `n`, when each counts with probability `share`: twice the
/// smaller tail of the binomial, exact. Between whole numbers it goes on smoothly.
pub fn binomial_tail(a: f64, n: f64, share: f64) -> f64 {
    // P(X ≥ k) = I_share(k, n − k + 1).
    let at_least = |k: f64| if k <= 0.0 { 1.0 } else { beta_reg(k, n - k + 1.0, share) };
    let above = at_least(a);
    // Of the other tail, count the complement: small probabilities keep their digits.
    let below = if a >= n { 1.0 } else { beta_reg(n - a, a + 1.0, 1.0 - share) };
    (2.0 * above.min(below)).min(1.0)
}

/// Probability that a deviate of Student's law with `freedom` degrees of freedom lies at least `t` away.
pub fn student_tail(t: f64, freedom: f64) -> f64 {
    beta_reg(freedom / 2.0, 0.5, freedom / (freedom + t * t))
}

/// The number of standard deviations beyond which a normal deviate lies with this probability, on either side.
pub fn normal_quantile(probability: f64) -> f64 {
    std::f64::consts::SQRT_2 * erfc_inv(probability)
}

/// Probability that a normal deviate lies at least `z` standard deviations away.
pub fn normal_tail(z: f64) -> f64 {
    erfc(z.abs() / std::f64::consts::SQRT_2)
}

/// Probability that χ² with `freedom` degrees of freedom is at least `value`.
pub fn chi_square_tail(value: f64, freedom: usize) -> f64 {
    if freedom == 0 || value <= 0.0 { 1.0 } else { gamma_ur(freedom as f64 / 2.0, value / 2.0) }
}

/// Probability that the least of `tests` independent probabilities is at most `least` (Šidák 1967).
pub fn sidak(least: f64, tests: usize) -> f64 {
    if tests == 0 { 1.0 } else { -(tests as f64 * (-least.min(1.0 - 1e-16)).ln_1p()).exp_m1() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_have_their_closed_forms() {
        // Ten heads of ten: 2·2⁻¹⁰; five of ten: all.
        assert!((binomial_tail(10.0, 10.0, 0.5) - 2f64.powi(-9)).abs() < 1e-15);
        assert!((binomial_tail(0.0, 10.0, 0.5) - 2f64.powi(-9)).abs() < 1e-15);
        assert_eq!(binomial_tail(5.0, 10.0, 0.5), 1.0);
        // One of three at a share of 1/4 and more: 1 − (3/4)³ = 37/64; at most one: 54/64.
        assert!((binomial_tail(1.0, 3.0, 0.25) - 1.0).abs() < 1e-12);
        assert!((binomial_tail(3.0, 3.0, 0.25) - 2.0 / 64.0).abs() < 1e-15);
        assert!((normal_tail(1.959_963_984_540_054) - 0.05).abs() < 1e-9);
        assert!((normal_quantile(0.05) - 1.959_963_984_540_054).abs() < 1e-9);
        // One degree of freedom is Cauchy's law, many are the normal one.
        assert!((student_tail(1.0, 1.0) - 0.5).abs() < 1e-12);
        assert!((student_tail(1.959_963_984_540_054, 1e7) - 0.05).abs() < 1e-6);
        // Two degrees of freedom: exp(−x/2).
        assert!((chi_square_tail(8.0, 2) - (-4f64).exp()).abs() < 1e-12);
        assert!((sidak(0.01, 2) - (1.0 - 0.99 * 0.99)).abs() < 1e-15);
        assert!((sidak(1e-18, 1000) / 1e-15 - 1.0).abs() < 1e-9);
    }
}
