//! How far a file is from its table.

use super::overlap::even;
use crate::bsdf::{Bsdf, Component, Estimate};
use crate::goniometer::Basis;
use crate::scene::Side;
use glam::DVec2;
use rayon::prelude::*;

/// Places along an edge of a cell at which a file is read.
const PLACES: u32 = 2;

/// A file as its loader reads it.
pub trait Loaded: Sync {
    /// Whether it has a component of a side.
    fn has(&self, side: Side, component: Component) -> bool;
    /// f by channel of the table that was written, in sr⁻¹ without light that touches no fiber, at the projections (x, y) of wi and wo.
    fn f(&self, side: Side, component: Component, wi: DVec2, wo: DVec2) -> Vec<f64>;
}

/// Least value of a cell whose difference is counted in standard errors: an error of few walks is itself unknown.
const KNOWN: f64 = 5.0;

/// How far a file is from its table, cell by cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Check {
    /// Largest difference of a cell, in standard errors of the table; only cells count whose value is five of them or more.
    pub most: f64,
    /// Mean difference of these cells, in standard errors of the table.
    pub mean: f64,
    /// √Σ(difference)²/√Σf² over all cells, by projected solid angle.
    pub relative: f64,
    /// √Σσ²/√Σf² of the table over the same cells.
    pub noise: f64,
    /// Largest difference of the share of light of an incident cell and channel.
    pub light: f64,
    /// Cells and channels whose difference is counted in standard errors.
    pub cells: usize,
}

/// Read a file in every pair of cells of the table that it has, at 2 × 2 places of each, and hold the mean against the table.
pub fn check(table: &Bsdf, incident: &Basis, file: &dyn Loaded) -> Check {
    let exit = &table.goniometer.exit;
    let (exits, channels) = (exit.cells(), table.channels.len());
    let share = 1.0 / f64::from(PLACES).powi(4);
    let row = |(part, cell): (usize, usize)| {
        let part = &table.tables()[part];
        let mut sums = Sums::default();
        let mut light = vec![0.0; channels];
        for bin in 0..exits {
            let mut mean = vec![0.0; channels];
            for wi in even(PLACES).map(|place| incident.direction(cell, place).truncate()) {
                for wo in even(PLACES).map(|place| exit.direction(bin, place).truncate()) {
                    let f = file.f(part.side, part.component, wi, wo);
                    mean.iter_mut().zip(f).for_each(|(mean, f)| *mean += share * f);
                }
            }
            let solid_angle = exit.projected_solid_angle(bin);
            let estimates = &part.f[(cell * exits + bin) * channels..][..channels];
            for ((mean, estimate), light) in mean.iter().zip(estimates).zip(&mut light) {
                *light += (mean - estimate.value) * solid_angle;
                sums.compare(*mean, *estimate, solid_angle);
            }
        }
        sums.light = light.into_iter().fold(0.0, |most: f64, light| most.max(light.abs()));
        sums
    };
    let has = |part: &usize| {
        let part = &table.tables()[*part];
        file.has(part.side, part.component)
    };
    let parts: Vec<usize> = (0..table.tables().len()).filter(has).collect();
    let rows: Vec<(usize, usize)> =
        parts.into_iter().flat_map(|part| (0..incident.cells()).map(move |cell| (part, cell))).collect();
    let all: Vec<Sums> = rows.into_par_iter().map(row).collect();
    all.into_iter().fold(Sums::default(), Sums::join).check()
}

/// Sums over cells of which a [`Check`] is made.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sums {
    most: f64,
    sum: f64,
    square: f64,
    variance: f64,
    all: f64,
    /// Largest difference of the light of an incident cell.
    pub light: f64,
    cells: usize,
}

impl Sums {
    /// Hold what was read of a cell against the table.
    pub fn compare(&mut self, read: f64, estimate: Estimate, solid_angle: f64) {
        let Estimate { value, stderr } = estimate;
        let difference = read - value;
        self.square += difference * difference * solid_angle;
        self.variance += stderr * stderr * solid_angle;
        self.all += value * value * solid_angle;
        if value >= KNOWN * stderr && value > 0.0 {
            let ratio = if difference == 0.0 { 0.0 } else { difference.abs() / stderr };
            // What is no number must show.
            self.most = if ratio.is_nan() { f64::INFINITY } else { self.most.max(ratio) };
            self.sum += ratio;
            self.cells += 1;
        }
    }

    fn join(self, other: Sums) -> Sums {
        Sums {
            most: self.most.max(other.most),
            sum: self.sum + other.sum,
            square: self.square + other.square,
            variance: self.variance + other.variance,
            all: self.all + other.all,
            light: self.light.max(other.light),
            cells: self.cells + other.cells,
        }
    }

    /// What the sums say.
    pub fn check(self) -> Check {
        let share = |square: f64| if self.all > 0.0 { (square / self.all).sqrt() } else { 0.0 };
        Check {
            most: self.most,
            mean: self.sum / self.cells.max(1) as f64,
            relative: share(self.square),
            noise: share(self.variance),
            light: self.light,
            cells: self.cells,
        }
    }
}
