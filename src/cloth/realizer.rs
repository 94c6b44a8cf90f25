//! Realizations of any cloth, one after the other.

use super::curves::Curve;
use super::draws::DrawnFor;
use super::realization::Realization;
use super::repeat::Cloth;
use super::separate::{LONGEST, Separation};
use super::web::Web;
use crate::error::Result;
use crate::scene::{Model, Packing, Scene, Structure};
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Most memory in bytes of the realizations that a realizer keeps.
const MOST_KEPT: usize = 1 << 30;

/// Most draws of separate fibers, of which one that succeeds is taken.
const ATTEMPTS: u64 = 3;

/// Draws realizations of a sheet, a weave or a knit.
#[derive(Clone, Debug)]
pub struct Realizer {
    element: Element,
    packing: Packing,
    seed: u64,
    drawn_for: DrawnFor,
    kept: Option<Arc<Mutex<Kept>>>,
}

/// Realizations that were drawn, by their numbers.
#[derive(Debug, Default)]
struct Kept {
    realizations: BTreeMap<u64, Arc<Realization>>,
    bytes: usize,
}

/// What is drawn from.
#[derive(Clone, Debug)]
enum Element {
    Yarns(Box<Cloth>),
    Web(Web),
}

impl Realizer {
    /// Lay out a scene, to draw realizations of its seed for a user.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) when a realization would have too many pieces, or the loops of a knit do not
    /// fit.
    pub fn new(scene: &Scene, packing: Packing, drawn_for: DrawnFor) -> Result<Realizer> {
        let element = match &scene.structure {
            Structure::Sheet(sheet) => Element::Web(Web::new(sheet, &scene.fibers)?),
            Structure::Weave(_) | Structure::Knit(_) => Element::Yarns(Box::new(Cloth::new(scene)?)),
        };
        Ok(Realizer { element, packing, seed: scene.model.seed, drawn_for, kept: None })
    }

    /// Of a cloth of yarns that is laid out, with the packing and the seed of a model.
    pub fn of_yarns(cloth: Cloth, model: &Model, drawn_for: DrawnFor) -> Realizer {
        let Model { packing, seed, .. } = *model;
        Realizer { element: Element::Yarns(Box::new(cloth)), packing, seed, drawn_for, kept: None }
    }

    /// The same cloth and what is kept of it, to draw for another user.
    pub fn for_user(&self, drawn_for: DrawnFor) -> Realizer {
        Realizer { drawn_for, ..self.clone() }
    }

    /// Draw a realization of separate fibers, which takes long, only once, and keep it for the next that asks this realizer or a
    /// clone of it, up to 1 GiB of them.
    pub fn keeping(self) -> Realizer {
        Realizer { kept: Some(Arc::default()), ..self }
    }

    /// The yarns that are laid out; none of a sheet.
    pub fn yarns(&self) -> Option<&Cloth> {
        match &self.element {
            Element::Yarns(cloth) => Some(cloth),
            Element::Web(_) => None,
        }
    }

