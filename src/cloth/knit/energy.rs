//! What a loop minimises: bending, with penalties for contact and for the wrong length.

use super::series::{Basis, Series};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Weight of the bending energy ∫κ² ds of a loop of length 1.
const BENDING: f64 = 1e-2;
/// Weight of an even speed: it chooses one of the many parametrisations of the same curve.
const EVEN: f64 = 1e-2;

/// Points that are looked at together.
const RUN: usize = 8;

/// Points never come nearer to each other than this share of the distance that they should keep.
pub const NEAREST: f64 = 0.5;

/// The room of a loop; the loop length is the unit.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    /// Distance between wales.
    pub wale: f64,
    /// Distance between courses.
    pub course: f64,
    /// Distance that axes keep.
    pub diameter: f64,
}

/// Weights of the constraints.
#[derive(Clone, Copy, Debug)]
pub struct Penalty {
    /// Of the squared overlap of pairs of points, in diameters.
    pub contact: f64,
    /// Of half the squared error of the length.
    pub length: f64,
    /// Multiplier of the error of the length.
    pub multiplier: f64,
}

/// A loop by its points: the half from the head to the foot, at the middles of equal steps of the parameter.
pub struct Points {
    pub point: Vec<DVec3>,
    first: Vec<DVec3>,
    second: Vec<DVec3>,
    /// Length of a loop.
    pub length: f64,
}

/// The sines and cosines at the points, and their derivatives.
pub struct Table {
    pub basis: Basis,
    /// Points from the head of a loop to its foot.
    pub half: usize,
    /// Coordinate of each term, and its values and derivatives at the points.
    terms: Vec<(usize, Vec<[f64; 3]>)>,
}

impl Table {
    pub fn new(basis: Basis, half: usize) -> Table {
        let term = |(axis, f): (usize, f64)| {
            let at = |place: usize| {
                let (sin, cos) = (f * parameter(place, half)).sin_cos();
                if axis == 0 { [sin, f * cos, -f * f * sin] } else { [cos, -f * sin, -f * f * cos] }
            };
            (axis, (0..half).map(at).collect())
        };
        let terms = basis.terms().map(term).collect();
        Table { basis, half, terms }
    }

    pub fn points(&self, series: &Series) -> Points {
        let values = (0..self.half).map(|place| series.at(parameter(place, self.half)));
        let step = PI / self.half as f64;
        let (mut point, mut first, mut second) = (Vec::new(), Vec::new(), Vec::new());
        let mut length = 0.0;
        for [p, d, dd] in values {
            length += 2.0 * d.length() * step;
            point.push(p);
            first.push(d);
            second.push(dd);
        }
        Points { point, first, second, length }
    }

    /// Energy of a curve and its derivatives by the coefficients; infinite where the yarn is about to run through itself.
    pub fn energy(&self, series: &Series, room: &Room, penalty: &Penalty) -> (f64, Vec<f64>) {
        let points = self.points(series);
        // Both halves of the loop have the same energy.
        let weight = 2.0 * PI / self.half as f64;
        let mut energy = 0.0;
        let mut slopes = [0; 3].map(|_| vec![DVec3::ZERO; self.half]);
        let error = points.length - 1.0;
        energy += penalty.multiplier * error + penalty.length * error * error / 2.0;
        let pull = penalty.multiplier + penalty.length * error;
        for (place, (&p, &q)) in points.first.iter().zip(&points.second).enumerate() {
            let (square, cross) = (p.length_squared(), p.cross(q));
            let (speed, turn) = (square.sqrt(), cross.length_squared());
            // Bending: κ² ds = |p × q|² |p|⁻⁵ dt.
            let fifth = square * square * speed;
            energy += BENDING * weight * turn / fifth;
            let by_p = 2.0 * q.cross(cross) / fifth - 5.0 * turn / (fifth * square) * p;
            slopes[1][place] += BENDING * weight * by_p;
            slopes[2][place] += BENDING * weight * 2.0 * cross.cross(p) / fifth;
            // Speed: (|p|² (2π)² − 1)².
            let uneven = square * TAU * TAU - 1.0;
            energy += EVEN * weight * uneven * uneven;
            slopes[1][place] += EVEN * weight * 4.0 * uneven * TAU * TAU * p;
            // Length.
            slopes[1][place] += pull * weight * p / speed;
        }
        match self.contact(&points, room, penalty.contact, &mut slopes[0]) {
            Some(pushed) => energy += pushed,
            None => return (f64::INFINITY, vec![0.0; self.terms.len()]),
        }
        let gradient = self.terms.iter().map(|(axis, values)| {
            let at = |place: usize| (0..3).map(|order| slopes[order][place][*axis] * values[place][order]).sum::<f64>();
            (0..self.half).map(at).sum()
        });
        (energy, gradient.collect())
    }

