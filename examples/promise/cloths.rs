//! Cloths at random, from a distribution much wider than the presets.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const WEAVES: [&[&str]; 7] = [
    &["X.", ".X"],
    &["XX.", "X.X", ".XX"],
    &["XXX.", "XX.X", "X.XX", ".XXX"],
    &["XX..", "XX..", "..XX", "..XX"],
    &["X....", "..X..", "....X", ".X...", "...X."],
    &["XX..", ".XX.", "..XX", "X..X"],
    &["X.......", "...X....", "......X.", ".X......", "....X...", ".......X", "..X.....", ".....X.."],
];

/// A generator with words for what cloths need.
struct Draw(ChaCha8Rng);

impl Draw {
    /// Even in the logarithm.
    fn log(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.0.random::<f64>())
    }

    fn even(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    fn chance(&mut self, share: f64) -> bool {
        self.0.random::<f64>() < share
    }

    /// A kind of fiber: its text.
    fn fiber(&mut self, name: &str, radius: f64) -> String {
        let index = self.even(1.33, 1.7);
        // Two fifths are clear; few are opaque.
        let absorption = if self.chance(0.4) { 0.0 } else { self.log(0.1, 1000.0) };
        format!("[fiber.{name}]\nradius_um = {radius:.2}\nior = {index:.3}\nabsorption_per_mm = {absorption:.3}\n")
    }

    /// A yarn and its fibers: the text, and its width in µm.
    fn yarn(&mut self, name: &str, round: bool) -> (String, f64) {
        let radius = self.log(3.0, if round { 40.0 } else { 150.0 });
        // Thick fibers come in small numbers.
        let fibers = self.log(if round { 5.0 } else { 1.0 }, (5000.0 / radius).clamp(1.5, 200.0)).round().max(1.0);
        let plies = if fibers > 2.0 && !round { self.log(1.0, 3.49).round() } else { 1.0 };
        let count = fibers * plies;
        let fill = if count < 4.0 { 0.6 } else { self.log(0.35, 0.7) };
        let size = 2.0 * radius * (count / fill).sqrt() * if count == 1.0 { 0.8 } else { 1.0 };
        let flat = if count < 4.0 || round { 1.0 } else { self.log(1.0, 2.0) };
        let twist = if self.chance(0.3) { 0.0 } else { self.log(50.0, 1500.0).round() };
        let (width, height) = (size * flat.sqrt(), size / flat.sqrt());
        let mut text = self.fiber(name, radius);
        let blend = count >= 8.0 && self.chance(0.2);
        let of = if blend {
            let other = radius * self.even(0.6, 1.2);
            text += &self.fiber(&format!("{name}x"), other);
            format!("{{ {name} = 0.6, {name}x = 0.4 }}")
        } else {
            format!("\"{name}\"")
        };
        text += &format!(
            "[yarn.{name}]\nfiber = {of}\nplies = {plies}\nfibers_per_ply = {fibers}\nwidth_um = {width:.1}\nheight_um = {height:.1}\n\
             ply_twist_per_m = {twist}\n"
        );
        if count >= 16.0 && self.chance(0.15) {
            let long = self.log(0.5, 3.0) * width;
            text += &format!(
                "[yarn.{name}.flyaways]\nhairs_per_mm = {:.2}\nhair_length_um = [{long:.0}, {:.0}]\n",
                self.log(0.5, 6.0),
                0.3 * long
            );
            if self.chance(0.5) {
                let high = 0.2 * width;
                text += &format!(
                    "loops_per_mm = {:.2}\nloop_height_um = [{high:.1}, {:.1}]\n",
                    self.log(0.5, 2.0),
                    0.3 * high
                );
            }
        }
        (text, width)
    }

    fn weave(&mut self) -> String {
        let [warp, weft] = ["a", "b"].map(|name| self.yarn(name, false));
        let two = self.chance(0.3);
        let second = if two { &weft } else { &warp };
        let (ends, picks) = (1e4 / warp.1 * self.log(0.3, 0.95), 1e4 / second.1 * self.log(0.3, 0.95));
        let draft = WEAVES[self.0.random_range(0..WEAVES.len())];
        format!(
            "{}{}[weave]\ndraft = {draft:?}\nwarp = [\"a\"]\nweft = [\"{}\"]\nends_per_cm = {ends:.2}\npicks_per_cm = {picks:.2}\n",
            warp.0,
            if two { &weft.0 } else { "" },
            if two { "b" } else { "a" }
        )
    }

    /// A jersey as Munden relaxes it, or a rib, with loops that are longer than the yarn needs.
    fn knit(&mut self) -> String {
        let (text, width) = self.yarn("a", true);
        let loose = self.log(1.05, 1.5);
        let rib = self.chance(0.4);
        let loop_cm = 1e-4 * width * loose * if rib { 17.5 } else { 18.5 };
        let (structure, courses, wales) = if rib { ("rib", 5.1, 7.8) } else { ("jersey", 5.5, 4.2) };
        format!(
            "{text}[knit]\nstructure = \"{structure}\"\nyarn = \"a\"\nloop_length_mm = {:.3}\ncourses_per_cm = {:.2}\nwales_per_cm = {:.2}\n",
            10.0 * loop_cm,
            courses / loop_cm,
            wales / loop_cm
        )
    }

    /// One or two populations of fibers, thin to thick by their optical depth, overlapping or separate.
    fn sheet(&mut self) -> String {
        let radius = self.log(3.0, 40.0);
        let (fill, depth) = (self.log(0.01, 0.4), self.log(0.2, 15.0));
        let thick = (depth * 2.5 * radius / fill).clamp(4.0 * radius, 2e4);
        let length = 1e6 * fill / (std::f64::consts::PI * radius * radius);
        let populations = if self.chance(0.3) { 2 } else { 1 };
        let mut text = self.fiber("a", radius) + &format!("[sheet]\nthickness_um = {thick:.1}\n");
        for _ in 0..populations {
            let way = match self.0.random_range(0..3) {
                0 => "orientation = \"isotropic\"\n".into(),
                1 => "orientation = \"planar\"\n".into(),
                _ => format!(
                    "orientation = \"aligned\"\naxis = [1, {:.2}, {:.2}]\nspread_deg = {:.0}\n",
                    self.even(-1.0, 1.0),
                    self.even(-0.3, 0.3),
                    self.log(5.0, 60.0)
                ),
            };
            text += &format!(
                "[[sheet.fibers]]\nfiber = \"a\"\nlength_density_per_mm2 = {:.3}\n{way}",
                length / f64::from(populations)
            );
        }
        text + if self.chance(0.5) { "[model]\npacking = \"random\"\n" } else { "" }
    }
}

/// The cloth file of a number: each has a generator of its own, so that any can be drawn alone.
pub fn cloth(seed: u64, number: u64) -> String {
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed << 32 | number));
    match draw.0.random_range(0..20) {
        0..3 => draw.sheet(),
        3..5 => draw.knit(),
        _ => draw.weave(),
    }
}
