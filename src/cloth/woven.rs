//! The woven cloth: where its threads lie.

use super::flyaways::loose_pieces;
use super::path::{Crossing, Path};
use super::section::Section;
use super::steps::{Limits, Steps};
use crate::error::{Error, Result};
use crate::scene::{Fiber, Scene, Structure, Weave, Yarn};
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// Most pieces of one realization: 1.6 GB of them.
const MAX_PIECES: f64 = 2e7;
/// Longest piece in shares of the smaller spacing of the threads.
const LONGEST: f64 = 0.25;

/// A system of parallel threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum System {
    /// The ends, along y.
    Warp,
    /// The picks, along x.
    Weft,
}

/// A thread of the repeat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thread {
    /// Whether it is an end or a pick.
    pub system: System,
    /// Its number in its system, from 0.
    pub index: usize,
    /// Index of its yarn in the weave.
    pub yarn: usize,
    /// x of an end, y of a pick, in mm.
    pub at: f64,
    /// Index of its axis; threads may share one.
    path: usize,
}

/// The explicit geometry of one repeat of a weave.
#[derive(Clone, Debug)]
pub struct Cloth {
    weave: Weave,
    fibers: Vec<Fiber>,
    period: DVec2,
    thickness: f64,
    threads: Vec<Thread>,
    sections: Vec<Section>,
    paths: Vec<(Path, Steps)>,
}

impl Cloth {
    /// Lay out the threads of a woven scene.
    ///
    /// # Errors
    /// [`Error::Input`] when the scene is no weave, or a realization of it would have too many pieces.
    pub fn new(scene: &Scene) -> Result<Cloth> {
        let Structure::Weave(weave) = &scene.structure else {
            return Err(Error::Input("a sheet has no yarns: there is no explicit cloth to lay out".into()));
        };
        let period =
            DVec2::new(weave.end_spacing * weave.ends.len() as f64, weave.pick_spacing * weave.picks.len() as f64);
        let [lowest, highest] = extent(weave);
        let mut cloth = Cloth {
            weave: weave.clone(),
            fibers: scene.fibers.clone(),
            period,
            thickness: highest - lowest,
            threads: Vec::new(),
            sections: weave.yarns.iter().map(|yarn| Section::new(yarn, &scene.fibers)).collect(),
            paths: Vec::new(),
        };
        match cloth.lay(highest) {
            Some(()) => Ok(cloth),
            None => Err(Error::Input(format!(
                "the fibers of the repeat have more than {MAX_PIECES:e} straight pieces; lower `fibers_per_ply`, the twist \
                 or the size of the draft"
            ))),
        }
    }

