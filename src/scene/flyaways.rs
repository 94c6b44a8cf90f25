//! The disorder of a yarn: `migration` and `flyaways` of a `[yarn.*]`, after Zhao, Luan, Bala, "Fitting procedural yarn
//! models for realistic cloth rendering", ACM Trans. Graph. 35(4), 2016.

use super::reader::{Allowed, Table, Value};
use super::sheet::{Fiber, MAX_VOLUME_FRACTION, UM};
use super::yarn::Yarn;
use crate::error::Result;
use std::f64::consts::FRAC_PI_2;

/// Standard deviations at which a length, a height or an angle is cut off.
const CUT: f64 = 3.0;
/// Share of the fibers of a yarn that may be in loops at any place.
const MOST_LOOPED: f64 = 0.25;
/// Numbers per mm of yarn.
const PER_MM: Allowed = Allowed::from(0.0, 1000.0);
/// Lengths and heights in µm.
const LENGTH: Allowed = Allowed::above(0.0, 10_000.0);
/// How steeply hairs rise where the file does not say, in degrees: a choice near the yarns 7 to 10 and 100 of
/// github.com/zahramontazeri91/Fiber-level-cloth-simulation, which are fits of this kind. From their distributions of the
/// way along, round and off the yarn, hairs have medians of 17° to 23°, and two thirds lie between 7° and 43°.
const RISE: [f64; 2] = [25.0, 15.0];

/// A fiber's distance from the centre of its ply swings along the yarn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Migration {
    /// Smallest and largest distance in shares of the one that the fiber was given, 0 to 1.
    pub radius: [f64; 2],
    /// Swings for each turn of the fibers about their ply.
    pub periods_per_turn: f64,
}

impl Migration {
    /// Distance from the ply's centre in shares of the fiber's own, at a phase in radians.
    pub fn share(&self, phase: f64) -> f64 {
        let [low, high] = self.radius;
        low + (high - low) / 2.0 * (phase.cos() + 1.0)
    }
}

/// A normal distribution, cut off at three standard deviations and at its limits: what lies beyond is drawn anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Mean before the cut.
    pub mean: f64,
    /// Standard deviation before the cut; 0 for the mean alone.
    pub deviation: f64,
    /// Smallest and largest value.
    pub limits: [f64; 2],
}

impl Spread {
    fn new(mean: f64, deviation: f64, most: f64) -> Spread {
        let reach = CUT * deviation;
        Spread { mean, deviation, limits: [(mean - reach).max(0.0), (mean + reach).min(most)] }
    }
}

/// Open ends of fibers that leave the surface of the yarn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hairs {
    /// Hairs on a mm of yarn.
    pub per_mm: f64,
    /// Length outside of the yarn in mm.
    pub length: Spread,
    /// Angle by which they rise from the yarn's surface in radians.
    pub rise: Spread,
}

/// Stretches of fiber that leave the yarn and come back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loops {
    /// Loops on a mm of yarn.
    pub per_mm: f64,
    /// Largest distance from the yarn's surface in mm.
    pub height: Spread,
    /// Length of yarn from a loop's start to its end in mm.
    pub span: f64,
}

/// Fibers outside of the yarn's section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flyaways {
    /// Open ends, if there are any.
    pub hairs: Option<Hairs>,
    /// Loops, if there are any.
    pub loops: Option<Loops>,
}

impl Flyaways {
    /// Largest distance from the yarn's section that any flyaway reaches upwards in mm, where the yarn climbs by an angle in
    /// radians that its hairs keep.
    pub fn reach(&self, climb: f64) -> f64 {
        let steepest = |hairs: &Hairs| (hairs.rise.limits[1] + climb).min(FRAC_PI_2);
        let hairs = self.hairs.map(|hairs| hairs.length.limits[1] * steepest(&hairs).sin());
        let loops = self.loops.map(|loops| loops.height.limits[1]);
        hairs.unwrap_or(0.0).max(loops.unwrap_or(0.0))
    }
}