    /// Derivatives of the length by the coefficients.
    pub fn length_slopes(&self, series: &Series) -> Vec<f64> {
        let points = self.points(series);
        let weight = 2.0 * PI / self.half as f64;
        let slope = |(axis, values): &(usize, Vec<[f64; 3]>)| {
            (0..self.half).map(|place| weight * points.first[place].normalize()[*axis] * values[place][1]).sum()
        };
        self.terms.iter().map(slope).collect()
    }

    /// Penalty of all pairs of points that are too near; none where a pair is nearer than half of what it should be.
    fn contact(&self, points: &Points, room: &Room, weight: f64, slopes: &mut [DVec3]) -> Option<f64> {
        let mut energy = 0.0;
        let mut passing = false;
        let scale = weight / (room.diameter * room.diameter);
        near(&points.point, room, self.basis.next_z, 1.0, |i, j, sign, apart, wanted| {
            let distance = apart.length();
            let deep = wanted - distance;
            if deep <= 0.0 {
                return;
            }
            passing |= deep > NEAREST * wanted;
            energy += scale * deep * deep;
            let push = apart * (2.0 * scale * deep / distance.max(1e-9));
            slopes[i] -= push;
            slopes[j] += push * sign;
        });
        (!passing).then_some(energy)
    }

    /// Least distance between points that are not neighbours along the yarn.
    pub fn least_distance(&self, points: &Points, room: &Room) -> f64 {
        let mut least = 2.0 * room.diameter;
        near(&points.point, room, self.basis.next_z, 2.0, |_, _, _, apart, wanted| {
            if wanted == room.diameter {
                least = least.min(apart.length());
            }
        });
        least
    }

    /// Largest curvature.
    pub fn largest_curvature(&self, points: &Points) -> f64 {
        let curvature = |(p, q): (&DVec3, &DVec3)| p.cross(*q).length() / p.length().powi(3);
        points.first.iter().zip(&points.second).map(curvature).fold(0.0, f64::max)
    }
}

/// The parameter of a point.
fn parameter(place: usize, half: usize) -> f64 {
    PI * (place as f64 + 0.5) / half as f64
}

/// Visit pairs of points nearer than some diameters: a point of the half loop, and an image of another in the same course
/// or one above, as (first, second, signs of the image, way from the image to the first, distance that they should
/// keep). Neighbours along the yarn need only be as far apart as on a circle that is bent to the yarn's radius.
fn near(
    points: &[DVec3],
    room: &Room,
    next_z: f64,
    diameters: f64,
    mut visit: impl FnMut(usize, usize, DVec3, DVec3, f64),
) {
    let distance = diameters * room.diameter;
    let reach = points.iter().fold(0.0f64, |reach, point| reach.max(point.y.abs()));
    let courses = ((2.0 * reach + distance) / room.course).floor().min(8.0) as i32;
    let square = distance * distance;
    let boxes: Vec<[DVec3; 2]> = points.chunks(RUN).map(bounds).collect();
    let mut close = Vec::with_capacity(boxes.len());
    for course in 0..=courses {
        for wale in -3..=3i32 {
            for mirror in [1.0, -1.0] {
                let sign = DVec3::new(mirror, 1.0, if wale % 2 == 0 { 1.0 } else { next_z });
                let offset = DVec3::new(f64::from(wale) * room.wale, f64::from(course) * room.course, 0.0);
                for (run, corners) in boxes.iter().enumerate() {
                    // Leave out the runs of points that are too far away together.
                    let [a, b] = corners.map(|corner| corner * sign + offset);
                    let (low, high) = (a.min(b), a.max(b));
                    close.clear();
                    close.extend((0..boxes.len()).filter(|&other| {
                        let gap = (boxes[other][0] - high).max(low - boxes[other][1]).max(DVec3::ZERO);
                        gap.length_squared() < square
                    }));
                    if close.is_empty() {
                        continue;
                    }
                    for (j, point) in points.iter().enumerate().skip(run * RUN).take(RUN) {
                        let image = *point * sign + offset;
                        let along = mirror * parameter(j, points.len()) / TAU + f64::from(wale);
                        for &other in &close {
                            for (i, own) in points.iter().enumerate().skip(other * RUN).take(RUN) {
                                let apart = *own - image;
                                if apart.length_squared() >= square {
                                    continue;
                                }
                                let between = (parameter(i, points.len()) / TAU - along).abs() / room.diameter;
                                let near = course == 0 && between < FRAC_PI_2;
                                let wanted = if near { room.diameter * between.sin() } else { room.diameter };
                                visit(i, j, sign, apart, wanted);
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The lowest and the highest corner of a box around points.
fn bounds(points: &[DVec3]) -> [DVec3; 2] {
    let first = points[0];
    points.iter().fold([first, first], |[low, high], point| [low.min(*point), high.max(*point)])
}
