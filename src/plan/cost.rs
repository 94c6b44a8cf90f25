//! What events cost, in round numbers that were measured once: plans made with them are the same whenever they are made.

use super::pilot::Pilot;
use crate::measure::ChosenEngine;
use crate::scene::{Packing, Scene, Structure};

/// What sends walks through a medium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EngineClass {
    /// The f64 engine on all threads.
    Cpu,
    /// The kernel on a software adapter.
    SoftwareGpu,
    /// The kernel on a graphics processor; its figure is an estimate, since none was measured.
    HardwareGpu,
}

impl EngineClass {
    /// Of an engine that was chosen.
    pub fn of(engine: &ChosenEngine) -> EngineClass {
        match (engine.name, engine.hardware) {
            ("cpu", _) => EngineClass::Cpu,
            (_, false) => EngineClass::SoftwareGpu,
            (_, true) => EngineClass::HardwareGpu,
        }
    }
}

/// Nanoseconds of a core, on an AMD EPYC at rest (README, How fast); those of a sheet, whose fibers are long and are not sorted along
/// yarns, are the second.
const PIECE_TESTED: [f64; 2] = [32.0, 80.0];
const PIECE_DRAWN: [f64; 2] = [550.0, 6000.0];
/// The same where fibers are moved apart; close ones take more.
const PIECE_APART: [f64; 2] = [40e3, 20e3];
/// A walk through finer cells takes this power of 1/edge more time: flights are those of the densest cell, and larger tables fit the
/// caches less. The second is that of untwisted yarns, whose cells are alike along them.
const FINER: [f64; 2] = [0.35, 0.15];
/// Realizations that a medium is counted from; of few pieces, which know the densities less well, up to `MOST_COUNTED`, as many of
/// `MANY_PIECES` as of more. Times that counting a piece takes as long as drawing one that may overlap.
const COUNTED: f64 = 40.0;
const MOST_COUNTED: f64 = 160.0;
const MANY_PIECES: f64 = 2e4;
const COUNTING: f64 = 3.0;
/// Straight rays to direct light and first hits, and the part of a walk's tests that one takes.
const RAYS: f64 = (1u64 << 20) as f64;
const OF_WALK: f64 = 0.5;

/// Nanoseconds and threads of this machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Seconds of a tentative event in a medium.
    pub event: f64,
    /// Seconds of a test of a piece of a fiber, all threads at work.
    pub test: f64,
    /// Power of 1/edge by which walks through finer cells take longer.
    finer: f64,
    /// Seconds of drawing a piece and of sorting it, all threads at work.
    pub piece: f64,
    /// Seconds of counting a piece once it is drawn, all threads at work.
    counted: f64,
}

impl Cost {
    /// Of a scene on an engine.
    pub fn of(scene: &Scene, engine: EngineClass) -> Cost {
        let cells = !matches!(scene.structure, Structure::Sheet(_));
        let kind = usize::from(!cells);
        let drawn = match scene.model.packing {
            Packing::Random => PIECE_DRAWN[kind],
            Packing::Separate => PIECE_APART[kind],
        };
        let threads = rayon::current_num_threads() as f64;
        let event = match (engine, cells) {
            (EngineClass::Cpu, false) => 180.0 / threads,
            (EngineClass::Cpu, true) => 300.0 / threads,
            (EngineClass::SoftwareGpu, false) => 20.0 / threads,
            (EngineClass::SoftwareGpu, true) => 45.0 / threads,
            (EngineClass::HardwareGpu, _) => 0.2,
        };
        Cost {
            finer: FINER[usize::from(scene.structure.untwisted())],
            event: 1e-9 * event,
            test: 1e-9 * PIECE_TESTED[kind] / threads,
            piece: 1e-9 * drawn / threads,
            counted: 1e-9 * COUNTING * PIECE_DRAWN[kind] / threads,
        }
    }

    /// How much more a walk costs in cells of another edge, in radii of the thinnest fiber, than in those of `tried`.
    pub fn of_edge(&self, edge: Option<f64>, tried: f64) -> f64 {
        edge.map_or(1.0, |edge| (tried / edge).powf(self.finer))
    }

    /// Seconds of preparing a medium of yarns: of counting it, and of its straight rays.
    pub fn preparing(&self, pilot: &Pilot) -> f64 {
        let pieces = pilot.pieces as f64;
        let realizations = COUNTED * (MANY_PIECES / pieces).sqrt().clamp(1.0, MOST_COUNTED / COUNTED);
        pieces * realizations * (self.piece + self.counted) + RAYS * OF_WALK * pilot.tests_a_walk * self.test
    }
}
