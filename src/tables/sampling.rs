//! The tables of a homogeneous sheet.

use super::alias::AliasTable;
use crate::concentric::Patch;
use crate::distribution::SpecificLength;
use crate::scene::Scene;

/// What every engine needs to know of the medium.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplingTables {
    /// Thickness of the sheet in mm; it fills 0 ≥ z ≥ −thickness.
    pub thickness: f64,
    /// Rate of tentative events, 2·Σ R F, in 1/mm: never below H(m).
    pub majorant: f64,
    /// Refractive index of the fiber, real.
    pub ior: f64,
    /// Fibers by weight R f.
    pub alias: AliasTable,
    /// The patch of directions of each entry of the alias table; padding repeats the first.
    pub patches: Vec<Patch>,
    /// Length of which every patch's extent is a whole multiple.
    pub patch_unit: f64,
}

impl SamplingTables {
    /// Build the tables of a sheet of one kind of fiber.
    pub fn new(scene: &Scene, specific_length: &SpecificLength) -> SamplingTables {
        let radius = |kind: usize| scene.fibers[kind].radius;
        let bundles = &specific_length.bundles;
        let weights: Vec<f64> = bundles.iter().map(|bundle| radius(bundle.kind) * bundle.length_density).collect();
        let alias = AliasTable::new(&weights);
        let mut patches: Vec<Patch> = bundles.iter().map(|bundle| bundle.patch).collect();
        patches.resize(alias.words().len(), bundles[0].patch);
        SamplingTables {
            thickness: scene.sheet.thickness,
            majorant: 2.0 * weights.iter().sum::<f64>(),
            ior: scene.fibers[bundles[0].kind].ior,
            alias,
            patches,
            patch_unit: specific_length.grid.unit(),
        }
    }

    /// Majorant optical depth of the sheet along its normal.
    pub fn depth(&self) -> f64 {
        self.majorant * self.thickness
    }
}
