//! Which walks a block of a medium has, and the rays that they set out along.

use super::trial::BLOCKS;
use crate::error::Result;
use crate::explicit::Banks;
use crate::goniometer::{Goniometer, Tally};
use crate::walk::{FirstHitBanks, FirstHits, WalkPlan, Walker};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Instant;

/// Numbers of walks, of each start, that a block has for its own.
pub const OF_BLOCK: u64 = 1 << 32;

/// Walks of one block in stretches of first number and count: after the `made` that it has, `walks` more of each start.
///
/// Walks of one bank of rays meet the same realizations. So block b has banks b, b + K, b + 2K, … of K blocks, and no other block
/// has any of them; `span` walks of each start go with a bank.
pub fn stretches(span: u64, number: u64, made: u64, walks: u64) -> Vec<(u64, u64)> {
    if span >= OF_BLOCK {
        return vec![(number * OF_BLOCK + made, walks)];
    }
    let (mut done, mut list) = (0, Vec::new());
    while done < walks {
        let (round, within) = ((made + done) / span, (made + done) % span);
        let count = (span - within).min(walks - done);
        list.push(((number + BLOCKS * round) * span + within, count));
        done += count;
    }
    list
}

/// Make the walks of all stretches, whose account has been checked.
///
/// # Errors
/// Those of [`Walker::run`].
pub fn walk(walker: &dyn Walker, goniometer: &Goniometer, seed: u64, stretches: &[(u64, u64)]) -> Result<Tally> {
    let run = |&(first, walks): &(u64, u64)| {
        walker.run(goniometer, &WalkPlan { first, ..WalkPlan::new(seed, walks) }, &mut |_| {})
    };
    let mut whole = run(stretches.first().unwrap_or(&(0, 0)))?;
    for stretch in stretches.iter().skip(1) {
        whole.merge(&run(stretch)?)?;
    }
    whole.check(stretches.iter().map(|(_, walks)| walks).sum())?;
    Ok(whole)
}

/// Banks of rays, of which those that blocks are at are kept: blocks are visited by turns.
#[derive(Debug)]
pub struct KeptBanks {
    banks: Arc<Banks>,
    kept: Mutex<Kept>,
}

#[derive(Debug, Default)]
struct Kept {
    banks: BTreeMap<u64, Arc<FirstHits>>,
    /// Least seconds that a bank took to make.
    seconds: Option<f64>,
}

impl KeptBanks {
    /// Of a medium.
    pub fn new(banks: Arc<Banks>) -> KeptBanks {
        KeptBanks { banks, kept: Mutex::default() }
    }

    /// Banks that were ready when the medium was.
    pub fn ready(&self) -> u64 {
        self.banks.ready()
    }

    /// Seconds that a further bank takes to make; none where none was made yet.
    pub fn seconds(&self) -> Option<f64> {
        self.lock().seconds
    }

    /// See that the banks of some stretches are there.
    ///
    /// # Errors
    /// Those of [`FirstHitBanks::bank`].
    pub fn make(&self, stretches: &[(u64, u64)]) -> Result<()> {
        stretches.iter().try_for_each(|(first, _)| self.bank(first / self.span()).map(|_| ()))
    }

    fn lock(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

impl FirstHitBanks for KeptBanks {
    fn span(&self) -> u64 {
        self.banks.span()
    }

    fn bank(&self, number: u64) -> Result<Arc<FirstHits>> {
        let mut kept = self.lock();
        if let Some(bank) = kept.banks.get(&number) {
            return Ok(bank.clone());
        }
        let started = Instant::now();
        let bank = self.banks.apart(number)?;
        if number >= self.ready() {
            let seconds = started.elapsed().as_secs_f64();
            kept.seconds = Some(kept.seconds.map_or(seconds, |least| least.min(seconds)));
        }
        kept.banks.insert(number, bank.clone());
        // A block that has gone on to this bank is done with its last one.
        if let Some(last) = number.checked_sub(BLOCKS) {
            kept.banks.remove(&last);
        }
        Ok(bank)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn blocks_share_no_walk_and_no_bank_and_grow_as_they_would_at_once() {
        let span = 100;
        let mut banks = HashSet::new();
        for number in 0..BLOCKS {
            let whole = stretches(span, number, 0, 250);
            assert_eq!(whole.iter().map(|(_, count)| count).sum::<u64>(), 250);
            let own: HashSet<u64> = whole.iter().map(|(first, _)| first / span).collect();
            assert!(whole.iter().all(|(first, count)| first / span == (first + count - 1) / span));
            assert!(own.iter().all(|bank| banks.insert(*bank)), "{own:?} are not its own");
            let ids =
                |list: &[(u64, u64)]| list.iter().flat_map(|(first, count)| *first..first + count).collect::<Vec<_>>();
            let parts = [stretches(span, number, 0, 130), stretches(span, number, 130, 120)].concat();
            assert_eq!(ids(&parts), ids(&whole));
        }
        assert_eq!(stretches(u64::MAX, 3, 7, 9), [(3 * OF_BLOCK + 7, 9)]);
    }
}
