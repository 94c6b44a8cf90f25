//! `[yarn.*]`.

use super::flyaways::{Flyaways, Migration, read_flyaways, read_migration};
use super::reader::{Allowed, Table, Value, closest};
use super::sheet::{Fiber, MAX_VOLUME_FRACTION, UM, find_fiber};
use crate::error::Result;
use std::f64::consts::PI;

/// Turns per metre → turns per mm.
const PER_M: f64 = 1e-3;
/// Twists in turns per metre.
const TWIST: Allowed = Allowed::from(-20_000.0, 20_000.0);
/// Shares of a blend, in any unit.
const SHARE: Allowed = Allowed::above(0.0, 1e6);

/// How densely fibers fill a ply, by distance from its centre: Zhao, Luan, Bala, "Fitting procedural yarn models for
/// realistic cloth rendering", ACM Trans. Graph. 35(4), 2016, section 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadialProfile {
    /// Density at the rim, 0 to 0.5; 0.5 is uniform.
    pub eps: f64,
    /// How fast the density falls, 0 to 10; 0 is uniform.
    pub beta: f64,
}

impl RadialProfile {
    /// Density per area at a distance from the ply's centre in ply radii, 0 to 1; at most 1.
    pub fn density(&self, r: f64) -> f64 {
        let fall = ((std::f64::consts::E - r.exp()) / (std::f64::consts::E - 1.0)).max(0.0);
        (1.0 - 2.0 * self.eps) * fall.powf(self.beta) + self.eps
    }
}

/// A yarn: plies of fibers, with an elliptical section in the cloth.
#[derive(Clone, Debug, PartialEq)]
pub struct Yarn {
    /// Its name in the file.
    pub name: String,
    /// Kinds of fiber, ascending, and their share of the number of fibers; the shares sum to 1.
    pub blend: Vec<(usize, f64)>,
    /// Number of plies.
    pub plies: u32,
    /// Number of fibers in each ply.
    pub fibers_per_ply: u32,
    /// Width of the section in mm, in the plane of the cloth.
    pub width: f64,
    /// Height of the section in mm, along z.
    pub height: f64,
    /// Turns of the fibers about their ply per mm of yarn; positive is Z, a right-handed helix. The only twist of a yarn
    /// of one ply.
    pub ply_twist: f64,
    /// Turns of the plies about the yarn per mm of yarn; 0 in a yarn of one ply.
    pub twist: f64,
    /// How densely the fibers fill a ply; none for uniformly.
    pub radial_profile: Option<RadialProfile>,
    /// How the fibers swing in their ply; none if they keep their distance from its centre.
    pub migration: Option<Migration>,
    /// Fibers outside of the section.
    pub flyaways: Option<Flyaways>,
}

impl Yarn {
    /// Largest distance from the section that any of its fibers reaches upwards in mm, where the yarn climbs by an angle in
    /// radians that its hairs keep.
    pub fn reach(&self, climb: f64) -> f64 {
        self.flyaways.map_or(0.0, |flyaways| flyaways.reach(climb))
    }

    /// Whether all its fibers run along it, without twist.
    pub fn untwisted(&self) -> bool {
        self.ply_twist == 0.0 && self.twist == 0.0 && self.flyaways.is_none()
    }

    /// Number of fibers.
    pub fn fibers(&self) -> usize {
        self.plies as usize * self.fibers_per_ply as usize
    }

    /// Number of fibers of each kind of the blend, by largest remainder.
    pub fn counts(&self) -> Vec<(usize, usize)> {
        let total = self.fibers();
        let exact = |share: f64| share * total as f64;
        let mut counts: Vec<(usize, usize)> =
            self.blend.iter().map(|&(kind, share)| (kind, exact(share).floor() as usize)).collect();
        let mut order: Vec<usize> = (0..counts.len()).collect();
        order.sort_by(|&a, &b| exact(self.blend[b].1).fract().total_cmp(&exact(self.blend[a].1).fract()));
        let missing = total.saturating_sub(counts.iter().map(|(_, count)| count).sum());
        for &place in order.iter().cycle().take(missing) {
            counts[place].1 += 1;
        }
        counts
    }

    /// Radius of a ply in the unit disc: equal circles that touch each other and the rim.
    pub fn ply_radius(&self) -> f64 {
        if self.plies == 1 {
            return 1.0;
        }
        let sine = (PI / f64::from(self.plies)).sin();
        sine / (1.0 + sine)
    }

