//! The repeat of a sequence of threads.

use std::collections::HashMap;
use std::hash::Hash;

/// The smallest period that a sequence shows at least twice, or its length.
pub fn period<T: Eq + Hash>(sequence: impl Iterator<Item = T>) -> usize {
    let mut known = HashMap::new();
    let words: Vec<usize> = sequence
        .map(|word| {
            let next = known.len();
            *known.entry(word).or_insert(next)
        })
        .collect();
    // Find the longest proper border of every beginning (Knuth, Morris, Pratt 1977).
    let mut borders = vec![0; words.len()];
    for place in 1..words.len() {
        let mut border = borders[place - 1];
        while border > 0 && words[border] != words[place] {
            border = borders[border - 1];
        }
        borders[place] = border + usize::from(words[border] == words[place]);
    }
    let smallest = words.len() - borders.last().copied().unwrap_or_default();
    if 2 * smallest <= words.len() { smallest } else { words.len() }
}

#[cfg(test)]
mod tests {
    use super::period;

    #[test]
    fn a_period_shows_twice_or_is_the_whole() {
        for (word, expected) in [
            ("a", 1),
            ("aa", 1),
            ("ab", 2),
            ("aba", 3),
            ("abab", 2),
            ("ababa", 2),
            ("abcab", 5),
            ("abcabc", 3),
            ("abcabcab", 3),
            ("abcdcba", 7),
            ("aabaab", 3),
            ("aabaaba", 3),
            ("aaab", 4),
        ] {
            assert_eq!(period(word.chars()), expected, "{word}");
        }
    }
}
