//! The tables of a homogeneous sheet.

use super::alias::AliasTable;
use crate::concentric::Patch;
use crate::distribution::SpecificLength;
use crate::scene::{Scene, Sheet};

/// A kind of fiber, as the engines see it.
#[derive(Clone, Debug, PartialEq)]
pub struct Kind {
    /// Radius in mm.
    pub radius: f64,
    /// Refractive index, real.
    pub ior: f64,
    /// Absorption in 1/mm by channel.
    pub absorption: Vec<f64>,
}

impl Kind {
    /// The least absorption of any channel, in 1/mm.
    pub fn clearest(&self) -> f64 {
        self.absorption.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// What every engine needs to know of the medium.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplingTables {
    /// Thickness of the sheet in mm; it fills 0 ≥ z ≥ −thickness.
    pub thickness: f64,
    /// Rate of tentative events, 2·Σ R F, in 1/mm: never below H(m).
    pub majorant: f64,
    /// Kinds of fiber, at least one.
    pub kinds: Vec<Kind>,
    /// Half the length of the approximating cylinder in radii; infinite for no bases.
    pub half_length: f64,
    /// Fibers by weight R f.
    pub alias: AliasTable,
    /// The patch of directions of each entry of the alias table; padding repeats the first.
    pub patches: Vec<Patch>,
    /// The kind of fiber of each entry, an index of `kinds`.
    pub entry_kinds: Vec<u8>,
    /// Length of which every patch's extent is a whole multiple.
    pub patch_unit: f64,
}

impl SamplingTables {
    /// Build the tables of a scene's sheet.
    pub fn new(scene: &Scene, sheet: &Sheet, specific_length: &SpecificLength) -> SamplingTables {
        let used = scene.kinds();
        let kinds: Vec<Kind> = used
            .iter()
            .zip(&scene.channels.absorption)
            .map(|(&kind, absorption)| {
                let fiber = &scene.fibers[kind];
                Kind { radius: fiber.radius, ior: fiber.ior, absorption: absorption.clone() }
            })
            .collect();
        let bundles = &specific_length.bundles;
        let place = |kind: usize| used.iter().position(|&known| known == kind).unwrap_or_default();
        let weights: Vec<f64> =
            bundles.iter().map(|bundle| kinds[place(bundle.kind)].radius * bundle.length_density).collect();
        let alias = AliasTable::new(&weights);
        let size = alias.words().len();
        let mut patches: Vec<Patch> = bundles.iter().map(|bundle| bundle.patch).collect();
        let mut entry_kinds: Vec<u8> = bundles.iter().map(|bundle| place(bundle.kind) as u8).collect();
        patches.resize(size, patches[0]);
        entry_kinds.resize(size, entry_kinds[0]);
        SamplingTables {
            thickness: sheet.thickness,
            majorant: 2.0 * weights.iter().sum::<f64>(),
            kinds,
            half_length: scene.model.length_over_radius / 2.0,
            alias,
            patches,
            entry_kinds,
            patch_unit: specific_length.grid.unit(),
        }
    }

    /// Majorant optical depth of the sheet along its normal.
    pub fn depth(&self) -> f64 {
        self.majorant * self.thickness
    }

    /// Channels that have to be told apart: one when no fiber absorbs.
    pub fn channels(&self) -> usize {
        if self.absorbing() { self.kinds[0].absorption.len() } else { 1 }
    }

    /// Whether any fiber absorbs in any channel.
    pub fn absorbing(&self) -> bool {
        self.kinds.iter().flat_map(|kind| &kind.absorption).any(|sigma| *sigma > 0.0)
    }
}
