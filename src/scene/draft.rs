//! The draft of a weave and the yarns of its threads: from rows of marks, or from a WIF file.

use super::reader::{Allowed, Table, Value};
use super::weave::MAX_THREADS;
use super::wif::{Spacing, Wif, period, read_colors, read_wif};
use super::yarn::{Yarn, find_yarn};
use crate::error::Result;
use std::path::Path;

/// Threads per cm → mm between two of them.
const CM: f64 = 10.0;
/// Keys of the yarns and the settings of the two systems.
const SYSTEMS: [(&str, &str); 2] = [("warp", "ends_per_cm"), ("weft", "picks_per_cm")];

/// A draft and what threads it is woven of.
pub struct Draft<'a> {
    /// Where it stands in the cloth file.
    pub value: Value<'a>,
    /// Whether an end lies over a pick, by pick and end, from the first of each.
    pub over: Vec<Vec<bool>>,
    /// Yarns of the ends and of the picks, over and over.
    pub threads: [Vec<usize>; 2],
    /// Distance of the ends and of the picks in mm.
    pub spacings: [f64; 2],
    /// The WIF file that it comes from.
    pub wif: Option<String>,
}

/// Read the draft that the cloth file has or points to.
pub fn read_draft<'a>(table: &Table<'a>, yarns: &[Yarn], folder: Option<&Path>) -> Result<Draft<'a>> {
    let value = match (table.get("draft"), table.get("wif")) {
        (Some(_), Some(wif)) => return Err(wif.error("a weave has a `draft` or a `wif`, not both")),
        (None, None) => return Err(table.error("[weave] needs a `draft` or a `wif`")),
        (None, Some(wif)) => return read_woven(table, wif, yarns, folder),
        (Some(draft), None) => draft,
    };
    if let Some(colors) = table.get("colors") {
        return Err(colors.error("`colors` belongs to a `wif`, and the weave has a `draft`"));
    }
    let over = read_rows(&value)?;
    check_interlacing(&value, &over)?;
    let threads = |key: &str| read_threads(&table.require(key)?, yarns);
    let threads = [threads("warp")?, threads("weft")?];
    let spacing = |key: &str| Ok(CM / table.require(key)?.number(Allowed::from(0.1, 1000.0))?);
    Ok(Draft { value, over, threads, spacings: [spacing("ends_per_cm")?, spacing("picks_per_cm")?], wif: None })
}

/// The draft of a WIF file, cut down to its repeat; what the cloth file says of yarns and settings goes first.
fn read_woven<'a>(table: &Table, value: Value<'a>, yarns: &[Yarn], folder: Option<&Path>) -> Result<Draft<'a>> {
    let wif = read_wif(&value, folder)?;
    let list = |key: &str| table.get(key).map(|value| read_threads(&value, yarns)).transpose();
    let mut given = [list("warp")?, list("weft")?];
    let colors = read_colors(table, yarns, [given[0].is_none(), given[1].is_none()], &wif)?;
    let Wif { file, mut over, colours, spacings, .. } = wif;
    let mut mm = [0.0; 2];
    for (system, ((_, key), spacing)) in SYSTEMS.into_iter().zip(spacings).enumerate() {
        mm[system] = match (table.get(key), spacing) {
            (Some(value), _) => CM / value.number(Allowed::from(0.1, 1000.0))?,
            (None, Spacing::Even(mm)) => mm,
            (None, Spacing::Refused(error)) => return Err(error),
            (None, Spacing::Missing) => {
                let threads = ["[WARP]", "[WEFT]"][system];
                return Err(table.error(format!("[weave] needs `{key}`: `{file}` gives no Spacing in {threads}")));
            }
        };
    }
    // Take threads of one colour for one yarn, and of a given list for alike.
    let of_colour = |colour: &Option<u32>| colour.and_then(|colour| colors.get(&colour)).copied().unwrap_or_default();
    let mut by_colour = colours.map(|colours| colours.iter().map(of_colour).collect::<Vec<usize>>());
    for (system, list) in given.iter().enumerate() {
        if list.is_some() {
            by_colour[system].fill(0);
        }
    }
    let column = |end: usize| over.iter().map(|row| row[end]).collect::<Vec<bool>>();
    let [ends, picks] = &mut by_colour;
    let width = period(ends.iter().enumerate().map(|(end, yarn)| (column(end), *yarn)));
    let height = period(over.iter().zip(picks.iter()));
    ends.truncate(width);
    picks.truncate(height);
    over.truncate(height);
    over.iter_mut().for_each(|row| row.truncate(width));
    if width > MAX_THREADS || height > MAX_THREADS {
        return Err(value.error(format!(
            "the repeat of `{file}` has {width} ends and {height} picks; allowed: {MAX_THREADS} of each; choose some of \
             them, such as wif = {{ file = \"…\", ends = [1, 24], picks = [1, 24] }}"
        )));
    }
    let [warp, weft] = by_colour;
    let threads = [given[0].take().unwrap_or(warp), given[1].take().unwrap_or(weft)];
    Ok(Draft { value, over, threads, spacings: mm, wif: Some(file) })
}

/// Rows from the first pick, which the file has last; each from the first end.
fn read_rows(value: &Value) -> Result<Vec<Vec<bool>>> {
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
    items.iter().map(|item| find_yarn(item, yarns)).collect()
}
