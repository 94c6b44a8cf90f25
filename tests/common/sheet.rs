//! Sheets of exactly aligned fibers by brute force: exponential flights at the true rate, the segment tracer at every
//! hit, its own bins. Nothing of the program is used.

use super::SplitMix;
use super::stats::mean_error;
use super::tracer::Trace;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_4;

/// The sheet, in mm.
#[derive(Clone, Copy, Debug)]
pub struct AlignedSheet {
    pub radius: f64,
    pub length_density: f64,
    pub thickness: f64,
    pub ior: f64,
    pub axis: DVec3,
    /// N of the exit disc.
    pub exit: usize,
}

impl AlignedSheet {
    /// Counts by exit cell: reflection, transmission, then direct light.
    pub fn measure(&self, wi: DVec3, walks: u64, seed: u64) -> Vec<u64> {
        let cells = self.exit * self.exit;
        let mut counts = vec![0; 2 * cells + 1];
        let mut random = SplitMix(seed);
        for _ in 0..walks {
            counts[self.walk(-wi, &mut random)] += 1;
        }
        counts
    }

    fn walk(&self, mut m: DVec3, random: &mut SplitMix) -> usize {
        let (mut z, mut touched) = (0.0, false);
        loop {
            let rate = 2.0 * self.radius * self.length_density * m.cross(self.axis).length();
            z += m.z * -random.uniform().ln() / rate;
            if z > 0.0 || z < -self.thickness {
                let cells = self.exit * self.exit;
                return match (touched, m.z > 0.0) {
                    (false, _) => 2 * cells,
                    (true, true) => disc_cell(m.x, m.y, self.exit),
                    (true, false) => cells + disc_cell(m.x, m.y, self.exit),
                };
            }
            m = Trace::hit(m, self.axis, 2.0 * random.uniform() - 1.0, self.ior).leave_at_random(random).direction;
            touched = true;
        }
    }
}

/// The cell of the concentric map that holds (x, y), by the four sectors of azimuth.
pub fn disc_cell(x: f64, y: f64, n: usize) -> usize {
    let r = x.hypot(y);
    let mut phi = y.atan2(x);
    if phi < -FRAC_PI_4 {
        phi += std::f64::consts::TAU;
    }
    let part = |middle: f64| r * (phi - middle) / FRAC_PI_4;
    let (a, b) = match phi / FRAC_PI_4 {
        sector if sector < 1.0 => (r, part(0.0)),
        sector if sector < 3.0 => (-part(2.0 * FRAC_PI_4), r),
        sector if sector < 5.0 => (-r, -part(4.0 * FRAC_PI_4)),
        _ => (part(6.0 * FRAC_PI_4), -r),
    };
    let along = |t: f64| (((t + 1.0) / 2.0 * n as f64) as usize).min(n - 1);
    along(b) * n + along(a)
}

/// A bundle of exactly aligned, dyed fibers, in mm.
#[derive(Clone, Copy, Debug)]
pub struct DyedBundle {
    pub radius: f64,
    pub length_density: f64,
    pub ior: f64,
    pub axis: DVec3,
    /// Red, green, blue.
    pub absorption: [f64; 3],
}

/// Several bundles in a sheet of 1 mm; fibers end at `half_length` radii from each hit.
#[derive(Clone, Debug)]
pub struct DyedSheet {
    pub bundles: Vec<DyedBundle>,
    pub half_length: f64,
}

/// What many walks through a dyed sheet did.
#[derive(Clone, Debug, Default)]
pub struct DyedLight {
    sum: [f64; 6],
    square: [f64; 6],
    walks: u64,
    /// Hits whose light left through a base: their number by walk, summed, and squares.
    bases: [f64; 2],
    /// Walks that touched no fiber.
    pub direct: u64,
}

impl DyedLight {
    /// Mean light of one walk and its standard error: reflected by channel, then transmitted by channel.
    pub fn mean(&self) -> Vec<(f64, f64)> {
        (0..6).map(|i| mean_error(self.sum[i], self.square[i], self.walks as f64)).collect()
    }

    /// Base exits of one walk and their standard error.
    pub fn bases(&self) -> (f64, f64) {
        mean_error(self.bases[0], self.bases[1], self.walks as f64)
    }

    fn join(mut self, other: DyedLight) -> DyedLight {
        for i in 0..6 {
            self.sum[i] += other.sum[i];
            self.square[i] += other.square[i];
        }
        self.bases = [self.bases[0] + other.bases[0], self.bases[1] + other.bases[1]];
        self.walks += other.walks;
        self.direct += other.direct;
        self
    }
}

impl DyedSheet {
    /// Walks on all cores; `walks` is rounded up to whole tasks.
    pub fn measure(&self, wi: DVec3, walks: u64, seed: u64) -> DyedLight {
        const TASKS: u64 = 64;
        let task = |i| {
            let mut random = SplitMix(seed.wrapping_mul(0x5851_f42d_4c95_7f2d) ^ i << 48);
            let mut light = DyedLight::default();
            (0..walks.div_ceil(TASKS)).for_each(|_| self.walk(-wi, &mut random, &mut light));
            light
        };
        (0..TASKS).into_par_iter().map(task).reduce(DyedLight::default, DyedLight::join)
    }

    fn walk(&self, mut m: DVec3, random: &mut SplitMix, light: &mut DyedLight) {
        let (mut z, mut touched, mut bases, mut depth) = (0.0, false, 0.0, [0.0; 3]);
        light.walks += 1;
        loop {
            let rate =
                |bundle: &DyedBundle| 2.0 * bundle.radius * bundle.length_density * m.cross(bundle.axis).length();
            let all: f64 = self.bundles.iter().map(rate).sum();
            z += m.z * -random.uniform().ln() / all;
            if !(-1.0..=0.0).contains(&z) {
                light.bases = [light.bases[0] + bases, light.bases[1] + bases * bases];
                light.direct += u64::from(!touched);
                let first = if m.z > 0.0 { 0 } else { 3 };
                let channels = depth.iter().enumerate().take(if touched { 3 } else { 0 });
                for (channel, depth) in channels {
                    let weight = f64::exp(-depth);
                    light.sum[first + channel] += weight;
                    light.square[first + channel] += weight * weight;
                }
                return;
            }
            let mut place = random.uniform() * all;
            let bundle = self.bundles.iter().find(|bundle| {
                place -= rate(bundle);
                place < 0.0
            });
            let bundle = bundle.unwrap_or(&self.bundles[0]);
            let hit = Trace::hit(m, bundle.axis, 2.0 * random.uniform() - 1.0, bundle.ior);
            let (trace, through_base) = hit.leave_short_at_random(self.half_length, random);
            m = trace.direction;
            bases += f64::from(u8::from(through_base));
            depth = [0, 1, 2].map(|channel| depth[channel] + bundle.absorption[channel] * trace.path * bundle.radius);
            touched = true;
        }
    }
}
