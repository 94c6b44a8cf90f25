//! What is known of the error of a medium before it is tried: measurements on the cloths of docs/medium.md.

use crate::scene::{Memory, Packing, Scene, Structure, dark_beside_light};

/// Edge, in radii of the thinnest fiber, at which the error of cells is told.
pub(super) const USUAL_EDGE: f64 = 4.0;

/// p of cells in spun yarns and in filaments.
const SPUN: f64 = 4.0;
const FILAMENTS: f64 = 3.0;
/// The same of fibers that were pushed apart.
const APART: [f64; 2] = [3.3, 2.5];

/// E² as shares of the scattered light: E² = floor² + cells² (edge/4)ᵖ. Cells that are cut where fibers end err by the square of their
/// edge, p = 4, in spun yarns; those of filaments, whose rims are sharp, by a little less, p = 3. The floor is that of directions
/// and of what the medium forgets. Both squares have means, variances and a covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belief {
    /// Means of floor² and cells².
    mean: [f64; 2],
    /// Their variances, and their covariance.
    variance: [f64; 2],
    covariance: f64,
    /// p.
    power: f64,
}

/// An error and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// E.
    pub error: f64,
    /// Its standard deviation; near 0 that which E² hides.
    pub spread: f64,
}

impl Belief {
    /// Of floor and cells, each with its standard deviation, and p.
    pub fn new(floor: [f64; 2], cells: [f64; 2], power: f64) -> Belief {
        let variance = |[error, spread]: [f64; 2]| (2.0 * error * spread).powi(2);
        Belief {
            mean: [floor[0].powi(2), cells[0].powi(2)],
            variance: [variance(floor), variance(cells)],
            covariance: 0.0,
            power,
        }
    }

    /// Of a cloth that nobody has tried: E of the medium of its placement with first hits on fibers.
    pub fn of(scene: &Scene) -> Belief {
        // Of a homogeneous sheet there are no cells to be coarse: E is at most 1.1 % in boxes of overlapping fibers, and that of
        // at-hit 5.8 % in the separate fibers of the nonwoven, which bend.
        if let Structure::Sheet(_) = &scene.structure {
            let floor = match scene.model.packing {
                Packing::Random => [0.005, 0.005],
                Packing::Separate => [0.058, 0.020],
            };
            return Belief::new(floor, [0.0, 0.0], SPUN);
        }
        let dark = dark_beside_light(&scene.fibers, &scene.kinds());
        let untwisted = scene.structure.untwisted();
        // Cells of separate fibers are not cut where fibers end.
        let (cells, power) = match (scene.model.packing, untwisted, dark) {
            // Gabardine, jersey, linen, muslin, rib, sheer, voile; charmeuse, lining.
            (Packing::Separate, false, _) => ([0.022, 0.010], APART[0]),
            (Packing::Separate, true, _) => ([0.080, 0.020], APART[1]),
            // Spun yarns: denim, gabardine, jersey, linen, muslin, rib, sheer, voile.
            (Packing::Random, false, _) => ([0.009, 0.002], SPUN),
            // Filaments without twist: charmeuse, lining.
            (Packing::Random, true, false) => ([0.024, 0.003], FILAMENTS),
            // Opaque ones beside others: dimout.
            (Packing::Random, true, true) => ([0.0145, 0.003], FILAMENTS),
        };
        let floor = match (scene.model.packing, scene.model.memory, untwisted, dark) {
            (Packing::Separate, _, false, _) => [0.025, 0.009],
            (Packing::Separate, _, true, _) => [0.080, 0.040],
            (Packing::Random, Memory::None, _, _) => [0.030, 0.008],
            (Packing::Random, Memory::Flight, false, _) => [0.0118, 0.0013],
            (Packing::Random, Memory::Flight, true, false) => [0.0138, 0.0011],
            (Packing::Random, Memory::Flight, true, true) => [0.021, 0.002],
        };
        Belief::new(floor, cells, power)
    }

    /// The belief after E² was found to be `square` ± `error` at some edge: the mean weighted by precision, of both parts.
    pub fn after(self, square: f64, error: f64, edge: f64) -> Belief {
        let growth = self.growth(edge);
        let Belief { mean, variance, covariance, power } = self;
        // What the found square tells of each part.
        let told = [variance[0] + growth * covariance, covariance + growth * variance[1]];
        let miss = square - mean[0] - growth * mean[1];
        let own = told[0] + growth * told[1];
        // A belief that what was found contradicts is worth as little as that makes it.
        let wider = if own > 0.0 { ((miss * miss - error * error) / own).max(1.0) } else { 1.0 };
        let (variance, covariance, told) =
            (variance.map(|part| wider * part), wider * covariance, told.map(|told| wider * told));
        let whole = wider * own + error * error;
        if whole <= 0.0 {
            return self;
        }
        let gain = told.map(|told| told / whole);
        Belief {
            mean: [0, 1].map(|part| (mean[part] + gain[part] * miss).max(0.0)),
            variance: [0, 1].map(|part| (variance[part] - gain[part] * told[part]).max(0.0)),
            covariance: covariance - gain[0] * told[1],
            power,
        }
    }

    /// E at an edge.
    pub fn at(self, edge: f64) -> Expected {
        let growth = self.growth(edge);
        let mean = self.mean[0] + growth * self.mean[1];
        let variance = self.variance[0] + 2.0 * growth * self.covariance + growth * growth * self.variance[1];
        let error = mean.sqrt();
        Expected { error, spread: (mean + variance.max(0.0).sqrt()).sqrt() - error }
    }

    /// How E² of cells grows with their edge, in units of that at the usual one.
    fn growth(self, edge: f64) -> f64 {
        (edge / USUAL_EDGE).powf(self.power)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn precise_trials_outweigh_what_was_believed_and_coarse_ones_do_not() {
        let belief = Belief::new([0.015, 0.005], [0.01, 0.005], SPUN);
        let sure = belief.after(0.06f64.powi(2), 1e-5, 2.0).at(2.0);
        assert!((sure.error - 0.06).abs() < 1e-3 && sure.spread < 1e-3, "{sure:?}");
        let unsure = belief.after(0.06f64.powi(2), 1.0, 2.0).at(2.0);
        assert!((unsure.error - belief.at(2.0).error).abs() < 1e-4, "{unsure:?}");
        let none = belief.after(-1e-3, 1e-5, 2.0).at(2.0);
        assert!(none.error < 1e-2 && none.spread > 0.0, "{none:?}");
    }

    #[test]
    fn what_is_found_at_two_edges_parts_cells_from_the_rest() {
        let truth = |edge: f64| 0.02f64.powi(2) + 0.03f64.powi(2) * (edge / 4.0).powi(3);
        let mut belief = Belief::new([0.015, 0.01], [0.02, 0.02], FILAMENTS);
        for edge in [2.0, 4.0, 8.0] {
            belief = belief.after(truth(edge), 1e-6, edge);
        }
        let found = [1.0, 3.0, 8.0].map(|edge| belief.at(edge).error);
        let expected = [1.0, 3.0, 8.0].map(|edge| truth(edge).sqrt());
        assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-4), "{found:?} {expected:?}");
        // A trial of coarse cells tells little of fine ones.
        let coarse = Belief::new([0.015, 0.005], [0.02, 0.01], FILAMENTS).after(truth(8.0), 1e-6, 8.0);
        assert!(coarse.at(2.0).spread > 10.0 * belief.at(2.0).spread);
    }
}
