//! Drafts of WIF files, in the manner of several programs: what cloth they are.

use crate::common::program::Place;
use crate::common::wif_files::{CLOTH, Loom, Random};
use fiberwalk::results::About;
use fiberwalk::scene::{Scene, Source, Structure, Weave};

/// Yarn `a` everywhere and settings of its own, so that only the draft is the file's.
const PLAIN: &str = "warp = [\"a\"]\nweft = [\"a\"]\nends_per_cm = 20\npicks_per_cm = 10";
/// Yarns by colour, settings from the file.
const COLOURS: &str = "colors = { 1 = \"a\", 2 = \"b\" }";
/// A 2/2 twill: pick 1, the last row, lies under the ends 1 and 2.
const TWILL: [&str; 4] = ["X..X", "..XX", ".XX.", "XX.."];

/// A WIF file of a 2/2 twill, its sections in the order of the 1997 text.
const FILE: &str = "[WIF]\nVersion=1.1\n[WEAVING]\nShafts=4\nTreadles=4\nRising Shed=true\n[WARP]\nThreads=4\n\
                    [WEFT]\nThreads=4\n[THREADING]\n1=1\n2=2\n3=3\n4=4\n[TIEUP]\n1=1,2\n2=2,3\n3=3,4\n4=1,4\n[TREADLING]\n\
                    1=1\n2=2\n3=3\n4=4\n";

fn parse_in(place: &Place, wif: impl AsRef<[u8]>, lines: &str) -> fiberwalk::Result<Scene> {
    // Do not write over a file: that waits for the disk.
    let _ = std::fs::remove_file(place.path("twill.wif"));
    place.write("twill.wif", wif);
    let (file, stem, text) = ("cloth.toml".into(), "cloth".into(), format!("{CLOTH}wif = \"twill.wif\"\n{lines}\n"));
    Scene::parse(&Source { file, stem, text, folder: Some(place.path("")) })
}

fn weave(wif: impl AsRef<[u8]>, lines: &str) -> Weave {
    let scene = parse_in(&Place::new(), wif, lines).unwrap_or_else(|error| panic!("{error}"));
    match scene.structure {
        Structure::Weave(weave) => weave,
        Structure::Sheet(_) | Structure::Knit(_) => panic!("it is a weave"),
    }
}

fn draft(wif: impl AsRef<[u8]>) -> Vec<String> {
    weave(wif, PLAIN).draft()
}

/// The file with one thing replaced.
fn edit(old: &str, new: &str) -> String {
    assert_eq!(FILE.matches(old).count(), 1, "`{old}` must be there once");
    FILE.replace(old, new)
}

#[test]
fn a_tie_up_lifts_the_ends_of_its_shafts() {
    let woven = weave(FILE, PLAIN);
    assert_eq!(woven.draft(), TWILL);
    // End 1 is the left column, pick 1 the lowest row.
    assert!(woven.warp_over(0, 0) && woven.warp_over(1, 0) && !woven.warp_over(0, 1) && woven.warp_over(0, 3));
    assert!((woven.end_spacing, woven.pick_spacing) == (0.5, 1.0));
    // A tie-up that is another, and a treadling the other way round, are other cloths.
    assert_eq!(draft(edit("1=1,2\n", "1=1,3\n")), ["X..X", "..XX", ".XX.", "X.X."]);
    assert_eq!(
        draft(edit("1=1\n2=2\n3=3\n4=4\n[TIEUP]", "1=4\n2=3\n3=2\n4=1\n[TIEUP]")),
        ["X..X", "XX..", ".XX.", "..XX"]
    );
}

