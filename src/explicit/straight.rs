//! Straight rays through realizations: the light that touches no fiber, and where the rest first meets one.

use crate::cloth::{FiberGrid, Realization, Realizer, Way, Work};
use crate::error::Result;
use crate::goniometer::{Goniometer, Straight};
use crate::scene::{Packing, Scene};
use crate::walk::{FirstHit, FirstHitBanks, FirstHits, MetFiber, Purpose, draw, uniform};
use glam::{DVec2, DVec3, DVec4};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex};

/// Realizations that rays of one bank go through.
const REALIZATIONS: u64 = 8;
/// Realizations that a calculator shows, whose rays are kept for walks; of further ones only the direct light is.
const SHOWN: u64 = 32;
/// Direct light is the mean of so many realizations that its standard error is this share of the incident light, or of `MOST`.
const PRECISION: f64 = 1e-3;
const MOST: u64 = 160;
/// Further realizations have no more pieces than this together, and this part of the rays.
const MOST_PIECES: u64 = 1 << 20;
const FEWER: usize = 4;
/// Rays through each, all starts together.
const RAYS: usize = 1 << 14;
/// Fewest rays of a start through each.
const FEWEST: usize = 16;
/// Walks that set out along one ray, before rays through other realizations take its place.
const WALKS_A_RAY: u64 = 2;
/// Sequences of rays have numbers of their own, above those of walks.
const SEQUENCES: u64 = 1 << 63;
/// Root of x⁵ = x + 1, whose powers make the most even additive sequence in four dimensions (Roberts 2018).
const ROOT: f64 = 1.167_303_978_261_418_7;

/// What straight rays of every start find in the realizations of a cloth, which come in any order.
#[derive(Debug)]
pub struct StraightRays {
    goniometer: Goniometer,
    seed: u64,
    /// Of each kind of the scene, its place among those in use.
    places: Vec<usize>,
    /// By realization: its rays, start by start.
    seen: Mutex<BTreeMap<u64, Vec<FirstHit>>>,
    /// By realization: the share of the rays of each start that touch nothing.
    untouched: Mutex<BTreeMap<u64, Vec<f64>>>,
}

impl StraightRays {
    /// Before the first realization.
    pub fn new(scene: &Scene, goniometer: &Goniometer) -> StraightRays {
        let used = scene.kinds();
        let place = |kind| used.iter().position(|&known| known == kind).unwrap_or_default();
        let places = (0..scene.fibers.len()).map(place).collect();
        StraightRays {
            goniometer: goniometer.clone(),
            seed: scene.model.seed,
            places,
            seen: Mutex::default(),
            untouched: Mutex::default(),
        }
    }

    /// Numbers of the realizations that rays are to go through before the first walk.
    pub fn wanted() -> Range<u64> {
        0..SHOWN
    }

    /// Walks that set out along one ray, in the mean over the rays of a bank, of so many walks of each of so many starts.
    pub fn walks_a_ray(packing: Packing, starts: usize, walks: u64) -> f64 {
        let of_start = (RAYS / starts.max(1)).max(FEWEST) as f64;
        match packing {
            Packing::Random => (walks as f64 / (REALIZATIONS as f64 * of_start)).min(WALKS_A_RAY as f64),
            // These rays serve all walks.
            Packing::Separate => walks as f64 / (SHOWN as f64 * of_start),
        }
    }

    /// Memory in bytes of the rays of so many starts, with a bank more that is made while they last.
    pub fn bytes(starts: usize) -> usize {
        let realization = (RAYS / starts).max(FEWEST) * starts * size_of::<FirstHit>();
        (SHOWN + REALIZATIONS) as usize * realization
    }

    /// Send rays through a realization, if it is wanted.
    ///
    /// # Errors
    /// Those of [`FiberGrid::new`].
    pub fn add(&self, number: u64, realization: &Realization) -> Result<()> {
        if !StraightRays::wanted().contains(&number) || self.seen().contains_key(&number) {
            return Ok(());
        }
        let rays = self.through(number, &FiberGrid::of(realization)?, self.of_start());
        self.untouched().insert(number, shares(&rays, self.of_start()));
        self.seen().insert(number, rays);
        Ok(())
    }

