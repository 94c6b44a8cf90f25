//! Where fibers go on: as their own image one period on, or, where the twist of their thread does not close, cut.

use super::chains::Chains;
use super::neighbours::Neighbour;
use glam::DVec3;
use std::collections::BTreeMap;

/// Starts of fibers lie in a plane across an axis when they are this near to it, in radii.
const IN_PLANE: f64 = 1e-6;

impl Chains {
    /// Length of fiber between two pieces, the second one moved by so many periods; infinite where no fiber leads from one to
    /// the other.
    pub fn between(&self, piece: usize, other: usize, shift: [i16; 2]) -> f64 {
        let fiber = self.fiber[piece] as usize;
        if fiber != self.fiber[other] as usize {
            return f64::INFINITY;
        }
        let Some(turns) = self.turns(fiber, shift.map(i32::from)) else { return f64::INFINITY };
        let moved = f64::from(turns) * self.length(fiber);
        let [from, to] = [self.along[other] + moved, self.along[other + 1] + moved];
        (from - self.along[piece + 1]).max(self.along[piece] - to).max(0.0)
    }

    /// How many times a fiber must go on to reach its image so many periods away, if it does.
    fn turns(&self, fiber: usize, shift: [i32; 2]) -> Option<i32> {
        let onward = self.onward[fiber];
        let axis = usize::from(onward[0] == 0);
        match shift {
            [0, 0] => Some(0),
            _ if !self.joined[fiber] => None,
            _ => Some(shift[axis] / onward[axis]).filter(|turns| onward.map(|periods| periods * turns) == shift),
        }
    }

    /// Whether points of two pieces, given by their shares, lie where the thread of both is cut: within so many radii of the
    /// ends of two fibers, of which one stops where the next period of the other begins.
    pub fn cut_between(&self, piece: usize, neighbour: &Neighbour, shares: [f64; 2], radii: f64) -> bool {
        let pieces = [piece, neighbour.piece as usize];
        let [own, other] = pieces.map(|piece| self.fiber[piece] as usize);
        let onward = self.onward[own];
        let one_cut = own == other || (self.thread[own].is_some() && self.thread[own] == self.thread[other]);
        if !one_cut || onward != self.onward[other] || (self.joined[own] && self.joined[other]) {
            return false;
        }
        // The shift from an end to the start that it faces.
        let ahead = match neighbour.shift.map(i32::from) {
            [0, 0] => return false,
            shift if shift == onward => [true, false],
            shift if shift == onward.map(|periods| -periods) => [false, true],
            _ => return false,
        };
        [0, 1].into_iter().all(|index| {
            let (piece, share) = (pieces[index], shares[index]);
            let along = self.along[piece] + share * (self.along[piece + 1] - self.along[piece]);
            let left = if ahead[index] { self.length(self.fiber[piece] as usize) - along } else { along };
            left <= radii * self.radius_at(piece)
        })
    }
}

/// The normal of the plane that the ends of each fiber lie in, if it is cut with others and does not go on as its own image:
/// x or y for the threads of a weave, whose sections stand upright; along the thread in a knit.
pub fn planes(chains: &Chains) -> Vec<Option<DVec3>> {
    let mut threads: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (fiber, thread) in chains.thread.iter().enumerate() {
        if let Some(thread) = thread {
            threads.entry(*thread).or_default().push(fiber);
        }
    }
    let mut planes = vec![None; chains.thread.len()];
    for fibers in threads.values() {
        let start = |fiber: usize| chains.of(fiber)[0];
        let axes = [(0, DVec3::X), (1, DVec3::Y)].into_iter().filter(|(axis, _)| chains.onward[fibers[0]][*axis] != 0);
        let upright = axes.map(|(_, normal)| normal).find(|normal| {
            let off = |fiber: &usize| (start(*fiber) - start(fibers[0])).dot(*normal).abs() / chains.radius[*fiber];
            fibers.iter().map(off).fold(0.0, f64::max) < IN_PLANE
        });
        let along =
            || fibers.iter().map(|fiber| (chains.of(*fiber)[1] - start(*fiber)).normalize_or_zero()).sum::<DVec3>();
        let Some(normal) = upright.or_else(|| along().try_normalize()) else { continue };
        for &fiber in fibers {
            planes[fiber] = (chains.onward[fiber] != [0, 0] && !chains.joined[fiber]).then_some(normal);
        }
    }
    planes
}
