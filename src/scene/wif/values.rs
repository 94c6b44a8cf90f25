//! What the lines of a WIF file say: numbers, lists, words.

use super::lines::{Entry, Sections, plain, shorten};
use crate::error::Result;
use std::collections::BTreeMap;

/// Largest number of a thread or a colour.
pub const MAX_NUMBER: u32 = 1_000_000;
/// Largest number of a shaft or a treadle.
pub const MAX_SHAFT: u32 = 4096;

/// A line NUMBER=LIST.
#[derive(Clone, Debug)]
pub struct Numbers<'a> {
    /// Where it stands.
    pub entry: Entry<'a>,
    /// Its numbers, ascending, without zeros and repetitions.
    pub list: Vec<u32>,
}

impl<'a> Sections<'a> {
    /// The line of a key.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) when it stands there twice with different values.
    pub fn named(&self, section: &str, key: &str) -> Result<Option<Entry<'a>>> {
        let mut found: Option<Entry> = None;
        for entry in self.entries(section).iter().filter(|entry| plain(entry.key).eq_ignore_ascii_case(key)) {
            self.check_double(found.as_ref(), entry)?;
            found = Some(*entry);
        }
        Ok(found)
    }

    /// The lines of a section by the number before the sign, from 0.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) when a key is no number, or stands there twice with different values.
    pub fn numbered(&self, section: &str) -> Result<BTreeMap<u32, Entry<'a>>> {
        let mut found = BTreeMap::new();
        for entry in self.entries(section) {
            let Some(number) = number(entry.key, MAX_NUMBER) else {
                let message = format!("`=` must follow a whole number to {MAX_NUMBER}");
                return Err(self.at(entry, &message));
            };
            let before = found.insert(number, *entry);
            self.check_double(before.as_ref(), entry)?;
        }
        Ok(found)
    }

    /// The same where numbers count threads, treadles or picks, from 1.
    ///
    /// # Errors
    /// Those of [`Sections::numbered`], and at the number 0: a file that counts from 0 would be another cloth here.
    pub fn counted(&self, section: &str) -> Result<BTreeMap<u32, Entry<'a>>> {
        let lines = self.numbered(section)?;
        match lines.get(&0) {
            Some(entry) => Err(self.at(entry, "numbers start at 1")),
            None => Ok(lines),
        }
    }

    /// The lines of a section of threads, shafts or treadles by number, from 1, with the lists of numbers behind the sign.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) when a key or an item of a list is no number.
    pub fn lists(&self, section: &str, what: &str) -> Result<BTreeMap<u32, Numbers<'a>>> {
        let mut found = BTreeMap::new();
        for (key, entry) in self.counted(section)? {
            let mut list = Vec::new();
            for item in entry.value.split(',').map(str::trim).filter(|item| !item.is_empty()) {
                let Some(number) = number(item, MAX_SHAFT) else {
                    let message = format!("must be numbers of {what} with commas between them, to {MAX_SHAFT}");
                    return Err(self.at(&entry, &message));
                };
                list.push(number);
            }
            // Leave out zero, which stands for none.
            list.retain(|&number| number > 0);
            list.sort_unstable();
            list.dedup();
            found.insert(key, Numbers { entry, list });
        }
        Ok(found)
    }

    /// A whole number behind a key; what follows a comma is passed over, since old files repeat the colour there.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) when it is none.
    pub fn whole(&self, entry: &Entry) -> Result<u32> {
        let first = entry.value.split(',').next().unwrap_or_default().trim();
        number(first, MAX_NUMBER).ok_or_else(|| {
            let message = format!("must be a whole number to {MAX_NUMBER}");
            self.at(entry, &message)
        })
    }

    /// Yes or no behind a key.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) when it is neither.
    pub fn yes(&self, entry: &Entry) -> Result<bool> {
        let word = |known: &[&str]| known.iter().any(|known| known.eq_ignore_ascii_case(entry.value));
        match (word(&["true", "on", "yes", "1"]), word(&["false", "off", "no", "0"])) {
            (true, _) => Ok(true),
            (_, true) => Ok(false),
            _ => Err(self.at(entry, "must be true, on, yes or 1, or false, off, no or 0")),
        }
    }

    /// A length that is not negative, behind a key.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) when it is none.
    pub fn length(&self, entry: &Entry) -> Result<f64> {
        let value = entry.value.parse().ok().filter(|value: &f64| value.is_finite() && *value >= 0.0);
        value.ok_or_else(|| self.at(entry, "must be a number from 0"))
    }

    /// Refuse a second line of a key that says something else: programs differ in which of them they take.
    fn check_double(&self, before: Option<&Entry>, entry: &Entry) -> Result<()> {
        match before {
            Some(before) if before.value != entry.value => {
                let (line, key, value) = (before.line, shorten(before.key), shorten(before.value));
                Err(self.at(entry, &format!("line {line} says {key}={value}; leave one of them")))
            }
            _ => Ok(()),
        }
    }
}

/// A whole number in digits.
fn number(text: &str, most: u32) -> Option<u32> {
    let digits = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    text.parse().ok().filter(|number| digits && *number <= most)
}
