//! Sheets of exactly aligned, dyed fibers by brute force: exponential flights at the true rate, the segment tracer at every
//! hit, bins of its own; flights go on at hits, or where light leaves a fiber. Nothing of the program is used.

use super::table::Method;
use crate::common::SplitMix;
use crate::common::sheet::disc_cell;
use crate::common::stats::mean_error;
use crate::common::tracer::Trace;
use glam::DVec3;
use rayon::prelude::*;

/// The sheet, in mm.
#[derive(Clone, Copy, Debug)]
pub struct Brute {
    pub radius: f64,
    pub length_density: f64,
    pub thickness: f64,
    pub ior: f64,
    pub axis: DVec3,
    pub absorption: [f64; 3],
    /// The factor of the rate where light is carried through fibers.
    pub carried: Option<f64>,
    /// Light leaves a fiber after so many chords at the latest.
    pub most_chords: u32,
}

/// N of the exit disc.
pub const EXIT: usize = 16;
const CELLS: usize = EXIT * EXIT;

/// What many walks did.
#[derive(Clone, Debug)]
pub struct Seen {
    /// By exit cell: reflection, transmission, then direct light.
    pub counts: Vec<u64>,
    /// Sums of absorbed light by channel, and of its squares.
    absorbed: [[f64; 2]; 3],
}

impl Seen {
    fn none() -> Seen {
        Seen { counts: vec![0; 2 * CELLS + 1], absorbed: [[0.0; 2]; 3] }
    }

    fn join(mut self, other: Seen) -> Seen {
        self.counts.iter_mut().zip(other.counts).for_each(|(a, b)| *a += b);
        let sums = self.absorbed.iter_mut().flatten();
        sums.zip(other.absorbed.iter().flatten()).for_each(|(a, b)| *a += b);
        self
    }

    pub fn walks(&self) -> u64 {
        self.counts.iter().sum()
    }

    pub fn reflected(&self) -> f64 {
        self.counts[..CELLS].iter().sum::<u64>() as f64 / self.walks() as f64
    }

    /// The share of light that fibers keep, and its standard error.
    pub fn absorbed(&self, channel: usize) -> (f64, f64) {
        let [sum, square] = self.absorbed[channel];
        mean_error(sum, square, self.walks() as f64)
    }
}

impl Brute {
    pub fn volume_fraction(&self) -> f64 {
        std::f64::consts::PI * self.radius.powi(2) * self.length_density
    }

    /// Walks on all cores; their number is rounded up to whole tasks.
    pub fn measure(&self, wi: DVec3, walks: u64, seed: u64) -> Seen {
        const TASKS: u64 = 32;
        let task = |i: u64| {
            let mut random = SplitMix(seed.wrapping_mul(0x5851_f42d_4c95_7f2d) ^ i << 48);
            let mut seen = Seen::none();
            (0..walks.div_ceil(TASKS)).for_each(|_| self.walk(-wi, &mut random, &mut seen));
            seen
        };
        (0..TASKS).into_par_iter().map(task).reduce(Seen::none, Seen::join)
    }

    fn walk(&self, mut m: DVec3, random: &mut SplitMix, seen: &mut Seen) {
        let beyond = self.carried.map_or(0.0, |_| self.radius);
        let (mut z, mut touched, mut path) = (beyond, false, 0.0);
        loop {
            // Fly straight to where fibers can be hit.
            let face = if m.z < 0.0 { beyond } else { -self.thickness - beyond };
            if (face - z) * m.z > 0.0 {
                z = face;
            }
            let rate = 2.0 * self.radius * self.length_density * m.cross(self.axis).length();
            z += m.z * -random.uniform().ln() / (rate * self.carried.unwrap_or(1.0));
            if z > beyond || z < -self.thickness - beyond {
                break;
            }
            let hit = Trace::hit(m, self.axis, 2.0 * random.uniform() - 1.0, self.ior);
            // Beyond the faces there is no fiber.
            let axis = z - beyond * hit.normal().z;
            if !(-self.thickness..=0.0).contains(&axis) {
                continue;
            }
            let mut left = hit.leave_at_random(random);
            if left.chords > self.most_chords {
                left = hit.leave_after(self.most_chords);
            }
            z += (left.point - hit.point).z * beyond;
            path += left.path * self.radius;
            (m, touched) = (left.direction, true);
        }
        let side = if m.z > 0.0 { 0 } else { CELLS };
        seen.counts[if touched { side + disc_cell(m.x, m.y, EXIT) } else { 2 * CELLS }] += 1;
        for (sums, sigma) in seen.absorbed.iter_mut().zip(self.absorption) {
            let kept = 1.0 - f64::exp(-sigma * path);
            sums[0] += kept;
            sums[1] += kept * kept;
        }
    }
}

/// The sheets that the methods stand for: at hits, carried, carried among separate fibers.
pub fn sheets_of(sheet: Brute) -> [Brute; 3] {
    let separate = 1.0 / (1.0 - sheet.volume_fraction());
    [None, Some(1.0), Some(separate)].map(|carried| Brute { carried, ..sheet })
}

/// Which of them a method stands for.
pub fn place_of(method: &Method) -> usize {
    usize::from(method.carried()) + usize::from(method.separate())
}
