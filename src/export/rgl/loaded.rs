//! A file as the loaders evaluate it.

use super::half::{bilinear, place};
use super::tensor::floats;
use super::warp::{Blend, Warp};
use crate::bsdf::Component;
use crate::colour::between;
use crate::export::fit::Loaded;
use crate::scene::Side;
use glam::{DVec2, DVec3};

/// The arrays of a file, and how its channels make those of the table.
pub struct Loader<'a> {
    phis: Vec<f64>,
    thetas: Vec<f64>,
    warp: Warp,
    /// Nodes along an edge of the values.
    n: usize,
    channels: usize,
    values: Vec<f32>,
    side: Side,
    back: &'a [Vec<f64>],
}

impl<'a> Loader<'a> {
    /// Read a file; none when it is not what `measured` loads.
    pub fn read(bytes: &[u8], side: Side, back: &'a [Vec<f64>]) -> Option<Loader<'a>> {
        let list = |name| Some(floats(bytes, name)?.1.into_iter().map(f64::from).collect::<Vec<_>>());
        let (shape, vndf) = floats(bytes, "vndf")?;
        let (values_shape, values) = floats(bytes, "rgb").or_else(|| floats(bytes, "spectra"))?;
        let (phis, thetas) = (list("phi_i")?, list("theta_i")?);
        let sound = shape[..2] == [phis.len(), thetas.len()] && values_shape[..2] == shape[..2];
        sound.then(|| Loader {
            warp: Warp::new(shape[2], &vndf),
            n: values_shape[3],
            channels: values_shape[2],
            values,
            phis,
            thetas,
            side,
            back,
        })
    }

    fn blend(&self, wi: DVec3) -> Blend {
        let theta = wi.truncate().length().atan2(wi.z);
        let phi = wi.y.atan2(wi.x);
        let mut blend = [(0, 0.0); 4];
        let pairs = between(&self.phis, phi)
            .into_iter()
            .flat_map(|(i, a)| between(&self.thetas, theta).into_iter().map(move |(j, b)| (i, j, a * b)));
        for (place, (i, j, share)) in blend.iter_mut().zip(pairs) {
            *place = (i * self.thetas.len() + j, share);
        }
        blend
    }

    /// f cos θo by channel of the file.
    fn eval(&self, wi: DVec3, wo: DVec3) -> Vec<f64> {
        let blend = self.blend(wi);
        let (sample, _) = self.warp.invert(&blend, place((wi + wo).normalize()));
        let size = self.n * self.n;
        let of = |channel: usize| {
            let at = |index: usize| {
                let value = |slice: usize| f64::from(self.values[(slice * self.channels + channel) * size + index]);
                blend.iter().map(|(slice, share)| if *share > 0.0 { share * value(*slice) } else { 0.0 }).sum::<f64>()
            };
            bilinear(self.n, sample, &at)
        };
        (0..self.channels).map(of).collect()
    }
}

impl Loaded for Loader<'_> {
    fn has(&self, side: Side, component: Component) -> bool {
        side == self.side && component == Component::Reflection
    }

    fn f(&self, _: Side, _: Component, wi: DVec2, wo: DVec2) -> Vec<f64> {
        let lift = |projection: DVec2| projection.extend((1.0 - projection.length_squared()).max(0.0).sqrt());
        let (wi, wo) = (lift(wi), lift(wo));
        let seen = self.eval(wi, wo);
        let shown = self.back.first().map_or(0, Vec::len);
        let sum = |to: usize| seen.iter().zip(self.back).map(|(value, back)| value * back[to]).sum::<f64>();
        (0..shown).map(|to| sum(to) / wo.z.max(1e-9)).collect()
    }
}
