//! A sheet of exactly aligned fibers by brute force: exponential flights at the true rate, the segment tracer at every
//! hit, its own bins. Nothing of the program is used.

use super::SplitMix;
use super::tracer::Trace;
use glam::DVec3;
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
