//! What is known of the error of a medium before it is tried: measurements on the cloths of docs/medium.md.

use crate::scene::{Packing, Scene, Structure};

/// Edge, in radii of the thinnest fiber, at which the error of cells is told.
const USUAL_EDGE: f64 = 2.0;
/// E grows with this power of the edge: by 1.5 to 2 from 2 to 4 radii and by 3.4 to 4 to 8. Below the usual edge it falls as fast for
/// filaments, to 0.72 of it at 1.4 radii, and hardly for spun yarns, whose directions are the coarser ones.
const POWER: f64 = 0.9;
const POWER_OF_SPUN: f64 = 0.3;

/// E², its mean and its standard deviation over cloths of a class, as shares of the scattered light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belief {
    /// E of the default medium at the usual edge.
    pub error: f64,
    /// Its standard deviation.
    pub spread: f64,
    /// Whether it is of spun yarns.
    pub spun: bool,
}

impl Belief {
    /// Of a cloth that nobody has tried: E of the medium of its placement with first hits on fibers, at the usual edge.
    pub fn of(scene: &Scene) -> Belief {
        // Of a homogeneous sheet there are no cells to be coarse: E is at most 1.1 % in boxes of overlapping fibers.
        if let Structure::Sheet(_) = &scene.structure {
            return Belief { error: 0.005, spread: 0.005, spun: false };
        }
        let untwisted = scene.structure.untwisted();
        let absorbing = !scene.channels.lossless() && scene.kinds().len() > 1;
        let (error, spread) = match (absorbing, untwisted, scene.model.packing) {
            // Where dark and light yarns meet: denim, dimout.
            (true, ..) => (0.065, 0.010),
            // Filaments without twist: charmeuse, lining.
            (_, true, _) => (0.045, 0.010),
            (_, _, Packing::Separate) => (0.035, 0.015),
            // Spun yarns: gabardine, jersey, linen, muslin, rib, sheer, voile.
            (_, false, Packing::Random) => (0.028, 0.008),
        };
        Belief { error, spread, spun: !untwisted }
    }

    /// What E at another edge is, in units of that at the usual one.
    pub fn growth(&self, edge: f64) -> f64 {
        let ratio = edge / USUAL_EDGE;
        ratio.powf(if self.spun && ratio < 1.0 { POWER_OF_SPUN } else { POWER })
    }

    /// The belief after E² was found to be `square` ± `error` at some edge. Squares are averaged, weighted by their precision.
    pub fn after(self, square: f64, error: f64, edge: f64) -> Belief {
        let growth = self.growth(edge).powi(2);
        let (found, found_error) = (square / growth, error / growth);
        let (known, known_error) = (self.error.powi(2), 2.0 * self.error * self.spread);
        let weights = [1.0 / known_error.powi(2), 1.0 / found_error.powi(2)];
        let mean = ((known * weights[0] + found * weights[1]) / (weights[0] + weights[1])).max(0.0);
        let spread = 1.0 / (weights[0] + weights[1]).sqrt();
        // Near 0 the error of E is that which its square hides.
        let error = mean.sqrt();
        Belief { error, spread: (mean + spread).sqrt() - error, ..self }
    }

    /// At an edge: E and its standard deviation.
    pub fn at(self, edge: f64) -> Belief {
        let growth = self.growth(edge);
        Belief { error: self.error * growth, spread: self.spread * growth, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn precise_trials_outweigh_what_was_believed_and_coarse_ones_do_not() {
        let belief = Belief { error: 0.025, spread: 0.01, spun: true };
        let sure = belief.after(0.06f64.powi(2), 1e-5, 2.0);
        assert!((sure.error - 0.06).abs() < 1e-3 && sure.spread < 1e-3, "{sure:?}");
        let unsure = belief.after(0.06f64.powi(2), 1.0, 2.0);
        assert!((unsure.error - 0.025).abs() < 1e-4, "{unsure:?}");
        // What is found at another edge is brought to the usual one.
        let coarse = belief.after((0.06 * belief.growth(4.0)).powi(2), 1e-5, 4.0);
        assert!((coarse.error - 0.06).abs() < 1e-3, "{coarse:?}");
        let none = belief.after(-1e-3, 1e-5, 2.0);
        assert!(none.error < 1e-2 && none.spread > 0.0, "{none:?}");
    }
}
