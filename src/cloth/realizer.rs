//! Realizations of any cloth, one after the other.

use super::realization::Realization;
use super::repeat::Cloth;
use super::separate::Separation;
use super::web::Web;
use crate::error::Result;
use crate::scene::{Packing, Scene, Structure};
use glam::DVec2;

/// Seed of the fibers: they do not depend on the seed of the walks.
pub const SEED: u64 = 0;

/// Draws realizations of a sheet, a weave or a knit.
#[derive(Clone, Debug)]
pub struct Realizer {
    element: Element,
    packing: Packing,
}

/// What is drawn from.
#[derive(Clone, Debug)]
enum Element {
    Yarns(Box<Cloth>),
    Web(Web),
}

impl Realizer {
    /// Lay out a scene.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) when a realization would have too many pieces, or the loops of a knit do not
    /// fit.
    pub fn new(scene: &Scene, packing: Packing) -> Result<Realizer> {
        let element = match &scene.structure {
            Structure::Sheet(sheet) => Element::Web(Web::new(sheet, &scene.fibers)?),
            Structure::Weave(_) | Structure::Knit(_) => Element::Yarns(Box::new(Cloth::new(scene)?)),
        };
        Ok(Realizer { element, packing })
    }

    /// Of a cloth of yarns that is laid out.
    pub fn of_yarns(cloth: Cloth, packing: Packing) -> Realizer {
        Realizer { element: Element::Yarns(Box::new(cloth)), packing }
    }

    /// Size of the periodic element along x and y in mm.
    pub fn period(&self) -> DVec2 {
        match &self.element {
            Element::Yarns(cloth) => cloth.period(),
            Element::Web(web) => web.period(),
        }
    }

    /// The cloth fills 0 ≥ z ≥ −thickness, in mm.
    pub fn thickness(&self) -> f64 {
        match &self.element {
            Element::Yarns(cloth) => cloth.thickness(),
            Element::Web(web) => web.thickness(),
        }
    }

    /// Draw a realization, a function of its number alone.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) when fibers are to be separate and cannot be.
    pub fn draw(&self, number: u64) -> Result<Realization> {
        match self.packing {
            Packing::Random => Ok(self.lay(number)),
            Packing::Separate => Ok(self.draw_separate(number)?.0),
        }
    }

    /// Draw a realization with separate fibers, whatever the packing, and say how separate they are.
    ///
    /// # Errors
    /// Those of [`Realizer::draw`].
    pub fn draw_separate(&self, number: u64) -> Result<(Realization, Separation)> {
        let mut realization = self.lay(number);
        let separation = realization.separate()?;
        Ok((realization, separation))
    }

    /// Lay fibers independently.
    fn lay(&self, number: u64) -> Realization {
        match &self.element {
            Element::Yarns(cloth) => cloth.draw(SEED, number),
            Element::Web(web) => web.draw(SEED, number),
        }
    }
}