#[test]
fn a_lift_plan_says_the_same_without_treadles() {
    let lift_plan = "[LIFTPLAN]\n1=1,2\n2=2,3\n3=3,4\n4=4,1\n";
    let start = FILE.find("[TIEUP]").expect("it has one");
    assert_eq!(draft(format!("{}{lift_plan}", &FILE[..start])), TWILL);
    // Programs that write a lift plan say that there are no treadles, or as many as ever.
    assert_eq!(draft(format!("{}{lift_plan}", &FILE[..start]).replace("Treadles=4", "Treadles=0")), TWILL);
    // A lift plan may raise shafts that hold nothing.
    assert_eq!(draft(format!("{}{lift_plan}", &FILE[..start]).replace("3=3,4\n4=4,1", "3=3,4,9\n4=4,1")), TWILL);
    // Beside a tie-up and a treadling it is not looked at, but without one of them it is.
    let other = "[LIFTPLAN]\n1=1\n2=2\n3=3\n4=4\n";
    let satin = ["...X", "..X.", ".X..", "X..."];
    assert_eq!(draft(format!("{FILE}{other}")), TWILL);
    assert_eq!(draft(edit("[TIEUP]\n1=1,2\n2=2,3\n3=3,4\n4=1,4\n", other)), satin);
    assert_eq!(draft(edit("[TREADLING]\n1=1\n2=2\n3=3\n4=4\n", other)), satin);
    assert_eq!(draft(edit("[TREADLING]\n1=1\n2=2\n3=3\n4=4\n", &format!("[TREADLING]\n{other}"))), satin);
}

#[test]
fn a_sinking_shed_lowers_what_a_rising_shed_lifts() {
    let inverse = [".XX.", "XX..", "X..X", "..XX"];
    for (value, expected) in [
        ("true", TWILL),
        ("TRUE", TWILL),
        ("on", TWILL),
        ("Yes", TWILL),
        ("1", TWILL),
        ("", TWILL),
        ("false", inverse),
        ("off", inverse),
        ("no", inverse),
        ("0", inverse),
        ("0 ; counterbalance", inverse),
    ] {
        assert_eq!(draft(edit("Rising Shed=true", &format!("Rising Shed={value}"))), expected, "{value}");
    }
    assert_eq!(draft(edit("Rising Shed=true\n", "")), TWILL);
}

#[test]
fn several_shafts_and_several_treadles_act_together() {
    // End 4 hangs on the shafts 3 and 4 and goes up with either; pick 3 presses two treadles. 0 stands for none.
    let file = edit("4=4\n[TIEUP]", "4=4, 3,\n[TIEUP]").replace("3=3\n4=4\n", "3=3,2,0\n4=4\n");
    assert_eq!(file.matches("3=3,2,0").count(), 1);
    assert_eq!(draft(file), ["X..X", ".XXX", ".XXX", "XX.."]);
}

#[test]
fn plans_by_chance_are_the_cloth_that_a_loom_would_weave() {
    let (mut random, mut woven) = (Random(7), 0);
    for _ in 0..600 {
        let loom = if random.below(2) == 0 { Loom::new(&mut random) } else { Loom::twill(&mut random) };
        let place = Place::new();
        let [one, other] = [false, true].map(|lift_plan| parse_in(&place, loom.file(lift_plan), COLOURS));
        let (Ok(one), Ok(other)) = (&one, &other) else {
            // Loose threads are refused in both forms.
            assert!(one.is_err() && other.is_err());
            continue;
        };
        assert_eq!(one.structure, other.structure);
        let Structure::Weave(weave) = &one.structure else { panic!("it is a weave") };
        let (ends, picks) = (weave.ends.len(), weave.picks.len());
        // The repeat, laid side by side, is what the loom weaves, thread by thread and yarn by yarn.
        for end in 0..loom.threading.len() {
            assert_eq!(weave.ends[end % ends] + 1, loom.colours[0][end]);
            for pick in 0..loom.treadling.len() {
                assert_eq!(weave.warp_over(end % ends, pick % picks), loom.over(end, pick));
            }
        }
        assert!(loom.colours[1].iter().enumerate().all(|(pick, colour)| weave.picks[pick % picks] + 1 == *colour));
        woven += 1;
    }
    assert!(woven > 200, "only {woven} of the plans hold together");
}

