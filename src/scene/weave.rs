//! `[weave]`.

use super::draft::{Draft, read_draft};
use super::reader::{Allowed, Table, Value};
use super::sheet::UM;
use super::yarn::{Yarn, round};
use crate::error::Result;
use std::path::Path;

/// Keys of the table.
const KEYS: [&str; 8] = ["draft", "wif", "colors", "warp", "weft", "ends_per_cm", "picks_per_cm", "warp_crimp_share"];
/// Most ends and most picks of a repeat.
pub(super) const MAX_THREADS: usize = 256;
/// Most fibers of a repeat.
const MAX_FIBERS: usize = 2_000_000;

/// A woven cloth: one repeat of it. Ends are the threads of the warp, from the smallest x; picks those of the weft,
/// from the smallest y.
#[derive(Clone, Debug, PartialEq)]
pub struct Weave {
    /// Yarns of the file, in the order of their names; some may have no use.
    pub yarns: Vec<Yarn>,
    /// The yarn of each end of the repeat.
    pub ends: Vec<usize>,
    /// The yarn of each pick of the repeat.
    pub picks: Vec<usize>,
    /// Whether the warp lies over the weft on the front, at pick · ends + end.
    pub over: Vec<bool>,
    /// Distance between the axes of two ends in mm.
    pub end_spacing: f64,
    /// Distance between the axes of two picks in mm.
    pub pick_spacing: f64,
    /// Share of the height of a crossing that the warp takes; the weft takes the rest.
    pub warp_crimp_share: f64,
    /// The WIF file that the draft comes from, as the user may find it.
    pub wif: Option<String>,
}

impl Weave {
    /// Whether an end lies over a pick on the front.
    pub fn warp_over(&self, end: usize, pick: usize) -> bool {
        self.over[pick * self.ends.len() + end]
    }

    /// Rows of X (warp over weft) and . (under it) as a cloth file writes them: the first pick last.
    pub fn draft(&self) -> Vec<String> {
        let mark = |end, pick| if self.warp_over(end, pick) { 'X' } else { '.' };
        let row = |pick| (0..self.ends.len()).map(|end| mark(end, pick)).collect();
        (0..self.picks.len()).rev().map(row).collect()
    }

    /// Indices of the kinds of fiber of the yarns that the threads are made of, ascending.
    pub fn kinds(&self) -> Vec<usize> {
        let used = self.ends.iter().chain(&self.picks).flat_map(|&yarn| &self.yarns[yarn].blend);
        let mut kinds: Vec<usize> = used.map(|(kind, _)| *kind).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds
    }

    /// Number of fibers of the repeat.
    pub fn fibers(&self) -> usize {
        self.ends.iter().chain(&self.picks).map(|&yarn| self.yarns[yarn].fibers()).sum()
    }
}

pub(super) fn read_weave(table: &Table, yarns: Vec<Yarn>, folder: Option<&Path>) -> Result<Weave> {
    table.expect_keys(&KEYS, &[])?;
    let Draft { value, over: draft, threads, spacings, wif } = read_draft(table, &yarns, folder)?;
    let [warp, weft] = threads;
    let [end_spacing, pick_spacing] = spacings;
    let share = table.get("warp_crimp_share").map(|value| value.number(Allowed::from(0.0, 1.0))).transpose()?;
    // Take as many columns and rows as the draft and the list of yarns have in common.
    let (width, height) = (draft[0].len(), draft.len());
    let (columns, rows) = (least_common_multiple(width, warp.len()), least_common_multiple(height, weft.len()));
    if columns > MAX_THREADS || rows > MAX_THREADS {
        let message = format!(
            "the repeat has {columns} ends ({width} in the draft, {} in `warp`) and {rows} picks ({height} in the draft, \
             {} in `weft`); allowed: {MAX_THREADS} of each",
            warp.len(),
            weft.len()
        );
        return Err(value.error(message));
    }
    let weave = Weave {
        ends: warp.iter().copied().cycle().take(columns).collect(),
        picks: weft.iter().copied().cycle().take(rows).collect(),
        over: (0..rows * columns).map(|place| draft[place / columns % height][place % columns % width]).collect(),
        end_spacing,
        pick_spacing,
        warp_crimp_share: share.unwrap_or(0.5),
        wif,
        yarns,
    };
    let place = |key: &str| table.get(key).unwrap_or_else(|| value.clone());
    check_widths(&place("ends_per_cm"), "ends", &weave.ends, &weave.yarns, end_spacing)?;
    check_widths(&place("picks_per_cm"), "picks", &weave.picks, &weave.yarns, pick_spacing)?;
    if weave.fibers() > MAX_FIBERS {
        let message = format!("the repeat has {} fibers; allowed: {MAX_FIBERS}", weave.fibers());
        return Err(value.error(message));
    }
    Ok(weave)
}

/// Refuse threads that do not fit side by side.
fn check_widths(value: &Value, system: &str, threads: &[usize], yarns: &[Yarn], spacing: f64) -> Result<()> {
    let next = threads.iter().cycle().skip(1);
    for (&a, &b) in threads.iter().zip(next) {
        let (a, b) = (&yarns[a], &yarns[b]);
        if a.width + b.width <= 2.0 * spacing * (1.0 + 1e-12) {
            continue;
        }
        let apart = round(spacing / UM);
        let message = if a.name == b.name {
            format!(
                "yarn `{}` is {} µm wide, but {system} lie {apart} µm apart: it can be {apart} µm wide at most",
                a.name,
                round(a.width / UM)
            )
        } else {
            format!(
                "yarns `{}` and `{}`, {} and {} µm wide, lie side by side, but {system} lie {apart} µm apart: together \
                 they can be {} µm wide at most",
                a.name,
                b.name,
                round(a.width / UM),
                round(b.width / UM),
                round(2.0 * spacing / UM)
            )
        };
        return Err(value.error(message));
    }
    Ok(())
}

fn least_common_multiple(a: usize, b: usize) -> usize {
    let (mut divisor, mut rest) = (a, b);
    while rest > 0 {
        (divisor, rest) = (rest, divisor % rest);
    }
    a / divisor * b
}
