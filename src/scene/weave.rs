//! `[weave]`.

use super::reader::{Allowed, Table, Value, closest};
use super::sheet::UM;
use super::yarn::{Yarn, round};
use crate::error::Result;

/// Most ends and most picks of a repeat.
const MAX_THREADS: usize = 256;
/// Most fibers of a repeat.
const MAX_FIBERS: usize = 2_000_000;
/// Threads per cm → mm between two of them.
const CM: f64 = 10.0;

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
}

impl Weave {
    /// Whether an end lies over a pick on the front.
    pub fn warp_over(&self, end: usize, pick: usize) -> bool {
        self.over[pick * self.ends.len() + end]
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

pub(super) fn read_weave(table: &Table, yarns: Vec<Yarn>) -> Result<Weave> {
    let keys = ["draft", "warp", "weft", "ends_per_cm", "picks_per_cm", "warp_crimp_share"];
    table.expect_keys(&keys, &[("wif", "is not available yet; write the `draft` here")])?;
    let value = table.require("draft")?;
    let draft = read_draft(&value)?;
    check_interlacing(&value, &draft)?;
    let warp = read_threads(&table.require("warp")?, &yarns)?;
    let weft = read_threads(&table.require("weft")?, &yarns)?;
    let spacing = |key: &str| Ok(CM / table.require(key)?.number(Allowed::from(0.1, 1000.0))?);
    let (end_spacing, pick_spacing) = (spacing("ends_per_cm")?, spacing("picks_per_cm")?);
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
        yarns,
    };
    check_widths(&table.require("ends_per_cm")?, "ends", &weave.ends, &weave.yarns, end_spacing)?;
    check_widths(&table.require("picks_per_cm")?, "picks", &weave.picks, &weave.yarns, pick_spacing)?;
    if weave.fibers() > MAX_FIBERS {
        let message = format!("the repeat has {} fibers; allowed: {MAX_FIBERS}", weave.fibers());
        return Err(value.error(message));
    }
    Ok(weave)
}

/// Rows from the first pick, which the file has last; each from the first end.
fn read_draft(value: &Value) -> Result<Vec<Vec<bool>>> {
    let what = "a list of texts of X (warp over weft) and . (under it), such as [\"X.\", \".X\"]";
    let items = value.as_array().filter(|items| !items.is_empty()).ok_or_else(|| value.expected(what))?;
    let mut rows: Vec<Vec<bool>> = Vec::new();
    for item in items.iter().rev() {
        let text = item.as_string().filter(|text| !text.is_empty()).ok_or_else(|| item.expected(what))?;
        let row = text.chars().map(|mark| match mark {
            'X' => Ok(true),
            '.' => Ok(false),
            _ => {
                Err(item.error(format!("`{mark}` is no mark of a draft; allowed: X (warp over weft) and . (under it)")))
            }
        });
        rows.push(row.collect::<Result<_>>()?);
    }
    for (item, row) in items.iter().rev().zip(&rows) {
        if row.len() != rows[0].len() {
            let (found, wanted) = (row.len(), rows[0].len());
            return Err(item.error(format!("this row of the draft has {found} marks, but the last row has {wanted}")));
        }
    }
    if rows.len() > MAX_THREADS || rows[0].len() > MAX_THREADS {
        let (columns, count) = (rows[0].len(), rows.len());
        let message = format!("the draft has {columns} ends and {count} picks; allowed: {MAX_THREADS} of each");
        return Err(value.error(message));
    }
    Ok(rows)
}

/// Refuse a thread that lies on one side of all that it crosses.
fn check_interlacing(value: &Value, draft: &[Vec<bool>]) -> Result<()> {
    let complain = |thread: String, never: &str| {
        let message = format!("{thread} never goes {never}: the cloth would fall apart");
        Err(value.error(message))
    };
    for end in 0..draft[0].len() {
        let mut marks = draft.iter().map(|row| row[end]);
        let first = marks.next();
        if marks.all(|mark| Some(mark) == first) {
            let never = if first == Some(true) { "under a pick" } else { "over a pick" };
            return complain(format!("end {} (column {} from the left)", end + 1, end + 1), never);
        }
    }
    for (pick, row) in draft.iter().enumerate() {
        if row.iter().all(|mark| *mark == row[0]) {
            let never = if row[0] { "over an end" } else { "under an end" };
            return complain(format!("pick {} (row {} from the bottom)", pick + 1, pick + 1), never);
        }
    }
    Ok(())
}

/// Names of yarns, as indices.
fn read_threads(value: &Value, yarns: &[Yarn]) -> Result<Vec<usize>> {
    let what = "a list of names of yarns, such as [\"white\", \"blue\"]";
    let items = value.as_array().filter(|items| !items.is_empty()).ok_or_else(|| value.expected(what))?;
    let find = |item: &Value| {
        let name = item.as_string().ok_or_else(|| item.expected("the name of a yarn"))?;
        yarns.iter().position(|yarn| yarn.name == name).ok_or_else(|| {
            let names: Vec<&str> = yarns.iter().map(|yarn| yarn.name.as_str()).collect();
            let hint = closest(name, &names).map(|best| format!(", did you mean `{best}`?")).unwrap_or_default();
            item.error(format!("there is no [yarn.{name}]{hint}; yarns: {}", names.join(", ")))
        })
    };
    items.iter().map(find).collect()
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
