//! Bad yarns and weaves: what the program says of them.

use crate::common::program::Place;
use fiberwalk::cloth::Cloth;
use fiberwalk::scene::{Scene, Source};

const CLOTH: &str = r#"[fiber.cotton]
radius_um = 6
ior = 1.5
[yarn.a]
fiber = "cotton"
fibers_per_ply = 50
width_um = 400
height_um = 300
[yarn.b]
fiber = { cotton = 1 }
fibers_per_ply = 50
width_um = 300
height_um = 200
[weave]
draft = ["XX.", "X.X", ".XX"]
warp = ["a"]
weft = ["a", "b"]
ends_per_cm = 20
picks_per_cm = 20
"#;

fn parse(text: &str) -> fiberwalk::Result<Scene> {
    Scene::parse(&Source { file: "cloth.toml".into(), stem: "cloth".into(), text: text.into(), folder: None })
}

/// The cloth file with one thing replaced, and what is said of it after the file's name.
fn refuse(cases: &[(&str, &str, &str)]) {
    for (old, new, message) in cases {
        assert_eq!(CLOTH.matches(old).count(), 1, "`{old}` must be there once");
        let error = parse(&CLOTH.replace(old, new)).expect_err(new);
        assert_eq!(error.to_string(), format!("cloth.toml:{message}"), "{new}");
    }
}

#[test]
fn the_file_itself_is_fine_and_its_repeat_is_the_common_multiple() {
    let cloth = Cloth::new(&parse(CLOTH).expect("it is right")).expect("it can be laid out");
    assert_eq!(
        (cloth.weave().expect("it is a weave").ends.len(), cloth.weave().expect("it is a weave").picks.len()),
        (3, 6)
    );
    assert_eq!(cloth.weave().expect("it is a weave").picks, [0, 1, 0, 1, 0, 1]);
    // The last row of the draft is the first pick: the first end lies under it.
    assert!(
        !cloth.weave().expect("it is a weave").warp_over(0, 0)
            && cloth.weave().expect("it is a weave").warp_over(2, 0)
            && !cloth.weave().expect("it is a weave").warp_over(0, 3)
    );
    // Yarns and fibers that have no use are fine.
    assert!(parse(&CLOTH.replace("weft = [\"a\", \"b\"]", "weft = [\"a\"]")).is_ok());
}

#[test]
fn a_draft_holds_together() {
    let what = "`weave.draft` is";
    let list = "but must be a list of texts of X (warp over weft) and . (under it), such as [\"X.\", \".X\"]";
    refuse(&[
        ("[\"XX.\", \"X.X\", \".XX\"]", "\"X.\"", &format!("15:9: {what} \"X.\", {list}")),
        ("[\"XX.\", \"X.X\", \".XX\"]", "[]", &format!("15:9: {what} [], {list}")),
        ("[\"XX.\", \"X.X\", \".XX\"]", "[\"\"]", &format!("15:10: {what} \"\", {list}")),
        ("\"X.X\"", "3", &format!("15:17: {what} 3, {list}")),
        ("\"X.X\"", "\"XoX\"", "15:17: `o` is no mark of a draft; allowed: X (warp over weft) and . (under it)"),
        ("\"X.X\"", "\"X.\"", "15:17: this row of the draft has 2 marks, but the last row has 3"),
        (
            "\".XX\"",
            "\"XXX\"",
            "15:9: end 1 (column 1 from the left) never goes under a pick: the cloth would fall apart",
        ),
        (
            "[\"XX.\", \"X.X\", \".XX\"]",
            "[\"XX\", \"..\"]",
            "15:9: pick 1 (row 1 from the bottom) never goes under an end: the cloth would fall apart",
        ),
        (
            "[\"XX.\", \"X.X\", \".XX\"]",
            "[\"..X\", \"XX.\", \"..X\", \"...\"]",
            "15:9: pick 1 (row 1 from the bottom) never goes under an end: the cloth would fall apart",
        ),
        (
            "[\"XX.\", \"X.X\", \".XX\"]",
            "[\"..X\", \".X.\"]",
            "15:9: end 1 (column 1 from the left) never goes over a pick: the cloth would fall apart",
        ),
    ]);
    let wide = format!("[\"{}\", \"{}\"]", "X.".repeat(129), ".X".repeat(129));
    let prime = format!("[\"{}\", \"{}\"]", "X.".repeat(64) + "X", ".X".repeat(64) + ".");
    refuse(&[
        ("[\"XX.\", \"X.X\", \".XX\"]", &wide, "15:9: the draft has 258 ends and 2 picks; allowed: 256 of each"),
        (
            "[\"XX.\", \"X.X\", \".XX\"]\nwarp = [\"a\"]",
            &format!("{prime}\nwarp = [\"a\", \"b\"]"),
            "15:9: the repeat has 258 ends (129 in the draft, 2 in `warp`) and 2 picks (2 in the draft, 2 in `weft`); \
             allowed: 256 of each",
        ),
    ]);
}

