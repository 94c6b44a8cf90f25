//! Threading, tie-up and treadling or lift plan → which end lies over which pick.

use super::lines::{Entry, Sections};
use super::threads::Threads;
use super::values::Numbers;
use crate::error::Result;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// The drawdown of some of the threads of a file.
#[derive(Debug)]
pub struct Drawdown<'a> {
    /// Numbers of the ends, ascending, and where they are threaded.
    pub ends: Vec<(u32, Entry<'a>)>,
    /// Numbers of the picks, ascending, and where their shed is said.
    pub picks: Vec<(u32, Entry<'a>)>,
    /// Whether an end lies over a pick, by pick and end.
    pub over: Vec<Vec<bool>>,
}

/// How the cloth is woven, as the file says it.
#[derive(Debug)]
pub struct Plan<'a> {
    rising: bool,
    /// Shafts of the ends that have some.
    ends: BTreeMap<u32, Numbers<'a>>,
    /// Shafts of the lift plan, or treadles with a tie-up, of the picks that have some.
    picks: BTreeMap<u32, Numbers<'a>>,
    /// Shafts of the treadles.
    tie_up: Option<BTreeMap<u32, Numbers<'a>>>,
}

/// Threads that were asked for and are not all there.
pub struct Outside {
    /// The threads that are there.
    pub there: Option<RangeInclusive<u32>>,
}

impl<'a> Plan<'a> {
    /// Read the threading and what lifts the shafts; tie-up and treadling go before a lift plan.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) at a line that cannot be understood or points at a shaft or a treadle that
    /// is not there. `Ok(Err(..))` names what the file lacks.
    pub fn read(
        sections: &Sections<'a>,
        warp: &Threads,
        weft: &Threads,
    ) -> Result<std::result::Result<Plan<'a>, &'static str>> {
        let count = |key| {
            let entry = sections.named("WEAVING", key)?;
            let count = entry.map(|entry| sections.whole(&entry)).transpose()?;
            // Take 0 for no number, since programs write it beside a lift plan.
            Ok(count.filter(|count| *count > 0))
        };
        let (shafts, treadles) = (count("Shafts")?, count("Treadles")?);
        let rising = sections.named("WEAVING", "Rising Shed")?.map(|entry| sections.yes(&entry)).transpose()?;
        let mut ends = sections.lists("THREADING", "shafts")?;
        let mut tie_up = sections.lists("TIEUP", "shafts")?;
        let mut treadling = sections.lists("TREADLING", "treadles")?;
        let mut lift_plan = sections.lists("LIFTPLAN", "shafts")?;
        // Leave out treadles that are not there, since some programs list all that they know of.
        tie_up.retain(|treadle, _| treadles.is_none_or(|most| *treadle <= most));
        for lines in [&ends, &tie_up] {
            check(sections, lines, "shaft", "Shafts", shafts)?;
        }
        check(sections, &treadling, "treadle", "Treadles", treadles)?;
        // Pass over threads beyond the number that the file says, and threads on no shaft or treadle.
        let keep = |lines: &mut BTreeMap<u32, Numbers>, most: Option<u32>| {
            lines.retain(|number, line| !line.list.is_empty() && most.is_none_or(|most| *number <= most));
        };
        keep(&mut ends, warp.count);
        keep(&mut treadling, weft.count);
        keep(&mut lift_plan, weft.count);
        if ends.is_empty() {
            return Ok(Err("no end on a shaft in [THREADING]"));
        }
        let (picks, tie_up) = match (tie_up.is_empty() || treadling.is_empty(), lift_plan.is_empty()) {
            (false, _) => (treadling, Some(tie_up)),
            (true, false) => (lift_plan, None),
            (true, true) => return Ok(Err("neither a [TIEUP] with a [TREADLING] nor a [LIFTPLAN]")),
        };
        Ok(Ok(Plan { rising: rising.unwrap_or(true), ends, picks, tie_up }))
    }

