//! Bad WIF files: what the program says of them.

use crate::common::program::Place;
use crate::common::wif_files::CLOTH;
use fiberwalk::scene::{Scene, Source};

/// A WIF file of a 2/2 twill; its first line of a section is 4.
const FILE: &str = "[WIF]\nVersion=1.1\n[WEAVING]\nShafts=4\nTreadles=4\nRising Shed=true\n[WARP]\nThreads=4\nColor=1\n\
                    Units=cm\nSpacing=0.05\n[WEFT]\nThreads=4\nColor=1\nUnits=cm\nSpacing=0.05\n[THREADING]\n1=1\n2=2\n\
                    3=3\n4=4\n[TIEUP]\n1=1,2\n2=2,3\n3=3,4\n4=1,4\n[TREADLING]\n1=1\n2=2\n3=3\n4=4\n\
                    [COLOR TABLE]\n1=0,0,139\n2=255,255,255\n";
const COLOURS: &str = "colors = { 1 = \"a\" }";
const PLAIN: &str = "warp = [\"a\"]\nweft = [\"a\"]";

/// What is said of a WIF file and the lines of a weave, without the folder.
fn complaint(wif: impl AsRef<[u8]>, lines: &str) -> String {
    let place = Place::new();
    place.write("t.wif", wif);
    let folder = place.path("");
    let (file, stem, text) = ("cloth.toml".into(), "cloth".into(), format!("{CLOTH}{lines}\n"));
    let error = Scene::parse(&Source { file, stem, text, folder: Some(folder.clone()) }).expect_err(lines);
    assert_eq!(error.exit_code(), 2);
    error.to_string().replace(&folder.display().to_string(), "")
}

/// Edits of the file, and what is said.
fn refuse(cases: &[(&str, &str, &str)]) {
    for (old, new, message) in cases {
        assert_eq!(FILE.matches(old).count(), 1, "`{old}` must be there once");
        assert_eq!(complaint(FILE.replace(old, new), &format!("wif = \"t.wif\"\n{COLOURS}")), *message, "{new}");
    }
}

/// Lines of the weave, and what is said of the file or of them.
fn refuse_lines(cases: &[(&str, &str)]) {
    for (lines, message) in cases {
        assert_eq!(complaint(FILE, lines), *message, "{lines}");
    }
}