#[test]
fn threads_are_known_yarns_that_fit_side_by_side() {
    let wide = "yarn `a` is 400 µm wide, but ends lie 333.333 µm apart: it can be 333.333 µm wide at most";
    let pair = "yarns `a` and `b`, 400 and 300 µm wide, lie side by side, but picks lie 333.333 µm apart: together they \
                can be 666.667 µm wide at most";
    refuse(&[
        ("[\"a\"]", "[\"white\"]", "16:9: there is no [yarn.white]; yarns: a, b"),
        (
            "[\"a\"]",
            "\"a\"",
            "16:8: `weave.warp` is \"a\", but must be a list of names of yarns, such as [\"white\", \"blue\"]",
        ),
        (
            "[\"a\"]",
            "[]",
            "16:8: `weave.warp` is [], but must be a list of names of yarns, such as [\"white\", \"blue\"]",
        ),
        ("[\"a\", \"b\"]", "[\"a\", 1]", "17:14: `weave.weft` is 1, but must be the name of a yarn"),
        ("ends_per_cm = 20", "ends_per_cm = 30", &format!("18:15: {wide}")),
        ("picks_per_cm = 20", "picks_per_cm = 30", &format!("19:16: {pair}")),
        (
            "ends_per_cm = 20",
            "ends_per_cm = 0",
            "18:15: `weave.ends_per_cm` is 0, but must be a number from 0.1 to 1000",
        ),
        ("ends_per_cm = 20\n", "", "14:1: [weave] needs `ends_per_cm`"),
        (
            "picks_per_cm = 20",
            "picks_per_cm = 20\nwarp_crimp_share = 1.1",
            "20:20: `weave.warp_crimp_share` is 1.1, but must be a number from 0 to 1",
        ),
        ("picks_per_cm = 20", "picks_per_cm = 20\nwif = \"a.wif\"", "20:7: a weave has a `draft` or a `wif`, not both"),
    ]);
}

