//! Reading TOML values with their places, so that every complaint names file, line and column.

use crate::error::{Error, Result};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A text and the name under which the user knows it.
pub struct Document<'a> {
    /// File name, `preset NAME` or the flag.
    pub file: String,
    /// The TOML text.
    pub source: &'a str,
}

impl Document<'_> {
    /// An error at a byte offset of the text.
    pub fn error(&self, offset: usize, message: impl Into<String>) -> Error {
        let before = &self.source.as_bytes()[..offset.min(self.source.len())];
        let start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
        Error::Scene {
            file: self.file.clone(),
            line: 1 + before.iter().filter(|&&byte| byte == b'\n').count(),
            column: 1 + String::from_utf8_lossy(&before[start..]).chars().count(),
            message: message.into(),
        }
    }

    /// The parser's complaint about malformed TOML.
    pub fn malformed(&self, error: &toml::de::Error) -> Error {
        let message = match error.message().trim().replace('\n', "; ") {
            // The parser says so of any missing or malformed value.
            message if message.starts_with("string values must be quoted") => {
                "expected one value after `=`: a number, a text in quotes, a list or a table".into()
            }
            message => message,
        };
        self.error(error.span().map_or(0, |span| span.start), message)
    }
}

/// A range of allowed numbers.
#[derive(Clone, Copy)]
pub struct Allowed {
    low: f64,
    open: bool,
    high: f64,
}

impl Allowed {
    /// low ≤ x ≤ high.
    pub const fn from(low: f64, high: f64) -> Allowed {
        Allowed { low, open: false, high }
    }

    /// low < x ≤ high.
    pub const fn above(low: f64, high: f64) -> Allowed {
        Allowed { low, open: true, high }
    }

    /// Whether a number is in the range.
    pub fn holds(&self, value: f64) -> bool {
        value.is_finite() && value <= self.high && if self.open { value > self.low } else { value >= self.low }
    }

    fn words(&self) -> String {
        let start = if self.open { "above" } else { "from" };
        let joint = if self.open { "and at most" } else { "to" };
        format!("a number {start} {} {joint} {}", self.low, self.high)
    }
}

/// A table of the file.
pub struct Table<'a> {
    document: &'a Document<'a>,
    /// Its name as the user writes it, such as `fiber.wool`; empty at the top.
    pub path: String,
    span: Range<usize>,
    table: &'a DeTable<'a>,
}

impl<'a> Table<'a> {
    /// The top of the document.
    pub fn root(document: &'a Document<'a>, table: &'a Spanned<DeTable<'a>>) -> Table<'a> {
        Table { document, path: String::new(), span: table.span(), table: table.get_ref() }
    }

    /// Refuse keys that are neither allowed nor among those known but not available yet.
    pub fn expect_keys(&self, allowed: &[&str], unavailable: &[(&str, &str)]) -> Result<()> {
        for key in self.table.keys() {
            let name: &str = key.get_ref();
            if let Some((_, why)) = unavailable.iter().find(|(known, _)| *known == name) {
                return Err(self.document.error(key.span().start, format!("`{name}` {why}")));
            }
            if !allowed.contains(&name) {
                let place = if self.path.is_empty() { "at the top".into() } else { format!("in [{}]", self.path) };
                let hint = hint(name, allowed);
                let list = list(allowed);
                let message = format!("unknown key `{name}` {place}{hint}; allowed: {list}");
                return Err(self.document.error(key.span().start, message));
            }
        }
        Ok(())
    }

    /// A value, if the key is there.
    pub fn get(&self, key: &str) -> Option<Value<'a>> {
        let (_, value) = self.table.iter().find(|(name, _)| name.get_ref() == key)?;
        let name = if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) };
        Some(Value { document: self.document, name, span: value.span(), value: value.get_ref() })
    }

    /// A value in a table of a table.
    pub fn at(&self, keys: &[&str]) -> Option<Value<'a>> {
        let (first, rest) = keys.split_first()?;
        let value = self.get(first)?;
        if rest.is_empty() { Some(value) } else { value.table().ok()?.at(rest) }
    }

    /// A value that must be there.
    pub fn require(&self, key: &str) -> Result<Value<'a>> {
        self.get(key).ok_or_else(|| {
            let place = if self.path.is_empty() { "the file".into() } else { format!("[{}]", self.path) };
            self.error(format!("{place} needs `{key}`"))
        })
    }

    /// All keys with their values.
    pub fn entries(&self) -> impl Iterator<Item = (&'a str, Value<'a>)> + '_ {
        self.table.keys().map(|key| key.get_ref().as_ref()).filter_map(|key| Some((key, self.get(key)?)))
    }

    /// An error at the head of the table.
    pub fn error(&self, message: impl Into<String>) -> Error {
        self.document.error(self.span.start, message)
    }
}

