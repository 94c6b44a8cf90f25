//! The factor of the rate that a placement of flights asks for, cell by cell.

use super::cells::Cell;
use super::sheet::{Bundle, SpecificLength};
use crate::error::{Error, Result};
use crate::scene::Placement;
use std::f64::consts::PI;

/// Separate fibers cannot fill more of a cell than this.
pub(super) const MAX_SEPARATE_FRACTION: f64 = 0.9;

impl SpecificLength {
    /// Share of each cell that is fiber, v = π Σ R² F = π ⟨R²F⟩/⟨RF⟩ Σ R F; `radius` gives R of a kind of fiber in mm.
    pub fn volume_fractions(&self, radius: impl Fn(usize) -> f64) -> Vec<f64> {
        let thickness = |list: &Vec<Bundle>| {
            let mean = |power: i32| list.iter().map(|b| radius(b.kind).powi(power) * b.length_density).sum::<f64>();
            PI * mean(2) / mean(1)
        };
        let thickness: Vec<f64> = self.lists.iter().map(thickness).collect();
        let fraction =
            |cell: &Cell| if cell.surface > 0.0 { cell.surface * thickness[cell.list as usize] } else { 0.0 };
        self.values.iter().map(fraction).collect()
    }

    /// Set the factors of a placement that follow from densities: 1/(1 − v) of separate fibers, and 1 where none is asked
    /// for. In a sheet nothing overlaps, so e = 1 and c = v.
    ///
    /// # Errors
    /// [`Error::Input`] when separate fibers cannot be so dense.
    pub fn place(&mut self, placement: Placement, radius: impl Fn(usize) -> f64) -> Result<()> {
        let separate = match placement {
            Placement::AtHit | Placement::Carried => false,
            Placement::CarriedDense => true,
            Placement::CarriedVoid => self.values.len() == 1,
        };
        let fractions = if separate { self.volume_fractions(radius) } else { vec![0.0; self.values.len()] };
        let fullest = (0..fractions.len()).max_by(|a, b| fractions[*a].total_cmp(&fractions[*b])).unwrap_or_default();
        // A sheet that is as full as the reader allows may be rounded upwards.
        if fractions[fullest] > MAX_SEPARATE_FRACTION * (1.0 + 1e-9) {
            return Err(Error::Input(format!(
                "fibers have up to {:.2} of the volume of a cell, so they overlap there, and placement \"{}\" is for \
                 separate fibers, at most {MAX_SEPARATE_FRACTION}; take placement \"carried-void\", \"carried\" or \
                 \"at-hit\"",
                fractions[fullest],
                placement.name()
            )));
        }
        for (cell, fraction) in self.values.iter_mut().zip(fractions) {
            cell.placement = 1.0 / (1.0 - fraction);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::concentric::Patch;
    use crate::distribution::{CellGrid, DirectionGrid};
    use glam::DVec2;

    /// Two kinds, of radius 0.01 and 0.02 mm, in two cells.
    fn cells(surfaces: [f64; 2]) -> SpecificLength {
        let patch = Patch { corner: DVec2::ZERO, extent: DVec2::ZERO };
        let bundle = |kind, length_density| Bundle { kind, patch, length_density };
        SpecificLength {
            grid: DirectionGrid { n: 4 },
            cells: CellGrid { counts: [2, 1, 1], period: DVec2::ONE, thickness: 1.0 },
            values: surfaces.map(|surface| Cell { surface, placement: 1.0, list: 0, centroid: Cell::MIDDLE }).to_vec(),
            lists: vec![vec![bundle(0, 6.0), bundle(1, 1.0)]],
            spread_error: 0.0,
        }
    }

    #[test]
    fn separate_fibers_have_their_volume_fraction() {
        // R F = 8 for F = 600 and 100: v = π (600·10⁻⁴ + 100·4·10⁻⁴).
        let (mut f, radius) = (cells([8.0, 0.0]), |kind| [0.01, 0.02][kind]);
        let v = PI * 0.1;
        assert!((f.volume_fractions(radius)[0] - v).abs() < 1e-12);
        f.place(Placement::CarriedDense, radius).expect("it is sparse");
        assert!((f.values[0].placement - 1.0 / (1.0 - v)).abs() < 1e-12);
        assert_eq!(f.values[1].placement, 1.0);
        f.place(Placement::Carried, radius).expect("it has no factor");
        assert_eq!(f.values[0].placement, 1.0);
    }

    #[test]
    fn fibers_that_must_overlap_are_refused_with_what_works() {
        let mut f = cells([24.0, 1.0]);
        let error = f.place(Placement::CarriedDense, |kind| [0.01, 0.02][kind]).expect_err("it is too dense");
        let text = error.to_string();
        assert!(text.contains("0.94") && text.contains("\"carried-void\", \"carried\" or \"at-hit\""), "{text}");
    }
}