#[test]
fn fibers_fit_into_their_yarns() {
    let keys = "allowed: fiber, plies, fibers_per_ply, width_um, height_um, ply_twist_per_m, twist_per_m, radial_profile, migration, flyaways";
    let blend = "but must be the name of a fiber, or a table such as { cotton = 0.6, viscose = 0.4 }";
    let few = "but must be a whole number from 1 to 100000";
    let a = "width_um = 400\nheight_um = 300";
    let b = "width_um = 300\nheight_um = 200";
    refuse(&[
        (
            "fiber = \"cotton\"",
            "fiber = \"coton\"",
            "5:9: there is no [fiber.coton], did you mean `cotton`?; fibers: cotton",
        ),
        ("fiber = \"cotton\"", "fiber = 5", &format!("5:9: `yarn.a.fiber` is 5, {blend}")),
        ("{ cotton = 1 }", "{}", &format!("10:9: `yarn.b.fiber` is a table, {blend}")),
        ("{ cotton = 1 }", "{ silk = 1 }", "10:18: there is no [fiber.silk]; fibers: cotton"),
        (
            "{ cotton = 1 }",
            "{ cotton = 0 }",
            "10:20: `yarn.b.fiber.cotton` is 0, but must be a number above 0 and at most 1000000",
        ),
        ("\"cotton\"\nfibers_per_ply = 50", "\"cotton\"", "4:1: [yarn.a] needs `fibers_per_ply`"),
        (
            "\"cotton\"\nfibers_per_ply = 50",
            "\"cotton\"\nfibers_per_ply = 0",
            &format!("6:18: `yarn.a.fibers_per_ply` is 0, {few}"),
        ),
        (
            "\"cotton\"\nfibers_per_ply = 50",
            "\"cotton\"\nfibers_per_ply = 1000000",
            &format!("6:18: `yarn.a.fibers_per_ply` is 1000000, {few}"),
        ),
        (
            "\"cotton\"\nfibers_per_ply = 50",
            "\"cotton\"\nfibers_per_ply = 50.5",
            &format!("6:18: `yarn.a.fibers_per_ply` is 50.5, {few}"),
        ),
        (
            "\"cotton\"\nfibers_per_ply = 50",
            "\"cotton\"\nfibers_per_ply = 800",
            "6:18: fibers fill 0.96 of the yarn's section, but at most 0.9 is possible: lower `fibers_per_ply` or raise \
             `width_um` and `height_um`",
        ),
        (
            "\"cotton\"\nfibers_per_ply = 50",
            "\"cotton\"\nplies = 2\nfibers_per_ply = 200",
            "7:18: fibers fill 0.96 of the section of the plies, but at most 0.9 is possible: lower `fibers_per_ply` or \
             raise `width_um` and `height_um`",
        ),
        (
            a,
            "width_um = 400\nheight_um = 11",
            "5:9: fiber `cotton` is 12 µm thick, but the yarn is only 11 µm; raise `width_um` and `height_um`",
        ),
        (
            a,
            "width_um = 400\nheight_um = 20\nplies = 3",
            "5:9: fiber `cotton` is 12 µm thick, but each of 3 plies is only 9.282 µm in a yarn of 20; raise `width_um` and \
             `height_um` to 25.9 or take fewer plies",
        ),
        (b, "width_um = 300", "9:1: [yarn.b] needs `height_um`"),
        (
            b,
            "width_um = -300\nheight_um = 200",
            "12:12: `yarn.b.width_um` is -300, but must be a number from 1 to 100000",
        ),
        (a, &format!("{a}\nplies = 17"), "9:9: `yarn.a.plies` is 17, but must be a whole number from 1 to 16"),
        (a, &format!("{a}\ntwist = 5"), &format!("9:1: unknown key `twist` in [yarn.a]; {keys}")),
        (
            a,
            &format!("{a}\ntwist_per_m = nan"),
            "9:15: `yarn.a.twist_per_m` is nan, but must be a number from -20000 to 20000",
        ),
        (
            a,
            &format!("{a}\ntwist_per_m = 5\nply_twist_per_m = 5"),
            "9:15: in a yarn of one ply `twist_per_m` and `ply_twist_per_m` say the same thing; give one of them",
        ),
        (
            a,
            &format!("{a}\nradial_profile = 3"),
            "9:18: `yarn.a.radial_profile` is 3, but must be a table such as { eps = 0.05, beta = 0.3 }",
        ),
        (
            a,
            &format!("{a}\nradial_profile = {{ eps = 0.6, beta = 1 }}"),
            "9:26: `yarn.a.radial_profile.eps` is 0.6, but must be a number from 0 to 0.5",
        ),
        (a, &format!("{a}\nradial_profile = {{ eps = 0 }}"), "9:18: [yarn.a.radial_profile] needs `beta`"),
    ]);
}

