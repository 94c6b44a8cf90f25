//! How many lanes, how long a dispatch, how often to flush.

use super::adapter::Kind;

/// A warm-up dispatch that takes this many seconds has told enough.
pub const TELLING: f64 = 0.01;

/// Passes of a run for which a warm-up pays, over those of its first dispatch: it compiles once more.
const LONG: f64 = 16.0;

/// Bounds of a device kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Lanes of a run that is too short for a warm-up.
    pub lanes: u32,
    /// Passes of a dispatch in the warm-up and in such a run.
    pub budget: u32,
    /// Lanes of the first dispatch of the warm-up; each next one has four times as many, until it tells enough.
    pub warm_up_lanes: u32,
    fewest_lanes: u32,
    /// Most lanes of any dispatch.
    pub most_lanes: u32,
    most_budget: u32,
    /// Seconds that one dispatch may take.
    target: f64,
}

/// What the warm-up chose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    pub lanes: u32,
    pub budget: u32,
}

impl Tuning {
    /// Dispatches of tens of milliseconds on hardware, as desktops end those of 2 s; up to a second in software.
    pub fn start(kind: Kind) -> Tuning {
        match kind {
            Kind::Hardware => Tuning {
                lanes: 1 << 13,
                budget: 256,
                warm_up_lanes: 1 << 13,
                fewest_lanes: 1 << 13,
                most_lanes: 1 << 18,
                most_budget: 1024,
                target: 0.04,
            },
            Kind::Software => Tuning {
                lanes: 1 << 14,
                budget: 4096,
                warm_up_lanes: 1 << 10,
                fewest_lanes: 1 << 10,
                most_lanes: 1 << 14,
                most_budget: 4096,
                target: 1.0,
            },
        }
    }

    /// Whether a run is long enough for a warm-up, by a guess at its passes.
    pub fn pays(&self, walks: u64, depth: f64) -> bool {
        walks as f64 * (1.0 + 2.0 * depth) > LONG * f64::from(self.warm_up_lanes) * f64::from(self.budget)
    }

    /// Choose by the measured seconds of one pass of one lane: the longest budget that fits with the fewest lanes, then
    /// as many lanes as fit.
    pub fn choose(&self, seconds_per_pass: f64, longest: u32) -> Choice {
        let passes = self.target / seconds_per_pass;
        let fits = |budget: &u32| f64::from(*budget) * f64::from(self.fewest_lanes) <= passes;
        let most = longest.min(self.most_budget);
        let budgets = [4096, 1024, 256].into_iter().filter(|budget| *budget <= most);
        let budget = budgets.into_iter().find(fits).unwrap_or(most.min(256));
        let mut lanes = self.fewest_lanes;
        while lanes < self.most_lanes && f64::from(2 * lanes) * f64::from(budget) <= passes {
            lanes *= 2;
        }
        Choice { lanes, budget }
    }
}

/// The longest dispatch in which a driver that ends a shader after `most_passes` of all its loops ends no loop early.
///
/// A pass of the kernel takes one pass of a loop and hardly ever more than two for the chords; a flush one, and one for each
/// channel. A twelfth is left for what is rarer.
pub fn longest_budget(flush_every: u32, channels: u32, most_passes: Option<u32>) -> u32 {
    let passes = |budget: u32| 3 * budget + budget.div_ceil(flush_every) * (2 + channels);
    let fits = |budget: &u32| most_passes.is_none_or(|most| passes(*budget) < most - most / 12);
    [4096, 1024, 256].into_iter().find(fits).unwrap_or(128)
}

/// Passes between two flushes, by the majorant optical depth: short walks must not wait for the flush.
pub fn flush_every(depth: f64) -> u32 {
    match depth {
        depth if depth < 1.0 => 1,
        depth if depth < 2.0 => 3,
        depth if depth < 4.0 => 5,
        depth if depth < 8.0 => 8,
        _ => 12,
    }
}

#[cfg(test)]
mod tests {
    use super::super::layout::Lane;
    use super::*;

    #[test]
    fn lanes_fit_into_a_buffer_of_the_default_limits() {
        let most = wgpu::Limits::default().max_storage_buffer_binding_size;
        for kind in [Kind::Hardware, Kind::Software] {
            let bytes = Tuning::start(kind).most_lanes as usize * size_of::<Lane>();
            assert!(bytes as u64 <= most, "{kind:?}: {bytes} bytes of lanes, allowed: {most}");
        }
    }

    #[test]
    fn budgets_are_short_only_where_loops_are_ended() {
        for (flush_every, channels) in [(1, 31), (1, 128), (4, 128)] {
            assert_eq!(longest_budget(flush_every, channels, None), 4096);
            let budget = longest_budget(flush_every, channels, Some(65_535));
            assert!(budget < 4096 && budget * 3 + budget / flush_every * (2 + channels) < 60_074, "{budget}");
        }
        assert_eq!(longest_budget(8, 1, Some(65_535)), 4096);
        assert_eq!(longest_budget(8, 1, Some(1_000)), 256);
        assert_eq!(longest_budget(8, 1, Some(500)), 128);
    }

    #[test]
    fn a_dispatch_stays_within_its_time() {
        for kind in [Kind::Hardware, Kind::Software] {
            let tuning = Tuning::start(kind);
            for seconds_per_pass in [1e-11, 1e-10, 1e-9, 1.4e-8] {
                let Choice { lanes, budget } = tuning.choose(seconds_per_pass, 4096);
                let time = f64::from(lanes) * f64::from(budget) * seconds_per_pass;
                assert!(time <= tuning.target, "{kind:?}, {seconds_per_pass}: {time} s");
                assert!([256, 1024, 4096].contains(&budget) && lanes.is_power_of_two());
            }
        }
    }
}