    /// Keep the ends or the picks of a range only.
    ///
    /// # Errors
    /// [`Outside`] when the file has not all of them.
    pub fn select(&mut self, warp: bool, range: &RangeInclusive<u32>) -> std::result::Result<(), Outside> {
        let lines = if warp { &mut self.ends } else { &mut self.picks };
        let span = |lines: &BTreeMap<u32, Numbers>| Some(*lines.keys().next()?..=*lines.keys().next_back()?);
        let there = span(lines);
        lines.retain(|number, _| range.contains(number));
        if span(lines).as_ref() == Some(range) { Ok(()) } else { Err(Outside { there }) }
    }

    /// Numbers of ends and picks.
    pub fn size(&self) -> [usize; 2] {
        [self.ends.len(), self.picks.len()]
    }

    /// Lift the shafts pick by pick.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) where a thread is missing between others.
    pub fn drawdown(&self, sections: &Sections) -> Result<Drawdown<'a>> {
        check_gaps(sections, &self.ends, "end", "shaft")?;
        check_gaps(sections, &self.picks, "pick", if self.tie_up.is_some() { "treadle" } else { "shaft" })?;
        // Find the ends on every shaft.
        let mut on_shaft: BTreeMap<u32, Vec<bool>> = BTreeMap::new();
        for (column, line) in self.ends.values().enumerate() {
            for shaft in &line.list {
                on_shaft.entry(*shaft).or_insert_with(|| vec![false; self.ends.len()])[column] = true;
            }
        }
        // Find the ends that every treadle moves.
        let moved = match &self.tie_up {
            None => on_shaft,
            Some(tie_up) => {
                tie_up.iter().map(|(treadle, line)| (*treadle, union(&line.list, &on_shaft, self.ends.len()))).collect()
            }
        };
        let row = |line: &Numbers| {
            let mut row = union(&line.list, &moved, self.ends.len());
            row.iter_mut().for_each(|over| *over ^= !self.rising);
            row
        };
        let numbers = |lines: &BTreeMap<u32, Numbers<'a>>| lines.iter().map(|(&n, line)| (n, line.entry)).collect();
        Ok(Drawdown {
            ends: numbers(&self.ends),
            picks: numbers(&self.picks),
            over: self.picks.values().map(row).collect(),
        })
    }
}

/// The ends that any of some shafts or treadles moves; those that hold nothing move none.
fn union(movers: &[u32], rows: &BTreeMap<u32, Vec<bool>>, width: usize) -> Vec<bool> {
    let mut all = vec![false; width];
    for row in movers.iter().filter_map(|mover| rows.get(mover)) {
        all.iter_mut().zip(row).for_each(|(all, one)| *all |= one);
    }
    all
}

/// Refuse a shaft or a treadle beyond the number that the file says.
fn check(sections: &Sections, lines: &BTreeMap<u32, Numbers>, what: &str, key: &str, most: Option<u32>) -> Result<()> {
    let Some(most) = most else { return Ok(()) };
    for line in lines.values() {
        if let Some(number) = line.list.last().filter(|number| **number > most) {
            return Err(sections.at(&line.entry, &format!("{what} {number}, but [WEAVING] {key} says {most}")));
        }
    }
    Ok(())
}

/// Refuse threads that are missing between others.
fn check_gaps(sections: &Sections, lines: &BTreeMap<u32, Numbers>, thread: &str, mover: &str) -> Result<()> {
    for ((before, _), (number, line)) in lines.iter().zip(lines.iter().skip(1)) {
        if before + 1 != *number {
            let message = match number - before {
                2 => format!("{thread} {} before it has no {mover}", number - 1),
                _ => format!("{thread}s {} to {} before it have no {mover}", before + 1, number - 1),
            };
            let entry = &line.entry;
            return Err(sections.at(entry, &format!("{message}, but must have one inside a cloth")));
        }
    }
    Ok(())
}
