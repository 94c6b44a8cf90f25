//! `[fiber.*]`, `[sheet]` and `[[sheet.fibers]]`.

use super::absorption::{Absorption, read_absorption};
use super::reader::{Allowed, Table, Value, closest};
use crate::error::Result;
use glam::DVec3;
use std::f64::consts::PI;
use std::path::Path;

/// µm → mm.
pub(super) const UM: f64 = 1e-3;
/// Fibers cannot fill more of the space than this.
pub(super) const MAX_VOLUME_FRACTION: f64 = 0.9;
/// Most kinds of fiber in one cloth: a walk keeps one path length for each.
pub const MAX_KINDS: usize = 4;

/// A kind of fiber.
#[derive(Clone, Debug, PartialEq)]
pub struct Fiber {
    /// Its name in the file.
    pub name: String,
    /// Radius in mm.
    pub radius: f64,
    /// Refractive index, real, ≥ 1.
    pub ior: f64,
    /// Density in g/cm³, if stated.
    pub density: Option<f64>,
    /// What it absorbs, as the file says.
    pub absorption: Absorption,
}

impl Fiber {
    /// Whether the light that crosses its middle keeps less than 1/e in every colour.
    pub fn opaque(&self) -> bool {
        2.0 * self.radius * self.absorption.least() > 1.0
    }
}

/// Whether some of these kinds of fiber are opaque and others are not.
pub fn dark_beside_light(fibers: &[Fiber], kinds: &[usize]) -> bool {
    let opaque = |kind: &&usize| fibers[**kind].opaque();
    (1..kinds.len()).contains(&kinds.iter().filter(opaque).count())
}

/// Directions of a population of fibers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orientation {
    /// All directions alike.
    Isotropic,
    /// All directions of the plane z = 0 alike.
    Planar,
    /// Uniform by solid angle in the cone |p × axis| ≤ sin(spread).
    Aligned {
        /// Unit vector.
        axis: DVec3,
        /// Half angle of the cone in radians, 0 to π/2.
        spread: f64,
    },
}

/// A population of fibers of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetFibers {
    /// Index of the kind.
    pub fiber: usize,
    /// Length of fiber in a volume, mm/mm³.
    pub length_density: f64,
    /// Directions.
    pub orientation: Orientation,
}

/// A statistically homogeneous sheet; it fills 0 ≥ z ≥ −thickness.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Thickness in mm.
    pub thickness: f64,
    /// Populations of fibers, at least one.
    pub fibers: Vec<SheetFibers>,
}

impl Sheet {
    /// Indices of the kinds of fiber that the sheet has, ascending.
    pub fn kinds(&self) -> Vec<usize> {
        let mut kinds: Vec<usize> = self.fibers.iter().map(|part| part.fiber).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds
    }

    /// Share of the volume that is fiber, v = Σ π R² L.
    pub fn volume_fraction(&self, fibers: &[Fiber]) -> f64 {
        self.fibers.iter().map(|part| PI * fibers[part.fiber].radius.powi(2) * part.length_density).sum()
    }

    /// Mass of an area in g/m², if all densities are stated.
    pub fn areal_mass(&self, fibers: &[Fiber]) -> Option<f64> {
        let part = |part: &SheetFibers| {
            let fiber = &fibers[part.fiber];
            // mm³/mm² × g/cm³ = 10³ g/m².
            Some(PI * fiber.radius.powi(2) * part.length_density * self.thickness * fiber.density? * 1e3)
        };
        self.fibers.iter().map(part).sum()
    }
}

pub(super) fn read_fibers(table: &Table, folder: Option<&Path>) -> Result<Vec<Fiber>> {
    let read = |(name, value): (&str, Value)| match value.table() {
        Ok(table) => read_fiber(name, &table, folder),
        Err(_) => Err(value.expected("a table: [fiber.NAME] describes a kind of fiber")),
    };
    let fibers: Vec<Fiber> = table.entries().map(read).collect::<Result<_>>()?;
    if fibers.is_empty() {
        return Err(table.error("the file needs at least one kind of fiber, [fiber.NAME]"));
    }
    Ok(fibers)
}

fn read_fiber(name: &str, table: &Table, folder: Option<&Path>) -> Result<Fiber> {
    let keys = ["radius_um", "fineness_dtex", "ior", "density_g_per_cm3", "absorption_per_mm"];
    let planned = ["roughness_deg", "cross_section"].map(|key| (key, "is not available yet"));
    table.expect_keys(&keys, &planned)?;
    let density = table.get("density_g_per_cm3").map(|value| value.number(Allowed::above(0.0, 25.0))).transpose()?;
    let absorption = table.get("absorption_per_mm").map(|value| read_absorption(&value, folder)).transpose()?;
    Ok(Fiber {
        name: name.into(),
        radius: read_radius(table, density)?,
        ior: table.require("ior")?.number(Allowed::from(1.0, 4.0))?,
        density,
        absorption: absorption.unwrap_or(Absorption::Grey(0.0)),
    })
}

