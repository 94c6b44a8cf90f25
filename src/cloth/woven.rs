//! The woven cloth: where its threads lie.

use super::path::{Crossing, Path};
use super::repeat::{Axis, Cloth, Fabric, Laid, System, Thread};
use crate::scene::Weave;
use glam::DVec2;
use std::collections::HashMap;

/// Lay all threads; threads of one yarn that cross the same yarns in the same way share their axis.
pub(super) fn lay(weave: &Weave) -> Laid {
    let [lowest, highest] = extent(weave);
    let spacing = DVec2::new(weave.end_spacing, weave.pick_spacing);
    let (mut threads, mut axes, mut known) = (Vec::new(), Vec::new(), HashMap::new());
    let ends = weave.ends.iter().enumerate().map(|(index, &own)| (System::Warp, index, own, spacing.x));
    let picks = weave.picks.iter().enumerate().map(|(index, &own)| (System::Weft, index, own, spacing.y));
    for (system, index, own, spacing) in ends.chain(picks) {
        let key = (system, own, crossed(weave, system, index));
        let axis = match known.get(&key) {
            Some(&axis) => axis,
            None => {
                axes.push(Axis::Plane(axis(weave, system, own, &key.2, highest)));
                known.insert(key, axes.len() - 1);
                axes.len() - 1
            }
        };
        threads.push(Thread { system, index, yarn: own, at: (index as f64 + 0.5) * spacing, axis });
    }
    Laid {
        fabric: Fabric::Woven(weave.clone()),
        yarns: weave.yarns.clone(),
        spacing,
        period: spacing * DVec2::new(weave.ends.len() as f64, weave.picks.len() as f64),
        thickness: highest - lowest,
        threads,
        axes,
    }
}

impl Cloth {
    /// Deepest that two yarns of a weave run into each other.
    pub(super) fn woven_penetration(&self, weave: &Weave) -> f64 {
        let (ends, picks) = self.threads().split_at(weave.ends.len());
        let mut largest = f64::NEG_INFINITY;
        for end in ends {
            for pick in picks {
                let side = if weave.warp_over(end.index, pick.index) { 1.0 } else { -1.0 };
                // z_w − z_f ≥ t_w + t_f, with the half heights t, falls into a part of x and a part of y.
                let part = |of: &Thread, across: &Thread, side: f64| {
                    let section = DVec2::new(self.yarn(of).width, self.yarn(of).height) / 2.0;
                    let depth = |step: i32| {
                        let place = f64::from(step) / 64.0;
                        let half = section.y * (1.0 - place * place).sqrt();
                        half + side * self.axis_height(across, of.at + place * section.x)
                    };
                    (-64..=64).map(depth).fold(f64::NEG_INFINITY, f64::max)
                };
                largest = largest.max(part(end, pick, side) + part(pick, end, -side));
            }
        }
        largest
    }
}

/// What a thread crosses: whether it lies over it, and its yarn.
fn crossed(weave: &Weave, system: System, index: usize) -> Vec<(bool, usize)> {
    match system {
        System::Warp => {
            weave.picks.iter().enumerate().map(|(pick, &yarn)| (weave.warp_over(index, pick), yarn)).collect()
        }
        System::Weft => {
            weave.ends.iter().enumerate().map(|(end, &yarn)| (!weave.warp_over(end, index), yarn)).collect()
        }
    }
}

/// Height of a thread's axis over the middle of the crossing: its share of half the yarns' heights, up or down.
fn crossing_height(weave: &Weave, system: System, own: usize, over: bool, other: usize) -> f64 {
    let share = match system {
        System::Warp => weave.warp_crimp_share,
        System::Weft => 1.0 - weave.warp_crimp_share,
    };
    let apart = (weave.yarns[own].height + weave.yarns[other].height) / 2.0;
    if over { share * apart } else { -share * apart }
}

/// Lowest and highest point that any fiber reaches, from the middle of the crossings: an axis is highest and lowest over a
/// crossing, and hairs and loops reach as far from their yarn as they can.
fn extent(weave: &Weave) -> [f64; 2] {
    let mut extent = [f64::INFINITY, f64::NEG_INFINITY];
    let ends = weave.ends.iter().enumerate().map(|(index, &own)| (System::Warp, index, own));
    let picks = weave.picks.iter().enumerate().map(|(index, &own)| (System::Weft, index, own));
    for (system, index, own) in ends.chain(picks) {
        for (over, other) in crossed(weave, system, index) {
            let height = crossing_height(weave, system, own, over, other);
            let half = weave.yarns[own].height / 2.0 + weave.yarns[own].reach(0.0);
            extent = [extent[0].min(height - half), extent[1].max(height + half)];
        }
    }
    extent
}

/// The axis of a thread that crosses these yarns, in a cloth whose highest point is to be z = 0.
fn axis(weave: &Weave, system: System, own: usize, crossed: &[(bool, usize)], highest: f64) -> Path {
    let spacing = match system {
        System::Warp => weave.pick_spacing,
        System::Weft => weave.end_spacing,
    };
    let crossing = |(index, &(over, other)): (usize, &(bool, usize))| Crossing {
        at: (index as f64 + 0.5) * spacing,
        height: crossing_height(weave, system, own, over, other) - highest,
        section: DVec2::new(weave.yarns[other].width, weave.yarns[other].height) / 2.0,
    };
    let crossings: Vec<Crossing> = crossed.iter().enumerate().map(crossing).collect();
    Path::new(&crossings, spacing * crossed.len() as f64)
}