#[test]
fn files_are_as_programs_write_them() {
    // Fiberworks: CR LF, the date in a comment, colours from 0 to 999, a default setting, every thread listed.
    let listed =
        |count: usize, of: &dyn Fn(usize) -> usize| (1..=count).map(|n| format!("{n}={}\n", of(n))).collect::<String>();
    let four = |n: usize| (n - 1) % 4 + 1;
    let fiberworks = format!(
        "[WIF]\nVersion=1.1\nDate=April 20, 1997\nDevelopers=wif@mhsoft.com\nSource Program=Fiberworks PCW\n\
         Source Version=4.2\n\n[CONTENTS]\nCOLOR PALETTE=true\nTIEUP=true\nLIFTPLAN=false\n\n[TEXT]\nTitle=a; b = [c\n\
         ; Creation Date=today\n[plain text\n\n[THREADING]\n{}\n[TIEUP]\n1=1,2\n2=2,3\n3=3,4\n4=1,4\n\n[TREADLING]\n{}\n\
         [WEAVING]\nRising Shed=true\nTreadles=4\nShafts=4\n\n[WARP]\nUnits=centimeters\nColor=1\nThreads=12\nSpacing=0.212\n\
         Thickness=0.212\n\n[WEFT]\nUnits=centimeters\nColor=2\nThreads=9\nSpacing=0.212\nThickness=0.212\n\n\
         [WARP COLORS]\n{}\n[COLOR TABLE]\n1=999,999,999\n2=0,0,500\n\n[COLOR PALETTE]\nRange=0,999\nEntries=2\n",
        listed(12, &four),
        listed(9, &four),
        listed(12, &|_| 1)
    );
    let woven = weave(fiberworks.replace('\n', "\r\n"), COLOURS);
    assert_eq!(
        (woven.draft(), woven.ends.clone(), woven.picks.clone()),
        (TWILL.map(String::from).to_vec(), vec![0; 4], vec![1; 4])
    );
    assert!((woven.end_spacing - 2.12).abs() < 1e-12 && (woven.pick_spacing - 2.12).abs() < 1e-12);

    // WeaveIt: 0 and 1, comments behind numbers, sparse colours, a lift plan beside the tie-up, sections of its own.
    let weaveit = "[WIF]\nVersion=1.1\nSource Program=Mac WeaveIt\n[CONTENTS]\nWEAVING=1\nNOTES\n[WEAVING]\nShafts=4 ; four\n\
                   Treadles=4\nRising Shed=1\nWeave Type=Balanced\n[WARP]\nThreads=8\nColor=1,0,0,0 ;default: dark\n\
                   Units=Inches\nSpacing=0.05     ;20 ends per inch\n[WEFT]\nThreads=8\nColor=2\nUnits=Inches\nSpacing=0.1\n\
                   [PRIVATE WEAVEIT BASICS]\nWEAVETYPE=BALANCE\nno line of the format\n[PRIVATE WEAVEIT WARP REPEATS]\n\
                   1=0,3,7\n[NOTES]\n1=one = two; three\nfree text\n[THREADING]\n8=4\n7=3\n6=2\n5=1\n4=4\n3=3\n2=2\n1=1\n\
                   [TIEUP]\n1=1,2   ;treadle 1 moves shafts 1 and 2\n2=2,3\n3=3,4\n4=1,4\n[LIFTPLAN]\n1=1,2\n2=2,3\n3=3,4\n\
                   4=1,4\n5=1,2\n6=2,3\n7=3,4\n8=1,4\n[TREADLING]\n1=1\n2=2\n3=3\n4=4\n5=1\n6=2\n7=3\n8=4\n\
                   [WARP COLORS]\n2=2\n4=2,255,255,255\n6=2\n8=2\n[WEFT COLORS]\n1=1\n3=1\n5=1\n7=1\n";
    let woven = weave(weaveit, COLOURS);
    assert_eq!(
        (woven.draft(), &woven.ends[..], &woven.picks[..]),
        (TWILL.map(String::from).to_vec(), &[0, 1, 0, 1][..], &[0, 1, 0, 1][..])
    );
    assert!((woven.end_spacing - 1.27).abs() < 1e-12 && (woven.pick_spacing - 2.54).abs() < 1e-12);

    // pyweaving: spaces around the sign, a lift plan and no treadles.
    let pyweaving = "[WIF]\nversion = 1.1\n\n[CONTENTS]\nweaving = true\n\n[WEAVING]\nrising shed = true\nshafts = 4\n\
                     treadles = 0\n\n[WARP]\nthreads = 4\nunits = centimeters\ncolor = 1\nspacing = 0.05\n\n[WEFT]\n\
                     threads = 4\nunits = centimeters\ncolor = 1\nspacing = .06\n\n[THREADING]\n1 = 1\n2 = 2\n3 = 3\n4 = 4\n\n\
                     [LIFTPLAN]\n1 = 1,2\n2 = 2,3\n3 = 3,4\n4 = 1, 4\n\n[COLOR PALETTE]\nentries = 1\nform = RGB\n\
                     range = 0,255\n\n[COLOR TABLE]\n1 = 0,0,0\n";
    let woven = weave(pyweaving, "colors = { 1 = \"b\" }");
    assert_eq!((woven.draft(), woven.ends[0], woven.end_spacing), (TWILL.map(String::from).to_vec(), 1, 0.5));

    // PixeLoom: names of blocks in comments. TempoWeave: lines of a semicolon, and names in any letters.
    assert_eq!(draft(edit("[THREADING]\n1=1\n2=2", "[THREADING]\n;[2]Border\n1=1;[2]Border\n2=2 ;[2]Ground")), TWILL);
    let tempo_weave =
        FILE.replace('[', ";\n[").replace("[THREADING]", "[ threading ]").replace("[TIEUP]", "[Tieup] ; x");
    assert_eq!(draft(tempo_weave.replace("Rising Shed", "RISING  shed")), TWILL);
}

