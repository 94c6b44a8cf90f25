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
/// Most realizations that a calculator shows, whose rays are kept for walks; of further ones only the direct light is. Rays through them are one in
/// so many of those through a realization that is drawn for a bank.
const SHOWN: u64 = 64;
const ONE_IN: u64 = 2;
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

    /// Numbers of the realizations that rays are to go through before the first walk where no calculator shows any.
    pub fn wanted() -> Range<u64> {
        0..SHOWN / ONE_IN
    }

    /// Walks that set out along one ray, in the mean over the rays of a bank, of so many walks of each of so many starts.
    pub fn walks_a_ray(packing: Packing, starts: usize, walks: u64) -> f64 {
        let of_start = of_start(starts.max(1)) as f64;
        match packing {
            Packing::Random => (walks as f64 / (REALIZATIONS as f64 * of_start)).min(WALKS_A_RAY as f64),
            // These rays serve all walks.
            Packing::Separate => walks as f64 / ((SHOWN / ONE_IN) as f64 * of_start),
        }
    }

    /// Memory in bytes of the rays of so many starts, with a bank more that is made while they last.
    pub fn bytes(starts: usize) -> usize {
        let realization = of_start(starts) * starts * size_of::<FirstHit>();
        (SHOWN / ONE_IN + REALIZATIONS) as usize * realization
    }

    /// Send rays through a realization, if there are not enough yet.
    ///
    /// # Errors
    /// Those of [`FiberGrid::new`].
    pub fn add(&self, number: u64, realization: &Realization) -> Result<()> {
        if number >= SHOWN || self.seen().contains_key(&number) {
            return Ok(());
        }
        let rays = self.through(number, &FiberGrid::of(realization)?, self.shown());
        self.untouched().insert(number, shares(&rays, self.shown()));
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
                    let of_start = (self.shown() / FEWER).max(FEWEST);
                    let rays = self.through(number, &FiberGrid::of(&realizer.draw(number)?)?, of_start);
                    Ok((number, shares(&rays, of_start)))
                };
                let found: Vec<(u64, Vec<f64>)> = numbers.into_par_iter().map(of_one).collect::<Result<_>>()?;
                self.untouched().extend(found);
            }
        }
    }

    /// Rays of a start through a realization that is drawn for a bank.
    fn of_start(&self) -> usize {
        of_start(self.goniometer.starts())
    }

    /// Rays of a start through a realization that a calculator shows.
    fn shown(&self) -> usize {
        self.of_start() / ONE_IN as usize
    }

    /// The rays of all starts through a realization: of each an even sequence of places on the lit face and directions inside
    /// the incident cell, begun anywhere.
    pub fn through(&self, number: u64, grid: &FiberGrid, of_start: usize) -> Vec<FirstHit> {
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

    /// The mean share over realizations of the light that touches nothing, and its standard error, by
    /// start; none before the second realization.
    pub fn light(&self) -> Option<Vec<Straight>> {
        let (untouched, each) = (self.untouched(), self.shown());
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
                let (stderr, with_mean) = if stderr < least {
                    (least, self.goniometer.weight(start) * least * least)
                } else {
                    (stderr, with_mean)
                };
                Straight { value: means[start], stderr, with_mean }
            };
            (0..self.goniometer.starts()).map(of).collect()
        })
    }

    /// Rays for the walks to set out along: of the realizations that were added, then of those that `realizer` draws.
    /// Without a realizer the first rays serve all walks.
    pub fn into_banks(self, realizer: Option<Realizer>) -> Banks {
        let seen = std::mem::take(&mut *self.seen()).into_values().collect();
        Banks { rays: self, realizer, seen, last: Mutex::new(None) }
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
    seen: Vec<Vec<FirstHit>>,
    /// The latest bank, and its number.
    last: Mutex<Option<(u64, Arc<FirstHits>)>>,
}

impl Banks {
    /// Memory of the rays that were shown in bytes.
    pub fn bytes(&self) -> usize {
        self.seen.iter().map(|own| own.len() * size_of::<FirstHit>()).sum()
    }

