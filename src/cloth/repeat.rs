//! The explicit cloth: what a weave and a knit have in common.

use super::flyaways::loose_pieces;
use super::knit::Course;
use super::path::Path;
use super::section::Section;
use super::steps::{Limits, Steps};
use super::{knit, woven};
use crate::error::{Error, Result};
use crate::scene::{Fiber, Knit, Scene, Structure, Weave, Yarn};
use glam::{DVec2, DVec3};

/// Most pieces of one realization: 1.6 GB of them.
const MAX_PIECES: f64 = 2e7;
/// Longest piece in shares of the smaller spacing of the threads.
const LONGEST: f64 = 0.25;

/// A system of parallel threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum System {
    /// The ends of a weave, along y.
    Warp,
    /// The picks of a weave, or the courses of a weft knit, along x.
    Weft,
}

/// A thread of the repeat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thread {
    /// Whether it is an end, or a pick or a course.
    pub system: System,
    /// Its number in its system, from 0.
    pub index: usize,
    /// Index of its yarn in [`Cloth::yarns`].
    pub yarn: usize,
    /// x of an end, y of a pick or of the middle line of a course, in mm.
    pub at: f64,
    /// Index of its axis; threads may share one.
    pub(super) axis: usize,
}

/// The axis of a thread over a period.
#[derive(Clone, Debug)]
pub(super) enum Axis {
    /// In the vertical plane of an end or a pick.
    Plane(Path),
    /// Loops.
    Loops(Course),
}

impl Axis {
    /// Length over the period in mm.
    pub fn length(&self) -> f64 {
        match self {
            Axis::Plane(path) => path.length(),
            Axis::Loops(course) => course.length,
        }
    }

    /// Length of the period along the thread's direction in mm.
    pub fn period(&self) -> f64 {
        match self {
            Axis::Plane(path) => path.period,
            Axis::Loops(course) => course.period,
        }
    }

    /// Steepest slope, rise over run.
    pub fn steepest(&self) -> f64 {
        match self {
            Axis::Plane(path) => path.steepest,
            Axis::Loops(course) => course.steepest(),
        }
    }
}

/// What is laid out.
#[derive(Clone, Debug)]
pub(super) enum Fabric {
    Woven(Weave),
    /// With the least distance of its axes over their diameter.
    Knitted(Knit, f64),
}

/// The threads of a repeat and their axes, as they are laid; the highest point of any yarn is z = 0.
pub(super) struct Laid {
    pub fabric: Fabric,
    pub yarns: Vec<Yarn>,
    pub spacing: DVec2,
    pub period: DVec2,
    pub thickness: f64,
    pub threads: Vec<Thread>,
    pub axes: Vec<Axis>,
}

/// The explicit geometry of one repeat of a weave or a knit.
#[derive(Clone, Debug)]
pub struct Cloth {
    pub(super) fabric: Fabric,
    fibers: Vec<Fiber>,
    yarns: Vec<Yarn>,
    spacing: DVec2,
    period: DVec2,
    thickness: f64,
    threads: Vec<Thread>,
    sections: Vec<Section>,
    axes: Vec<(Axis, Steps)>,
}

impl Cloth {
    /// Lay out the threads of a woven or knitted scene.
    ///
    /// # Errors
    /// [`Error::Input`] when the scene is a sheet, the loops of a knit do not fit, or a realization would have too many
    /// pieces.
    pub fn new(scene: &Scene) -> Result<Cloth> {
        let laid = match &scene.structure {
            Structure::Sheet(_) => {
                return Err(Error::Input("a sheet has no yarns: there is no explicit cloth to lay out".into()));
            }
            Structure::Weave(weave) => woven::lay(weave),
            Structure::Knit(knit) => knit::lay(knit)?,
        };
        let sections: Vec<Section> = laid.yarns.iter().map(|yarn| Section::new(yarn, &scene.fibers)).collect();
        let longest = LONGEST * laid.spacing.min_element();
        let mut left = MAX_PIECES;
        let mut axes: Vec<(Axis, Steps)> = Vec::with_capacity(laid.axes.len());
        for (index, axis) in laid.axes.into_iter().enumerate() {
            // All threads of an axis have one yarn.
            let users = laid.threads.iter().filter(|thread| thread.axis == index);
            let (yarn, count) = users.fold((0, 0.0), |(_, count), thread| (thread.yarn, count + 1.0));
            let section = &sections[yarn];
            let limits = Limits { radius: section.thinnest(), twist: section.bend(), longest };
            let fibers = laid.yarns[yarn].fibers() as f64 * count;
            let steps = match &axis {
                Axis::Plane(path) => Steps::new(path, &limits, left / fibers),
                Axis::Loops(course) => Steps::new(course, &limits, left / fibers),
            };
            let Some(steps) = steps else { return Err(too_many()) };
            left -= fibers * (steps.pieces + 1.0) + count * loose_pieces(section, &steps);
            axes.push((axis, steps));
        }
        if left < 0.0 {
            return Err(too_many());
        }
        let Laid { fabric, yarns, spacing, period, thickness, threads, .. } = laid;
        let fibers = scene.fibers.clone();
        Ok(Cloth { fabric, fibers, yarns, spacing, period, thickness, threads, sections, axes })
    }