#[test]
fn bytes_may_be_of_several_kinds() {
    let marked = [b"\xef\xbb\xbf".as_slice(), FILE.as_bytes()].concat();
    let latin = [b"; \xfcber\r[NOTES]\r1=K\xf6per\r".as_slice(), FILE.replace('\n', "\r").as_bytes()].concat();
    let mixed = FILE.replace("1=1\n", "1=1\r\n").replace("2=2\n", "2=2\r") + "\u{1a}\u{1a}";
    for bytes in [marked, latin, mixed.into_bytes(), FILE.replace('\n', "\n\n  \t").into_bytes()] {
        assert_eq!(draft(bytes), TWILL);
    }
    // A line may stand twice, if it says the same.
    assert_eq!(draft(edit("2=2\n3=3\n4=4\n[TIEUP]", "2=2\n2=2\n2=\n3=3\n4=4\n[TIEUP]")), TWILL);
    assert_eq!(draft(format!("{FILE}[THREADING]\n2=2\n[threading]\n")), TWILL);
}

#[test]
fn threads_that_are_not_threaded_are_no_part_of_the_cloth() {
    let threading = "1=1\n2=2\n3=3\n4=4\n[TIEUP]";
    // More are declared than threaded; the first and the last may be on no shaft.
    assert_eq!(draft(edit("[WARP]\nThreads=4", "[WARP]\nThreads=400")), TWILL);
    assert_eq!(draft(edit("[WARP]\nThreads=4", "[WARP]")), TWILL);
    assert_eq!(draft(edit("[WEFT]\nThreads=4", "[WEFT]\nThreads=0")), TWILL);
    assert_eq!(
        draft(
            edit(threading, "2=1\n3=2\n4=3\n5=4\n6=0\n7=\n[TIEUP]").replace("[WARP]\nThreads=4", "[WARP]\nThreads=9")
        ),
        TWILL
    );
    // Fewer are declared than threaded, treadled and tied up: the others are passed over.
    assert_eq!(draft(edit("4=4\n[TIEUP]", "4=4\n5=1\n6=1\n[TIEUP]")), TWILL);
    assert_eq!(draft(format!("{FILE}5=1\n6=1\n")), TWILL);
    assert_eq!(draft(edit("4=1,4\n", "4=1,4\n5=1,2\n6=9\n")), TWILL);
    // Without a number of them they count.
    assert_eq!(draft(edit("[WEFT]\nThreads=4", "[WEFT]") + "5=1\n"), ["XX..", "X..X", "..XX", ".XX.", "XX.."]);
    // A number of shafts or treadles may be missing.
    assert_eq!(draft(edit("Shafts=4\nTreadles=4\n", "")), TWILL);
}

