//! WIF files and cloth files made by chance: right ones, and right ones with mistakes.
#![allow(dead_code, reason = "each binary uses its own part")]

pub mod fuzz;

/// A cloth file up to its weave, with the yarns `a` and `b`.
pub const CLOTH: &str = "[fiber.cotton]\nradius_um = 6\nior = 1.5\n[yarn.a]\nfiber = \"cotton\"\nfibers_per_ply = 50\n\
                         width_um = 300\nheight_um = 200\n[yarn.b]\nfiber = \"cotton\"\nfibers_per_ply = 50\n\
                         width_um = 250\nheight_um = 250\n[weave]\n";

/// Numbers by chance, always the same for a seed (SplitMix64: Steele, Lea, Flood 2014).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A whole number below another.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    pub fn pick<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }

    /// Some of the numbers from 1 to the last, at least one.
    fn some(&mut self, last: usize, most: usize) -> Vec<usize> {
        (0..1 + self.below(most)).map(|_| 1 + self.below(last)).collect()
    }
}

/// A plan by chance: shafts of the ends, shafts of the treadles, treadles of the picks.
pub struct Loom {
    pub shafts: usize,
    pub rising: bool,
    pub threading: Vec<Vec<usize>>,
    pub tie_up: Vec<Vec<usize>>,
    pub treadling: Vec<Vec<usize>>,
    pub colours: [Vec<usize>; 2],
}

impl Loom {
    pub fn new(random: &mut Random) -> Loom {
        let (shafts, treadles) = (2 + random.below(8), 2 + random.below(8));
        let several = 1 + random.below(2);
        // Threads that stand there over and over have a period.
        let mut threads = |last: usize, most: usize| {
            let (length, times) = (1 + random.below(12), 1 + random.below(4));
            let once: Vec<Vec<usize>> = (0..length).map(|_| random.some(last, most)).collect();
            once.iter().cycle().take(length * times + random.below(length)).cloned().collect::<Vec<_>>()
        };
        let (threading, treadling) = (threads(shafts, several), threads(treadles, several));
        let tie_up = (0..treadles).map(|_| random.some(shafts, shafts)).collect();
        let rising = random.below(3) > 0;
        let colours = [threading.len(), treadling.len()].map(|count| {
            let cycle = 1 + random.below(3);
            (0..count).map(|thread| 1 + thread / cycle % 2).collect()
        });
        Loom { shafts, rising, threading, tie_up, treadling, colours }
    }

    /// A twill of equal shafts and treadles, whose threads all interlace.
    pub fn twill(random: &mut Random) -> Loom {
        let shafts = 2 + random.below(7);
        let up = 1 + random.below(shafts - 1);
        let straight = |count: usize| (0..count).map(|thread| vec![1 + thread % shafts]).collect::<Vec<_>>();
        let counts = [shafts + random.below(30), shafts + random.below(30)];
        Loom {
            shafts,
            rising: random.below(3) > 0,
            threading: straight(counts[0]),
            tie_up: (0..shafts).map(|treadle| (0..up).map(|next| 1 + (treadle + next) % shafts).collect()).collect(),
            treadling: straight(counts[1]),
            colours: counts.map(|count| (0..count).map(|_| 1 + random.below(10) / 9).collect()),
        }
    }

    /// Whether an end lies over a pick.
    pub fn over(&self, end: usize, pick: usize) -> bool {
        let mut lifted = self.treadling[pick].iter().flat_map(|treadle| &self.tie_up[treadle - 1]);
        lifted.any(|shaft| self.threading[end].contains(shaft)) == self.rising
    }

    /// The file, by tie-up and treadling or by a lift plan.
    pub fn file(&self, lift_plan: bool) -> String {
        let numbers = |numbers: &[usize]| numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(",");
        let section = |name: &str, lists: &[Vec<usize>]| {
            let line = |(index, list): (usize, &Vec<usize>)| format!("{}={}\n", index + 1, numbers(list));
            format!("[{name}]\n{}", lists.iter().enumerate().map(line).collect::<String>())
        };
        let colours = |name: &str, of: &[usize]| section(name, &of.iter().map(|&c| vec![c]).collect::<Vec<_>>());
        let lifted = |pick: &Vec<usize>| pick.iter().flat_map(|treadle| self.tie_up[treadle - 1].clone()).collect();
        let sheds = match lift_plan {
            true => section("LIFTPLAN", &self.treadling.iter().map(lifted).collect::<Vec<Vec<usize>>>()),
            false => section("TIEUP", &self.tie_up) + &section("TREADLING", &self.treadling),
        };
        let system =
            |name: &str, count| format!("[{name}]\nThreads={count}\nColor=1\nUnits=Centimeters\nSpacing=0.05\n");
        [
            "[WIF]\nVersion=1.1\nDate=April 20, 1997\n[CONTENTS]\nTHREADING=true\n[TEXT]\nTitle=by chance; all of it\n"
                .into(),
            format!("[WEAVING]\nShafts={}\nTreadles={}\n", self.shafts, self.tie_up.len()),
            format!("Rising Shed={}\n", self.rising),
            system("WARP", self.threading.len()),
            system("WEFT", self.treadling.len()),
            "[COLOR PALETTE]\nEntries=2\nForm=RGB\nRange=0,999\n[COLOR TABLE]\n1=0,0,999\n2=999,999,999\n".into(),
            section("THREADING", &self.threading),
            sheds,
            colours("WARP COLORS", &self.colours[0]),
            colours("WEFT COLORS", &self.colours[1]),
        ]
        .concat()
    }
}

