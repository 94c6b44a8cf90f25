//! Names of bases: how the hemisphere is cut into cells.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::fmt;

/// Most cells of a basis.
const MOST_CELLS: u32 = 1 << 16;
/// Most rings of a polar basis: one a degree.
const MOST_RINGS: u32 = 90;
/// Most sectors of a ring: one a degree.
const MOST_SECTORS: u32 = 360;

/// A way to cut the hemisphere, as the cloth file names it: `8`, `klems` or `polar:18x36`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "Value", into = "Value")]
pub enum BasisChoice {
    /// N × N cells of the concentric map, all of one projected solid angle.
    Disc(u32),
    /// The 145 cells of the full basis of Klems, centred on multiples of their width in φ.
    Klems,
    /// Rings of equal width in θ, each cut into equal sectors, the first of which begins at φ = 0.
    Polar {
        /// Rings from the normal to the horizon, 1 to 90.
        rings: u32,
        /// Sectors of a ring, 1 to 360.
        sectors: u32,
    },
}

impl BasisChoice {
    /// Number of cells.
    pub fn cells(self) -> usize {
        match self {
            BasisChoice::Disc(n) => (n as usize).pow(2),
            BasisChoice::Klems => 145,
            BasisChoice::Polar { rings, sectors } => rings as usize * sectors as usize,
        }
    }

    /// A basis that has a word for a name; none for other words.
    pub fn from_word(word: &str) -> Option<BasisChoice> {
        let number = |text: &str, most: u32| {
            let digits = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
            text.parse().ok().filter(|number| digits && (1..=most).contains(number))
        };
        match word.strip_prefix("polar:") {
            Some(size) => {
                let (rings, sectors) = size.split_once('x')?;
                Some(BasisChoice::Polar { rings: number(rings, MOST_RINGS)?, sectors: number(sectors, MOST_SECTORS)? })
            }
            None => (word == "klems").then_some(BasisChoice::Klems),
        }
    }
}

impl fmt::Display for BasisChoice {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            BasisChoice::Disc(n) => write!(formatter, "{n}"),
            BasisChoice::Klems => write!(formatter, "klems"),
            BasisChoice::Polar { rings, sectors } => write!(formatter, "polar:{rings}x{sectors}"),
        }
    }
}

impl From<BasisChoice> for Value {
    fn from(basis: BasisChoice) -> Value {
        match basis {
            BasisChoice::Disc(n) => json!(n),
            other => json!(other.to_string()),
        }
    }
}

impl TryFrom<Value> for BasisChoice {
    type Error = String;

    fn try_from(value: Value) -> Result<BasisChoice, String> {
        let disc = value.as_u64().and_then(|n| u32::try_from(n).ok()).map(BasisChoice::Disc);
        let basis = disc.or_else(|| BasisChoice::from_word(value.as_str()?));
        let sized = basis.filter(|basis| (1..=MOST_CELLS as usize).contains(&basis.cells()));
        sized.ok_or_else(|| format!("{value} is no basis"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_they_are_written() {
        for basis in [BasisChoice::Disc(16), BasisChoice::Klems, BasisChoice::Polar { rings: 18, sectors: 36 }] {
            let text = serde_json::to_string(&basis).expect("it has a name");
            assert_eq!(serde_json::from_str::<BasisChoice>(&text).expect("it is a name"), basis, "{text}");
        }
        for wrong in
            ["0", "257", "4294967296", "\"klem\"", "\"polar:0x36\"", "\"polar:91x36\"", "\"polar:1x361\"", "[8]"]
        {
            assert!(serde_json::from_str::<BasisChoice>(wrong).is_err(), "{wrong}");
        }
        for wrong in ["", "Klems", "polar:", "polar:18", "polar:18x", "polar:18x36x1", "polar:+8x9", "polar:18X36"] {
            assert_eq!(BasisChoice::from_word(wrong), None, "{wrong}");
        }
    }
}