#[test]
fn a_line_at_fault_is_named() {
    let shafts = "must be numbers of shafts with commas between them, to 4096";
    let key = "`=` must follow a whole number to 1000000";
    refuse(&[
        (
            "2=2\n3=3\n4=4\n[TIEUP]",
            "2=9\n3=3\n4=4\n[TIEUP]",
            "t.wif:19:1: [THREADING] 2=9: shaft 9, but [WEAVING] Shafts says 4",
        ),
        ("1=1,2", "1=1,5", "t.wif:23:1: [TIEUP] 1=1,5: shaft 5, but [WEAVING] Shafts says 4"),
        (
            "2=2\n3=3\n4=4\n[COLOR",
            "2=2,7\n3=3\n4=4\n[COLOR",
            "t.wif:29:1: [TREADLING] 2=2,7: treadle 7, but [WEAVING] Treadles says 4",
        ),
        ("1=1,2", "1=1;2\n5=one", &format!("t.wif:24:1: [TIEUP] 5=one: {shafts}")),
        ("1=1,2", "1=1 2", &format!("t.wif:23:1: [TIEUP] 1=1 2: {shafts}")),
        ("1=1,2", "1=-1", &format!("t.wif:23:1: [TIEUP] 1=-1: {shafts}")),
        ("1=1,2", "1=5000", &format!("t.wif:23:1: [TIEUP] 1=5000: {shafts}")),
        ("1=1,2", "first=1,2", &format!("t.wif:23:1: [TIEUP] first=1,2: {key}")),
        ("1=1,2", "1000001=1,2", &format!("t.wif:23:1: [TIEUP] 1000001=1,2: {key}")),
        ("[THREADING]\n", "[THREADING]\n0=1\n", "t.wif:18:1: [THREADING] 0=1: numbers start at 1"),
        ("[TIEUP]\n", "[TIEUP]\n0=1,2\n", "t.wif:23:1: [TIEUP] 0=1,2: numbers start at 1"),
        ("[TREADLING]\n", "[TREADLING]\n0=1\n", "t.wif:28:1: [TREADLING] 0=1: numbers start at 1"),
        ("[TREADLING]\n", "[LIFTPLAN]\n0=1,2\n[TREADLING]\n", "t.wif:28:1: [LIFTPLAN] 0=1,2: numbers start at 1"),
        ("[COLOR TABLE]\n", "[WARP COLORS]\n0=1\n[COLOR TABLE]\n", "t.wif:33:1: [WARP COLORS] 0=1: numbers start at 1"),
        // A file that counts from 0 throughout.
        (
            "[THREADING]\n1=1\n2=2\n3=3\n4=4\n",
            "[THREADING]\n0=0\n1=1\n2=2\n3=3\n",
            "t.wif:18:1: [THREADING] 0=0: numbers start at 1",
        ),
        ("1=1,2", "1 1,2", "t.wif:23:1: [TIEUP] `1 1,2` is neither KEY=VALUE nor a comment after `;`"),
        ("[TIEUP]", "[TIEUP", "t.wif:22:1: [THREADING] `[TIEUP` is neither KEY=VALUE nor a comment after `;`"),
        ("1=1,2", "1=1,2\n1=2", "t.wif:24:1: [TIEUP] 1=2: line 23 says 1=1,2; leave one of them"),
        ("Shafts=4", "Shafts=4\nshafts=8", "t.wif:5:1: [WEAVING] shafts=8: line 4 says Shafts=4; leave one of them"),
        ("Shafts=4", "Shafts=four", "t.wif:4:1: [WEAVING] Shafts=four: must be a whole number to 1000000"),
        (
            "Rising Shed=true",
            "Rising Shed=maybe",
            "t.wif:6:1: [WEAVING] Rising Shed=maybe: must be true, on, yes or 1, or false, off, no or 0",
        ),
        ("[WARP]\nThreads=4", "[WARP]\nThreads=-4", "t.wif:8:1: [WARP] Threads=-4: must be a whole number to 1000000"),
        (
            "[COLOR TABLE]",
            "[WARP COLORS]\n2=red\n[COLOR TABLE]",
            "t.wif:33:1: [WARP COLORS] 2=red: must be a whole number to 1000000",
        ),
    ]);
    let long = "x".repeat(5000);
    let message = complaint(FILE.replace("1=1,2", &format!("1={long}")), &format!("wif = \"t.wif\"\n{COLOURS}"));
    assert_eq!(message, format!("t.wif:23:1: [TIEUP] 1={}…: {shafts}", &long[..60]));
}

#[test]
fn a_cloth_that_would_fall_apart_is_refused_by_its_thread() {
    refuse(&[
        (
            "3=3\n4=4\n[TIEUP]",
            "4=4\n[TIEUP]",
            "t.wif:20:1: [THREADING] 4=4: end 3 before it has no shaft, but must have one inside a cloth",
        ),
        (
            "2=2\n3=3\n4=4\n[COLOR",
            "2=0\n4=4\n[COLOR",
            "t.wif:30:1: [TREADLING] 4=4: picks 2 to 3 before it have no treadle, but must have one inside a cloth",
        ),
        (
            "1=1,2",
            "1=1,2,3,4",
            "t.wif:28:1: [TREADLING] 1=1: pick 1 never goes over an end: the cloth would fall apart",
        ),
        ("1=1,2", "1=0", "t.wif:28:1: [TREADLING] 1=1: pick 1 never goes under an end: the cloth would fall apart"),
        (
            "2=2\n3=3\n4=4\n[COLOR",
            "2=1\n3=1\n4=1\n[COLOR",
            "t.wif:18:1: [THREADING] 1=1: end 1 never goes under a pick: the cloth would fall apart",
        ),
        (
            "4=4\n[TIEUP]",
            "4=1,2,3\n[TIEUP]",
            "t.wif:21:1: [THREADING] 4=1,2,3: end 4 never goes under a pick: the cloth would fall apart",
        ),
        (
            "1=1,2\n2=2,3\n3=3,4\n4=1,4",
            "1=1\n2=1,2\n3=3\n4=1",
            "t.wif:21:1: [THREADING] 4=4: end 4 never goes over a pick: the cloth would fall apart",
        ),
    ]);
}

