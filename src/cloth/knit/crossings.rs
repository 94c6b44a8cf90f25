//! How a course hangs in the one below.

use super::series::Series;
use crate::scene::Stitch;
use glam::DVec3;
use std::f64::consts::TAU;

/// Points of a loop for this purpose.
const POINTS: i32 = 96;

/// Whether each loop hangs in the one below as it should. Seen from the front of a face wale, a loop leaves the one below in
/// this order, from the middle of its wale to the next: its leg over the head below, its foot under the leg below; then
/// the same backwards in the next wale. In a wale that faces the back over and under change places.
pub fn hooked(series: &Series, course: f64, stitch: Stitch) -> bool {
    let next = stitch == Stitch::Jersey;
    crossings(series, course) == [true, false, !next, next]
}

/// Where the course above crosses this one, from the head of one of its loops to the next: whether it lies over it.
fn crossings(series: &Series, course: f64) -> Vec<bool> {
    let point = |place: i32| series.at(TAU * f64::from(place) / f64::from(POINTS))[0];
    let below: Vec<DVec3> = (-POINTS..=2 * POINTS).map(point).collect();
    let mut found = Vec::new();
    for place in 0..POINTS {
        let [a, b] = [place, place + 1].map(|place| point(place) + DVec3::Y * course);
        let mut here: Vec<(f64, bool)> = Vec::new();
        for pair in below.windows(2) {
            let (along, across) = ((b - a).truncate(), (pair[1] - pair[0]).truncate());
            let (gap, turn) = ((pair[0] - a).truncate(), along.perp_dot(across));
            let [s, t] = [gap.perp_dot(across) / turn, gap.perp_dot(along) / turn];
            if (0.0..1.0).contains(&s) && (0.0..1.0).contains(&t) {
                here.push((s, a.lerp(b, s).z > pair[0].lerp(pair[1], t).z));
            }
        }
        here.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.extend(here.into_iter().map(|(_, over)| over));
    }
    found
}