    /// Share of the section of its plies that is fiber, when the yarn lies level and has no twist.
    pub fn packing(&self, fibers: &[Fiber]) -> f64 {
        let area: f64 = self.counts().iter().map(|&(kind, count)| fibers[kind].radius.powi(2) * count as f64).sum();
        let plies = f64::from(self.plies) * self.ply_radius().powi(2);
        area / (plies * self.width * self.height / 4.0)
    }
}

pub(super) fn read_yarns(table: &Table, fibers: &[Fiber]) -> Result<Vec<Yarn>> {
    let read = |(name, value): (&str, Value)| match value.table() {
        Ok(table) => read_yarn(name, &table, fibers),
        Err(_) => Err(value.expected("a table: [yarn.NAME] describes a yarn")),
    };
    table.entries().map(read).collect()
}

/// The index of the yarn that a value names.
pub(super) fn find_yarn(item: &Value, yarns: &[Yarn]) -> Result<usize> {
    let name = item.as_string().ok_or_else(|| item.expected("the name of a yarn"))?;
    yarns.iter().position(|yarn| yarn.name == name).ok_or_else(|| {
        let names: Vec<&str> = yarns.iter().map(|yarn| yarn.name.as_str()).collect();
        let hint = closest(name, &names).map(|best| format!(", did you mean `{best}`?")).unwrap_or_default();
        item.error(format!("there is no [yarn.{name}]{hint}; yarns: {}", names.join(", ")))
    })
}

const KEYS: [&str; 10] = [
    "fiber",
    "plies",
    "fibers_per_ply",
    "width_um",
    "height_um",
    "ply_twist_per_m",
    "twist_per_m",
    "radial_profile",
    "migration",
    "flyaways",
];

fn read_yarn(name: &str, table: &Table, fibers: &[Fiber]) -> Result<Yarn> {
    table.expect_keys(&KEYS, &[])?;
    let whole = |key: &str, most: u32| {
        let what = format!("a whole number from 1 to {most}");
        table.get(key).map(|value| value.integer(1, most, &what)).transpose()
    };
    let length = |key: &str| Ok(table.require(key)?.number(Allowed::from(1.0, 1e5))? * UM);
    let turns = |key: &str| {
        let value = table.get(key);
        value.map(|value| Ok(value.number(TWIST)? * PER_M)).transpose()
    };
    table.require("fibers_per_ply")?;
    let mut yarn = Yarn {
        name: name.into(),
        blend: read_blend(&table.require("fiber")?, fibers)?,
        plies: whole("plies", 16)?.unwrap_or(1),
        fibers_per_ply: whole("fibers_per_ply", 100_000)?.unwrap_or(1),
        width: length("width_um")?,
        height: length("height_um")?,
        ply_twist: turns("ply_twist_per_m")?.unwrap_or(0.0),
        twist: turns("twist_per_m")?.unwrap_or(0.0),
        radial_profile: table.get("radial_profile").map(|value| read_profile(&value)).transpose()?,
        migration: None,
        flyaways: None,
    };
    // A single yarn has one twist, by whichever name.
    if let (1, Some(value)) = (yarn.plies, table.get("twist_per_m")) {
        if table.get("ply_twist_per_m").is_some() {
            let message =
                "in a yarn of one ply `twist_per_m` and `ply_twist_per_m` say the same thing; give one of them";
            return Err(value.error(message));
        }
        (yarn.ply_twist, yarn.twist) = (yarn.twist, 0.0);
    }
    check_room(&yarn, table, fibers)?;
    yarn.migration = table.get("migration").map(|value| read_migration(&value, &yarn, fibers)).transpose()?;
    if let Some(value) = table.get("flyaways") {
        let thickest = yarn.blend.iter().map(|&(kind, _)| 2.0 * fibers[kind].radius).fold(0.0, f64::max);
        if yarn.width.min(yarn.height) < 2.0 * thickest {
            let message =
                "hairs and loops leave a bundle: the yarn must be at least twice as wide and high as its fibers";
            return Err(value.error(message));
        }
        yarn.flyaways = Some(read_flyaways(&value, &yarn)?);
    }
    Ok(yarn)
}

