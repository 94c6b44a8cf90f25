//! `[knit]`.

use super::reader::{Allowed, Table, Value, closest};
use super::sheet::UM;
use super::yarn::{Yarn, round};
use crate::error::Result;

/// Stitches per cm → mm between two of them.
const CM: f64 = 10.0;
/// Largest ratio of the axes of a yarn's section: loops are laid out as if it were round.
const MAX_ASPECT: f64 = 1.25;

/// Least diameter of a yarn in shares of the loop length: of a thinner one, the points of a loop would lie too far apart to
/// tell that it does not pass through itself.
pub const THINNEST: f64 = 1.0 / 128.0;

/// How the loops of a weft knit hang in each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stitch {
    /// Every wale shows the legs of its loops on the front.
    Jersey,
    /// 1×1 rib: wales show the legs of their loops on the front and on the back by turns.
    Rib,
}

/// A weft-knitted cloth: wales run along y and courses along x.
#[derive(Clone, Debug, PartialEq)]
pub struct Knit {
    /// How the loops hang in each other.
    pub stitch: Stitch,
    /// The yarn of all courses.
    pub yarn: Yarn,
    /// Distance between two wales, along x, in mm.
    pub wale_spacing: f64,
    /// Distance between two courses, along y, in mm.
    pub course_spacing: f64,
    /// Length of the yarn's axis in one loop in mm.
    pub loop_length: f64,
}

impl Knit {
    /// Indices of the kinds of fiber, ascending.
    pub fn kinds(&self) -> Vec<usize> {
        self.yarn.blend.iter().map(|(kind, _)| *kind).collect()
    }

    /// Wales of a repeat.
    pub fn wales(&self) -> usize {
        match self.stitch {
            Stitch::Jersey => 1,
            Stitch::Rib => 2,
        }
    }

    /// Length of a loop in mm that would just reach the next course: up, across and down again on straight lines.
    pub fn least_length(&self) -> f64 {
        2.0 * self.course_spacing.hypot(self.wale_spacing / 2.0)
    }

    /// Diameter that the yarn is laid out with in mm: the mean of its width and its height.
    pub fn diameter(&self) -> f64 {
        (self.yarn.width + self.yarn.height) / 2.0
    }
}

pub(super) fn read_knit(table: &Table, yarns: Vec<Yarn>) -> Result<Knit> {
    table.expect_keys(&["structure", "yarn", "courses_per_cm", "wales_per_cm", "loop_length_mm"], &[])?;
    let stitches = [("jersey", Stitch::Jersey), ("rib", Stitch::Rib)];
    let stitch = table.require("structure")?.choice(&stitches, &[])?;
    let spacing = |key: &str| Ok(CM / table.require(key)?.number(Allowed::from(0.1, 1000.0))?);
    let knit = Knit {
        stitch,
        yarn: find_yarn(&table.require("yarn")?, yarns)?,
        wale_spacing: spacing("wales_per_cm")?,
        course_spacing: spacing("courses_per_cm")?,
        loop_length: table.require("loop_length_mm")?.number(Allowed::from(0.01, 1000.0))?,
    };
    check_length(&knit, &table.require("loop_length_mm")?)?;
    check_thickness(&knit, &table.require("yarn")?)?;
    Ok(knit)
}

/// The yarn of a name, if its section is round enough.
fn find_yarn(value: &Value, yarns: Vec<Yarn>) -> Result<Yarn> {
    let name = value.as_string().ok_or_else(|| value.expected("the name of a yarn"))?;
    let Some(yarn) = yarns.iter().find(|yarn| yarn.name == name) else {
        let names: Vec<&str> = yarns.iter().map(|yarn| yarn.name.as_str()).collect();
        let hint = closest(name, &names).map(|best| format!(", did you mean `{best}`?")).unwrap_or_default();
        return Err(value.error(format!("there is no [yarn.{name}]{hint}; yarns: {}", names.join(", "))));
    };
    let (long, short) = (yarn.width.max(yarn.height), yarn.width.min(yarn.height));
    if long > short * MAX_ASPECT * (1.0 + 1e-12) {
        let (width, height) = (round(yarn.width / UM), round(yarn.height / UM));
        return Err(value.error(format!(
            "yarn `{name}` is {width} µm wide and {height} µm high, but a knitted yarn must be nearly round: one at most \
             {MAX_ASPECT} times the other"
        )));
    }
    Ok(yarn.clone())
}

/// Refuse a loop that cannot reach the next course.
fn check_length(knit: &Knit, value: &Value) -> Result<()> {
    let least = knit.least_length();
    if knit.loop_length > least {
        return Ok(());
    }
    Err(value.error(format!(
        "a loop of {} mm cannot reach the next course: at these courses and wales it is longer than {} mm",
        round(knit.loop_length),
        round(least)
    )))
}

/// Refuse a yarn that is too thin for its loops.
fn check_thickness(knit: &Knit, yarn: &Value) -> Result<()> {
    if knit.diameter() >= THINNEST * knit.loop_length {
        return Ok(());
    }
    let least = (THINNEST * knit.loop_length / UM * 1e3).ceil() / 1e3;
    let most = (knit.diameter() / THINNEST * 1e3).floor() / 1e3;
    Err(yarn.error(format!(
        "yarn `{}` is {} µm thick, too thin for loops of {} mm: it must be at least 1/{:.0} of them, {least} µm; or lower \
         `loop_length_mm` to {most}",
        knit.yarn.name,
        round(knit.diameter() / UM),
        round(knit.loop_length),
        1.0 / THINNEST,
    )))
}
