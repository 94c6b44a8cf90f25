//! Where light is gathered until there is enough of it to be tested: by exit cell, by part of a hemisphere, as a total; of one
//! incident cell, and of all of a lit side. The order is fixed by the geometry of the cells and not by what they hold.

use crate::goniometer::{Basis, Goniometer, Moments, Outcome, Tally};
use std::f64::consts::TAU;

/// Parts of a hemisphere: four quadrants of φ, each within 45° of the normal and beyond.
pub const PARTS: usize = 8;
/// Kinds of pools: three of scattered light and direct light, of one start and of all of a lit side.
pub(super) const LEVELS: usize = 8;

/// The light that comes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Incoming {
    /// That of a start.
    Start(usize),
    /// That of all incident cells of a lit side, by its place in `sides`, equally many walks of each.
    Side(usize),
}

/// The light that goes out. Hemispheres are numbered 0 on the lit side and 1 on the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outgoing {
    /// That of an exit bin, as [`BinLayout`](crate::goniometer::BinLayout) numbers them.
    Cell(usize),
    /// That of a part of a hemisphere: 8 × hemisphere + 4 × (1 where sin²θ > ½) + quadrant of φ. A cell is in the part of its
    /// middle.
    Part(usize),
    /// All scattered light of a hemisphere.
    Total(usize),
    /// The light that touches no fiber.
    Direct,
}

/// Light that is tested together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pool {
    /// Where it comes from.
    pub incoming: Incoming,
    /// Where it goes.
    pub outgoing: Outgoing,
}

impl Pool {
    /// The number of its kind, below [`LEVELS`].
    pub(super) fn level(&self) -> usize {
        let kind = match self.outgoing {
            Outgoing::Cell(_) => 0,
            Outgoing::Part(_) => 1,
            Outgoing::Total(_) => 2,
            Outgoing::Direct => 3,
        };
        let all = matches!(self.incoming, Incoming::Side(_));
        kind + if all { LEVELS / 2 } else { 0 }
    }
}

/// Design effects (Kish 1965): the variance of a sum over walks, over that of as many independent ones.
///
/// Walks that set out along rays through draws of the fibers are alike: two have the same ray, and thousands the same draw.
/// The further they are added up, the more that counts. Of ten presets of yarns, measured by runs through different draws, jersey
/// has the largest effects: 1.1 (cells), 1.15 (parts) and 1.25 (totals) in the mean over starts, 1.2, 2.2 and 10 of all starts
/// together. Stated here is a little more (`tests/light/clustered.rs`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Effects {
    /// By [`Pool::level`].
    levels: [f64; LEVELS],
}

impl Effects {
    /// Of independent walks.
    pub const NONE: Effects = Effects { levels: [1.0; LEVELS] };
    /// Of a bank of rays along each of which two walks set out.
    const PAIRS: Effects = Effects { levels: [1.2, 1.5, 2.0, 2.0, 1.3, 3.5, 12.0, 12.0] };

    /// Of so many walks along each ray, less than one in a short run: the excess over 1 is in proportion.
    pub fn of(walks_a_ray: f64) -> Effects {
        Effects { levels: Effects::PAIRS.levels.map(|effect| 1.0 + (effect - 1.0) * walks_a_ray / 2.0) }
    }

    /// Of a pool.
    pub fn of_pool(&self, pool: Pool) -> f64 {
        self.levels[pool.level()]
    }

    /// Of the χ² of so many cells and pools of some incoming light. What walks have in common moves all cells together: a few
    /// combinations have the effect of totals, the rest that of cells.
    pub fn of_chi_square(&self, incoming: Incoming, cells: usize) -> f64 {
        let [cell, total] =
            [Outgoing::Cell(0), Outgoing::Total(0)].map(|outgoing| self.of_pool(Pool { incoming, outgoing }));
        if total == 1.0 { 1.0 } else { total.min(cell + 4.0 * total / cells.max(1) as f64) }
    }
}

/// Which exit cells a part of a hemisphere holds.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    /// By exit cell of one hemisphere.
    of_cell: Vec<usize>,
    cells: [usize; PARTS],
}

impl Parts {
    pub fn new(exit: &Basis) -> Parts {
        let part = |cell| {
            let middle = exit.centre(cell);
            // Rounding must not decide for a cell that lies on an axis.
            let turn = middle.y.atan2(middle.x) / TAU + 1e-9;
            let quadrant = ((4.0 * turn.rem_euclid(1.0)) as usize).min(3);
            4 * usize::from(middle.truncate().length_squared() > 0.5 + 1e-9) + quadrant
        };
        let of_cell: Vec<usize> = (0..exit.cells()).map(part).collect();
        let mut cells = [0; PARTS];
        of_cell.iter().for_each(|&part| cells[part] += 1);
        Parts { of_cell, cells }
    }

    /// The part of an exit bin.
    pub fn of_bin(&self, bin: usize) -> usize {
        bin / self.of_cell.len() * PARTS + self.of_cell[bin % self.of_cell.len()]
    }

    /// Whether a pool is more than a single cell.
    pub fn gathers(&self, outgoing: Outgoing) -> bool {
        match outgoing {
            Outgoing::Part(part) => self.cells[part % PARTS] > 1,
            Outgoing::Total(_) => self.of_cell.len() > 1,
            Outgoing::Cell(_) | Outgoing::Direct => true,
        }
    }
}