#[test]
fn what_a_file_lacks_is_said_at_the_key_that_names_it() {
    let sheds = "cloth.toml:15:7: `t.wif` has neither a [TIEUP] with a [TREADLING] nor a [LIFTPLAN]";
    refuse(&[
        ("[THREADING]", "[PRIVATE]", "cloth.toml:15:7: `t.wif` has no end on a shaft in [THREADING]"),
        ("[TIEUP]", "[PRIVATE]", sheds),
        ("[TREADLING]", "[PRIVATE]", sheds),
        ("1=1,2\n2=2,3\n3=3,4\n4=1,4\n", "", sheds),
    ]);
    for nothing in ["", "\u{feff}", "no file of this kind", "\0\0\0\0"] {
        let message = complaint(nothing, &format!("wif = \"t.wif\"\n{COLOURS}"));
        assert_eq!(message, "cloth.toml:15:7: `t.wif` has no end on a shaft in [THREADING]");
    }
    let wide: Vec<u8> = [0xfe, 0xff].into_iter().chain(FILE.bytes().flat_map(|byte| [0, byte])).collect();
    let message = "cloth.toml:15:7: cannot read the WIF file `t.wif`: it is UTF-16 text; save the file as UTF-8";
    assert_eq!(complaint(wide, &format!("wif = \"t.wif\"\n{COLOURS}")), message);
    let message = "cloth.toml:15:7: cannot read the WIF file `t.wif`: it is longer than 1024 KiB";
    assert_eq!(complaint(";".repeat((1 << 20) + 1), &format!("wif = \"t.wif\"\n{COLOURS}")), message);
    assert!(complaint(";".repeat(1 << 20), &format!("wif = \"t.wif\"\n{COLOURS}")).ends_with("in [THREADING]"));
}

#[test]
fn settings_that_cannot_be_used_are_refused_unless_the_cloth_file_has_its_own() {
    let even = "all must have one; `ends_per_cm` in the cloth file sets it";
    let cases = [
        (
            "[WARP]\nThreads=4\nColor=1\nUnits=cm\nSpacing=0.05",
            "[WARP]\nThreads=4\nColor=1",
            "cloth.toml:14:1: [weave] needs `ends_per_cm`: `t.wif` gives no Spacing in [WARP]".to_owned(),
        ),
        (
            "Color=1\nUnits=cm\nSpacing=0.05\n[WEFT]",
            "Color=1\nUnits=cm\nSpacing=0\n[WEFT]",
            "cloth.toml:14:1: [weave] needs `ends_per_cm`: `t.wif` gives no Spacing in [WARP]".to_owned(),
        ),
        (
            "Color=1\nUnits=cm\nSpacing=0.05\n[WEFT]",
            "Color=1\nSpacing=0.05\n[WEFT]",
            "t.wif:10:1: [WARP] Spacing=0.05: [WARP] needs Units=decipoints, inches or centimeters".to_owned(),
        ),
        (
            "Color=1\nUnits=cm\nSpacing=0.05\n[WEFT]",
            "Color=1\nUnits=cm\nSpacing=50\n[WEFT]",
            "t.wif:11:1: [WARP] Spacing=50: is 500 mm, but must be from 0.01 to 100 mm".to_owned(),
        ),
        (
            "[COLOR TABLE]",
            "[WARP SPACING]\n3=0.07\n[COLOR TABLE]",
            format!("t.wif:33:1: [WARP SPACING] 3=0.07: the threads before it have a Spacing of 0.05, but {even}"),
        ),
    ];
    for (old, new, message) in &cases {
        refuse(&[(old, new, message)]);
        let place = Place::new();
        place.write("t.wif", FILE.replace(old, new));
        let text = format!("{CLOTH}wif = \"t.wif\"\n{COLOURS}\nends_per_cm = 20\n");
        let source = Source { file: "cloth.toml".into(), stem: "c".into(), text, folder: Some(place.path("")) };
        assert!(Scene::parse(&source).is_ok(), "{new}");
    }
    refuse(&[
        (
            "Color=1\nUnits=cm\nSpacing=0.05\n[WEFT]",
            "Color=1\nUnits=ells\nSpacing=0.05\n[WEFT]",
            "t.wif:10:1: [WARP] Units=ells: must be decipoints, inches or centimeters",
        ),
        (
            "Color=1\nUnits=cm\nSpacing=0.05\n[WEFT]",
            "Color=1\nUnits=cm\nSpacing=-1\n[WEFT]",
            "t.wif:11:1: [WARP] Spacing=-1: must be a number from 0",
        ),
        (
            "Color=1\nUnits=cm\nSpacing=0.05\n[WEFT]",
            "Color=1\nUnits=cm\nSpacing=nan\n[WEFT]",
            "t.wif:11:1: [WARP] Spacing=nan: must be a number from 0",
        ),
        (
            "Color=1\nUnits=cm\nSpacing=0.05\n[WEFT]",
            "Color=1\nUnits=cm\nSpacing=0.02\n[WEFT]",
            "cloth.toml:15:7: yarn `a` is 300 µm wide, but ends lie 200 µm apart: it can be 200 µm wide at most",
        ),
    ]);
}

