//! Read files with mistakes, and see that the program takes them or says what is wrong.

use super::{CLOTH, Random, lines, wif};
use fiberwalk::scene::{Scene, Source, Structure};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

/// What became of the files.
#[derive(Default)]
pub struct Count {
    pub tried: usize,
    pub taken: usize,
    /// The longest time that one took.
    pub slowest: Duration,
}

/// Read files until the time is over and at least so many were tried; a file that ends in a panic or is taken wrongly stays in the folder.
pub fn fuzz(seed: u64, time: Duration, least: usize, folder: &Path) -> Count {
    let start = Instant::now();
    let mut random = Random(seed);
    let mut count = Count::default();
    while start.elapsed() < time || count.tried < least {
        let (bytes, lines) = (wif(&mut random), lines(&mut random));
        let (file, text) = (folder.join("f.wif"), format!("{CLOTH}{lines}"));
        std::fs::write(&file, bytes).expect("a file can be written");
        let one = Instant::now();
        let taken = catch_unwind(AssertUnwindSafe(|| read(&text, folder)));
        count.slowest = count.slowest.max(one.elapsed());
        count.taken += usize::from(taken.unwrap_or_else(|_| {
            std::fs::write(folder.join("f.toml"), &text).expect("a file can be written");
            panic!("file {}: f.toml and f.wif in {}", count.tried, folder.display())
        }));
        count.tried += 1;
        // A file system waits for the disk when a file is written over.
        std::fs::remove_file(&file).expect("a file can be removed");
    }
    count
}

/// Whether a cloth is taken.
fn read(text: &str, folder: &Path) -> bool {
    let source = Source { file: "f.toml".into(), stem: "f".into(), text: text.into(), folder: Some(folder.into()) };
    match Scene::parse(&source) {
        Err(error) => {
            let message = error.to_string();
            assert_eq!(error.exit_code(), 2, "{message}");
            assert!(message.len() < 2000, "{} bytes of a message: {message}", message.len());
            false
        }
        Ok(Scene { structure: Structure::Weave(weave), .. }) => {
            let (ends, picks) = (weave.ends.len(), weave.picks.len());
            assert!((1..=256).contains(&ends) && (1..=256).contains(&picks) && weave.over.len() == ends * picks);
            assert!([weave.end_spacing, weave.pick_spacing].iter().all(|mm| (0.01..=100.0).contains(mm)));
            assert!((0..ends).all(|end| both((0..picks).map(|pick| weave.warp_over(end, pick)))), "an end is loose");
            assert!((0..picks).all(|pick| both((0..ends).map(|end| weave.warp_over(end, pick)))), "a pick is loose");
            true
        }
        Ok(_) => panic!("it is no weave"),
    }
}

/// Whether marks of both kinds are among some.
fn both(mut marks: impl Iterator<Item = bool>) -> bool {
    let first = marks.next();
    marks.any(|mark| Some(mark) != first)
}