    /// Walks that set out along one ray; none where there are only these rays for all walks.
    pub fn walks_a_ray(&self) -> Option<u64> {
        self.realizer.as_ref().map(|_| WALKS_A_RAY)
    }

    /// Banks whose rays were ready with the medium; endless where they serve all walks.
    pub fn ready(&self) -> u64 {
        self.realizer.as_ref().map_or(u64::MAX, |_| self.seen.len() as u64 / (REALIZATIONS * ONE_IN))
    }

    /// The rays of a bank that shares no realization with another, which the first ones of a run do.
    ///
    /// # Errors
    /// Those of [`FirstHitBanks::bank`].
    pub fn apart(&self, number: u64) -> Result<Arc<FirstHits>> {
        if self.realizer.is_none() || number >= self.ready() {
            return self.bank(number);
        }
        let realizations = (REALIZATIONS * ONE_IN) as usize;
        let own = self.seen.chunks(realizations).nth(number as usize).unwrap_or_default();
        Ok(Arc::new(FirstHits::by_turns(self.rays.shown(), own)))
    }

    /// A part of the rays through all realizations that were shown: a short run sees as many as there are.
    fn mixed(&self, number: u64) -> FirstHits {
        let (each, parts) = (self.rays.shown(), self.ready() as usize);
        let own = |rays: &Vec<FirstHit>| -> Vec<FirstHit> {
            rays.chunks(each)
                .flat_map(|start| start.chunks(each / parts).nth(number as usize).unwrap_or_default())
                .copied()
                .collect()
        };
        FirstHits::by_turns(each / parts, &self.seen.iter().map(own).collect::<Vec<_>>())
    }

    /// Rays through realizations that nobody has drawn yet.
    fn drawn(&self, realizer: &Realizer, number: u64) -> Result<FirstHits> {
        let through = |realization| {
            let grid = FiberGrid::of(&realizer.draw(realization)?)?;
            Ok(self.rays.through(realization, &grid, self.rays.of_start()))
        };
        // Beyond those that were shown, whatever their number was.
        let first = SHOWN + (number - self.ready()) * REALIZATIONS;
        let numbers = first..first + REALIZATIONS;
        let drawn: Vec<Vec<FirstHit>> = numbers.into_par_iter().map(through).collect::<Result<_>>()?;
        Ok(FirstHits::by_turns(self.rays.of_start(), &drawn))
    }
}

impl FirstHitBanks for Banks {
    fn span(&self) -> u64 {
        let of_start = REALIZATIONS * self.rays.of_start() as u64;
        self.walks_a_ray().map_or(u64::MAX, |walks| walks * of_start)
    }

    fn bank(&self, number: u64) -> Result<Arc<FirstHits>> {
        // Without a realizer there is one bank.
        let number = if self.realizer.is_some() { number } else { 0 };
        let mut last = self.last.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some((_, bank)) = last.as_ref().filter(|(known, _)| *known == number) {
            return Ok(bank.clone());
        }
        let bank = Arc::new(match &self.realizer {
            None => FirstHits::by_turns(self.rays.shown(), &self.seen),
            Some(_) if number < self.ready() => self.mixed(number),
            Some(realizer) => self.drawn(realizer, number)?,
        });
        *last = Some((number, bank.clone()));
        Ok(bank)
    }
}

/// Rays of each of so many starts through a realization that is drawn for a bank, so many that those which are shown can be shared out evenly.
fn of_start(starts: usize) -> usize {
    (RAYS / starts).max(FEWEST) / 8 * 8
}

/// Shares of the rays of each start through one realization that touch nothing.
fn shares(rays: &[FirstHit], of_start: usize) -> Vec<f64> {
    let share = |own: &[FirstHit]| own.iter().filter(|ray| ray.fiber.is_none()).count() as f64 / own.len() as f64;
    rays.chunks(of_start).map(share).collect()
}

fn narrow(vector: DVec3) -> [f32; 3] {
    vector.as_vec3().to_array()
}
