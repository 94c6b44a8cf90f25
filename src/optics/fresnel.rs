//! Fresnel's law for unpolarised light.

/// Share of unpolarised light that a dielectric interface reflects, from outside at the cosine of incidence.
///
/// Fresnel's formulas for s and p polarisation, averaged; `ior` ≥ 1. By reversibility it is also the reflectance
/// from inside along the refracted direction.
pub fn reflectance(cos_incidence: f64, ior: f64) -> f64 {
    let cos_refraction = (ior * ior - 1.0 + cos_incidence * cos_incidence).sqrt() / ior;
    let s = (cos_incidence - ior * cos_refraction) / (cos_incidence + ior * cos_refraction);
    let p = (ior * cos_incidence - cos_refraction) / (ior * cos_incidence + cos_refraction);
    0.5 * (s * s + p * p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_brewster_and_grazing_have_their_known_values() {
        let ior: f64 = 1.55;
        let normal = ((ior - 1.0) / (ior + 1.0)).powi(2);
        assert!((reflectance(1.0, ior) - normal).abs() < 1e-15);
        // At Brewster's angle, tan θ = η, only s light is reflected.
        let brewster = ior.atan();
        let s = ((ior * ior - 1.0) / (ior * ior + 1.0)).powi(2);
        assert!((reflectance(brewster.cos(), ior) - 0.5 * s).abs() < 1e-12);
        assert!((reflectance(0.0, ior) - 1.0).abs() < 1e-12);
        assert!(reflectance(0.3, 1.0).abs() < 1e-15);
        assert!(reflectance(1e-8, 1.0).abs() < 1e-15);
    }
}
