//! Comparisons with a stated rate of false alarms.
//!
//! All gates are at 4 standard deviations of a normal variable: one false alarm in 16,000 (two-sided), and seeds are
//! fixed, so a test that passes goes on passing. Controls are sized to stand at 8 to 10.

/// Gate of every comparison.
pub const GATE: f64 = 4.0;

/// z of a count against its expected probability.
pub fn binomial_z(count: u64, walks: u64, probability: f64) -> f64 {
    let n = walks as f64;
    (count as f64 - n * probability) / (n * probability * (1.0 - probability)).sqrt()
}

/// Two-sample χ² of counts from equally many or different numbers of walks, as a standard normal z.
///
/// Cells with fewer than 25 counts in both together are pooled; χ² goes to z by Wilson and Hilferty.
pub fn two_sample_z(a: &[u64], a_walks: u64, b: &[u64], b_walks: u64) -> f64 {
    let (na, nb) = (a_walks as f64, b_walks as f64);
    let (mut pooled_a, mut pooled_b) = (0.0, 0.0);
    let mut cells: Vec<(f64, f64)> = Vec::new();
    for (&a, &b) in a.iter().zip(b) {
        let (a, b) = (a as f64, b as f64);
        if a + b < 25.0 {
            pooled_a += a;
            pooled_b += b;
        } else {
            cells.push((a, b));
        }
    }
    if pooled_a + pooled_b >= 25.0 {
        cells.push((pooled_a, pooled_b));
    }
    let chi2: f64 = cells.iter().map(|(a, b)| (a * (nb / na).sqrt() - b * (na / nb).sqrt()).powi(2) / (a + b)).sum();
    // Cells of a full partition lose one degree of freedom to the fixed totals.
    chi2_z(chi2, cells.len() as f64 - 1.0)
}

/// z of χ² with k degrees of freedom (Wilson and Hilferty 1931).
pub fn chi2_z(chi2: f64, k: f64) -> f64 {
    let spread = 2.0 / (9.0 * k);
    ((chi2 / k).cbrt() - (1.0 - spread)) / spread.sqrt()
}