/// Words that matter to a reader of these files.
const WORDS: [&str; 50] = [
    "[",
    "]",
    "=",
    ";",
    ",",
    "\r",
    "\n",
    "\r\n",
    "\0",
    "\u{1a}",
    "\u{feff}",
    "0",
    "1",
    "-1",
    "4096",
    "4097",
    "65536",
    "1000000",
    "1000001",
    "4294967295",
    "4294967296",
    "99999999999999999999",
    "1e9",
    "nan",
    "inf",
    "0.05",
    "true",
    "no",
    "[THREADING]\n",
    "[TIEUP]\n",
    "[TREADLING]\n",
    "[LIFTPLAN]\n",
    "[WARP COLORS]\n",
    "[COLOR TABLE]\n",
    "[WARP SPACING]\n",
    "[WARP]\n",
    "[WEFT]\n",
    "[WEAVING]\n",
    "[PRIVATE X Y]\n",
    "Threads=",
    "Units=inches\n",
    "Spacing=",
    "Color=",
    "Shafts=",
    "Rising Shed=",
    "ä",
    "\u{2028}",
    "  ",
    "#",
    "…",
];

/// A file with some mistakes.
pub fn spoil(random: &mut Random, mut bytes: Vec<u8>) -> Vec<u8> {
    for _ in 0..random.below(6) {
        let at = random.below(bytes.len() + 1);
        let end = at + random.below((bytes.len() - at).min(40) + 1);
        match random.below(8) {
            0 => drop(bytes.drain(at..end)),
            1 => drop(bytes.splice(at..end, random.pick(&WORDS).bytes())),
            2 => drop(bytes.splice(at..at, random.pick(&WORDS).bytes())),
            3 => {
                let copy = bytes[at..end].to_vec();
                let there = random.below(bytes.len() + 1);
                bytes.splice(there..there, copy);
            }
            4 if at < bytes.len() => bytes[at] = random.next() as u8,
            5 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            6 => bytes.truncate(at.max(bytes.len() / 2)),
            _ => {
                // Put another number in the place of one.
                let digits = |byte: &u8| byte.is_ascii_digit();
                if let Some(start) = bytes[at..].iter().position(digits).map(|start| at + start) {
                    let length = bytes[start..].iter().take_while(|byte| digits(byte)).count();
                    let number = match random.below(3) {
                        0 => random.below(10),
                        1 => random.below(5000),
                        _ => random.next() as usize,
                    };
                    bytes.splice(start..start + length, number.to_string().bytes());
                }
            }
        }
    }
    bytes
}

/// A WIF file: most often a right one with mistakes, now and then bytes without sense, or a long one.
pub fn wif(random: &mut Random) -> Vec<u8> {
    let lift_plan = random.below(3) == 0;
    let loom = if random.below(2) == 0 { Loom::new(random) } else { Loom::twill(random) };
    let file = loom.file(lift_plan).into_bytes();
    match random.below(400) {
        0..8 => (0..random.below(400)).map(|_| random.next() as u8).collect(),
        8 => {
            let line = random.pick(&WORDS).as_bytes().to_vec();
            [file, line.repeat(random.below(60_000))].concat()
        }
        9 => long(random).into_bytes(),
        _ => spoil(random, file),
    }
}

/// As many threads, shafts and treadles as fit into a file.
pub fn long(random: &mut Random) -> String {
    let count = 3000 + random.below(1200);
    let section = |name: &str, line: &mut dyn FnMut(usize) -> String| {
        format!("[{name}]\n{}", (1..=count).map(|number| format!("{number}={}\n", line(number))).collect::<String>())
    };
    let all = (1..=4).map(|_| (1 + random.below(count)).to_string()).collect::<Vec<_>>().join(",");
    section("THREADING", &mut |number| number.to_string())
        + &section("TIEUP", &mut |number| format!("{number},{all}"))
        + &section("TREADLING", &mut |_| (1 + random.below(count)).to_string())
}

/// The lines of a weave in a cloth file, some of them wrong.
pub fn lines(random: &mut Random) -> String {
    let wif = [
        "\"f.wif\"",
        "{ file = \"f.wif\" }",
        "{ file = \"f.wif\", ends = [1, 4] }",
        "{ file = \"f.wif\", picks = [2, 9] }",
    ];
    let yarns = ["warp = [\"a\"]", "weft = [\"a\", \"b\"]", "warp = [\"a\", \"a\", \"b\"]\nweft = [\"b\"]", ""];
    let colors = [
        "colors = { 1 = \"a\", 2 = \"b\" }",
        "colors = { 1 = \"a\" }",
        "colors = { 1 = \"a\", 2 = \"a\", 3 = \"b\" }",
        "",
    ];
    let settings = ["", "", "ends_per_cm = 12", "ends_per_cm = 8\npicks_per_cm = 9", "picks_per_cm = 0.5"];
    let wif = if random.below(3) > 0 { wif[0] } else { random.pick(&wif) };
    let colors = if random.below(3) > 0 { colors[0] } else { random.pick(&colors) };
    let yarns = if random.below(3) > 0 { "" } else { random.pick(&yarns) };
    let text = format!("wif = {}\n{yarns}\n{colors}\n{}\n", wif, random.pick(&settings));
    match random.below(5) {
        0 => String::from_utf8_lossy(&spoil(random, text.into_bytes())).into_owned(),
        _ => text,
    }
}
