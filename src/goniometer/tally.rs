//! The integer tally of a run and its two accounts.

use crate::error::{Error, Result};

/// Order of the counts of one incident cell: reflection cells, transmission cells, direct, lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BinLayout {
    /// Exit cells of one side.
    pub exit_cells: usize,
}

impl BinLayout {
    /// Bin of light that left on the lit side.
    pub fn reflection(&self, cell: usize) -> usize {
        cell
    }

    /// Bin of light that touched a fiber and left on the other side.
    pub fn transmission(&self, cell: usize) -> usize {
        self.exit_cells + cell
    }

    /// Bin of light that touched no fiber.
    pub fn direct(&self) -> usize {
        2 * self.exit_cells
    }

    /// Bin of walks that were given up.
    pub fn lost(&self) -> usize {
        2 * self.exit_cells + 1
    }

    /// Bins of one incident cell.
    pub fn stride(&self) -> usize {
        2 * self.exit_cells + 2
    }
}

/// Sums over all finished walks, made by the engine independently of the bins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Walks started.
    pub launched: u64,
    /// Walks that came to an end.
    pub finished: u64,
    /// Tentative events, null collisions and the last step out of the sheet included.
    pub tentative_events: u64,
    /// Real hits.
    pub collisions: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.launched += other.launched;
        self.finished += other.finished;
        self.tentative_events += other.tentative_events;
        self.collisions += other.collisions;
    }
}

/// Which engine made the counts, from which random numbers.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Origin {
    /// `gpu` or `cpu`.
    pub engine: &'static str,
    /// The adapter, or the number of threads.
    pub adapter: String,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// Counts of walks by incident cell and exit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tally {
    /// Who counted.
    pub origin: Origin,
    /// How the bins of one incident cell are laid out.
    pub layout: BinLayout,
    /// Walks of each incident cell.
    pub walks_per_incident: u64,
    /// Counts, `layout.stride()` for each incident cell.
    pub bins: Vec<u64>,
    /// Sums over the run.
    pub counts: Counts,
}

impl Tally {
    /// An empty tally.
    pub fn new(origin: Origin, layout: BinLayout, incident_cells: usize) -> Tally {
        let bins = vec![0; layout.stride() * incident_cells];
        Tally { origin, layout, walks_per_incident: 0, bins, counts: Counts::default() }
    }

    /// Number of incident cells.
    pub fn incident_cells(&self) -> usize {
        self.bins.len() / self.layout.stride()
    }

    /// All bins of one incident cell.
    pub fn of_incident(&self, cell: usize) -> &[u64] {
        let stride = self.layout.stride();
        &self.bins[cell * stride..(cell + 1) * stride]
    }

    /// Counts by exit cell of the lit side.
    pub fn reflection(&self, cell: usize) -> &[u64] {
        &self.of_incident(cell)[..self.layout.exit_cells]
    }

    /// Counts by exit cell of the far side, without the light that touched no fiber.
    pub fn transmission(&self, cell: usize) -> &[u64] {
        &self.of_incident(cell)[self.layout.exit_cells..2 * self.layout.exit_cells]
    }

    /// Walks that touched no fiber.
    pub fn direct(&self, cell: usize) -> u64 {
        self.of_incident(cell)[self.layout.direct()]
    }

    /// Walks that were given up.
    pub fn lost(&self, cell: usize) -> u64 {
        self.of_incident(cell)[self.layout.lost()]
    }

    /// Add the counts of other walks of the same instrument and seed.
    pub fn add(&mut self, other: &Tally) {
        debug_assert_eq!((self.layout, self.bins.len()), (other.layout, other.bins.len()));
        self.walks_per_incident += other.walks_per_incident;
        self.bins.iter_mut().zip(&other.bins).for_each(|(sum, count)| *sum += count);
        self.counts += other.counts;
    }

    /// Hold the counts against the plan.
    ///
    /// 1. By incident cell: walks planned = reflected + transmitted + direct + lost.
    /// 2. Over the run, in units of one walk's light: launched = out + absorbed + lost, where launched and finished are
    ///    counted by the engine apart from the bins, and absorbed is 0 in a lossless medium.
    ///
    /// # Errors
    /// [`Error::Account`] names the first sum that does not close.
    pub fn check(&self, planned_per_incident: u64) -> Result<()> {
        let fail = |message: String| Err(Error::Account { engine: self.origin.engine, message });
        for cell in 0..self.incident_cells() {
            let counted: u64 = self.of_incident(cell).iter().sum();
            if counted != planned_per_incident {
                return fail(format!(
                    "incident cell {cell} was to get {planned_per_incident} walks and counts {counted}"
                ));
            }
        }
        let out_and_lost: u64 = self.bins.iter().sum();
        let Counts { launched, finished, .. } = self.counts;
        if launched != out_and_lost || finished != out_and_lost {
            return fail(format!("{launched} walks started and {finished} ended, but {out_and_lost} were binned"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn closed() -> Tally {
        let origin = Origin { engine: "cpu", adapter: String::new(), seed: 0 };
        let mut tally = Tally::new(origin, BinLayout { exit_cells: 4 }, 3);
        for cell in 0..3 {
            tally.bins[cell * 10 + cell] = 7;
            tally.bins[cell * 10 + 8] = 3;
        }
        tally.counts = Counts { launched: 30, finished: 30, ..Counts::default() };
        tally
    }

    #[test]
    fn a_closed_account_passes() {
        assert!(closed().check(10).is_ok());
    }

    #[test]
    fn each_broken_sum_is_named() {
        let mut moved = closed();
        moved.bins[0] -= 1;
        moved.bins[11] += 1;
        assert!(moved.check(10).is_err_and(|e| e.to_string().contains("incident cell 0")));
        let mut relaunched = closed();
        relaunched.counts.launched += 1;
        assert!(relaunched.check(10).is_err_and(|e| e.to_string().contains("31 walks started")));
        let mut unfinished = closed();
        unfinished.counts.finished -= 1;
        assert!(unfinished.check(10).is_err_and(|e| e.to_string().contains("29 ended")));
    }
}