    /// See direct light in further realizations, until its error is small enough.
    ///
    /// # Errors
    /// Those of drawing the fibers.
    pub fn go_on(&self, realizer: &Realizer) -> Result<()> {
        let side_by_side = rayon::current_num_threads() as u64;
        let worst = || self.light().into_iter().flatten().map(|light| light.stderr).fold(0.0, f64::max);
        if worst() <= PRECISION {
            return Ok(());
        }
        let most = MOST.min(SHOWN + MOST_PIECES / realizer.draw(0)?.pieces().len().max(1) as u64);
        loop {
            let worst = worst();
            let first = self.untouched().len() as u64;
            if worst <= PRECISION || first >= most {
                return Ok(());
            }
            // The error falls with the root of the realizations.
            let wanted = (first as f64 * (worst / PRECISION).powi(2)).ceil().min(most as f64) as u64;
            for start in (first..wanted).step_by(side_by_side as usize) {
                let numbers = start..(start + side_by_side).min(wanted);
                let of_one = |number| {
                    let of_start = (self.of_start() / FEWER).max(FEWEST);
                    let rays = self.through(number, &FiberGrid::of(&realizer.draw(number)?)?, of_start);
                    Ok((number, shares(&rays, of_start)))
                };
                let found: Vec<(u64, Vec<f64>)> = numbers.into_par_iter().map(of_one).collect::<Result<_>>()?;
                self.untouched().extend(found);
            }
        }
    }

    /// Rays of a start through one realization.
    fn of_start(&self) -> usize {
        (RAYS / self.goniometer.starts()).max(FEWEST)
    }

    /// The rays of all starts through a realization: of each an even sequence of places on the lit face and directions inside
    /// the incident cell, begun anywhere.
    fn through(&self, number: u64, grid: &FiberGrid, of_start: usize) -> Vec<FirstHit> {
        let [low, high] = grid.span();
        let mut work = Work::default();
        let step = DVec4::new(1.0, ROOT, ROOT.powi(2), ROOT.powi(3)) / ROOT.powi(4);
        let mut rays = Vec::with_capacity(of_start * self.goniometer.starts());
        for start in 0..self.goniometer.starts() {
            let begin =
                DVec4::from_array(draw(self.seed, SEQUENCES | number, start as u32, Purpose::Start).map(uniform));
            for ray in 0..of_start {
                let at = (begin + step * (ray as f64 + 1.0)).fract();
                let m = -self.goniometer.start_direction(start, DVec2::new(at.x, at.y));
                let place = grid.period() * DVec2::new(at.z, at.w);
                let from = place.extend(if m.z < 0.0 { high } else { low });
                let fiber = match grid.first_entry(from, m, None, &mut work) {
                    Way::Fiber { tube, point, meeting } => {
                        let piece = &grid.tubes()[tube];
                        Some(MetFiber {
                            place: narrow(point),
                            p: narrow(piece.direction()),
                            offset: meeting.offset as f32,
                            kind: self.places[piece.kind()] as u32,
                        })
                    }
                    Way::Out | Way::Endless => None,
                };
                rays.push(FirstHit { m: narrow(m), fiber });
            }
        }
        rays
    }

    /// So many rays of each start through one realization, start by start.
    pub fn of_one(&self, number: u64, grid: &FiberGrid, of_start: usize) -> Vec<FirstHit> {
        self.through(number, grid, of_start)
    }

    /// The mean share over realizations of the light that touches nothing, and its standard error, by
    /// start; none before the second realization.
    pub fn light(&self) -> Option<Vec<Straight>> {
        let (untouched, each) = (self.untouched(), self.of_start());
        let n = untouched.len() as f64;
        (untouched.len() > 1).then(|| {
            let cells = self.goniometer.incident_cells();
            let side = |start: usize| start / cells * cells..(start / cells + 1) * cells;
            let mean = |start: usize| untouched.values().map(|shares| shares[start]).sum::<f64>() / n;
            let means: Vec<f64> = (0..self.goniometer.starts()).map(mean).collect();
            // By realization and lit side: how far the mean over all starts is off.
            let off = |shares: &[f64], start: usize| {
                side(start).map(|start| self.goniometer.weight(start) * (shares[start] - means[start])).sum::<f64>()
            };
            let sides = |shares: &Vec<f64>| {
                (0..self.goniometer.starts()).step_by(cells).map(|start| off(shares, start)).collect()
            };
            let off: Vec<Vec<f64>> = untouched.values().map(sides).collect();
            let of = |start: usize| {
                let own = || untouched.values().map(|shares| shares[start] - means[start]);
                let square: f64 = own().map(|own| own * own).sum();
                let shared: f64 = own().zip(&off).map(|(own, off)| own * off[start / cells]).sum();
                // Where all or none of the rays were stopped, the error is that of one of them.
                let least = 1.0 / (n * each as f64);
                let (stderr, with_mean) = ((square / n / (n - 1.0)).sqrt(), shared / n / (n - 1.0));
                match stderr < least {
                    true => Straight {
                        value: means[start],
                        stderr: least,
                        with_mean: self.goniometer.weight(start) * least * least,
                    },
                    false => Straight { value: means[start], stderr, with_mean },
                }
            };
            (0..self.goniometer.starts()).map(of).collect()
        })
    }