#[test]
fn what_programs_leave_empty_or_write_besides_changes_nothing() {
    let treadles = edit("Treadles=4", "Treadles=10").replace("4=1,4\n", "4=1,4\n5=\n6=0\n10= ; none\n");
    assert_eq!(draft(treadles), TWILL);
    assert_eq!(draft(edit("[WEFT]\nThreads=4", "[WEFT]\nThreads=7") + "5=\n6=0\n7= ; none\n"), TWILL);
    assert_eq!(draft(edit("[TREADLING]\n", "[LIFTPLAN]\n1=\n2=\n[TREADLING]\n")), TWILL);
    // Thickness and symbols; wrong contents.
    for besides in [
        "[WARP THICKNESS]\n1=0.2\n3=0.4\n[WEFT THICKNESS]\n2=.1\n",
        "[CONTENTS]\nTIEUP=yes\nTREADLING=1\nLIFTPLAN=on\nCOLOR TABLE=\nNOTES=true\n",
        "[WARP SYMBOLS]\n1='a'\n[TRANSLATIONS]\n1=x\n[BITMAP FILE]\n1=a.bmp\n[BITMAP IMAGE]\n:)\n",
    ] {
        assert_eq!(draft(format!("{FILE}{besides}")), TWILL, "{besides}");
    }
    // Colours have the range of their palette, or none.
    let file = FILE.replace("[WARP]\n", "[WARP]\nColor=1\n") + "[WEFT COLORS]\n1=2\n2=2\n3=2\n4=2\n";
    let lines = format!("{COLOURS}\nends_per_cm = 10\npicks_per_cm = 10");
    for palette in ["Entries=2\nForm=RGB\nRange=0,255", "Entries=2\nRange=0,999", "Range=0,65535", ""] {
        let colours = format!("[COLOR PALETTE]\n{palette}\n[COLOR TABLE]\n1=200,0,0\n2=0,0,250\n");
        let woven = weave(file.clone() + &colours, &lines);
        assert_eq!((&woven.draft()[..], woven.ends[0], woven.picks[0]), (&TWILL.map(String::from)[..], 0, 1));
    }
}

#[test]
fn settings_come_from_the_file_in_its_units() {
    let spaced = |warp: &str, weft: &str| {
        FILE.replace("[WARP]\n", &format!("[WARP]\n{warp}\n")).replace("[WEFT]\n", &format!("[WEFT]\n{weft}\n"))
    };
    let yarns = "warp = [\"a\"]\nweft = [\"a\"]";
    for (lines, mm) in [
        ("Units=decipoints\nSpacing=36", 1.27),
        ("Units=Inches\nSpacing=.05", 1.27),
        ("Units=INCHES\nSpacing=0.05", 1.27),
        ("Units=Centimeters\nSpacing=0.127", 1.27),
        ("Units=cm\nSpacing=1.27e-1", 1.27),
    ] {
        let woven = weave(spaced(lines, "Spacing=0.1\nUnits=centimeters"), yarns);
        assert!((woven.end_spacing - mm).abs() < 1e-12 && (woven.pick_spacing - 1.0).abs() < 1e-12, "{lines}");
    }
    // The cloth file goes first.
    let woven = weave(spaced("Units=Inches\nSpacing=.05", "Spacing=7"), PLAIN);
    assert_eq!((woven.end_spacing, woven.pick_spacing), (0.5, 1.0));
    // Threads of one distance may be listed, with others that are no part of the cloth.
    let listed =
        |lines: &str| spaced("Units=cm\nSpacing=0.2", "Units=cm\nSpacing=0.1") + &format!("[WARP SPACING]\n{lines}");
    assert_eq!(weave(listed("1=0.05\n2=.05\n3=0.05\n4=5e-2\n5=0.3\n"), yarns).end_spacing, 0.5);
    assert_eq!(weave(listed("2=.05\n"), PLAIN).end_spacing, 0.5);
}