#[test]
fn colours_are_named_completely() {
    let striped = FILE.replace("[COLOR TABLE]", "[COLOR PALETTE]\nRange=0,510\n[WARP COLORS]\n2=2\n3=7\n[COLOR TABLE]");
    for (lines, message) in [
        (
            "wif = \"t.wif\"",
            "14:1: [weave] needs `warp`, or `colors` for the colours of `t.wif`: 1 (rgb 0, 0, 70), 2 (rgb 128, 128, 128), 7 (not in [COLOR TABLE])",
        ),
        (
            "wif = \"t.wif\"\nwarp = [\"a\"]",
            "14:1: [weave] needs `weft`, or `colors` for the colours of `t.wif`: 1 (rgb 0, 0, 70)",
        ),
        (
            "wif = \"t.wif\"\ncolors = { 1 = \"a\" }",
            "16:10: `colors` names no yarn for these colours of `t.wif`: 2 (rgb 128, 128, 128), 7 (not in [COLOR TABLE])",
        ),
        (
            "wif = \"t.wif\"\ncolors = { 1 = \"a\", 3 = \"a\" }",
            "16:25: `t.wif` has no colour 3; colours: 1 (rgb 0, 0, 70), 2 (rgb 128, 128, 128), 7 (not in [COLOR TABLE])",
        ),
        ("wif = \"t.wif\"\ncolors = { 1 = \"a\", 2 = \"white\" }", "16:25: there is no [yarn.white]; yarns: a, b"),
        (
            "wif = \"t.wif\"\ncolors = [\"a\"]",
            "16:10: `weave.colors` is [\"a\"], but must be a table from colours of the WIF file to yarns, such as { 1 = \"white\", 2 = \"blue\" }",
        ),
    ] {
        assert_eq!(complaint(&striped, lines), format!("cloth.toml:{message}"), "{lines}");
    }
    let without = FILE.replacen("Color=1\n", "", 1);
    let message = "cloth.toml:16:10: `t.wif` has threads without a colour: neither a line in [WARP COLORS] nor Color in [WARP]; \
                   give `warp` in place of `colors`";
    assert_eq!(complaint(without, &format!("wif = \"t.wif\"\n{COLOURS}")), message);
    // More colours than one can read.
    let many: String = (1..=4).map(|thread| format!("{thread}={}\n", thread + 2)).collect();
    let long: String = (3..=40).map(|colour| format!("{colour}=1,2,3\n")).collect();
    let message = complaint(format!("{FILE}{long}[WARP COLORS]\n{many}"), "wif = \"t.wif\"\ncolors = { 99 = \"a\" }");
    assert!(message.ends_with("16 (rgb 1, 2, 3), and 24 more"), "{message}");
}

#[test]
fn keys_of_the_cloth_file_that_do_not_go_together_are_refused() {
    let form = "a table such as { file = \"twill.wif\", ends = [1, 24], picks = [1, 24] }";
    let range = "two numbers [first, last] of threads of the WIF file, from 1";
    refuse_lines(&[
        ("wif = \"t.wif\"\ndraft = [\"X.\", \".X\"]", "cloth.toml:15:7: a weave has a `draft` or a `wif`, not both"),
        (PLAIN, "cloth.toml:14:1: [weave] needs a `draft` or a `wif`"),
        (
            &format!("wif = \"t.wif\"\n{PLAIN}\n{COLOURS}"),
            "cloth.toml:18:10: `colors` has no use: `warp` and `weft` name the yarns",
        ),
        (
            &format!("draft = [\"X.\", \".X\"]\n{COLOURS}"),
            "cloth.toml:16:10: `colors` belongs to a `wif`, and the weave has a `draft`",
        ),
        ("wif = 3", &format!("cloth.toml:15:7: `weave.wif` is 3, but must be the name of a WIF file, or {form}")),
        ("wif = {}", "cloth.toml:15:7: [weave.wif] needs `file`"),
        ("wif = { file = 3 }", "cloth.toml:15:16: `weave.wif.file` is 3, but must be a text in quotes"),
        (
            "wif = { file = \"t.wif\", end = 3 }",
            "cloth.toml:15:25: unknown key `end` in [weave.wif], did you mean `ends`?; allowed: file, ends, picks",
        ),
        (
            "wif = { file = \"t.wif\", ends = [3] }",
            &format!("cloth.toml:15:32: `weave.wif.ends` is [3], but must be {range}"),
        ),
        (
            "wif = { file = \"t.wif\", ends = [3, 2] }",
            &format!("cloth.toml:15:32: `weave.wif.ends` is [3, 2], but must be {range}"),
        ),
        (
            "wif = { file = \"t.wif\", ends = [0, 2] }",
            &format!("cloth.toml:15:33: `weave.wif.ends` is 0, but must be {range}"),
        ),
        (
            "wif = { file = \"t.wif\", ends = [2, 9] }",
            "cloth.toml:15:32: `t.wif` has the ends 1 to 4, not all of 2 to 9",
        ),
        (
            "wif = { file = \"t.wif\", picks = [8, 9] }",
            "cloth.toml:15:33: `t.wif` has the picks 1 to 4, not all of 8 to 9",
        ),
        (
            "wif = { file = \"t.wif\", picks = [1, 1] }",
            "t.wif:18:1: [THREADING] 1=1: end 1 never goes under a pick: the cloth would fall apart",
        ),
        (
            "wif = \"x.wif\"",
            "cloth.toml:15:7: cannot read the WIF file `x.wif`: No such file or directory (os error 2)",
        ),
        ("wif = \"\"", "cloth.toml:15:7: cannot read the WIF file ``: Is a directory (os error 21)"),
    ]);
}