    /// Rays for the walks to set out along: of the realizations that were added, then of those that `realizer` draws.
    /// Without a realizer the first rays serve all walks.
    pub fn into_banks(self, realizer: Option<Realizer>) -> Banks {
        let seen: Vec<Vec<FirstHit>> = std::mem::take(&mut *self.seen()).into_values().collect();
        let of_bank = if realizer.is_some() { REALIZATIONS as usize } else { seen.len().max(1) };
        let shown = seen.chunks(of_bank).map(|some| Arc::new(FirstHits::by_turns(self.of_start(), some))).collect();
        Banks { rays: self, realizer, shown, last: Mutex::new(None) }
    }

    fn untouched(&self) -> std::sync::MutexGuard<'_, BTreeMap<u64, Vec<f64>>> {
        self.untouched.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    fn seen(&self) -> std::sync::MutexGuard<'_, BTreeMap<u64, Vec<FirstHit>>> {
        self.seen.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

/// Banks of rays through realizations of a cloth.
#[derive(Debug)]
pub struct Banks {
    rays: StraightRays,
    realizer: Option<Realizer>,
    /// Rays through the realizations that a calculator showed.
    shown: Vec<Arc<FirstHits>>,
    /// The latest one that had to be made, and its number.
    last: Mutex<Option<(u64, Arc<FirstHits>)>>,
}

impl Banks {
    /// Rays of a start through all realizations that a calculator showed.
    pub fn of_start(&self) -> usize {
        self.shown.iter().map(|bank| bank.of_start).sum()
    }

    /// Memory of these rays in bytes.
    pub fn bytes(&self) -> usize {
        self.shown.iter().map(|bank| bank.bytes()).sum()
    }

    /// Walks that set out along one ray; none where there are only these rays for all walks.
    pub fn walks_a_ray(&self) -> Option<u64> {
        self.realizer.as_ref().map(|_| WALKS_A_RAY)
    }
}

impl FirstHitBanks for Banks {
    fn span(&self) -> u64 {
        let of_start = REALIZATIONS * self.rays.of_start() as u64;
        self.walks_a_ray().map_or(u64::MAX, |walks| walks * of_start)
    }

    fn bank(&self, number: u64) -> Result<Arc<FirstHits>> {
        let shown = self.shown.get(usize::try_from(number).unwrap_or(usize::MAX));
        let (None, Some(realizer)) = (shown, &self.realizer) else {
            return Ok(shown.unwrap_or(&self.shown[0]).clone());
        };
        let mut last = self.last.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some((_, bank)) = last.as_ref().filter(|(known, _)| *known == number) {
            return Ok(bank.clone());
        }
        let through = |realization| {
            let grid = FiberGrid::of(&realizer.draw(realization)?)?;
            Ok(self.rays.through(realization, &grid, self.rays.of_start()))
        };
        let numbers = number * REALIZATIONS..(number + 1) * REALIZATIONS;
        let drawn: Vec<Vec<FirstHit>> = numbers.into_par_iter().map(through).collect::<Result<_>>()?;
        let bank = Arc::new(FirstHits::by_turns(self.rays.of_start(), &drawn));
        *last = Some((number, bank.clone()));
        Ok(bank)
    }
}

/// Shares of the rays of each start through one realization that touch nothing.
fn shares(rays: &[FirstHit], of_start: usize) -> Vec<f64> {
    let share = |own: &[FirstHit]| own.iter().filter(|ray| ray.fiber.is_none()).count() as f64 / own.len() as f64;
    rays.chunks(of_start).map(share).collect()
}

fn narrow(vector: DVec3) -> [f32; 3] {
    vector.as_vec3().to_array()
}