#[test]
fn migration_and_flyaways_are_possible() {
    let a = "width_um = 400\nheight_um = 300";
    let twisted = "width_um = 400\nheight_um = 300\nply_twist_per_m = 500";
    let migration = "a table such as { radius = [0.8, 1.0], periods_per_turn = 1.0 }";
    let shares = "two numbers from 0 to 1, ascending: shares of a fiber's distance from its ply's centre";
    let flyaways = "a table such as { hairs_per_mm = 3.0, hair_length_um = [600, 200] }";
    let lengths = "two numbers, the mean (above 0) and the standard deviation, of at most 10000 µm";
    let refuse_line = |line: &str, message: &str| {
        refuse(&[(a, &format!("{twisted}\n{line}"), message)]);
    };
    refuse_line("migration = 3", &format!("10:13: `yarn.a.migration` is 3, but must be {migration}"));
    refuse_line("migration = { radius = [0.5, 1] }", "10:13: [yarn.a.migration] needs `periods_per_turn`");
    refuse_line(
        "migration = { radius = [0.5, 0.4], periods_per_turn = 1 }",
        &format!("10:24: `yarn.a.migration.radius` is [0.5, 0.4], but must be {shares}"),
    );
    refuse_line(
        "migration = { radius = [0.5, 1.2], periods_per_turn = 1 }",
        &format!("10:24: `yarn.a.migration.radius` is [0.5, 1.2], but must be {shares}"),
    );
    refuse_line(
        "migration = { radius = [0.5, 1], periods_per_turn = 0 }",
        "10:53: `yarn.a.migration.periods_per_turn` is 0, but must be a number above 0 and at most 100",
    );
    // 50 fibers of 12 µm fill 0.06 of the yarn; at (1 + s)/2 ± (1 − s)/2 of its distance the mean of 1/g² is
    // (1 + s)/2 / s^1.5 = 17.39 for s = 0.1: 1.04.
    refuse_line(
        "migration = { radius = [0.1, 1], periods_per_turn = 1 }",
        "10:24: fibers that come as near to their ply's centre as 0.1 of their distance crowd there and fill 1.04, but at \
         most 0.9 is possible: raise the smallest share of `radius` to 0.12 or lower `fibers_per_ply` to 43",
    );
    // So it is taken.
    for line in [
        "migration = { radius = [0.12, 1], periods_per_turn = 1 }",
        "migration = { radius = [0.8, 1.0], periods_per_turn = 1 }",
    ] {
        let text = CLOTH.replace(a, &format!("{twisted}\n{line}"));
        assert!(parse(&text).is_ok(), "{line}");
    }
    refuse(&[(
        a,
        &format!("{a}\nmigration = {{ radius = [0.5, 1], periods_per_turn = 1 }}"),
        "9:13: fibers migrate so many times a turn about their ply, and they do not turn; give `ply_twist_per_m`",
    )]);
    refuse_line("flyaways = {}", &format!("10:12: `yarn.a.flyaways` is a table, but must be {flyaways}"));
    refuse_line("flyaways = { hairs_per_mm = 3 }", "10:12: [yarn.a.flyaways] needs `hair_length_um`");
    refuse_line("flyaways = { loop_height_um = [80, 30] }", "10:12: [yarn.a.flyaways] needs `loops_per_mm`");
    refuse_line(
        "flyaways = { hairs_per_mm = 3, hair_length_um = 600 }",
        &format!("10:49: `yarn.a.flyaways.hair_length_um` is 600, but must be {lengths}"),
    );
    refuse_line(
        "flyaways = { hairs_per_mm = -1, hair_length_um = [600, 200] }",
        "10:29: `yarn.a.flyaways.hairs_per_mm` is -1, but must be a number from 0 to 1000",
    );
    refuse_line(
        "flyaways = { loops_per_mm = 8, loop_height_um = [80, 30] }",
        "10:29: 8 loops on a mm, each 2.000 mm long, take more than a quarter of the yarn's 50 fibers; allowed: 6.250 on \
         a mm",
    );
    refuse(&[
        (
            a,
            &format!("{a}\nflyaways = {{ loops_per_mm = 1, loop_height_um = [80, 30] }}"),
            "9:12: a loop goes once round its ply where `loop_span_um` does not say how far it goes, and the fibers of this \
             yarn have no twist; give `loop_span_um`",
        ),
        (
            "fibers_per_ply = 50\nwidth_um = 400\nheight_um = 300",
            "fibers_per_ply = 1\nwidth_um = 400\nheight_um = 20\nflyaways = { hairs_per_mm = 1, hair_length_um = [80, 30] }",
            "9:12: hairs and loops leave a bundle: the yarn must be at least twice as wide and high as its fibers",
        ),
    ]);
}

#[test]
fn a_cloth_is_a_sheet_or_a_weave() {
    let sheet = "[sheet]\nthickness_um = 500\n[[sheet.fibers]]\nfiber = \"cotton\"\nlength_density_per_mm2 = 100\n\
                 orientation = \"planar\"\n[weave]";
    let weave = &CLOTH[CLOTH.find("[weave]").expect("it is there")..];
    let yarns = &CLOTH[CLOTH.find("[yarn.a]").expect("it is there")..CLOTH.find("[weave]").expect("it is there")];
    refuse(&[
        ("[weave]", sheet, "20:1: a cloth is one of [sheet], [weave] and [knit]"),
        (weave, "", "1:1: the file needs a [sheet], a [weave] or a [knit]"),
        (
            weave,
            sheet.trim_end_matches("[weave]"),
            "4:2: [yarn] belongs to a [weave] or a [knit], and the file has none",
        ),
        (yarns, "", "1:1: the file needs `yarn`"),
        ("[weave]", "[knit]\n[weave]", "14:1: a cloth is one of [sheet], [weave] and [knit]"),
        (yarns, "[yarn]\na = 3\n", "5:5: `yarn.a` is 3, but must be a table: [yarn.NAME] describes a yarn"),
    ]);
    let place = Place::new();
    for flag in [["--cells", "4x4x4"], ["--cone", "3"]] {
        let outcome = place.run(&["measure", "felt", flag[0], flag[1]]);
        let message = format!("error: {}:1:1: it belongs to a woven or knitted cloth; leave it out\n", flag[0]);
        assert_eq!((outcome.code, outcome.stderr), (Some(2), message));
    }
}

