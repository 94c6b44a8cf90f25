//! What a shared library of Linux needs.

use std::env;

/// What the dynamic section of a library says.
pub struct Elf {
    /// Names of libraries that it needs.
    pub needed: Vec<String>,
    /// Whether it brings folders of its own to search.
    pub has_search_path: bool,
}

/// Types of program headers and of entries of the dynamic section.
const LOAD: u64 = 1;
const DYNAMIC: u64 = 2;
const NEEDED: u64 = 1;
const STRINGS: u64 = 5;
const SEARCH_PATHS: [u64; 2] = [15, 29];

impl Elf {
    /// Read a whole library of 64 bits, little-endian, for the machine of this program; none for others.
    pub fn new(bytes: &[u8]) -> Option<Elf> {
        let number = |at: usize, size: usize| -> Option<u64> {
            let part = bytes.get(at..at.checked_add(size)?)?;
            Some(part.iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte)))
        };
        let machine = match env::consts::ARCH {
            "x86_64" => 62,
            "aarch64" => 183,
            "riscv64" => 243,
            _ => return None,
        };
        if !bytes.starts_with(b"\x7fELF\x02\x01") || number(18, 2)? != machine {
            return None;
        }
        let (first, size, count) = (number(32, 8)? as usize, number(54, 2)? as usize, number(56, 2)? as usize);
        // Type, offset in the file, address, bytes in the file.
        let header = |i: usize| {
            let at = first.checked_add(i * size)?;
            Some([number(at, 4)?, number(at + 8, 8)?, number(at + 16, 8)?, number(at + 32, 8)?])
        };
        let headers: Vec<[u64; 4]> = (0..count).filter_map(header).collect();
        let [_, dynamic, _, length] = headers.iter().find(|[kind, ..]| *kind == DYNAMIC)?;
        let entry = |i: u64| {
            let at = dynamic.checked_add(16 * i)? as usize;
            Some((number(at, 8)?, number(at.checked_add(8)?, 8)?))
        };
        let entries: Vec<(u64, u64)> = (0..length / 16).map_while(entry).take_while(|(kind, _)| *kind != 0).collect();
        let strings = entries.iter().find(|(kind, _)| *kind == STRINGS)?.1;
        let inside = |[kind, _, start, length]: &&[u64; 4]| *kind == LOAD && strings.wrapping_sub(*start) < *length;
        let [_, offset, start, _] = headers.iter().find(inside)?;
        let strings = offset.checked_add(strings - start)?;
        let text = |place: u64| -> Option<String> {
            let bytes = bytes.get(usize::try_from(strings.checked_add(place)?).ok()?..)?;
            let end = bytes.iter().position(|byte| *byte == 0)?;
            Some(String::from_utf8_lossy(&bytes[..end]).into_owned())
        };
        let needed = entries.iter().filter(|(kind, _)| *kind == NEEDED).filter_map(|(_, place)| text(*place)).collect();
        Some(Elf { needed, has_search_path: entries.iter().any(|(kind, _)| SEARCH_PATHS.contains(kind)) })
    }
}