    /// Size of the repeat along x and y in mm.
    pub fn period(&self) -> DVec2 {
        self.period
    }

    /// Size of the repeat along x, y and z in mm; the cloth fills 0 ≥ z ≥ −thickness.
    pub fn size(&self) -> DVec3 {
        self.period.extend(self.thickness)
    }

    /// Distance between the highest and the lowest point that any fiber reaches in mm: of the yarns, or of hairs and loops
    /// that are as high as they can be.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Distance between ends or wales along x, and between picks or courses along y, in mm.
    pub fn spacing(&self) -> DVec2 {
        self.spacing
    }

    /// The threads of the repeat, ends before picks; of a knit one course.
    pub fn threads(&self) -> &[Thread] {
        &self.threads
    }

    /// The weave that was laid out, if it is one.
    pub fn weave(&self) -> Option<&Weave> {
        match &self.fabric {
            Fabric::Woven(weave) => Some(weave),
            Fabric::Knitted(..) => None,
        }
    }

    /// The knit that was laid out, if it is one.
    pub fn knit(&self) -> Option<&Knit> {
        match &self.fabric {
            Fabric::Woven(_) => None,
            Fabric::Knitted(knit, _) => Some(knit),
        }
    }

    /// The kinds of fiber of the scene.
    pub fn kinds(&self) -> &[Fiber] {
        &self.fibers
    }

    /// Indices of the kinds of fiber that the threads are made of, ascending.
    pub fn used_kinds(&self) -> Vec<usize> {
        match &self.fabric {
            Fabric::Woven(weave) => weave.kinds(),
            Fabric::Knitted(knit, _) => knit.kinds(),
        }
    }

    /// The yarns of the cloth; some may have no use.
    pub fn yarns(&self) -> &[Yarn] {
        &self.yarns
    }

    /// Indices of the yarns that the threads are made of, ascending.
    pub fn used_yarns(&self) -> Vec<usize> {
        let mut used: Vec<usize> = self.threads.iter().map(|thread| thread.yarn).collect();
        used.sort_unstable();
        used.dedup();
        used
    }

    /// The yarn of a thread.
    pub fn yarn(&self, thread: &Thread) -> &Yarn {
        &self.yarns[thread.yarn]
    }

    /// Height of a thread's axis in mm at a distance along its direction: y of an end, x of a pick; of a course at a length
    /// of yarn from the first head.
    pub fn axis_height(&self, thread: &Thread, along: f64) -> f64 {
        match self.axis(thread) {
            Axis::Plane(path) => path.height(along),
            Axis::Loops(course) => course.at(along).point.z,
        }
    }

    /// The point of a thread's axis in mm after so many periods of it: equal distances along the thread's direction in a
    /// weave, equal lengths of yarn from the head of the first loop in a knit.
    pub fn axis_point(&self, thread: &Thread, periods: f64) -> DVec3 {
        match self.axis(thread) {
            Axis::Plane(path) => {
                let along = periods * path.period;
                match thread.system {
                    System::Warp => DVec3::new(thread.at, along, path.height(along)),
                    System::Weft => DVec3::new(along, thread.at, path.height(along)),
                }
            }
            Axis::Loops(course) => course.at(periods * course.length).point,
        }
    }

    /// Deepest that two yarns run into each other in mm; negative when no two touch. In a weave along z, from 129 sections of
    /// each crossing; in a knit in any direction, of round yarns of the mean diameter.
    pub fn largest_penetration(&self) -> f64 {
        match &self.fabric {
            Fabric::Woven(weave) => self.woven_penetration(weave),
            Fabric::Knitted(knit, clearance) => knit.diameter() * (1.0 - clearance),
        }
    }

    /// Pieces that a realization has, about.
    pub fn expected_pieces(&self) -> usize {
        let of_thread = |thread: &Thread| {
            let regular = self.yarn(thread).fibers() as f64 * (self.steps(thread).pieces + 1.0);
            regular + loose_pieces(self.section(thread), self.steps(thread))
        };
        self.threads.iter().map(of_thread).sum::<f64>() as usize
    }

    pub(super) fn section(&self, thread: &Thread) -> &Section {
        &self.sections[thread.yarn]
    }

    pub(super) fn axis(&self, thread: &Thread) -> &Axis {
        &self.axes[thread.axis].0
    }

    pub(super) fn steps(&self, thread: &Thread) -> &Steps {
        &self.axes[thread.axis].1
    }
}

fn too_many() -> Error {
    Error::Input(format!(
        "the fibers of the repeat have more than {MAX_PIECES:e} straight pieces; lower `fibers_per_ply`, the twist or the \
         size of the draft"
    ))
}
