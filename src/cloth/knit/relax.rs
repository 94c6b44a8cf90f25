//! The shape of a relaxed loop.

use super::crossings::hooked;
use super::energy::{Penalty, Room, Table};
use super::minimise::minimise;
use super::series::{Basis, Series};
use crate::scene::Stitch;
use std::ops::Range;

/// Axes are pushed this much farther apart than the yarn is thick, in diameters: what is left of the penalty's softness.
const MARGIN: f64 = 0.006;
/// Points of half a loop, times the diameter: between them the yarn comes nearer by 0.4 % of its diameter at most.
const FINENESS: f64 = 2.8;
/// Deepest overlap that counts as none, in diameters.
pub const DEEPEST: f64 = 0.01;
/// Deepest overlap of a yarn that grows on.
const LOOSE: f64 = 0.05;
/// A growing yarn becomes thicker by this factor.
const GROWTH: f64 = 1.2;
/// Width of the loops of a rib before they relax.
const WIDE: f64 = 0.2;
/// Height of its layers above the middle, in diameters.
const LAYER: f64 = 2.0;
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
    let half = (FINENESS / room.diameter).clamp(64.0, 256.0) as usize;
    let table = Table::new(Basis::new(stitch), half);
    let mut series = start(&table.basis, stitch, room);
    let clearance = table.least_distance(&table.points(&series), room);
    // Between points that lie farther apart than the yarn is thick, it could slip through.
    if clearance < 1.0 / half as f64 || !starts_hooked(&series, stitch, room) {
        return Err(0.0);
    }
    let mut multiplier = 0.0;
    let mut grown = Room { diameter: clearance.min(room.diameter) / GROWTH, ..*room };
    let mut fitted = grown.diameter;
    while grown.diameter < room.diameter {
        grown.diameter = (grown.diameter * GROWTH).min(room.diameter);
        descend(&table, &mut series, &grown, 0..2, &mut multiplier);
        if table.least_distance(&table.points(&series), &grown) < (1.0 - LOOSE) * grown.diameter {
            break;
        }
        fitted = grown.diameter;
    }
    if fitted < room.diameter {
        return Err(fitted);
    }
    descend(&table, &mut series, room, 2..ROUNDS, &mut multiplier);
    lengthen(&table, &mut series);
    let fine = Table::new(table.basis, 4 * half);
    let points = fine.points(&series);
    let clearance = fine.least_distance(&points, room) / room.diameter;
    let relaxed = Relaxed { clearance, bend: fine.largest_curvature(&points) * room.diameter / 2.0, series };
    if relaxed.fits() { Ok(relaxed) } else { Err(fitted / GROWTH) }
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

/// A loop whose crossings are right, and about as long as it should be. Loops of a rib lie in two layers, which may
/// overlap when the wales are narrow.
fn start(basis: &Basis, stitch: Stitch, room: &Room) -> Series {
    let Room { wale, course, diameter } = *room;
    let wide = width(stitch, room);
    let layer = LAYER * diameter;
    let make = |bulge: f64| {
        let amplitude = |(axis, f): (usize, f64)| match (stitch, axis, f) {
            (_, 0, 2.0) => bulge * wide,
            (_, 1, 1.0) => 0.75 * course,
            // Heads and feet behind, legs in front.
            (Stitch::Jersey, 2, 2.0) => -1.2 * diameter,
            // The same before the face wale's layer and turned over in the next: (layer − 2.2 cos 2t) (cos t/2 − cos 3t/2 / 3).
            (Stitch::Rib, 2, 0.5) => layer + 0.36 * diameter,
            (Stitch::Rib, 2, 1.5) => -layer / 3.0 - 1.1 * diameter,
            (Stitch::Rib, 2, 2.5) => -1.1 * diameter,
            (Stitch::Rib, 2, 3.5) => 0.36 * diameter,
            _ => 0.0,
        };
        Series { basis: basis.clone(), wale, coefficients: basis.terms().map(amplitude).collect() }
    };
    let [mut low, mut high] = [0.17, 0.25];
    for _ in 0..20 {
        let middle = (low + high) / 2.0;
        if make(middle).length() < 1.0 { low = middle } else { high = middle }
    }
    make(low)
}