#[test]
fn colours_of_the_file_are_yarns_and_part_of_the_repeat() {
    let coloured = |warp: &str, weft: &str| {
        let file = FILE.replace("Threads=4", "Threads=8").replace("4=4\n[TIEUP]", "4=4\n5=1\n6=2\n7=3\n8=4\n[TIEUP]");
        format!("{file}5=1\n6=2\n7=3\n8=4\n[WARP COLORS]\n{warp}[WEFT COLORS]\n{weft}")
            .replace("Threads", "Color=1\nThreads")
    };
    let yarns = |lines: &str, warp: &str, weft: &str| {
        let woven = weave(coloured(warp, weft), &format!("{lines}\nends_per_cm = 10\npicks_per_cm = 10"));
        (woven.ends, woven.picks)
    };
    // Two stripes make eight ends of four.
    assert_eq!(yarns(COLOURS, "5=2\n6=2\n7=2\n8=2\n", ""), (vec![0, 0, 0, 0, 1, 1, 1, 1], vec![0; 4]));
    assert_eq!(yarns(COLOURS, "2=2\n4=2\n6=2\n8=2\n", "1=2\n"), (vec![0, 1, 0, 1], vec![1, 0, 0, 0, 0, 0, 0, 0]));
    // Colours of the same yarn are alike.
    assert_eq!(yarns("colors = { 1 = \"b\", 2 = \"b\" }", "5=2\n", "3=2\n"), (vec![1; 4], vec![1; 4]));
    // A list goes before the colours, and its length counts.
    assert_eq!(
        yarns("warp = [\"b\", \"a\", \"a\"]\ncolors = { 1 = \"b\" }", "5=3\n", ""),
        ([1, 0, 0].repeat(4), vec![1; 4])
    );
    assert_eq!(yarns("warp = [\"b\"]\nweft = [\"a\"]", "5=3\n", "7=9\n"), (vec![1; 4], vec![0; 4]));
}

#[test]
fn a_long_file_is_cut_down_to_its_repeat() {
    let twill = |ends: usize, picks: usize| {
        let lines = |count: usize| (0..count).map(|n| format!("{}={}\n", n + 1, n % 4 + 1)).collect::<String>();
        let start = FILE.find("[WARP]").expect("it has one");
        format!(
            "{}[THREADING]\n{}[TIEUP]\n1=1,2\n2=2,3\n3=3,4\n4=1,4\n[TREADLING]\n{}",
            &FILE[..start],
            lines(ends),
            lines(picks)
        )
    };
    assert_eq!(draft(twill(1285, 3058)), TWILL);
    assert_eq!(draft(twill(8, 4)), TWILL);
    // What does not stand there twice is no repeat: seven ends that start again may be meant as seven.
    assert_eq!(weave(twill(7, 4), PLAIN).ends.len(), 7);
    // A point twill turns at its last end.
    let point = edit("4=4\n[TIEUP]", "4=4\n5=3\n6=2\n[TIEUP]").replace("[WARP]\nThreads=4", "[WARP]\nThreads=6");
    assert_eq!(draft(&point), ["X..X..", "..XXX.", ".XX.XX", "XX...X"]);
    // Threads can be chosen: those of the turn, or a part of a file without a repeat.
    let chosen = |wif: &str, table: &str| {
        let place = Place::new();
        place.write("twill.wif", wif);
        let text = format!("{CLOTH}wif = {{ file = \"twill.wif\", {table} }}\n{PLAIN}\n");
        let source = Source { file: "cloth.toml".into(), stem: "c".into(), text, folder: Some(place.path("")) };
        match Scene::parse(&source).unwrap_or_else(|error| panic!("{error}")).structure {
            Structure::Weave(weave) => weave.draft(),
            Structure::Sheet(_) | Structure::Knit(_) => panic!("it is a weave"),
        }
    };
    assert_eq!(chosen(&point, "ends = [1, 4]"), TWILL);
    assert_eq!(chosen(&point, "ends = [3, 6], picks = [2, 4]"), [".X..", "XXX.", "X.XX"]);
    assert_eq!(chosen(&twill(5000, 9), "ends = [4001, 4300], picks = [1, 8]"), TWILL);
}

