//! The axis of a course as a Fourier series.

use crate::scene::Stitch;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Highest harmonic of a loop.
const HARMONICS: usize = 8;

/// The sines and cosines that the symmetries of a stitch allow. The parameter t grows by 2π from wale to wale, and t = 0
/// is the head of a loop.
///
/// The axis is x = w t/2π + Σ aₙ sin fₙt, y = Σ bₙ cos fₙt, z = Σ cₙ cos fₙt: a loop is its own mirror image in x. Plain
/// loops have feet like their heads, turned over in y: x(t + π) = x + w/2, y → −y, z → z, which leaves even
/// harmonics of x and z and odd ones of y. In a rib the next wale is the mirror image in z: z has the odd halves.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    /// Frequencies of x, y and z.
    pub frequencies: [Vec<f64>; 3],
    /// 1, or −1 where the next wale is the mirror image in z.
    pub next_z: f64,
}

impl Basis {
    /// The series of a stitch.
    pub fn new(stitch: Stitch) -> Basis {
        let up_to = |count: usize, frequency: fn(f64) -> f64| (1..=count).map(|n| frequency(n as f64)).collect();
        match stitch {
            Stitch::Jersey => {
                let even = |n: f64| 2.0 * n;
                let half = HARMONICS / 2;
                Basis {
                    frequencies: [up_to(half, even), up_to(half, |n| 2.0 * n - 1.0), up_to(half, even)],
                    next_z: 1.0,
                }
            }
            Stitch::Rib => {
                let whole = up_to(HARMONICS, |n| n);
                Basis { frequencies: [whole.clone(), whole, up_to(HARMONICS, |n| n - 0.5)], next_z: -1.0 }
            }
        }
    }

    /// Coordinate and frequency of each coefficient.
    pub fn terms(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        (0..3).flat_map(|axis| self.frequencies[axis].iter().map(move |frequency| (axis, *frequency)))
    }
}

/// The axis of the course whose loops stand about y = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    pub basis: Basis,
    /// Distance between wales.
    pub wale: f64,
    /// Amplitudes of x, y and z in the order of [`Basis::terms`].
    pub coefficients: Vec<f64>,
}

impl Series {
    /// Point, first and second derivative by the parameter.
    pub fn at(&self, t: f64) -> [DVec3; 3] {
        let per_turn = self.wale / TAU;
        let mut out = [DVec3::X * per_turn * t, DVec3::X * per_turn, DVec3::ZERO];
        for ((axis, f), c) in self.basis.terms().zip(&self.coefficients) {
            let (sin, cos) = (f * t).sin_cos();
            let (value, first) = if axis == 0 { (sin, f * cos) } else { (cos, -f * sin) };
            out[0][axis] += c * value;
            out[1][axis] += c * first;
            out[2][axis] -= c * f * f * value;
        }
        out
    }

    /// Length of a loop, by the midpoint rule, which is as good as exact for a periodic integrand.
    pub fn length(&self) -> f64 {
        const POINTS: u32 = 512;
        let speed = |i| self.at(PI * (f64::from(i) + 0.5) / f64::from(POINTS))[1].length();
        (0..POINTS).map(speed).sum::<f64>() * TAU / f64::from(POINTS)
    }

    /// All lengths times a factor.
    pub fn scaled(&self, factor: f64) -> Series {
        let coefficients = self.coefficients.iter().map(|c| c * factor).collect();
        Series { basis: self.basis.clone(), wale: self.wale * factor, coefficients }
    }
}
