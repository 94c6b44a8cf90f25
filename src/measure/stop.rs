//! When a run has made enough walks.

use crate::bsdf::noise;
use crate::goniometer::Tally;
use std::time::{Duration, Instant};

/// Walks of each cell before the first decision.
const FIRST: u64 = 4096;
/// Later decisions on a tolerance fall at multiples of this.
const EVEN: u64 = 256;
/// Walks that are made at once, over those that noise as it is asks for: its own error leaves few runs short of them.
const ENOUGH: f64 = 1.01;
/// The least part of the walks there are that are made before the next decision.
const LEAST: f64 = 1.0 / 32.0;
/// Walks of each cell after which a cloth that has scattered so small a share of them counts as one that scatters nothing.
const NOTHING: u64 = 1 << 18;
const HARDLY: f64 = 1e-5;

/// A share in percent, without zeros behind: `5 %`.
pub fn percent(share: f64) -> String {
    format!("{} %", (1e8 * share).round() / 1e6)
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// After so many walks of each incident cell.
    Walks(u64),
    /// When the relative noise of the scattered light is at most this.
    Tolerance(f64),
    /// When the walks have taken so long.
    Time(Duration),
}

impl Stop {
    /// The number of walks of each cell at which to decide next, after `made` of them; none when it is enough.
    ///
    /// Decisions fall at 4096·{2ʲ, 3·2ʲ⁻¹} walks, those on a tolerance where the noise of the walks so far says that there are
    /// enough if that is sooner, so that the result depends on the tally alone and not on the clock, but for [`Stop::Time`].
    pub fn next(&self, tally: &Tally, made: u64, begun: Instant, most: u64) -> Option<u64> {
        let (enough, wanted) = match self {
            Stop::Walks(walks) => return (made < *walks).then_some(*walks),
            Stop::Tolerance(tolerance) => {
                let noise = noise(tally);
                let times = (ENOUGH * more(noise, *tolerance)).max(1.0 + LEAST);
                let enough = noise <= *tolerance || (made >= NOTHING && scattered(tally) < HARDLY);
                (enough, times * made as f64)
            }
            Stop::Time(time) => (made > 0 && begun.elapsed() >= *time, f64::INFINITY),
        };
        // Before the first walk nothing says how many it takes.
        let wanted = if made > 0 { wanted.min((u64::MAX / 2) as f64) as u64 } else { u64::MAX / 2 };
        let wanted = wanted.next_multiple_of(EVEN);
        (!enough && made < most).then(|| step_after(made).min(wanted).min(most))
    }

    /// Walks of each cell that the whole run will take, as far as can be told after `made` of them.
    pub fn expected(&self, noise: f64, made: u64, begun: Instant) -> Option<u64> {
        let more = match self {
            Stop::Walks(walks) => return Some(*walks),
            Stop::Tolerance(tolerance) => more(noise, *tolerance),
            Stop::Time(time) => time.as_secs_f64() / begun.elapsed().as_secs_f64(),
        };
        (more.is_finite() && made > 0).then(|| (made as f64 * more.max(1.0)) as u64)
    }
}

/// Times as many walks as there are that bring their noise to a tolerance: it falls with the root of the walks.
fn more(noise: f64, tolerance: f64) -> f64 {
    (noise / tolerance).powi(2)
}

/// Share of all walks that were scattered.
fn scattered(tally: &Tally) -> f64 {
    let of = |start: usize| tally.reflection(start).iter().chain(tally.transmission(start)).sum::<u64>();
    (0..tally.starts()).map(of).sum::<u64>() as f64 / tally.counts.finished.max(1) as f64
}

/// The least of 4096·{2ʲ, 3·2ʲ⁻¹} above a number.
fn step_after(made: u64) -> u64 {
    let mut step = FIRST;
    while step <= made {
        // 4096·2ʲ is followed by 4096·3·2ʲ⁻¹, and that by 4096·2ʲ⁺¹.
        step = if step.is_power_of_two() { step / 2 * 3 } else { step / 3 * 4 };
    }
    step
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::goniometer::{BinLayout, Origin};

    #[test]
    fn decisions_fall_at_powers_of_two_and_halfway_between() {
        let mut made = 0;
        let steps: Vec<u64> = (0..6)
            .map(|_| {
                made = step_after(made);
                made
            })
            .collect();
        assert_eq!(steps, [4096, 6144, 8192, 12288, 16384, 24576]);
    }

    #[test]
    fn each_rule_stops_when_it_says() {
        let origin = Origin { engine: "cpu".into(), adapter: String::new(), seed: 0 };
        let mut tally = Tally::new(origin, BinLayout { exit_cells: 1 }, 1, None);
        let now = Instant::now();
        assert_eq!(Stop::Walks(10).next(&tally, 0, now, 100), Some(10));
        assert_eq!(Stop::Walks(10).next(&tally, 10, now, 100), None);
        assert_eq!(Stop::Tolerance(0.05).next(&tally, 0, now, 1 << 30), Some(4096));
        // Half of 4096 walks: noise 1/√4095 = 1.6 %.
        tally.bins = vec![2048, 0, 2048, 0, 0];
        assert_eq!(Stop::Tolerance(0.01).next(&tally, 4096, now, 1 << 30), Some(6144));
        // 1.2 times the walks are enough, or nearly enough.
        assert_eq!(Stop::Tolerance(0.0143).next(&tally, 4096, now, 1 << 30), Some(5120));
        assert_eq!(Stop::Tolerance(0.0156).next(&tally, 4096, now, 1 << 30), Some(4352));
        assert_eq!(Stop::Tolerance(0.02).next(&tally, 4096, now, 1 << 30), None);
        assert_eq!(Stop::Tolerance(0.01).next(&tally, 4096, now, 5000), Some(5000));
        assert_eq!(Stop::Time(Duration::ZERO).next(&tally, 4096, now, 1 << 30), None);
        assert_eq!(Stop::Time(Duration::from_secs(3600)).next(&tally, 6144, now, 1 << 30), Some(8192));
        // A cloth that scatters nothing comes to an end.
        tally.bins = vec![0, 0, NOTHING, 0, 0];
        tally.counts.finished = NOTHING;
        assert_eq!(Stop::Tolerance(0.01).next(&tally, NOTHING, now, 1 << 40), None);
        // So does one that scatters hardly anything, but none that scatters little.
        tally.bins = vec![1, 1, NOTHING - 2, 0, 0];
        assert_eq!(Stop::Tolerance(0.01).next(&tally, NOTHING, now, 1 << 40), None);
        tally.bins = vec![3, 3, NOTHING - 6, 0, 0];
        assert!(Stop::Tolerance(0.01).next(&tally, NOTHING, now, 1 << 40).is_some());
    }
}
