//! Files with mistakes, for as long as one likes: `cargo bench --bench fuzz_wif -- [SECONDS [SEED]]`.
//!
//! Cloth files that name WIF files, both by chance: no panic, no message without a place or an end, no cloth that cannot be.
//! The files at fault stay in the folder that is named. Prints how many were tried and taken, the longest time that one
//! took, and the peak memory of the process.

#[path = "../tests/common/wif_files/mod.rs"]
mod wif_files;

use fiberwalk::measure::peak_bytes;
use std::path::Path;
use std::time::Duration;

fn main() {
    // Cargo adds a flag of its own.
    let mut numbers = std::env::args().filter_map(|argument| argument.parse().ok());
    let (seconds, seed) = (numbers.next().unwrap_or(60), numbers.next().unwrap_or(1));
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz_wif");
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    let count = wif_files::fuzz::fuzz(seed, Duration::from_secs(seconds), 0, &folder);
    let peak = peak_bytes().map_or("unknown".into(), |bytes| format!("{} MiB", bytes >> 20));
    println!(
        "{} files tried, {} taken, slowest {} ms, peak memory {peak}",
        count.tried,
        count.taken,
        count.slowest.as_millis()
    );
}