    /// Straight pieces that a realization has, about.
    pub fn expected_pieces(&self) -> usize {
        match (&self.element, self.packing) {
            (Element::Yarns(cloth), _) => cloth.expected_pieces(),
            (Element::Web(web), Packing::Random) => web.expected_pieces(),
            (Element::Web(web), Packing::Separate) => web.expected_pieces().max(web.pieces_no_longer_than(LONGEST)),
        }
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

    /// Draw a realization, a function of the seed, the user and its number among those of the user.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) when fibers are to be separate and cannot be.
    pub fn draw(&self, number: u64) -> Result<Realization> {
        match self.packing {
            Packing::Random => Ok(self.lay(0, number)),
            Packing::Separate => {
                let Some(kept) = &self.kept else { return Ok(self.draw_separate(number)?.0) };
                let kept = || kept.lock().unwrap_or_else(PoisonError::into_inner);
                // Others may draw meanwhile: hold no lock.
                let key = self.drawn_for.number(number, 0);
                let known = kept().realizations.get(&key).cloned();
                if let Some(known) = known {
                    return Ok(Realization::clone(&known));
                }
                let drawn = self.draw_separate(number)?.0;
                kept().keep(key, &drawn);
                Ok(drawn)
            }
        }
    }

    /// Draw a realization with separate fibers, whatever the packing, and say how separate they are. Where all fibers but a few that
    /// are caught in each other have found room, they are laid anew, up to twice.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) with the overlap that is left when fibers are too dense.
    pub fn draw_separate(&self, number: u64) -> Result<(Realization, Separation)> {
        let (threads, mut attempt) = (self.yarns().is_some(), 0);
        loop {
            let mut realization = self.lay(attempt, number);
            let separation = realization.push_apart(threads);
            if separation.reached() {
                return Ok((realization, separation));
            }
            attempt += 1;
            if !separation.fills() || attempt == ATTEMPTS {
                return Err(realization.refusal(&separation, threads, attempt));
            }
        }
    }

    /// Lay fibers independently.
    fn lay(&self, attempt: u64, number: u64) -> Realization {
        let number = self.drawn_for.number(number, attempt);
        match &self.element {
            Element::Yarns(cloth) => cloth.draw(self.seed, number),
            Element::Web(web) => web.draw(self.seed, number),
        }
    }
}

impl Kept {
    /// Keep a realization while there is room.
    fn keep(&mut self, number: u64, drawn: &Realization) {
        let corners: usize = drawn.fibers.iter().map(|fiber| fiber.points.len()).sum();
        let bytes = corners * size_of::<DVec3>() + drawn.fibers.len() * size_of::<Curve>();
        if self.bytes + bytes <= MOST_KEPT && self.realizations.insert(number, Arc::new(drawn.clone())).is_none() {
            self.bytes += bytes;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, Source};

    #[test]
    fn separate_fibers_are_drawn_once_and_others_are_not_kept() {
        let source = Source::find("sheer").expect("it is a preset");
        let scene = Scene::parse(&source).expect("it is right");
        let keeping = |packing| Realizer::new(&scene, packing, DrawnFor::Medium).expect("it can be laid out").keeping();
        let kept = |realizer: &Realizer| {
            let kept = realizer.kept.as_ref().expect("it keeps").lock().expect("nobody failed");
            (kept.realizations.keys().copied().collect::<Vec<_>>(), kept.bytes)
        };
        let separate = keeping(Packing::Separate);
        let (first, before) = (separate.draw(3).expect("it is loose"), kept(&separate));
        assert_eq!(before.0, [3]);
        // A clone finds it, and it is the same; put another in its place to see that it is not drawn again.
        let shared = separate.clone();
        assert_eq!(shared.draw(3).expect("it is known"), first);
        let other = separate.draw(4).expect("it is loose");
        assert_ne!(other, first);
        if let Some(kept) = &separate.kept {
            kept.lock().expect("nobody failed").realizations.insert(3, Arc::new(other.clone()));
        }
        assert_eq!(shared.draw(3).expect("it is known"), other);
        assert_eq!(
            Realizer::new(&scene, Packing::Separate, DrawnFor::Medium)
                .and_then(|plain| plain.draw(3))
                .expect("it is loose"),
            first
        );
        let random = keeping(Packing::Random);
        random.draw(3).expect("nothing is refused");
        assert!(kept(&random).0.is_empty() && before.1 > 0);
    }

    #[test]
    fn fibers_that_are_caught_in_each_other_are_laid_anew() {
        // A weave of yarns that are nearly too full.
        let text = "[fiber.f]\nradius_um = 5\nior = 1.5\n[yarn.y]\nfiber = \"f\"\nfibers_per_ply = 19\nwidth_um = 50\n\
                    height_um = 50\nply_twist_per_m = 1000\n[weave]\ndraft = [\".X\", \"X.\"]\nwarp = [\"y\"]\nweft = [\"y\"]\n\
                    ends_per_cm = 130\npicks_per_cm = 130\n";
        let source = Source { file: "full.toml".into(), stem: "full".into(), text: text.into(), folder: None };
        let mut scene = Scene::parse(&source).expect("it is right");
        scene.model.seed = 0;
        let realizer = Realizer::new(&scene, Packing::Separate, DrawnFor::Medium).expect("it can be laid out");
        // In the first draw of this number two fibers are caught in each other.
        let mut first = realizer.lay(0, 5);
        assert!(!first.push_apart(true).reached());
        let (drawn, separation) = realizer.draw_separate(5).expect("there is room");
        assert!(separation.reached(), "{separation:?}");
        let mut anew = realizer.lay(1, 5);
        anew.push_apart(true);
        assert!(drawn == anew);
    }

    #[test]
    fn what_has_no_room_is_not_kept() {
        let scene = Scene::parse(&Source::find("sheer").expect("it is a preset")).expect("it is right");
        let realizer = Realizer::new(&scene, Packing::Random, DrawnFor::Medium).expect("it can be laid out");
        let drawn = realizer.draw(0).expect("nothing is refused");
        let mut kept = Kept { bytes: MOST_KEPT, ..Kept::default() };
        kept.keep(0, &drawn);
        assert!(kept.realizations.is_empty() && kept.bytes == MOST_KEPT);
    }
}
