//! Kinds of fiber.

use crate::scene::Scene;

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
    /// The kinds that the cloth of a scene has, in the order of [`Scene::kinds`].
    pub fn of_scene(scene: &Scene) -> Vec<Kind> {
        let kinds = scene.kinds().into_iter().zip(&scene.channels.absorption);
        kinds
            .map(|(kind, absorption)| {
                let fiber = &scene.fibers[kind];
                Kind { radius: fiber.radius, ior: fiber.ior, absorption: absorption.clone() }
            })
            .collect()
    }

    /// The channels that kinds of fiber absorb in; none when no fiber absorbs in any.
    pub fn channels(kinds: &[Kind]) -> Option<usize> {
        let absorbing = kinds.iter().flat_map(|kind| &kind.absorption).any(|sigma| *sigma > 0.0);
        absorbing.then(|| kinds[0].absorption.len())
    }

    /// The least absorption of any channel, in 1/mm.
    pub fn clearest(&self) -> f64 {
        self.absorption.iter().copied().fold(f64::INFINITY, f64::min)
    }
}