/// Refuse fibers that their ply cannot hold.
fn check_room(yarn: &Yarn, table: &Table, fibers: &[Fiber]) -> Result<()> {
    let narrow = yarn.width.min(yarn.height);
    let ply = narrow * yarn.ply_radius();
    for &(kind, _) in &yarn.blend {
        let thickness = 2.0 * fibers[kind].radius;
        if thickness > ply * (1.0 + 1e-12) {
            let (name, thickness) = (&fibers[kind].name, thickness / UM);
            let room = match yarn.plies {
                1 => format!("the yarn is only {} µm; raise `width_um` and `height_um`", round(narrow / UM)),
                plies => format!(
                    "each of {plies} plies is only {} µm in a yarn of {}; raise `width_um` and `height_um` to {} or take fewer \
                     plies",
                    round(ply / UM),
                    round(narrow / UM),
                    up(thickness / yarn.ply_radius()),
                ),
            };
            let message = format!("fiber `{name}` is {} µm thick, but {room}", round(thickness));
            return Err(table.require("fiber")?.error(message));
        }
    }
    let packing = yarn.packing(fibers);
    // A lone fiber may fill its ply.
    if yarn.fibers_per_ply > 1 && packing > MAX_VOLUME_FRACTION {
        let whose = if yarn.plies > 1 { "the section of the plies" } else { "the yarn's section" };
        let message = format!(
            "fibers fill {packing:.2} of {whose}, but at most {MAX_VOLUME_FRACTION} is possible: lower `fibers_per_ply` \
             or raise `width_um` and `height_um`"
        );
        return Err(table.require("fibers_per_ply")?.error(message));
    }
    Ok(())
}

/// The name of a kind of fiber, or names with their shares of the number of fibers.
fn read_blend(value: &Value, fibers: &[Fiber]) -> Result<Vec<(usize, f64)>> {
    let what = "the name of a fiber, or a table such as { cotton = 0.6, viscose = 0.4 }";
    let Ok(table) = value.table() else {
        let name = value.as_string().ok_or_else(|| value.expected(what))?;
        return Ok(vec![(find_fiber(value, name, fibers)?, 1.0)]);
    };
    let share = |(name, value): (&str, Value)| Ok((find_fiber(&value, name, fibers)?, value.number(SHARE)?));
    let mut blend = table.entries().map(share).collect::<Result<Vec<_>>>()?;
    if blend.is_empty() {
        return Err(value.expected(what));
    }
    let total: f64 = blend.iter().map(|(_, share)| share).sum();
    blend.iter_mut().for_each(|(_, share)| *share /= total);
    blend.sort_by_key(|(kind, _)| *kind);
    Ok(blend)
}

fn read_profile(value: &Value) -> Result<RadialProfile> {
    let table = value.table().map_err(|_| value.expected("a table such as { eps = 0.05, beta = 0.3 }"))?;
    table.expect_keys(&["eps", "beta"], &[])?;
    let eps = table.require("eps")?.number(Allowed::from(0.0, 0.5))?;
    let beta = table.require("beta")?.number(Allowed::from(0.0, 10.0))?;
    Ok(RadialProfile { eps, beta })
}

/// A length as a user would write it.
pub(super) fn round(number: f64) -> f64 {
    (number * 1e3).round() / 1e3
}

/// A length in µm that is no shorter, to a tenth.
fn up(number: f64) -> f64 {
    (number * 10.0 - 1e-6).ceil() / 10.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn yarn(plies: u32, fibers_per_ply: u32, blend: &[(usize, f64)]) -> Yarn {
        Yarn {
            name: "y".into(),
            blend: blend.to_vec(),
            plies,
            fibers_per_ply,
            width: 0.2,
            height: 0.1,
            ply_twist: 0.0,
            twist: 0.0,
            radial_profile: None,
            migration: None,
            flyaways: None,
        }
    }

    #[test]
    fn a_blend_is_rounded_by_largest_remainder() {
        let thirds = [(0, 1.0 / 3.0), (1, 1.0 / 3.0), (2, 1.0 / 3.0)];
        assert_eq!(yarn(1, 10, &thirds).counts(), [(0, 4), (1, 3), (2, 3)]);
        // 0.7, 2.1, 4.2 of 7: the first has the largest remainder.
        assert_eq!(yarn(1, 7, &[(0, 0.1), (1, 0.3), (4, 0.6)]).counts(), [(0, 1), (1, 2), (4, 4)]);
        assert_eq!(yarn(3, 4, &[(2, 1.0)]).counts(), [(2, 12)]);
    }

    #[test]
    fn plies_touch_each_other_and_the_rim() {
        // Of two circles the radius is a half, of three 1 / (1 + 2/√3), of seven of which none is central 0.3026.
        for (plies, radius) in [(1, 1.0), (2, 0.5), (3, 1.0 / (1.0 + 2.0 / 3f64.sqrt())), (7, 0.302_6)] {
            assert!((yarn(plies, 1, &[(0, 1.0)]).ply_radius() - radius).abs() < 1e-4, "{plies} plies");
        }
    }
}
