//! The shape of a relaxed loop.

use super::crossings::hooked;
use super::energy::{Penalty, Room, Table};
use super::minimise::minimise;
use super::series::{Basis, Series};
use crate::scene::{Stitch, THINNEST};
use std::ops::Range;

/// Axes are pushed this much farther apart than the yarn is thick, in diameters: what is left of the penalty's softness.
const MARGIN: f64 = 0.006;
/// Points of half a loop, times the diameter: between them the yarn comes nearer by 0.2 % of its diameter at most.
const FINENESS: f64 = 4.5;
/// Most of them: those of the thinnest yarn.
const FINEST: f64 = 2.0 / THINNEST;
/// Deepest overlap that counts as none, in diameters.
pub const DEEPEST: f64 = 0.01;
/// Deepest overlap of a yarn that grows on.
const LOOSE: f64 = 0.05;
/// A growing yarn becomes thicker by this factor.
const GROWTH: f64 = 1.2;
/// Loops of a thinner yarn start as if it were so thick.
const THIN: f64 = 0.02;
/// Width of the loops of a rib before they relax.
const WIDE: f64 = 0.2;
/// Loops that the yarn grows on, one after the other, until it fits.
const STARTS: usize = 2;
/// Loops that are looked at for this: heights of the layers of a rib in diameters, amplitudes of y in courses, and of x in the
/// width of a loop.
const LAYERS: [f64; 2] = [2.0, 3.0];
const HEIGHTS: [f64; 3] = [0.7, 0.76, 0.82];
const BULGES: [f64; 5] = [0.16, 0.18, 0.2, 0.22, 0.25];
/// Lengths of the shorter loops that a long one of a rib may come from, and by how much they grow in a step.
const SHORTER: [f64; 2] = [0.92, 0.84];
const LENGTHENED: f64 = 0.01;
/// Rounds of heavier and heavier penalties, and iterations of each at most.
const ROUNDS: i32 = 5;
const ITERATIONS: usize = 300;
/// How far a point moves in a step at most, in diameters: two of them by less than [`NEAREST`](super::energy::NEAREST).
const LONGEST: f64 = 0.2;

/// A relaxed loop, in loop lengths.
#[derive(Clone, Debug)]
pub struct Relaxed {
    pub series: Series,
    /// Least distance of axes over the diameter.
    pub clearance: f64,
    /// Largest curvature times the radius of the yarn.
    pub bend: f64,
}

impl Relaxed {
    /// Whether the yarn fits.
    pub fn fits(&self) -> bool {
        self.clearance >= 1.0 - DEEPEST && self.bend <= 1.0
    }
}

/// The loop that bends least in its room; its length is 1. Where the yarn is too thick, the largest diameter that fits,
/// about.
///
/// A thin yarn is laid as it hangs together, and grows. On the way no step moves a point by more than a fifth of the
/// diameter, and no two points come nearer than half of it: so yarns never pass through each other, and loops hang as
/// they did.
pub fn relax(stitch: Stitch, room: &Room) -> Result<Relaxed, f64> {
    let grown = relax_from_thin(stitch, room);
    match (grown, stitch) {
        (Err(largest), Stitch::Rib) => SHORTER.iter().find_map(|share| lengthened(stitch, room, *share)).ok_or(largest),
        (grown, _) => grown,
    }
}

/// Let a thin yarn grow on the first loops.
fn relax_from_thin(stitch: Stitch, room: &Room) -> Result<Relaxed, f64> {
    let table = Table::new(Basis::new(stitch), points(room));
    let mut largest: f64 = 0.0;
    for (series, clearance) in starts(&table, stitch, room) {
        match grow(&table, series, clearance, stitch, room) {
            Ok(relaxed) => return Ok(relaxed),
            Err(fitted) => largest = largest.max(fitted),
        }
    }
    Err(largest)
}

/// Relax a shorter loop of the same yarn, then give it more and more of it: the narrow wales of long loops leave a thin yarn
/// no start that is right.
fn lengthened(stitch: Stitch, room: &Room, share: f64) -> Option<Relaxed> {
    let of =
        |share: f64| Room { wale: room.wale / share, course: room.course / share, diameter: room.diameter / share };
    let mut series = relax_from_thin(stitch, &of(share)).ok()?.series;
    let table = Table::new(Basis::new(stitch), points(room));
    let steps = ((1.0 - share) / LENGTHENED).ceil();
    let mut multiplier = 0.0;
    for step in 1..=steps as u32 {
        let longer = of(share + (1.0 - share) * f64::from(step) / steps);
        series.wale = longer.wale;
        descend(&table, &mut series, &longer, 0..ROUNDS, &mut multiplier);
        if table.least_distance(&table.points(&series), &longer) < (1.0 - LOOSE) * longer.diameter {
            return None;
        }
    }
    let relaxed = finish(&table, series, room);
    relaxed.fits().then_some(relaxed)
}

/// Points of half a loop.
fn points(room: &Room) -> usize {
    (FINENESS / room.diameter).clamp(64.0, FINEST) as usize
}

