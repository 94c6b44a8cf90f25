//! Lines and sections of a WIF file, and where they stand.

use crate::error::{Error, Result};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Sections that say something about the cloth. All others are passed over: CONTENTS too, which many files have wrong.
const SECTIONS: [&str; 13] = [
    "WEAVING",
    "WARP",
    "WEFT",
    "THREADING",
    "TIEUP",
    "TREADLING",
    "LIFTPLAN",
    "WARP COLORS",
    "WEFT COLORS",
    "WARP SPACING",
    "WEFT SPACING",
    "COLOR PALETTE",
    "COLOR TABLE",
];
/// Longest piece of a file that a complaint repeats, in characters.
const LONGEST: usize = 60;

/// A line KEY=VALUE of one of these sections, with a value.
#[derive(Clone, Copy, Debug)]
pub struct Entry<'a> {
    /// 1-based line.
    pub line: usize,
    /// Name of the section.
    pub section: &'static str,
    /// What stands before the sign.
    pub key: &'a str,
    /// What stands behind it, without a comment.
    pub value: &'a str,
}

/// The file as it was read.
#[derive(Debug)]
pub struct Sections<'a> {
    /// The file as the user may find it.
    pub file: &'a str,
    entries: BTreeMap<&'static str, Vec<Entry<'a>>>,
}

/// The text of a file: UTF-8, with or without a byte order mark, or else Latin-1.
///
/// # Errors
/// What is wrong with the bytes, when they are UTF-16.
pub fn decode(bytes: &[u8]) -> std::result::Result<Cow<'_, str>, String> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err("it is UTF-16 text; save the file as UTF-8".into());
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    Ok(match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().map(|&byte| char::from(byte)).collect()),
    })
}

impl<'a> Sections<'a> {
    /// Split a text into sections and their lines.
    ///
    /// # Errors
    /// [`Error::Scene`] at a line of a section of the cloth that is neither KEY=VALUE nor a comment.
    pub fn read(file: &'a str, text: &'a str) -> Result<Sections<'a>> {
        let mut sections = Sections { file, entries: BTreeMap::new() };
        // Pass over lines before the first section.
        let mut section = None;
        // Leave out the sign that DOS took for the end of a file.
        for (line, text) in lines(text.trim_end_matches(['\u{1a}', '\0'])) {
            let text = text.trim();
            if text.is_empty() || text.starts_with([';', '#']) {
                continue;
            }
            let name = text.strip_prefix('[').and_then(|rest| rest.split_once(']'));
            if let Some((name, _)) = name {
                let name = plain(name);
                section = SECTIONS.into_iter().find(|known| known.eq_ignore_ascii_case(&name));
                continue;
            }
            let Some(section) = section else { continue };
            // Cut a comment off; only the sections of texts have values with semicolons.
            let text = text.split(';').next().unwrap_or_default();
            let Some((key, value)) = text.split_once('=') else {
                let message = format!("[{section}] `{}` is neither KEY=VALUE nor a comment after `;`", shorten(text));
                return Err(sections.error(line, message));
            };
            let (key, value) = (key.trim(), value.trim());
            // Take a key without a value for no line.
            if !value.is_empty() {
                sections.entries.entry(section).or_default().push(Entry { line, section, key, value });
            }
        }
        Ok(sections)
    }

    /// Lines of a section that have a value, in their order.
    pub fn entries(&self, section: &str) -> &[Entry<'a>] {
        self.entries.get(section).map_or(&[], Vec::as_slice)
    }

    /// A complaint about a line.
    pub fn error(&self, line: usize, message: String) -> Error {
        Error::Scene { file: self.file.into(), line, column: 1, message }
    }

    /// A complaint about a line KEY=VALUE.
    pub fn at(&self, entry: &Entry, message: &str) -> Error {
        let Entry { line, section, key, value } = *entry;
        self.error(line, format!("[{section}] {}={}: {message}", shorten(key), shorten(value)))
    }
}

/// Lines with their numbers from 1, whatever ends them: CR LF, LF or CR.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut rest = Some(text);
    let next = move || {
        let text = rest?;
        let Some(end) = text.find(['\r', '\n']) else {
            rest = None;
            return Some(text);
        };
        let (line, tail) = text.split_at(end);
        rest = Some(tail.strip_prefix("\r\n").unwrap_or(&tail[1..]));
        Some(line)
    };
    std::iter::from_fn(next).enumerate().map(|(index, line)| (index + 1, line))
}

/// A name with single spaces.
pub fn plain(name: &str) -> String {
    name.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// So much of a text as a complaint can hold.
pub fn shorten(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => Cow::Owned(format!("{}…", &text[..end])),
        None => Cow::Borrowed(text),
    }
}
