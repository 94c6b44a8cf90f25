//! A smooth dielectric cylinder, in closed form and in f64, for the engines on the host.
//!
//! Computes: reflectance of an interface; direction, place and path length of light that leaves a fiber.
//!
//! Inputs: the ray m and the fiber direction p as unit vectors, the offset α in radii, the real refractive index.
//!
//! Differs from the paper: the approximating cylinder is infinitely long and smooth, and all its internal reflections
//! are summed in closed form (the lobes of Marschner et al., "Light Scattering from Human Hair Fibers", ACM TOG 22(3),
//! 2003) where the paper follows the ray.

mod cylinder;
mod fresnel;

pub use cylinder::{Encounter, Passage};
pub use fresnel::reflectance;