/// The radius, as it stands or from the mass of a length: R = √(T / (π ρ)); 1 dtex = 0.1 g/km.
fn read_radius(table: &Table, density: Option<f64>) -> Result<f64> {
    let allowed = Allowed::from(0.1 * UM, 1000.0 * UM);
    let Some(fineness) = table.get("fineness_dtex") else {
        return Ok(table.require("radius_um")?.number(Allowed::from(0.1, 1000.0))? * UM);
    };
    if table.get("radius_um").is_some() {
        return Err(fineness.error("`fineness_dtex` and `radius_um` say the same thing; give one of them"));
    }
    let Some(density) = density else {
        return Err(fineness.error("`fineness_dtex` needs `density_g_per_cm3` to give a radius"));
    };
    let dtex = fineness.number(Allowed::above(0.0, 1e6))?;
    let radius = 0.01 * (dtex / (PI * density)).sqrt();
    if allowed.holds(radius) {
        Ok(radius)
    } else {
        Err(fineness.expected("a fineness that gives a radius from 0.1 to 1000 µm"))
    }
}

pub(super) fn read_sheet(table: &Table, fibers: &[Fiber]) -> Result<Sheet> {
    table.expect_keys(&["thickness_um", "fibers"], &[])?;
    let thickness = table.require("thickness_um")?.number(Allowed::from(1.0, 1e6))? * UM;
    let value = table.require("fibers")?;
    let items = value.as_array().ok_or_else(|| value.expected("a list of tables, [[sheet.fibers]]"))?;
    let parts = items.iter().map(|item| read_part(&item.table()?, fibers)).collect::<Result<Vec<_>>>()?;
    if parts.is_empty() {
        return Err(value.error("the sheet is empty: it needs at least one [[sheet.fibers]]"));
    }
    let sheet = Sheet { thickness, fibers: parts };
    let v = sheet.volume_fraction(fibers);
    if v > MAX_VOLUME_FRACTION {
        let message = format!(
            "fibers fill {v:.2} of the sheet, but at most {MAX_VOLUME_FRACTION} is possible: \
             lower length_density_per_mm2 or radius_um"
        );
        return Err(value.error(message));
    }
    Ok(sheet)
}

fn read_part(table: &Table, fibers: &[Fiber]) -> Result<SheetFibers> {
    let keys = ["fiber", "length_density_per_mm2", "orientation", "axis", "spread_deg"];
    table.expect_keys(&keys, &[])?;
    let value = table.require("fiber")?;
    let fiber = find_fiber(&value, value.string()?, fibers)?;
    let length_density = table.require("length_density_per_mm2")?.number(Allowed::above(0.0, 1e8))?;
    let word = table.require("orientation")?;
    let aligned = Orientation::Aligned { axis: DVec3::X, spread: 0.0 };
    let words = [("isotropic", Orientation::Isotropic), ("planar", Orientation::Planar), ("aligned", aligned)];
    let mut orientation = word.choice(&words, &[])?;
    if let Orientation::Aligned { axis, spread } = &mut orientation {
        *axis = read_axis(&table.require("axis")?)?;
        if let Some(value) = table.get("spread_deg") {
            *spread = value.number(Allowed::from(0.0, 90.0))?.to_radians();
        }
    } else if let Some(value) = table.get("axis").or(table.get("spread_deg")) {
        return Err(value.error("`axis` and `spread_deg` belong to orientation = \"aligned\""));
    }
    Ok(SheetFibers { fiber, length_density, orientation })
}

/// The index of a kind of fiber that a value names.
pub(super) fn find_fiber(value: &Value, name: &str, fibers: &[Fiber]) -> Result<usize> {
    fibers.iter().position(|fiber| fiber.name == name).ok_or_else(|| {
        let names: Vec<&str> = fibers.iter().map(|fiber| fiber.name.as_str()).collect();
        let hint = closest(name, &names).map(|best| format!(", did you mean `{best}`?")).unwrap_or_default();
        value.error(format!("there is no [fiber.{name}]{hint}; fibers: {}", names.join(", ")))
    })
}

fn read_axis(value: &Value) -> Result<DVec3> {
    let what = "three numbers [x, y, z] that are not all 0";
    let items = value.as_array().filter(|items| items.len() == 3).ok_or_else(|| value.expected(what))?;
    let coordinate = |item: &Value| item.number(Allowed::from(-1e6, 1e6));
    let axis = DVec3::new(coordinate(&items[0])?, coordinate(&items[1])?, coordinate(&items[2])?);
    axis.try_normalize().ok_or_else(|| value.expected(what))
}