#[test]
fn a_repeat_has_256_threads_at_most_and_a_file_4096() {
    let straight = |count: usize| (1..=count).map(|n| format!("{n}={n}\n")).collect::<String>();
    let satin = |count: usize| format!("[THREADING]\n{0}[LIFTPLAN]\n{0}", straight(count));
    let choose = "choose some of them, such as wif = { file = \"…\", ends = [1, 24], picks = [1, 24] }";
    let lines = format!("wif = \"t.wif\"\n{PLAIN}\nends_per_cm = 10\npicks_per_cm = 10");
    let message =
        format!("cloth.toml:15:7: the repeat of `t.wif` has 257 ends and 257 picks; allowed: 256 of each; {choose}");
    assert_eq!(complaint(satin(257), &lines), message);
    let message = format!("cloth.toml:15:7: `t.wif` has 4097 ends and 1 picks; allowed: 4096 of each; {choose}");
    let shaft = (1..=4097).map(|n| format!("{n}=1\n")).collect::<String>();
    assert_eq!(complaint(format!("[THREADING]\n{shaft}[LIFTPLAN]\n1=1\n"), &lines), message);
    // Numbers alone take no room.
    let far = "[WARP]\nThreads=1000000\n[THREADING]\n999999=1\n1000000=2\n[LIFTPLAN]\n999999=1\n1000000=2\n";
    let place = Place::new();
    place.write("t.wif", far);
    let source =
        Source { file: "c".into(), stem: "c".into(), text: format!("{CLOTH}{lines}"), folder: Some(place.path("")) };
    assert!(Scene::parse(&source).is_ok());
    // A list of yarns may make the repeat too long.
    let message = complaint(satin(100), &lines.replace("warp = [\"a\"]", "warp = [\"a\", \"a\", \"b\"]"));
    assert_eq!(
        message,
        "cloth.toml:15:7: the repeat has 300 ends (100 in the draft, 3 in `warp`) and 100 picks (100 in the draft, 1 in `weft`); allowed: 256 of each"
    );
}

#[test]
fn the_program_says_so_and_ends_with_2() {
    let place = Place::new();
    place.write("cloths/t.wif", FILE.replace("2=2\n3=3\n4=4\n[TIEUP]", "2=9\n3=3\n4=4\n[TIEUP]"));
    place.write(
        "cloths/cloth.toml",
        format!("{CLOTH}wif = \"t.wif\"\n{COLOURS}\n[model]\ncells = [16, 16, 4]\ncone_deg = 20\n"),
    );
    let outcome = place.run(&["inspect", "cloths/cloth.toml"]);
    let message = "error: cloths/t.wif:19:1: [THREADING] 2=9: shaft 9, but [WEAVING] Shafts says 4\n";
    assert_eq!((outcome.code, outcome.stderr.as_str(), outcome.stdout.as_str()), (Some(2), message, ""));
    // The file as it should be is inspected.
    place.write("cloths/t.wif", FILE);
    let outcome = place.run(&["inspect", "cloths/cloth.toml", "--width", "600"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    assert!(outcome.stdout.contains("4 ends × 4 picks"), "{}", outcome.stdout);
    assert!(outcome.stdout.contains("draft            of cloths/t.wif\n"), "{}", outcome.stdout);
}
