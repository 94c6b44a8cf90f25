//! The fibers of one realization as curves: text for Mitsuba, polylines for OBJ.
//!
//! Mitsuba 3 reads one control point `x y z radius` a line and starts a new curve after an empty line. Its reader knows no
//! comments but looks at nothing after the fourth number, so the header stands behind the first point. Its `linearcurve`
//! draws the pieces as they are. Its `bsplinecurve` refuses curves of fewer than four points, so short ones get more on
//! their pieces; it rounds corners and ends curves a piece early. One shape has one material: write one kind of fiber a file.

use crate::cloth::{Cloth, Curve, Realization};
use crate::scene::Packing;
use glam::DVec3;
use std::io::{Result, Write};
use std::ops::RangeInclusive;

/// Repeats that may be written along an axis.
pub const REPEATS: RangeInclusive<u32> = 1..=1000;
/// Fewest points of a curve that Mitsuba reads as a B-spline.
const FEWEST: usize = 4;
/// Longest name in the header in bytes: Mitsuba's lines have fewer than 1024.
const LONGEST_NAME: usize = 400;

/// How curves are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveFormat {
    /// Text for Mitsuba's shapes `linearcurve` and `bsplinecurve`.
    Mitsuba,
    /// Polylines of a Wavefront OBJ file, one group for each thread and kind of fiber; without radii.
    Obj,
}

/// Which curves are written.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveChoice {
    /// Number of the realization.
    pub realization: u64,
    /// Its seed.
    pub seed: u64,
    /// How its fibers were laid.
    pub packing: Packing,
    /// Repeats along x and y.
    pub repeats: [u32; 2],
    /// The only kind of fiber that is written; none for all.
    pub kind: Option<usize>,
}

/// What was written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurveCounts {
    /// Curves.
    pub fibers: u64,
    /// Their points.
    pub points: u64,
    /// Their length in mm.
    pub length: f64,
}

/// Write the fibers of a realization of a cloth, in their order, thread by thread; repeats follow each other, each moved by a
/// whole number of periods. Fibers run on beyond the repeat and start where their thread is cut.
///
/// # Errors
/// What the writer says.
pub fn write_curves(
    cloth: &Cloth,
    drawn: &Realization,
    name: &str,
    format: CurveFormat,
    choice: &CurveChoice,
    out: &mut impl Write,
) -> Result<CurveCounts> {
    let mut counts = CurveCounts::default();
    let header = header(cloth, name, choice);
    if format == CurveFormat::Obj {
        header.iter().try_for_each(|line| writeln!(out, "# {line}"))?;
    }
    let mut group = None;
    let shifts = (0..choice.repeats[1]).flat_map(|y| (0..choice.repeats[0]).map(move |x| [x, y]));
    for [x, y] in shifts {
        let shift = (cloth.period() * glam::DVec2::new(f64::from(x), f64::from(y))).extend(0.0);
        for curve in drawn.fibers.iter().filter(|curve| choice.kind.is_none_or(|kind| kind == curve.kind)) {
            match format {
                CurveFormat::Mitsuba => mitsuba(curve, shift, &header, &mut counts, out)?,
                CurveFormat::Obj => obj(cloth, curve, shift, &mut group, &mut counts, out)?,
            }
        }
    }
    Ok(counts)
}

/// What the curves are, line by line.
fn header(cloth: &Cloth, name: &str, choice: &CurveChoice) -> Vec<String> {
    let visible = |c: char| if c.is_control() { ' ' } else { c };
    let mut bytes = 0;
    let fits = |c: &char| {
        bytes += c.len_utf8();
        bytes <= LONGEST_NAME
    };
    let name: String = name.chars().take_while(fits).map(visible).collect();
    let (size, [nx, ny]) = (cloth.size(), choice.repeats);
    let axes = if cloth.knit().is_some() { "x courses, y wales" } else { "x weft, y warp" };
    vec![
        format!("fiberwalk {}: {name}", env!("CARGO_PKG_VERSION")),
        format!(
            "in mm; {axes}, z up from the front's highest point, the back at {:.6}; seed {}, realization {}",
            -size.z, choice.seed, choice.realization
        ),
        format!("fibers {}", choice.packing.description()),
        format!("period {:.9} {:.9}; repeats {nx}x{ny}; fibers run on beyond the period", size.x, size.y),
    ]
}

/// The curve with more points on its pieces, if it has too few.
fn at_least(points: &[DVec3], fewest: usize) -> Vec<DVec3> {
    let parts = (fewest - 1).div_ceil(points.len() - 1).max(1);
    let piece = |ends: &[DVec3]| {
        let (from, to) = (ends[0], ends[1]);
        (1..=parts).map(move |part| from.lerp(to, part as f64 / parts as f64))
    };
    points.iter().copied().take(1).chain(points.windows(2).flat_map(piece)).collect()
}

fn mitsuba(
    curve: &Curve,
    shift: DVec3,
    header: &[String],
    counts: &mut CurveCounts,
    out: &mut impl Write,
) -> Result<()> {
    let points = at_least(&curve.points, FEWEST);
    for (index, point) in points.iter().enumerate() {
        let p = *point + shift;
        write!(out, "{:.6} {:.6} {:.6} {:.6}", p.x, p.y, p.z, curve.radius)?;
        if (counts.fibers, index) == (0, 0) {
            write!(out, " # {}", header.join("; "))?;
        }
        writeln!(out)?;
    }
    counts.add(&points);
    writeln!(out)
}

fn obj(
    cloth: &Cloth,
    curve: &Curve,
    shift: DVec3,
    group: &mut Option<(usize, usize)>,
    counts: &mut CurveCounts,
    out: &mut impl Write,
) -> Result<()> {
    if *group != Some((curve.thread, curve.kind)) {
        *group = Some((curve.thread, curve.kind));
        // A name is one word.
        let word = |c: char| if c.is_alphanumeric() { c } else { '_' };
        let kind: String = cloth.kinds()[curve.kind].name.chars().map(word).collect();
        writeln!(out, "# radius {:.6}\ng thread_{} {kind}\nusemtl {kind}", curve.radius, curve.thread)?;
    }
    for point in &curve.points {
        let p = *point + shift;
        writeln!(out, "v {:.6} {:.6} {:.6}", p.x, p.y, p.z)?;
    }
    write!(out, "l")?;
    // Points are counted from 1.
    for index in 1..=curve.points.len() as u64 {
        write!(out, " {}", counts.points + index)?;
    }
    counts.add(&curve.points);
    writeln!(out)
}

impl CurveCounts {
    fn add(&mut self, points: &[DVec3]) {
        self.fibers += 1;
        self.points += points.len() as u64;
        self.length += points.windows(2).map(|ends| ends[0].distance(ends[1])).sum::<f64>();
    }
}
