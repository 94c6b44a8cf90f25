//! WIF, the Weaving Information File, version 1.1 (R. Nielsen and others, 1997): drafts of weaving programs.
//!
//! Computes: which ends lie over which picks, and the colours and the distances of threads, as the file gives them.
//!
//! Inputs: the bytes of a file; lengths leave in mm. End 1 is at the smallest x, pick 1 at the smallest y. Where the
//! format leaves something open, programs differ, and docs/cloth-file.md says what is done here.
//!
//! The lines are read by hand: readers of INI files lose the lines' numbers, merge or drop keys that stand there twice,
//! and split values that this format does not split.
//!
//! Differs from the paper: it does not say how its input is written.

mod colors;
mod drawdown;
mod lines;
mod period;
mod threads;
mod values;

use super::load::read_beside;
use super::reader::{Table, Value};
use crate::error::{Error, Result};
pub use colors::read_colors;
use drawdown::{Drawdown, Outside, Plan};
use lines::{Sections, decode, shorten};
pub use period::period;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::Path;
pub use threads::Spacing;
use threads::Threads;

/// Longest file in bytes.
const MAX_BYTES: u64 = 1 << 20;
/// Most ends and most picks that are looked at.
const MAX_THREADS: usize = 4096;
/// What `wif` may be.
const FORMS: &str =
    "the name of a WIF file, or a table such as { file = \"twill.wif\", ends = [1, 24], picks = [1, 24] }";

/// What a WIF file says of a cloth.
pub struct Wif {
    /// The file as the user may find it.
    pub file: String,
    /// Whether an end lies over a pick, by pick and end, from the first of each.
    pub over: Vec<Vec<bool>>,
    /// Index of the colour of every end and every pick.
    pub colours: [Vec<Option<u32>>; 2],
    /// Distance of the ends and of the picks.
    pub spacings: [Spacing; 2],
    /// The table of colours, in words.
    pub table: BTreeMap<u32, String>,
}

/// Read the file that the key `wif` names; every thread of it interlaces.
///
/// # Errors
/// [`Error::Scene`] at a line of the WIF file, or at the key when the file lacks something or cannot be read.
pub fn read_wif(value: &Value, folder: Option<&Path>) -> Result<Wif> {
    let (file, ranges) = read_choice(value)?;
    let (path, bytes) = read_beside(&file, "the WIF file", folder, MAX_BYTES)?;
    let name = path.display().to_string();
    let text = decode(&bytes).map_err(|why| file.error(format!("cannot read the WIF file `{name}`: {why}")))?;
    let sections = Sections::read(&name, &text)?;
    let warp = Threads::read(&sections, ["WARP", "WARP COLORS", "WARP SPACING"])?;
    let weft = Threads::read(&sections, ["WEFT", "WEFT COLORS", "WEFT SPACING"])?;
    let lacks = |what| file.error(format!("`{name}` has {what}"));
    let mut plan = Plan::read(&sections, &warp, &weft)?.map_err(lacks)?;
    for (warp, range) in [(true, &ranges[0]), (false, &ranges[1])] {
        let Some((value, range)) = range else { continue };
        plan.select(warp, range).map_err(|Outside { there }| {
            let threads = if warp { "ends" } else { "picks" };
            let found = there.map_or("none".into(), |there| format!("{} to {}", there.start(), there.end()));
            value.error(format!("`{name}` has the {threads} {found}, not all of {} to {}", range.start(), range.end()))
        })?;
    }
    let [ends, picks] = plan.size();
    if ends > MAX_THREADS || picks > MAX_THREADS {
        return Err(file.error(format!(
            "`{name}` has {ends} ends and {picks} picks; allowed: {MAX_THREADS} of each; choose some of them, such as \
             wif = {{ file = \"…\", ends = [1, 24], picks = [1, 24] }}"
        )));
    }
    let Drawdown { ends, picks, over } = plan.drawdown(&sections)?;
    check_interlacing(&sections, &ends, &picks, &over)?;
    let numbers = [&ends, &picks].map(|threads| threads.iter().map(|(number, _)| *number).collect::<Vec<u32>>());
    let colour = |threads: &Threads, numbers: &[u32]| numbers.iter().map(|number| threads.colour(*number)).collect();
    Ok(Wif {
        colours: [colour(&warp, &numbers[0]), colour(&weft, &numbers[1])],
        spacings: [warp.spacing(&sections, &numbers[0]), weft.spacing(&sections, &numbers[1])],
        table: colour_table(&sections)?,
        over,
        file: name.clone(),
    })
}

