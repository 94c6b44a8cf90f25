//! A quasi-Newton minimiser.

/// Iterations without success before it gives up.
const SMALL: f64 = 1e-12;

/// Minimise a function with its gradient from a start: BFGS with backtracking (Nocedal and Wright, Numerical
/// Optimization, section 6.1). No step is longer than `longest` in the sum of its parts. The same input gives the same
/// result.
pub fn minimise(
    start: &[f64],
    iterations: usize,
    longest: f64,
    tolerance: f64,
    mut function: impl FnMut(&[f64]) -> (f64, Vec<f64>),
) -> Vec<f64> {
    let n = start.len();
    let mut x = start.to_vec();
    let (mut value, mut slope) = function(&x);
    let mut inverse = identity(n);
    let mut fresh = true;
    for _ in 0..iterations {
        let mut step: Vec<f64> = inverse.iter().map(|row| -dot(row, &slope)).collect();
        let mut descent = dot(&step, &slope);
        if descent >= 0.0 {
            // Start again from the steepest descent.
            inverse = identity(n);
            fresh = true;
            step = slope.iter().map(|g| -g).collect();
            descent = dot(&step, &slope);
        }
        let size: f64 = step.iter().map(|s| s.abs()).sum();
        let mut share = (longest / size).min(1.0);
        let found = loop {
            let next: Vec<f64> = x.iter().zip(&step).map(|(x, s)| x + share * s).collect();
            let (next_value, next_slope) = function(&next);
            if next_value <= value + 1e-4 * share * descent {
                break Some((next, next_value, next_slope));
            }
            share *= 0.4;
            if share * size < SMALL {
                break None;
            }
        };
        let Some((next, next_value, next_slope)) = found else {
            if fresh {
                break;
            }
            inverse = identity(n);
            fresh = true;
            continue;
        };
        let s: Vec<f64> = next.iter().zip(&x).map(|(a, b)| a - b).collect();
        let y: Vec<f64> = next_slope.iter().zip(&slope).map(|(a, b)| a - b).collect();
        let gained = value - next_value;
        (x, value, slope) = (next, next_value, next_slope);
        if gained <= tolerance * value.abs() && !fresh {
            break;
        }
        let sy = dot(&s, &y);
        if sy > 1e-14 {
            if fresh {
                let scale = sy / dot(&y, &y);
                inverse.iter_mut().flatten().for_each(|h| *h *= scale);
            }
            update(&mut inverse, &s, &y, sy);
            fresh = false;
        }
    }
    x
}

/// H ← (1 − s yᵀ/sy) H (1 − y sᵀ/sy) + s sᵀ/sy.
fn update(inverse: &mut [Vec<f64>], s: &[f64], y: &[f64], sy: f64) {
    let hy: Vec<f64> = inverse.iter().map(|row| dot(row, y)).collect();
    let both = (1.0 + dot(y, &hy) / sy) / sy;
    for (i, row) in inverse.iter_mut().enumerate() {
        for (j, h) in row.iter_mut().enumerate() {
            *h += both * s[i] * s[j] - (hy[i] * s[j] + s[i] * hy[j]) / sy;
        }
    }
}

fn identity(n: usize) -> Vec<Vec<f64>> {
    (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