#[test]
fn the_draft_is_part_of_what_a_result_is_of() {
    let place = Place::new();
    let about = |wif: &str| About::new(&parse_in(&place, wif, PLAIN).unwrap_or_else(|error| panic!("{error}")));
    let twill = about(FILE);
    let expected = serde_json::json!({
        "draft": TWILL,
        "warp": ["a", "a", "a", "a"],
        "weft": ["a", "a", "a", "a"],
        "ends_per_cm": 20.0,
        "picks_per_cm": 10.0,
    });
    assert_eq!(twill.weave, Some(expected));
    // The same cloth file beside another WIF file is another cloth.
    let other = about(&edit("1=1,2\n", "1=1,3\n"));
    assert!(other.cloth == twill.cloth && other != twill);
    let text = serde_json::to_string(&twill).expect("it is JSON");
    assert_eq!(serde_json::from_str::<About>(&text).expect("it can be read back"), twill);
}

#[test]
fn the_example_is_a_houndstooth_check() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/weaves/houndstooth.toml");
    let scene = Scene::parse(&Source::find(file).expect("it is there")).unwrap_or_else(|error| panic!("{error}"));
    let Structure::Weave(weave) = &scene.structure else { panic!("it is a weave") };
    let eight: Vec<String> = TWILL.iter().chain(&TWILL).map(|row| row.repeat(2)).collect();
    assert_eq!(weave.draft(), eight);
    // Four dark threads and four light ones, in both systems.
    let names = |threads: &[usize]| threads.iter().map(|&yarn| weave.yarns[yarn].name.clone()).collect::<Vec<_>>();
    let check = ["dark", "dark", "dark", "dark", "light", "light", "light", "light"];
    assert_eq!(
        (names(&weave.ends), names(&weave.picks)),
        (check.map(String::from).to_vec(), check.map(String::from).to_vec())
    );
    assert!((weave.end_spacing - 0.8).abs() < 1e-12 && (weave.pick_spacing - 0.8).abs() < 1e-12);
    // The check: which colour is on top.
    let top: Vec<String> = (0..8)
        .rev()
        .map(|pick| {
            let dark =
                |end: usize| if weave.warp_over(end, pick) { weave.ends[end] == 0 } else { weave.picks[pick] == 0 };
            (0..8).map(|end| if dark(end) { '#' } else { '-' }).collect()
        })
        .collect();
    let drawn = ["#--#----", "--##----", "-##-----", "##------", "####-##-", "######--", "#####--#", "####--##"];
    assert_eq!(top, drawn);
}

#[test]
fn files_by_chance_are_taken_or_refused_in_words() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("wif");
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    let count = crate::common::wif_files::fuzz::fuzz(1, std::time::Duration::ZERO, 2000, &folder);
    assert!(count.tried == 2000 && count.taken > 50, "{} tried, {} taken", count.tried, count.taken);
}