type Choice<'a> = Option<(Value<'a>, RangeInclusive<u32>)>;

/// The name of the file, and which ends and picks of it are meant.
fn read_choice<'a>(value: &Value<'a>) -> Result<(Value<'a>, [Choice<'a>; 2])> {
    if value.as_string().is_some() {
        return Ok((value.clone(), [None, None]));
    }
    let table: Table = value.table().map_err(|_| value.expected(FORMS))?;
    table.expect_keys(&["file", "ends", "picks"], &[])?;
    let range = |key: &str| {
        let Some(value) = table.get(key) else { return Ok(None) };
        let what = "two numbers [first, last] of threads of the WIF file, from 1";
        let items = value.as_array().filter(|items| items.len() == 2).ok_or_else(|| value.expected(what))?;
        let first = items[0].integer(1, values::MAX_NUMBER, what)?;
        let last = items[1].integer(1, values::MAX_NUMBER, what)?;
        if first > last { Err(value.expected(what)) } else { Ok(Some((value, first..=last))) }
    };
    let file = table.require("file")?;
    file.string()?;
    Ok((file, [range("ends")?, range("picks")?]))
}

/// Refuse a thread that lies on one side of all that it crosses.
fn check_interlacing(
    sections: &Sections,
    ends: &[(u32, lines::Entry)],
    picks: &[(u32, lines::Entry)],
    over: &[Vec<bool>],
) -> Result<()> {
    let complain = |thread: &str, (number, entry): &(u32, lines::Entry), above: bool, crossed: &str| {
        let never = if above { "under" } else { "over" };
        let message = format!("{thread} {number} never goes {never} {crossed}: the cloth would fall apart");
        sections.at(entry, &message)
    };
    for (column, end) in ends.iter().enumerate() {
        if over.iter().all(|row| row[column] == over[0][column]) {
            return Err(complain("end", end, over[0][column], "a pick"));
        }
    }
    for (row, pick) in over.iter().zip(picks) {
        if row.iter().all(|over| *over == row[0]) {
            return Err(complain("pick", pick, !row[0], "an end"));
        }
    }
    Ok(())
}

/// Colours in words: red, green and blue from 0 to 255, or what the file says where that cannot be understood.
fn colour_table(sections: &Sections) -> std::result::Result<BTreeMap<u32, String>, Error> {
    let three = |text: &str| -> Option<Vec<f64>> { text.split(',').map(|part| part.trim().parse().ok()).collect() };
    let range = sections.named("COLOR PALETTE", "Range")?.and_then(|entry| three(entry.value));
    let [low, high] = match range.as_deref() {
        Some(&[low, high]) if low < high => [low, high],
        _ => [0.0, 255.0],
    };
    let words = |entry: lines::Entry| match three(entry.value).as_deref() {
        Some(&[r, g, b]) if [r, g, b].iter().all(|value| value.is_finite()) => {
            let [r, g, b] = [r, g, b].map(|value| (255.0 * (value - low) / (high - low)).round());
            format!("rgb {r}, {g}, {b}")
        }
        _ => shorten(entry.value).into_owned(),
    };
    Ok(sections.numbered("COLOR TABLE")?.into_iter().map(|(number, entry)| (number, words(entry))).collect())
}
