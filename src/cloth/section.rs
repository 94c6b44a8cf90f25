//! Places of fibers in the section of a yarn.

use crate::scene::{Fiber, Yarn};
use glam::DVec2;
use rand::seq::SliceRandom;
use rand::{Rng, RngExt};
use std::f64::consts::TAU;

/// A fiber of a yarn, by its place in the unit disc.
#[derive(Clone, Copy, Debug)]
pub struct Strand {
    /// Index of its kind in the scene.
    pub kind: usize,
    /// Azimuth of its ply's centre where the yarn starts, in radians.
    ply: f64,
    /// Distance from its ply's centre.
    radius: f64,
    /// Azimuth about its ply's centre where the yarn starts, in radians.
    azimuth: f64,
}

/// The section of a yarn; lengths in mm, twists in radians per mm.
#[derive(Clone, Debug)]
pub struct Section {
    yarn: Yarn,
    /// Radius of each kind of fiber of the scene.
    radii: Vec<f64>,
    /// Radius of a ply in the unit disc.
    ply_radius: f64,
}

impl Section {
    /// The section of a yarn.
    pub fn new(yarn: &Yarn, fibers: &[Fiber]) -> Section {
        let radii = fibers.iter().map(|fiber| fiber.radius).collect();
        Section { yarn: yarn.clone(), radii, ply_radius: yarn.ply_radius() }
    }

    /// Radius of a kind of fiber in mm.
    pub fn radius(&self, kind: usize) -> f64 {
        self.radii[kind]
    }

    /// Radius of the thinnest fiber in mm.
    pub fn thinnest(&self) -> f64 {
        self.yarn.blend.iter().map(|&(kind, _)| self.radii[kind]).fold(f64::INFINITY, f64::min)
    }

    /// Largest |d²(place)/ds²| of any fiber in 1/mm.
    pub fn bend(&self) -> f64 {
        let largest = self.yarn.width.max(self.yarn.height) / 2.0 - self.thinnest();
        let (ply, own) = ((TAU * self.yarn.twist).powi(2), (TAU * self.yarn.ply_twist).powi(2));
        largest.max(0.0) * ((1.0 - self.ply_radius) * ply + self.ply_radius * own)
    }

    /// Draw the places of all fibers.
    pub fn draw(&self, rng: &mut impl Rng) -> Vec<Strand> {
        let mut kinds: Vec<usize> = Vec::with_capacity(self.yarn.fibers());
        for (kind, count) in self.yarn.counts() {
            kinds.resize(kinds.len() + count, kind);
        }
        kinds.shuffle(rng);
        let phase = TAU * rng.random::<f64>();
        let per_ply = self.yarn.fibers_per_ply as usize;
        let strand = |(place, kind): (usize, usize)| {
            let turn = (place / per_ply) as f64 / f64::from(self.yarn.plies);
            let radius = self.ply_radius * self.draw_radius(rng);
            Strand { kind, ply: phase + TAU * turn, radius, azimuth: TAU * rng.random::<f64>() }
        };
        kinds.into_iter().enumerate().map(strand).collect()
    }

    /// Distance from the centre of a ply, in ply radii: a place in the disc, accepted by the density there.
    fn draw_radius(&self, rng: &mut impl Rng) -> f64 {
        loop {
            let radius = rng.random::<f64>().sqrt();
            let Some(profile) = &self.yarn.radial_profile else { return radius };
            if rng.random::<f64>() < profile.density(radius) {
                return radius;
            }
        }
    }

    /// Place of a fiber in the section after a length of yarn, in mm: (left, up) for one who looks along the thread;
    /// left × up is its direction, so a positive twist makes a right-handed helix. `turn` is the angle in radians of the
    /// frame that the twist is counted against.
    pub fn place(&self, strand: &Strand, length: f64, turn: f64) -> DVec2 {
        let ply = (1.0 - self.ply_radius) * DVec2::from_angle(strand.ply + TAU * self.yarn.twist * length + turn);
        let own = strand.radius * DVec2::from_angle(strand.azimuth + TAU * self.yarn.ply_twist * length + turn);
        // The disc becomes the ellipse that keeps the fiber's surface inside.
        let inside = DVec2::new(self.yarn.width, self.yarn.height) / 2.0 - self.radii[strand.kind];
        inside.max(DVec2::ZERO) * (ply + own)
    }
}