#[test]
fn a_repeat_has_so_many_fibers_kinds_and_pieces_at_most() {
    let many = "\"cotton\"\nfibers_per_ply = 100000\nwidth_um = 8000\nheight_um = 8000";
    let text = CLOTH.replace("\"cotton\"\nfibers_per_ply = 50\nwidth_um = 400\nheight_um = 300", many);
    let thin = text.replace("per_cm = 20", "per_cm = 1");
    let thin =
        thin.replace("[\"XX.\", \"X.X\", \".XX\"]", &format!("[\"{}\", \"{}\"]", "X.".repeat(12), ".X".repeat(12)));
    let error = parse(&thin).expect_err("it is too much");
    assert_eq!(error.to_string(), "cloth.toml:15:9: the repeat has 2500050 fibers; allowed: 2000000");
    // Fewer fibers, but hard-twisted ones.
    let twisted =
        text.replace("per_cm = 20", "per_cm = 1").replace("height_um = 8000", "height_um = 8000\ntwist_per_m = 2000");
    let error = Cloth::new(&parse(&twisted).expect("the file is fine")).expect_err("it is too much");
    let message = "the fibers of the repeat have more than 2e7 straight pieces; lower `fibers_per_ply`, the twist or the \
                   size of the draft";
    assert_eq!(error.to_string(), message);
    let mut kinds = CLOTH.replace("{ cotton = 1 }", "{ cotton = 1, f1 = 1, f2 = 1, f3 = 1, f4 = 1 }");
    for kind in 1..=4 {
        kinds += &format!("[fiber.f{kind}]\nradius_um = 5\nior = 1.5\n");
    }
    let error = parse(&kinds).expect_err("they are too many");
    assert_eq!(error.to_string(), "cloth.toml:14:1: the weave has 5 kinds of fiber; allowed: 1 to 4");
}

#[test]
fn a_sheet_has_no_explicit_cloth() {
    let scene = Scene::parse(&Source::find("felt").expect("it is a preset")).expect("it is right");
    let error = Cloth::new(&scene).expect_err("it is a sheet");
    assert_eq!(error.to_string(), "a sheet has no yarns: there is no explicit cloth to lay out");
}

#[test]
fn the_model_of_a_weave_has_cells_and_a_cone() {
    let with = |lines: &str| parse(&format!("{CLOTH}[model]\n{lines}\n"));
    let model = with("cells = [32, 24, 8]\ncone_deg = 5").expect("it is right").model;
    assert_eq!(model.cells, Some([32, 24, 8]));
    assert!((model.cone.unwrap_or(0.0) - 5f64.to_radians()).abs() < 1e-12);
    let plain = parse(CLOTH).expect("it is right").model;
    assert!(plain.cells.is_none() && plain.cone == Some(0.0));
    let cells = "but must be three whole numbers [nx, ny, nz] from 1 to 256";
    for (lines, message) in [
        ("cells = 32", format!("21:9: `model.cells` is 32, {cells}")),
        ("cells = [32, 32]", format!("21:9: `model.cells` is [32, 32], {cells}")),
        ("cells = [32, 32, 0]", format!("21:18: `model.cells` is 0, {cells}")),
        ("cells = [32, 32, 257]", format!("21:18: `model.cells` is 257, {cells}")),
        ("cone_deg = -1", "21:12: `model.cone_deg` is -1, but must be a number from 0 to 90".into()),
    ] {
        let error = with(lines).expect_err(lines);
        assert_eq!(error.to_string(), format!("cloth.toml:{message}"));
    }
    let mut model = plain;
    for (key, text) in [("cells", "24x24x8"), ("cone", "3"), ("directions", "4096")] {
        model.set_from_flag(key, text).unwrap_or_else(|error| panic!("{error}"));
    }
    assert_eq!((model.cells, model.directions), (Some([24, 24, 8]), 4096));
    assert!((model.cone.unwrap_or(0.0) - 3f64.to_radians()).abs() < 1e-12);
    let error = model.set_from_flag("cells", "24x24").expect_err("a count is missing");
    assert_eq!(error.to_string(), format!("--cells:1:1: `cells` is 24x24, {cells}"));
    let error = model.set_from_flag("placement", "5").expect_err("it is no word");
    assert_eq!(
        error.to_string(),
        "--placement:1:1: `placement` is 5, but must be one of at-hit, carried, carried-dense, carried-void"
    );
}
