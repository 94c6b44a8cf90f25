//! Places of fibers in the section of a yarn.

use super::rim::Rim;
use crate::scene::{Fiber, Flyaways, Yarn};
use glam::DVec2;
use rand::seq::SliceRandom;
use rand::{Rng, RngExt};
use std::f64::consts::TAU;

/// A fiber of a yarn, by its place in its ply.
#[derive(Clone, Copy, Debug)]
pub struct Strand {
    /// Index of its kind in the scene.
    pub kind: usize,
    /// Azimuth of its ply's centre where the yarn starts, in radians.
    ply: f64,
    /// Distance from its ply's centre, 0 to 1 at the rim of the ply; of a fiber that migrates, the one that its shares are of.
    radius: f64,
    /// Azimuth about its ply's centre where the yarn starts, in radians.
    azimuth: f64,
    /// Phase of its migration where the yarn starts, in radians.
    phase: f64,
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
        self.radii[self.thinnest_kind()]
    }

    /// The kind of the thinnest fiber.
    pub fn thinnest_kind(&self) -> usize {
        let kinds = self.yarn.blend.iter().map(|&(kind, _)| kind);
        kinds.min_by(|&a, &b| self.radii[a].total_cmp(&self.radii[b])).unwrap_or_default()
    }

    /// Fibers outside of the section, if there are any.
    pub fn flyaways(&self) -> Option<&Flyaways> {
        self.yarn.flyaways.as_ref()
    }

    /// The ellipse of the outermost fibers of a kind.
    pub fn rim(&self, kind: usize) -> Rim {
        Rim { half: self.inside(kind) }
    }

    /// Turns of the outermost fibers about the yarn per mm, in radians.
    pub fn surface_twist(&self) -> f64 {
        TAU * ((1.0 - self.ply_radius) * self.yarn.twist + self.ply_radius * self.yarn.ply_twist)
    }

    /// Largest |d(place)/ds| of any fiber.
    pub fn drift(&self) -> f64 {
        let (ply, own) = (TAU * self.yarn.twist.abs(), TAU * self.yarn.ply_twist.abs());
        let ([swing, rate], [ring, largest]) = (self.swing(), self.largest());
        ring * ply + largest * (own + swing * rate)
    }

    /// Largest |d²(place)/ds²| of any fiber in 1/mm.
    pub fn bend(&self) -> f64 {
        let (ply, own) = ((TAU * self.yarn.twist).powi(2), (TAU * self.yarn.ply_twist).powi(2));
        // Of r e^{iws} (m + a cos ks) it is at most r (m w² + a ((w + k)² + (w − k)²)/2) = r ((m + a) w² + a k²).
        let ([swing, rate], [ring, largest]) = (self.swing(), self.largest());
        ring * ply + largest * (own + swing * rate.powi(2))
    }

    /// Largest distance of a ply's centre from the middle of the yarn, and of an axis from its ply's centre, in mm.
    fn largest(&self) -> [f64; 2] {
        [self.ring().max_element(), self.room(self.thinnest_kind()).max_element()]
    }

    /// Amplitude of the migration in shares of the fiber's distance from its ply's centre, and its rate in radians per mm.
    fn swing(&self) -> [f64; 2] {
        self.yarn.migration.map_or([0.0; 2], |migration| {
            let [low, high] = migration.radius;
            [(high - low) / 2.0, TAU * self.yarn.ply_twist.abs() * migration.periods_per_turn]
        })
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
            let radius = self.draw_radius(rng);
            let azimuth = TAU * rng.random::<f64>();
            // A yarn without migration takes no number for it.
            let swing = self.yarn.migration.map_or(0.0, |_| TAU * rng.random::<f64>());
            Strand { kind, ply: phase + TAU * turn, radius, azimuth, phase: swing }
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

    /// A kind of fiber, by its share of the number of fibers.
    pub fn draw_kind(&self, rng: &mut impl Rng) -> usize {
        let mut left = rng.random::<f64>();
        let blend = &self.yarn.blend;
        let drawn = blend.iter().find(|(_, share)| {
            left -= share;
            left < 0.0
        });
        drawn.or(blend.last()).map_or(0, |(kind, _)| *kind)
    }

    /// Place of a fiber in the section after a length of yarn, in mm: (left, up) for one who looks along the thread;
    /// left × up is its direction, so a positive twist makes a right-handed helix. `turn` is the angle in radians of the
    /// frame that the twist is counted against.
    pub fn place(&self, strand: &Strand, length: f64, turn: f64) -> DVec2 {
        let [ply, own] = self.turned(strand, length, turn);
        self.ring() * ply + self.room(strand.kind) * own
    }

    /// Place of a fiber in the unit disc that the section is made of, after a length of yarn.
    pub fn disc(&self, strand: &Strand, length: f64, turn: f64) -> DVec2 {
        let [ply, own] = self.turned(strand, length, turn);
        (1.0 - self.ply_radius) * ply + self.ply_radius * own
    }

    /// Direction of a fiber's ply from the middle of the yarn, a unit vector, and its place in the ply, a unit disc.
    fn turned(&self, strand: &Strand, length: f64, turn: f64) -> [DVec2; 2] {
        let ply = DVec2::from_angle(strand.ply + TAU * self.yarn.twist * length + turn);
        let turned = TAU * self.yarn.ply_twist * length;
        let radius = match &self.yarn.migration {
            None => strand.radius,
            Some(migration) => strand.radius * migration.share(strand.phase + migration.periods_per_turn * turned),
        };
        [ply, radius * DVec2::from_angle(strand.azimuth + turned + turn)]
    }

    /// Semi-axes of the section in mm.
    fn half(&self) -> DVec2 {
        DVec2::new(self.yarn.width, self.yarn.height) / 2.0
    }

    /// Semi-axes of the ellipse that the plies' centres lie on in mm.
    fn ring(&self) -> DVec2 {
        (1.0 - self.ply_radius) * self.half()
    }

    /// Semi-axes of the ellipse about its ply's centre that the axis of a fiber of this kind lies in, in mm: its surface is in
    /// the ply.
    fn room(&self, kind: usize) -> DVec2 {
        (self.ply_radius * self.half() - self.radii[kind]).max(DVec2::ZERO)
    }

    /// Semi-axes of the ellipse of the axes of the outermost fibers of this kind in mm.
    fn inside(&self, kind: usize) -> DVec2 {
        (self.half() - self.radii[kind]).max(DVec2::ZERO)
    }
}
