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

/// Mean of n numbers and its standard error, from their sum and the sum of their squares.
pub fn mean_error(sum: f64, square: f64, n: f64) -> (f64, f64) {
    let mean = sum / n;
    (mean, ((square / n - mean * mean).max(0.0) / (n - 1.0)).sqrt())
}

/// z of two independent means with their standard errors.
pub fn means_z(a: (f64, f64), b: (f64, f64)) -> f64 {
    if a == b { 0.0 } else { (a.0 - b.0) / a.1.hypot(b.1) }
}

/// The largest |z| of several.
pub fn largest(z: &[f64]) -> f64 {
    z.iter().fold(0.0, |most, z| most.max(z.abs()))
}

/// Two-sample χ² of the counts of two partitions, and its degrees of freedom.
///
/// Cells with fewer than 25 counts in both together are pooled; the fixed totals take one degree of freedom.
pub fn two_sample_chi2(a: &[u64], a_walks: u64, b: &[u64], b_walks: u64) -> (f64, f64) {
    let (na, nb) = (a_walks as f64, b_walks as f64);
    let (few, mut cells): (Vec<_>, Vec<_>) =
        a.iter().zip(b).map(|(&a, &b)| (a as f64, b as f64)).partition(|(a, b)| a + b < 25.0);
    let pool = few.iter().fold((0.0, 0.0), |pool, cell| (pool.0 + cell.0, pool.1 + cell.1));
    if pool.0 + pool.1 >= 25.0 {
        cells.push(pool);
    }
    let chi2 = cells.iter().map(|(a, b)| (a * (nb / na).sqrt() - b * (na / nb).sqrt()).powi(2) / (a + b)).sum();
    (chi2, cells.len() as f64 - 1.0)
}

/// z of χ² with k degrees of freedom (Wilson and Hilferty 1931).
pub fn chi2_z(chi2: f64, k: f64) -> f64 {
    let spread = 2.0 / (9.0 * k);
    ((chi2 / k).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// Two tallies of independent walks, incident cell by incident cell, all bins, as a standard normal z.
pub fn two_tally_z(a: &fiberwalk::goniometer::Tally, b: &fiberwalk::goniometer::Tally) -> f64 {
    assert_ne!(a.origin().seed, b.origin().seed, "tallies of the same seed are not independent");
    let (mut chi2, mut freedom) = (0.0, 0.0);
    for cell in 0..a.starts() {
        let (part, k) =
            two_sample_chi2(a.of_start(cell), a.walks_per_incident(), b.of_start(cell), b.walks_per_incident());
        chi2 += part;
        freedom += k;
    }
    chi2_z(chi2, freedom)
}