/// A value of the file.
#[derive(Clone)]
pub struct Value<'a> {
    document: &'a Document<'a>,
    name: String,
    span: Range<usize>,
    value: &'a DeValue<'a>,
}

impl<'a> Value<'a> {
    /// A value that stands alone, such as a flag's.
    pub fn alone(document: &'a Document<'a>, name: &str, value: &'a Spanned<DeValue<'a>>) -> Value<'a> {
        Value { document, name: name.into(), span: value.span(), value: value.get_ref() }
    }

    /// The same value under another name.
    pub fn named(&self, name: &str) -> Value<'a> {
        Value { name: name.into(), span: self.span.clone(), ..*self }
    }

    /// An error at this value.
    pub fn error(&self, message: impl Into<String>) -> Error {
        self.document.error(self.span.start, message)
    }

    /// The complaint that something else was expected here.
    pub fn expected(&self, what: &str) -> Error {
        let text = self.document.source.get(self.span.clone()).unwrap_or_default();
        let found = match self.value {
            DeValue::Table(_) => "a table".to_owned(),
            DeValue::Array(_) | DeValue::Integer(_) if text.len() > 60 => format!("an {}", self.value.type_str()),
            _ if text.len() > 60 => format!("a {}", self.value.type_str()),
            _ => text.to_owned(),
        };
        self.error(format!("`{}` is {found}, but must be {what}", self.name))
    }

    /// A number, in range.
    pub fn number(&self, allowed: Allowed) -> Result<f64> {
        self.any_number().filter(|value| allowed.holds(*value)).ok_or_else(|| self.expected(&allowed.words()))
    }

    /// Whether this is a number without end.
    pub fn is_infinite(&self) -> bool {
        self.any_number().is_some_and(|value| value == f64::INFINITY)
    }

    fn any_number(&self) -> Option<f64> {
        match self.value {
            DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|i| i as f64),
            DeValue::Float(float) => float.as_str().parse().ok(),
            _ => None,
        }
    }

    /// A whole number, in range, if the value is a number at all.
    pub fn integer(&self, low: u32, high: u32, what: &str) -> Result<u32> {
        let DeValue::Integer(integer) = self.value else { return Err(self.expected(what)) };
        let value = i64::from_str_radix(integer.as_str(), integer.radix()).ok();
        value
            .and_then(|value| u32::try_from(value).ok())
            .filter(|value| (low..=high).contains(value))
            .ok_or_else(|| self.expected(what))
    }

    /// A text.
    pub fn string(&self) -> Result<&'a str> {
        self.value.as_str().ok_or_else(|| self.expected("a text in quotes"))
    }

    /// A text, if the value is one.
    pub fn as_string(&self) -> Option<&'a str> {
        self.value.as_str()
    }

    /// One of a few words; words that are known but not available yet are refused by name.
    pub fn choice<T: Copy>(&self, available: &[(&str, T)], planned: &[&str]) -> Result<T> {
        let words: Vec<&str> = available.iter().map(|(word, _)| *word).collect();
        let word = self.value.as_str().ok_or_else(|| self.expected(&format!("one of {}", list(&words))))?;
        if let Some((_, choice)) = available.iter().find(|(known, _)| *known == word) {
            return Ok(*choice);
        }
        let name = &self.name;
        if planned.contains(&word) {
            let message = format!("`{name}`: \"{word}\" is not available yet; allowed: {}", list(&words));
            return Err(self.error(message));
        }
        let hint = hint(word, &words);
        Err(self.error(format!("`{name}`: unknown value \"{word}\"{hint}; allowed: {}", list(&words))))
    }

    /// A table.
    pub fn table(&self) -> Result<Table<'a>> {
        let table = self.value.as_table().ok_or_else(|| self.expected("a table"))?;
        Ok(Table { document: self.document, path: self.name.clone(), span: self.span.clone(), table })
    }

    /// The items of an array, if the value is one.
    pub fn as_array(&self) -> Option<Vec<Value<'a>>> {
        let array = self.value.as_array()?;
        let item = |value: &'a Spanned<DeValue<'a>>| Value::alone(self.document, &self.name, value);
        Some(array.iter().map(item).collect())
    }
}

/// The word nearest to what was typed, if one is near.
pub fn closest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let lower = word.to_lowercase();
    let distance = |candidate: &&&str| strsim::damerau_levenshtein(&lower, &candidate.to_lowercase());
    known.iter().min_by_key(distance).filter(|best| distance(best) <= 1 + word.len() / 4).copied()
}

fn hint(word: &str, known: &[&str]) -> String {
    closest(word, known).map(|best| format!(", did you mean `{best}`?")).unwrap_or_default()
}

fn list(words: &[&str]) -> String {
    words.join(", ")
}