/// Let a thin yarn grow on a loop whose axes are so far apart; none that is thicker than the error fits, about.
fn grow(table: &Table, mut series: Series, clearance: f64, stitch: Stitch, room: &Room) -> Result<Relaxed, f64> {
    let mut multiplier = 0.0;
    let mut grown = Room { diameter: clearance.min(room.diameter) / GROWTH, ..*room };
    let mut fitted = grown.diameter;
    while grown.diameter < room.diameter {
        grown.diameter = (grown.diameter * GROWTH).min(room.diameter);
        descend(table, &mut series, &grown, 0..2, &mut multiplier);
        if table.least_distance(&table.points(&series), &grown) < (1.0 - LOOSE) * grown.diameter {
            break;
        }
        fitted = grown.diameter;
    }
    if fitted < room.diameter {
        return Err(fitted);
    }
    descend(table, &mut series, room, 2..ROUNDS, &mut multiplier);
    let relaxed = finish(table, series, room);
    let hangs = stitch == Stitch::Rib || hooked(&relaxed.series, room.course, stitch);
    if relaxed.fits() && hangs { Ok(relaxed) } else { Err(fitted / GROWTH) }
}

/// Give a loop its length, and see how far it keeps apart.
fn finish(table: &Table, mut series: Series, room: &Room) -> Relaxed {
    lengthen(table, &mut series);
    let fine = Table::new(table.basis.clone(), 4 * table.half);
    let points = fine.points(&series);
    let clearance = fine.least_distance(&points, room) / room.diameter;
    Relaxed { clearance, bend: fine.largest_curvature(&points) * room.diameter / 2.0, series }
}

/// Lower the energy with heavier and heavier penalties.
fn descend(table: &Table, series: &mut Series, room: &Room, rounds: Range<i32>, multiplier: &mut f64) {
    let wide = Room { diameter: room.diameter * (1.0 + MARGIN), ..*room };
    // Scale the variables so that bending is about as stiff in all of them.
    let scales: Vec<f64> = table.basis.terms().map(|(_, f)| 1.0 / f.max(1.0).powi(2)).collect();
    for round in rounds {
        let contact = 1e2 * 10f64.powi(round);
        let penalty = Penalty { contact, length: 1e2 * 4f64.powi(round), multiplier: *multiplier };
        let from: Vec<f64> = series.coefficients.iter().zip(&scales).map(|(c, s)| c / s).collect();
        let of =
            |x: &[f64]| Series { coefficients: x.iter().zip(&scales).map(|(x, s)| x * s).collect(), ..series.clone() };
        let best = minimise(&from, ITERATIONS, LONGEST * room.diameter, 1e-9, |x| {
            let (energy, slopes) = table.energy(&of(x), &wide, &penalty);
            (energy, slopes.iter().zip(&scales).map(|(g, s)| g * s).collect())
        });
        *series = of(&best);
        *multiplier += penalty.length * (series.length() - 1.0);
    }
}

/// Bring the length to 1 by the smallest change of the coefficients.
fn lengthen(table: &Table, series: &mut Series) {
    for _ in 0..8 {
        let error = 1.0 - series.length();
        let slopes = table.length_slopes(series);
        let square: f64 = slopes.iter().map(|g| g * g).sum();
        series.coefficients.iter_mut().zip(&slopes).for_each(|(c, g)| *c += error * g / square);
    }
}

/// Whether the first loop hangs as it should; that of a rib is pulled wide, so that its layers lie side by side.
fn starts_hooked(series: &Series, stitch: Stitch, room: &Room) -> bool {
    let wide = Series { wale: width(stitch, room), ..series.clone() };
    hooked(&wide, room.course, stitch)
}

/// Width of the loops before they relax.
fn width(stitch: Stitch, room: &Room) -> f64 {
    match stitch {
        Stitch::Jersey => room.wale,
        Stitch::Rib => room.wale.max(WIDE),
    }
}

/// Loops whose crossings are right, with the least distances of their axes; first the one of about the right length. The
/// loops of a rib lie in two layers, which may overlap when the wales are narrow.
fn starts(table: &Table, stitch: Stitch, room: &Room) -> Vec<(Series, f64)> {
    let thick = room.diameter.max(THIN);
    let make = |bulge: f64, height: f64, layer: f64| {
        let amplitude = |(axis, f): (usize, f64)| match (stitch, axis, f) {
            (_, 0, 2.0) => bulge * width(stitch, room),
            (_, 1, 1.0) => height * room.course,
            // Heads and feet behind, legs in front.
            (Stitch::Jersey, 2, 2.0) => -1.2 * thick,
            // The same before the face wale's layer and turned over in the next: (layer − 2.2 cos 2t) (cos t/2 − cos 3t/2 / 3).
            (Stitch::Rib, 2, 0.5) => (layer + 0.36) * thick,
            (Stitch::Rib, 2, 1.5) => (-layer / 3.0 - 1.1) * thick,
            (Stitch::Rib, 2, 2.5) => -1.1 * thick,
            (Stitch::Rib, 2, 3.5) => 0.36 * thick,
            _ => 0.0,
        };
        Series {
            basis: table.basis.clone(),
            wale: room.wale,
            coefficients: table.basis.terms().map(amplitude).collect(),
        }
    };
    let mut found = Vec::new();
    for (layer, height) in LAYERS.into_iter().flat_map(|layer| HEIGHTS.map(|height| (layer, height))) {
        for bulge in BULGES {
            let series = make(bulge, height, layer);
            let clearance = table.least_distance(&table.points(&series), room);
            // Between points that lie farther apart than the yarn is thick, it could slip through.
            if clearance.min(room.diameter) >= 2.0 / table.half as f64 && starts_hooked(&series, stitch, room) {
                found.push((series, clearance));
            }
        }
    }
    let error = |series: &Series| (series.length() - 1.0).abs();
    found.sort_by(|a, b| error(&a.0).total_cmp(&error(&b.0)));
    found.truncate(STARTS);
    found
}