/// Some incoming light in both tallies and one channel.
pub(super) struct Beam {
    pub incoming: Incoming,
    /// Walks that say where it goes.
    pub walks: [u64; 2],
    /// By exit bin.
    pub light: Vec<[Moments; 2]>,
    /// What touches no fiber, where it is among these walks.
    pub untouched: Option<[Moments; 2]>,
}

impl Beam {
    /// The light of a start. With `met` only walks that met a fiber count; otherwise the first channel has the direct light too.
    pub fn of_start(tallies: [&Tally; 2], start: usize, channel: usize, met: bool) -> Beam {
        let layout = tallies[0].layout;
        let walks = tallies.map(|tally| tally.walks_per_incident() - if met { tally.direct(start) } else { 0 });
        let light = |bin| tallies.map(|tally| tally.light(start, bin, channel));
        let untouched = tallies.map(|tally| {
            let (count, unit) = (tally.of_start(start)[layout.outcome(Outcome::Direct)], tally.unit());
            Moments { sum: count * unit, square: count * unit * unit }
        });
        Beam {
            incoming: Incoming::Start(start),
            walks,
            light: (0..2 * layout.exit_cells).map(light).collect(),
            untouched: (channel == 0 && !met).then_some(untouched),
        }
    }

    /// An empty sum over the starts of a lit side.
    pub fn of_side(side: usize, like: &Beam) -> Beam {
        let none = [Moments::default(); 2];
        let light = vec![none; like.light.len()];
        Beam { incoming: Incoming::Side(side), walks: [0; 2], light, untouched: like.untouched.map(|_| none) }
    }

    /// Add the light of a start. The result is held against the law of walks whose starts are drawn at random, whose variance is
    /// no less than that of equally many walks of each.
    pub fn add(&mut self, start: &Beam) {
        for i in 0..2 {
            self.walks[i] += start.walks[i];
        }
        self.light.iter_mut().zip(&start.light).for_each(|(sum, light)| gather(sum, light));
        if let (Some(sum), Some(light)) = (&mut self.untouched, &start.untouched) {
            gather(sum, light);
        }
    }

    /// The light of each part of both hemispheres, and the total of each.
    pub fn pools(&self, parts: &Parts) -> Vec<(Outgoing, [Moments; 2])> {
        let mut sums = [[Moments::default(); 2]; 2 * PARTS + 2];
        for (bin, light) in self.light.iter().enumerate() {
            let part = parts.of_bin(bin);
            gather(&mut sums[part], light);
            gather(&mut sums[2 * PARTS + part / PARTS], light);
        }
        let outgoing = |place: usize| {
            if place < 2 * PARTS { Outgoing::Part(place) } else { Outgoing::Total(place - 2 * PARTS) }
        };
        let pools = sums.into_iter().enumerate().map(|(place, light)| (outgoing(place), light));
        pools.filter(|(outgoing, _)| parts.gathers(*outgoing)).collect()
    }
}

/// Add light of both tallies.
pub(super) fn gather(sum: &mut [Moments; 2], light: &[Moments; 2]) {
    sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += *light);
}

/// Starts of a lit side, by its place in `sides`.
pub(super) fn starts_of(goniometer: &Goniometer, side: usize) -> std::ops::Range<usize> {
    let cells = goniometer.incident_cells();
    side * cells..(side + 1) * cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::BasisChoice;

    #[test]
    fn parts_hold_the_cells_of_every_basis_alike() {
        for (choice, least) in [
            (BasisChoice::Disc(16), 28),
            (BasisChoice::Disc(5), 2),
            (BasisChoice::Klems, 16),
            (BasisChoice::Polar { rings: 18, sectors: 36 }, 81),
        ] {
            let basis = Basis::new(choice);
            let parts = Parts::new(&basis);
            assert_eq!(parts.cells.iter().sum::<usize>(), basis.cells());
            assert!(parts.cells.iter().all(|&cells| cells >= least), "{choice:?}: {:?}", parts.cells);
            // Cells on an axis go with those counter-clockwise from it.
            let quadrants: Vec<usize> = (0..4).map(|q| parts.cells[q] + parts.cells[4 + q]).collect();
            assert!(quadrants[1..].iter().all(|&cells| quadrants[0].abs_diff(cells) <= 1), "{choice:?}: {quadrants:?}");
            assert_eq!(parts.of_bin(basis.cells()), PARTS + parts.of_cell[0]);
        }
        let parts = Parts::new(&Basis::new(BasisChoice::Disc(1)));
        assert!(!parts.gathers(Outgoing::Part(0)) && !parts.gathers(Outgoing::Total(1)));
    }

    #[test]
    fn the_effect_of_chi_square_lies_between_those_of_cells_and_totals() {
        assert_eq!(Effects::NONE.of_chi_square(Incoming::Side(0), 2), 1.0);
        let pairs = Effects::of(2.0);
        for (incoming, cell, total) in [(Incoming::Start(0), 1.2, 2.0), (Incoming::Side(0), 1.3, 12.0)] {
            assert_eq!(pairs.of_chi_square(incoming, 1), total);
            assert!((pairs.of_chi_square(incoming, 1_000_000) - cell).abs() < 1e-3);
        }
        // Ten walks along a ray have five times the excess of two, one has half of it.
        assert!((Effects::of(10.0).levels[2] - 6.0).abs() < 1e-12 && Effects::of(1.0).levels[2] == 1.5);
    }
}
