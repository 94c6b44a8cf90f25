//! The change of variables of the RGL's files: a grid of densities over the unit square and its cumulative sums.
//!
//! "Marginal2D" with continuous interpolation, mitsuba3, `include/mitsuba/core/distr_2d.h`: densities are bilinear between nodes that
//! stand at k/(n − 1). Between two parameters the cumulative sums themselves are interpolated.

/// Grids of n × n nodes, one for each pair of parameters, as densities that integrate to 1.
#[derive(Clone, Debug)]
pub struct Warp {
    n: usize,
    /// By slice, row, column.
    density: Vec<f32>,
    /// Integrals of a row up to a column.
    along: Vec<f32>,
    /// Integrals up to a row.
    rows: Vec<f32>,
}

/// Slices with shares that add up to 1.
pub type Blend = [(usize, f64); 4];

impl Warp {
    /// From grids of positive numbers, one after the other.
    pub fn new(n: usize, grids: &[f32]) -> Warp {
        let cell = 1.0 / (n - 1) as f64;
        let mut warp = Warp {
            n,
            density: Vec::with_capacity(grids.len()),
            along: Vec::with_capacity(grids.len()),
            rows: Vec::with_capacity(grids.len() / n),
        };
        for grid in grids.chunks_exact(n * n) {
            let mut along = Vec::with_capacity(n * n);
            for row in grid.chunks_exact(n) {
                let mut sum = 0.0;
                along.push(0.0);
                for pair in row.windows(2) {
                    sum += f64::from(pair[0] + pair[1]) / 2.0 * cell;
                    along.push(sum);
                }
            }
            let whole = |row: usize| along[row * n + n - 1];
            let mut rows = vec![0.0];
            for row in 1..n {
                rows.push(rows[row - 1] + (whole(row - 1) + whole(row)) / 2.0 * cell);
            }
            let all = rows[n - 1];
            warp.density.extend(grid.iter().map(|value| (f64::from(*value) / all) as f32));
            warp.along.extend(along.iter().map(|value| (value / all) as f32));
            warp.rows.extend(rows.iter().map(|value| (value / all) as f32));
        }
        warp
    }

    fn node(&self, of: &[f32], blend: &Blend, stride: usize, index: usize) -> f64 {
        blend.iter().map(|(slice, share)| share * f64::from(of[slice * stride + index])).sum()
    }

    /// The place of the square that a sample, uniform on the square, is sent to, and the density there.
    pub fn sample(&self, blend: &Blend, sample: [f64; 2]) -> ([f64; 2], f64) {
        let n = self.n;
        let cells = (n - 1) as f64;
        let below = |row: usize| self.node(&self.rows, blend, n, row);
        let row = last_below(n - 1, sample[1], &below);
        let whole = |row: usize| self.node(&self.along, blend, n * n, row * n + n - 1);
        let (r0, r1) = (whole(row), whole(row + 1));
        let y = solve((sample[1] - below(row)) * cells, r0, r1);
        let mix = |column: usize, of: &[f32]| {
            let at = |row: usize| self.node(of, blend, n * n, row * n + column);
            at(row) + y * (at(row + 1) - at(row))
        };
        let target = sample[0] * (r0 + y * (r1 - r0));
        let column = last_below(n - 1, target, &|column| mix(column, &self.along));
        let (c0, c1) = (mix(column, &self.density), mix(column + 1, &self.density));
        let x = solve((target - mix(column, &self.along)) * cells, c0, c1);
        ([(column as f64 + x) / cells, (row as f64 + y) / cells], c0 + x * (c1 - c0))
    }

    /// The sample that is sent to a place, and the density there: the inverse of [`Warp::sample`].
    pub fn invert(&self, blend: &Blend, place: [f64; 2]) -> ([f64; 2], f64) {
        let n = self.n;
        let cells = (n - 1) as f64;
        let split = |t: f64| {
            let scaled = t.clamp(0.0, 1.0) * cells;
            let low = (scaled as usize).min(n - 2);
            (low, scaled - low as f64)
        };
        let ((column, x), (row, y)) = (split(place[0]), split(place[1]));
        let mix = |column: usize, of: &[f32]| {
            let at = |row: usize| self.node(of, blend, n * n, row * n + column);
            at(row) + y * (at(row + 1) - at(row))
        };
        let (c0, c1) = (mix(column, &self.density), mix(column + 1, &self.density));
        let density = c0 + x * (c1 - c0);
        let along = mix(column, &self.along) + x * (c0 + 0.5 * x * (c1 - c0)) / cells;
        let whole = |row: usize| self.node(&self.along, blend, n * n, row * n + n - 1);
        let (r0, r1) = (whole(row), whole(row + 1));
        let rows = self.node(&self.rows, blend, n, row) + y * (r0 + 0.5 * y * (r1 - r0)) / cells;
        ([along / (r0 + y * (r1 - r0)), rows], density)
    }
}

/// The last of `count` intervals whose lower end is not above a value.
fn last_below(count: usize, value: f64, ends: &dyn Fn(usize) -> f64) -> usize {
    let (mut low, mut high) = (0, count);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if ends(middle) <= value { low = middle } else { high = middle }
    }
    low
}

/// t ∈ [0, 1] up to which a density that goes from v0 to v1 has the integral `area`.
fn solve(area: f64, v0: f64, v1: f64) -> f64 {
    let t = if (v0 - v1).abs() < 1e-4 * (v0 + v1) {
        2.0 * area / (v0 + v1)
    } else {
        (v0 - (v0 * v0 - 2.0 * area * (v0 - v1)).max(0.0).sqrt()) / (v0 - v1)
    };
    t.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hills() -> Warp {
        let hill = |phase: f64| {
            move |i: usize| (1.2 + (i as f64 * 0.9 + phase).sin() + 0.5 * (i as f64 / 7.0 - phase).cos()).abs() as f32
        };
        let grids: Vec<f32> = [0.0, 1.0].into_iter().flat_map(|phase| (0..49).map(hill(phase))).collect();
        Warp::new(7, &grids)
    }

    #[test]
    fn the_inverse_undoes_the_warp() {
        let warp = hills();
        for blend in [[(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)], [(0, 0.3), (1, 0.7), (0, 0.0), (0, 0.0)]] {
            for i in 0..400 {
                let sample = [(f64::from(i) * 0.618).fract(), (f64::from(i) * 0.383).fract()];
                let (place, density) = warp.sample(&blend, sample);
                let (back, same) = warp.invert(&blend, place);
                assert!(
                    (back[0] - sample[0]).abs() < 1e-5 && (back[1] - sample[1]).abs() < 1e-5,
                    "{sample:?} {back:?}"
                );
                assert!((density / same - 1.0).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn the_density_is_that_of_the_warp() {
        // Areas: the determinant of the inverse by central differences.
        let warp = hills();
        let blend = [(1, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];
        for place in [[0.31, 0.21], [0.63, 0.11], [0.05, 0.97], [0.56, 0.42]] {
            let at = |dx: f64, dy: f64| warp.invert(&blend, [place[0] + dx, place[1] + dy]).0;
            let step = 1e-3;
            let dx = [0, 1].map(|k| (at(step, 0.0)[k] - at(-step, 0.0)[k]) / (2.0 * step));
            let dy = [0, 1].map(|k| (at(0.0, step)[k] - at(0.0, -step)[k]) / (2.0 * step));
            let density = warp.invert(&blend, place).1;
            let area = dx[0] * dy[1] - dx[1] * dy[0];
            assert!((area / density - 1.0).abs() < 5e-3, "{place:?}: {area} for {density}");
        }
    }
}