/// Read `migration` of a yarn whose twist is known.
pub(super) fn read_migration(value: &Value, yarn: &Yarn, fibers: &[Fiber]) -> Result<Migration> {
    let example = "a table such as { radius = [0.8, 1.0], periods_per_turn = 1.0 }";
    let table = value.table().map_err(|_| value.expected(example))?;
    table.expect_keys(&["radius", "periods_per_turn"], &[])?;
    let place = table.require("radius")?;
    let share = Allowed::from(0.0, 1.0);
    let what = "two numbers from 0 to 1, ascending: shares of a fiber's distance from its ply's centre";
    let radius = pair(&place, what, [share, share])?;
    if radius[0] > radius[1] {
        return Err(place.expected(what));
    }
    let periods_per_turn = table.require("periods_per_turn")?.number(Allowed::above(0.0, 100.0))?;
    if yarn.ply_twist == 0.0 {
        let message =
            "fibers migrate so many times a turn about their ply, and they do not turn; give `ply_twist_per_m`";
        return Err(value.error(message));
    }
    let migration = Migration { radius, periods_per_turn };
    let crowded = crowding(&migration, yarn, fibers);
    if yarn.fibers() > 1 && crowded > MAX_VOLUME_FRACTION {
        let message = format!(
            "fibers that come as near to their ply's centre as {} of their distance crowd there and fill {crowded:.2}, but \
             at most {MAX_VOLUME_FRACTION} is possible: {}",
            radius[0],
            roomier(&migration, yarn, fibers, crowded)
        );
        return Err(place.error(message));
    }
    Ok(migration)
}

/// What would fit in place of a migration by which the middle of a ply becomes so full.
fn roomier(migration: &Migration, yarn: &Yarn, fibers: &[Fiber], crowded: f64) -> String {
    let [low, high] = migration.radius;
    let fits = |low: &f64| {
        let narrower = Migration { radius: [*low, high], ..*migration };
        crowding(&narrower, yarn, fibers) <= MAX_VOLUME_FRACTION
    };
    let fewer = (f64::from(yarn.fibers_per_ply) * MAX_VOLUME_FRACTION / crowded).floor();
    let fewer = (fewer >= 1.0).then(|| format!("lower `fibers_per_ply` to {fewer}"));
    let hundredths = (low * 100.0).ceil() as u32..=(high * 100.0).floor() as u32;
    let share = hundredths.map(|share| f64::from(share) / 100.0).find(fits);
    let share = share.map(|share| format!("raise the smallest share of `radius` to {share}"));
    match (share, fewer) {
        (Some(share), Some(fewer)) => format!("{share} or {fewer}"),
        (Some(one), None) | (None, Some(one)) => one,
        (None, None) => "raise both shares of `radius`".into(),
    }
}

/// Share of the middle of a ply that is fiber, within two fiber radii of its centre: what migrates there besides what lies
/// there.
fn crowding(migration: &Migration, yarn: &Yarn, fibers: &[Fiber]) -> f64 {
    const RINGS: u32 = 1000;
    const PHASES: u32 = 64;
    let thickest = yarn.blend.iter().map(|&(kind, _)| fibers[kind].radius).fold(0.0, f64::max);
    let near = (2.0 * thickest / (yarn.ply_radius() * yarn.width.min(yarn.height) / 2.0)).min(1.0);
    // Rings of equal area, and how many fibers have their distance in them.
    let middle = |ring: u32| ((f64::from(ring) + 0.5) / f64::from(RINGS)).sqrt();
    let density = |r: f64| yarn.radial_profile.map_or(1.0, |profile| profile.density(r));
    let (mut all, mut here) = (0.0, 0.0);
    for r in (0..RINGS).map(middle) {
        let phase = |step: u32| (f64::from(step) + 0.5) / f64::from(PHASES) * std::f64::consts::PI;
        let comes = (0..PHASES).filter(|step| r * migration.share(phase(*step)) < near).count();
        all += density(r);
        here += density(r) * comes as f64 / f64::from(PHASES);
    }
    yarn.packing(fibers) * here / all / (near * near)
}