    /// Make all threads, unless they have too many pieces; threads of one yarn that cross the same yarns in the same way share
    /// their axis.
    fn lay(&mut self, highest: f64) -> Option<()> {
        let mut left = MAX_PIECES;
        let mut known = HashMap::new();
        let ends = (0..self.weave.ends.len()).map(|index| (System::Warp, index));
        let picks = (0..self.weave.picks.len()).map(|index| (System::Weft, index));
        for (system, index) in ends.chain(picks).collect::<Vec<_>>() {
            let (own, spacing) = match system {
                System::Warp => (self.weave.ends[index], self.weave.end_spacing),
                System::Weft => (self.weave.picks[index], self.weave.pick_spacing),
            };
            let crossed = crossed(&self.weave, system, index);
            let fibers = self.weave.yarns[own].fibers() as f64;
            let key = (system, own, crossed);
            let path = match known.get(&key) {
                Some(&path) => path,
                None => {
                    let path = axis(&self.weave, system, own, &key.2, highest);
                    let section = &self.sections[own];
                    let longest = LONGEST * self.weave.end_spacing.min(self.weave.pick_spacing);
                    let limits = Limits { radius: section.thinnest(), twist: section.bend(), longest };
                    let steps = Steps::new(&path, &limits, left / fibers)?;
                    self.paths.push((path, steps));
                    known.insert(key, self.paths.len() - 1);
                    self.paths.len() - 1
                }
            };
            left -= fibers * (self.paths[path].1.pieces + 1.0) + loose_pieces(&self.sections[own], &self.paths[path].1);
            self.threads.push(Thread { system, index, yarn: own, at: (index as f64 + 0.5) * spacing, path });
        }
        (left >= 0.0).then_some(())
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

    /// The threads of the repeat, ends before picks.
    pub fn threads(&self) -> &[Thread] {
        &self.threads
    }

    /// The weave that was laid out.
    pub fn weave(&self) -> &Weave {
        &self.weave
    }

    /// The kinds of fiber of the scene.
    pub fn kinds(&self) -> &[Fiber] {
        &self.fibers
    }

    /// The yarn of a thread.
    pub fn yarn(&self, thread: &Thread) -> &Yarn {
        &self.weave.yarns[thread.yarn]
    }

    /// Height of a thread's axis in mm at a distance along its direction: y of an end, x of a pick.
    pub fn axis_height(&self, thread: &Thread, along: f64) -> f64 {
        self.path(thread).height(along)
    }

    /// Deepest that two yarns run into each other along z, in mm, from 129 sections of each crossing; negative when no
    /// two touch.
    pub fn largest_penetration(&self) -> f64 {
        let (ends, picks) = self.threads.split_at(self.weave.ends.len());
        let mut largest = f64::NEG_INFINITY;
        for end in ends {
            for pick in picks {
                let side = if self.weave.warp_over(end.index, pick.index) { 1.0 } else { -1.0 };
                // z_w − z_f ≥ t_w + t_f, with the half heights t, falls into a part of x and a part of y.
                let part = |of: &Thread, across: &Thread, side: f64| {
                    let section = DVec2::new(self.yarn(of).width, self.yarn(of).height) / 2.0;
                    let depth = |step: i32| {
                        let place = f64::from(step) / 64.0;
                        let half = section.y * (1.0 - place * place).sqrt();
                        half + side * self.axis_height(across, of.at + place * section.x)
                    };
                    (-64..=64).map(depth).fold(f64::NEG_INFINITY, f64::max)
                };
                largest = largest.max(part(end, pick, side) + part(pick, end, -side));
            }
        }
        largest
    }

    /// Pieces that a realization has, about.
    pub fn expected_pieces(&self) -> usize {
        self.pieces() as usize
    }

    fn pieces(&self) -> f64 {
        let of_thread = |thread: &Thread| {
            let regular = self.yarn(thread).fibers() as f64 * (self.steps(thread).pieces + 1.0);
            regular + loose_pieces(self.section(thread), self.steps(thread))
        };
        self.threads.iter().map(of_thread).sum()
    }

    pub(super) fn section(&self, thread: &Thread) -> &Section {
        &self.sections[thread.yarn]
    }

    pub(super) fn path(&self, thread: &Thread) -> &Path {
        &self.paths[thread.path].0
    }

    pub(super) fn steps(&self, thread: &Thread) -> &Steps {
        &self.paths[thread.path].1
    }
}

/// What a thread crosses: whether it lies over it, and its yarn.
fn crossed(weave: &Weave, system: System, index: usize) -> Vec<(bool, usize)> {
    match system {
        System::Warp => {
            weave.picks.iter().enumerate().map(|(pick, &yarn)| (weave.warp_over(index, pick), yarn)).collect()
        }
        System::Weft => {
            weave.ends.iter().enumerate().map(|(end, &yarn)| (!weave.warp_over(end, index), yarn)).collect()
        }
    }
}

/// Height of a thread's axis over the middle of the crossing: its share of half the yarns' heights, up or down.
fn crossing_height(weave: &Weave, system: System, own: usize, over: bool, other: usize) -> f64 {
    let share = match system {
        System::Warp => weave.warp_crimp_share,
        System::Weft => 1.0 - weave.warp_crimp_share,
    };
    let apart = (weave.yarns[own].height + weave.yarns[other].height) / 2.0;
    if over { share * apart } else { -share * apart }
}

/// Lowest and highest point that any fiber reaches, from the middle of the crossings: an axis is highest and lowest over a
/// crossing, and hairs and loops reach as far from their yarn as they can.
fn extent(weave: &Weave) -> [f64; 2] {
    let mut extent = [f64::INFINITY, f64::NEG_INFINITY];
    let ends = weave.ends.iter().enumerate().map(|(index, &own)| (System::Warp, index, own));
    let picks = weave.picks.iter().enumerate().map(|(index, &own)| (System::Weft, index, own));
    for (system, index, own) in ends.chain(picks) {
        for (over, other) in crossed(weave, system, index) {
            let height = crossing_height(weave, system, own, over, other);
            let half = weave.yarns[own].height / 2.0 + weave.yarns[own].reach();
            extent = [extent[0].min(height - half), extent[1].max(height + half)];
        }
    }
    extent
}

/// The axis of a thread that crosses these yarns, in a cloth whose highest point is to be z = 0.
fn axis(weave: &Weave, system: System, own: usize, crossed: &[(bool, usize)], highest: f64) -> Path {
    let spacing = match system {
        System::Warp => weave.pick_spacing,
        System::Weft => weave.end_spacing,
    };
    let crossing = |(index, &(over, other)): (usize, &(bool, usize))| Crossing {
        at: (index as f64 + 0.5) * spacing,
        height: crossing_height(weave, system, own, over, other) - highest,
        section: DVec2::new(weave.yarns[other].width, weave.yarns[other].height) / 2.0,
    };
    let crossings: Vec<Crossing> = crossed.iter().enumerate().map(crossing).collect();
    Path::new(&crossings, spacing * crossed.len() as f64)
}
