//! How near two pieces come.

use glam::DVec3;

/// Pieces whose directions differ by less than about the root of this meet in the middle of where they lie side by side.
const PARALLEL: f64 = 0.002;

/// The nearest points of two pieces, as shares of each, and the way from the second point to the first.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    pub shares: [f64; 2],
    pub apart: DVec3,
}

/// Find the nearest points of two pieces (Ericson, Real-Time Collision Detection, 2005, section 5.1.9): of pieces that are
/// nearly parallel, points near the middle of where they lie side by side.
pub fn meet(a: [DVec3; 2], b: [DVec3; 2]) -> Nearest {
    nearest(a, b, PARALLEL)
}

/// Find the exactly nearest points of two pieces.
pub fn closest(a: [DVec3; 2], b: [DVec3; 2]) -> Nearest {
    nearest(a, b, 1e-14)
}

fn nearest(a: [DVec3; 2], b: [DVec3; 2], parallel: f64) -> Nearest {
    let (u, v, r) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (uu, vv, uv) = (u.length_squared(), v.length_squared(), u.dot(v));
    let (ur, vr) = (u.dot(r), v.dot(r));
    // Weigh the middle of the shadow of the second piece on the first one.
    let shadow = [-ur / uu, (uv - ur) / uu].map(|share| share.clamp(0.0, 1.0));
    let middle = 0.5 * (shadow[0] + shadow[1]);
    let weight = parallel * uu * vv;
    let mut s = ((uv * vr - vv * ur + weight * middle) / (uu * vv - uv * uv + weight)).clamp(0.0, 1.0);
    let mut t = (uv * s + vr) / vv;
    if t < 0.0 {
        t = 0.0;
        s = shadow[0];
    } else if t > 1.0 {
        t = 1.0;
        s = shadow[1];
    }
    Nearest { shares: [s, t], apart: r + u * s - v * t }
}