/// Read `flyaways` of a yarn whose twist and migration are known.
pub(super) fn read_flyaways(value: &Value, yarn: &Yarn) -> Result<Flyaways> {
    let example = "a table such as { hairs_per_mm = 3.0, hair_length_um = [600, 200] }";
    let table = value.table().map_err(|_| value.expected(example))?;
    let hairs = ["hairs_per_mm", "hair_length_um", "hair_rise_deg"];
    let loops = ["loops_per_mm", "loop_height_um", "loop_span_um"];
    table.expect_keys(&[hairs, loops].concat(), &[])?;
    let any = |keys: [&str; 3]| keys.iter().any(|key| table.get(key).is_some());
    if !any(hairs) && !any(loops) {
        return Err(value.expected(example));
    }
    Ok(Flyaways {
        hairs: any(hairs).then(|| read_hairs(&table)).transpose()?,
        loops: any(loops).then(|| read_loops(&table, yarn)).transpose()?,
    })
}

fn read_hairs(table: &Table) -> Result<Hairs> {
    let per_mm = table.require("hairs_per_mm")?.number(PER_MM)?;
    let [mean, deviation] = read_lengths(&table.require("hair_length_um")?)?;
    let degrees = [Allowed::from(0.0, 90.0), Allowed::from(0.0, 90.0)];
    let what = "two numbers from 0 to 90, the mean and the standard deviation";
    let rise = table.get("hair_rise_deg").map(|value| pair(&value, what, degrees)).transpose()?;
    let [rise, spread] = rise.unwrap_or(RISE).map(f64::to_radians);
    let right = FRAC_PI_2;
    Ok(Hairs { per_mm, length: Spread::new(mean, deviation, f64::INFINITY), rise: Spread::new(rise, spread, right) })
}

fn read_loops(table: &Table, yarn: &Yarn) -> Result<Loops> {
    let per_mm = table.require("loops_per_mm")?;
    let [mean, deviation] = read_lengths(&table.require("loop_height_um")?)?;
    let span = match table.get("loop_span_um") {
        Some(value) => value.number(LENGTH)? * UM,
        None if yarn.ply_twist == 0.0 => {
            let message = "a loop goes once round its ply where `loop_span_um` does not say how far it goes, and the fibers \
                           of this yarn have no twist; give `loop_span_um`";
            return Err(table.error(message));
        }
        // From one place where the fiber migrates furthest in to the next, as the paper's loops.
        None => 1.0 / (yarn.ply_twist.abs() * yarn.migration.map_or(1.0, |migration| migration.periods_per_turn)),
    };
    let count = per_mm.number(PER_MM)?;
    let most = MOST_LOOPED * yarn.fibers() as f64 / span;
    if count > most {
        let message = format!(
            "{count} loops on a mm, each {:.3} mm long, take more than a quarter of the yarn's {} fibers; allowed: {:.3} on a mm",
            span,
            yarn.fibers(),
            most
        );
        return Err(per_mm.error(message));
    }
    Ok(Loops { per_mm: count, height: Spread::new(mean, deviation, f64::INFINITY), span })
}

/// Mean and standard deviation of a length in mm.
fn read_lengths(value: &Value) -> Result<[f64; 2]> {
    let what = "two numbers, the mean (above 0) and the standard deviation, of at most 10000 µm";
    Ok(pair(value, what, [LENGTH, Allowed::from(0.0, 10_000.0)])?.map(|length| length * UM))
}

/// A list of two numbers.
fn pair(value: &Value, what: &str, allowed: [Allowed; 2]) -> Result<[f64; 2]> {
    match value.as_array().as_deref() {
        Some([first, second]) => {
            let number = |item: &Value, allowed| item.number(allowed).map_err(|_| value.expected(what));
            Ok([number(first, allowed[0])?, number(second, allowed[1])?])
        }
        _ => Err(value.expected(what)),
    }
}
