//! `colors`: from the colours of a WIF file to yarns.

use super::Wif;
use crate::error::Result;
use crate::scene::reader::Table;
use crate::scene::yarn::{Yarn, find_yarn};
use std::collections::{BTreeMap, BTreeSet};

/// Most colours that a complaint names.
const NAMED: usize = 16;

/// The yarn of every colour that a thread without a given yarn has.
pub fn read_colors(
    table: &Table,
    yarns: &[Yarn],
    wanted: [bool; 2],
    Wif { file, colours, table: names, .. }: &Wif,
) -> Result<BTreeMap<u32, usize>> {
    let word = |colour: &u32| {
        let name = names.get(colour).map_or("not in [COLOR TABLE]", String::as_str);
        format!("{colour} ({name})")
    };
    let used: Vec<&Option<u32>> = (0..2).filter(|system| wanted[*system]).flat_map(|system| &colours[system]).collect();
    let mut known: Vec<u32> = used.iter().filter_map(|colour| **colour).collect();
    known.sort_unstable();
    known.dedup();
    let list = |mut colours: &mut dyn Iterator<Item = &u32>| {
        let mut words: Vec<String> = (&mut colours).take(NAMED).map(word).collect();
        let more = colours.count();
        if more > 0 {
            words.push(format!("and {more} more"));
        }
        words.join(", ")
    };
    let Some(value) = table.get("colors") else {
        return match wanted {
            [false, false] => Ok(BTreeMap::new()),
            _ => {
                let key = if wanted[0] { "warp" } else { "weft" };
                let found = if known.is_empty() { "none".into() } else { list(&mut known.iter()) };
                Err(table.error(format!("[weave] needs `{key}`, or `colors` for the colours of `{file}`: {found}")))
            }
        };
    };
    if wanted == [false, false] {
        return Err(value.error("`colors` has no use: `warp` and `weft` name the yarns"));
    }
    let what = "a table from colours of the WIF file to yarns, such as { 1 = \"white\", 2 = \"blue\" }";
    let mut colors = BTreeMap::new();
    for (key, value) in value.table().map_err(|_| value.expected(what))?.entries() {
        let number = key.parse().ok().filter(|number| known.contains(number) || names.contains_key(number));
        let Some(number) = number else {
            let all: BTreeSet<u32> = known.iter().chain(names.keys()).copied().collect();
            return Err(value.error(format!("`{file}` has no colour {key}; colours: {}", list(&mut all.iter()))));
        };
        colors.insert(number, find_yarn(&value, yarns)?);
    }
    let mut missing = known.iter().filter(|colour| !colors.contains_key(colour)).peekable();
    if missing.peek().is_some() {
        let missing = list(&mut missing);
        return Err(value.error(format!("`colors` names no yarn for these colours of `{file}`: {missing}")));
    }
    if used.iter().any(|colour| colour.is_none()) {
        let threads = if wanted[0] && colours[0].contains(&None) { "WARP" } else { "WEFT" };
        let key = threads.to_lowercase();
        return Err(value.error(format!(
            "`{file}` has threads without a colour: neither a line in [{threads} COLORS] nor Color in [{threads}]; give \
             `{key}` in place of `colors`"
        )));
    }
    Ok(colors)
}
