//! Where one looks from.

use crate::cloth::{Cloth, System};
use glam::{DVec2, DVec3};

/// A face of the cloth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// Seen from +z: x to the right, y up.
    Front,
    /// Seen from −z when the cloth is turned about the warp: y is still up, and x runs to the left.
    Back,
}

/// A parallel view of the cloth; right × up points to the one who looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Axes of the picture in the frame of the cloth.
    right: DVec3,
    up: DVec3,
    toward: DVec3,
    /// Size of the repeat along the axes of the picture in mm; no repeat is infinite.
    pub(super) period: DVec3,
    /// What lies nearer than this plane is cut away, in mm along the direction to the one who looks; infinite for no cut.
    pub(super) cut: f64,
    /// How far one sees beyond the cut in mm.
    pub(super) reach: f64,
}

impl View {
    /// The view of a face of a cloth whose repeat has this size in mm.
    pub fn face(period: DVec2, face: Face) -> View {
        let side = if face == Face::Front { 1.0 } else { -1.0 };
        let period = period.extend(f64::INFINITY);
        let (right, toward) = (DVec3::X * side, DVec3::Z * side);
        View { right, up: DVec3::Y, toward, period, cut: f64::INFINITY, reach: f64::INFINITY }
    }

    /// The view of a cut along the threads of a system through a plane x or y = `at`, with z up.
    pub fn along(cloth: &Cloth, system: System, at: f64) -> View {
        let (spacing, period, endless) = (cloth.spacing(), cloth.period(), f64::INFINITY);
        match system {
            System::Warp => View {
                right: DVec3::Y,
                up: DVec3::Z,
                toward: DVec3::X,
                period: DVec3::new(period.y, endless, period.x),
                cut: at,
                reach: spacing.x,
            },
            System::Weft => View {
                right: DVec3::X,
                up: DVec3::Z,
                toward: -DVec3::Y,
                period: DVec3::new(period.x, endless, period.y),
                cut: -at,
                reach: spacing.y,
            },
        }
    }

    /// A vector of the cloth in the frame of the picture: right, up, towards the one who looks.
    pub fn turn(&self, vector: DVec3) -> DVec3 {
        DVec3::new(vector.dot(self.right), vector.dot(self.up), vector.dot(self.toward))
    }
}
