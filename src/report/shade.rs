//! Light and shade: from the depth buffer to colours.

use super::colour::{Colour, mix};
use super::depth::{Depth, Seen};
use glam::Vec3;

/// Points of the buffer to a pixel, each way.
pub const FINE: usize = 3;
/// Light from the upper left, towards the light.
const LIGHT: Vec3 = Vec3::new(-0.5, 0.55, 0.67);
/// Light from all sides, and from the light itself.
const AMBIENT: f32 = 0.33;
const DIRECT: f32 = 0.58;
/// Highlight and its sharpness.
const GLOSS: f32 = 0.07;
const SHARPNESS: i32 = 24;

/// A picture of one repeat: linear colours times cover, and cover, in rows from below.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Of each pixel the colour, times the share of it that is covered, and that share.
    pub pixels: Vec<(Colour, f32)>,
}

impl Tile {
    /// The pixel over a background, of any repeat.
    pub fn over(&self, column: i64, row: i64, background: Colour) -> Colour {
        let [columns, rows] = self.size.map(|size| size as i64);
        let (colour, cover) = self.pixels[(row.rem_euclid(rows) * columns + column.rem_euclid(columns)) as usize];
        [0, 1, 2].map(|channel| colour[channel] + background[channel] * (1.0 - cover))
    }

    /// Average the points of every pixel.
    fn gather(depth: &Depth, shade: impl Fn(&Seen, usize) -> Option<Colour>) -> Tile {
        let size = depth.size().map(|size| size / FINE);
        let mut pixels = Vec::with_capacity(size[0] * size[1]);
        for place in 0..size[0] * size[1] {
            let (mut sum, mut cover) = ([0.0; 3], 0.0);
            for point in 0..FINE * FINE {
                let (column, row) = (place % size[0] * FINE + point % FINE, place / size[0] * FINE + point / FINE);
                if let Some(colour) = shade(depth.at(column, row), place) {
                    let share = 1.0 / (FINE * FINE) as f32;
                    sum = [0, 1, 2].map(|channel| sum[channel] + share * colour[channel]);
                    cover += share;
                }
            }
            pixels.push((sum, cover));
        }
        Tile { size, pixels }
    }
}

/// Light on a surface with this normal; `sun` is the share of the direct light and `sky` that of the rest.
fn lit(base: Colour, normal: Vec3, sun: f32, sky: f32) -> Colour {
    let light = LIGHT.normalize();
    let half = (light + Vec3::Z).normalize();
    let diffuse = AMBIENT * sky + DIRECT * sun * normal.dot(light).max(0.0);
    let gloss = GLOSS * sun * normal.dot(half).max(0.0).powi(SHARPNESS);
    base.map(|part| part * diffuse + gloss)
}

/// A face: fibers as cylinders, yarns by the shape and the shadows of the surface that they make; `spacing` is that of
/// the closest threads and `thickness` that of the cloth, in mm.
pub fn face(depth: &Depth, colours: &[Colour], pixels_per_mm: f64, spacing: f64, thickness: f64) -> Tile {
    let relief = Relief::new(depth, pixels_per_mm as f32, spacing as f32, thickness as f32);
    Tile::gather(depth, |seen, place| {
        if seen.is_nothing() {
            return None;
        }
        let fiber = Vec3::from(seen.normal());
        let normal = (0.45 * fiber + 0.55 * relief.normals[place]).normalize();
        Some(lit(colours[usize::from(seen.kind)], normal, relief.sun[place], relief.sky[place]))
    })
}

/// A cut: fibers that are cut open flat and with a dark rim, those behind the plane fainter with their distance.
pub fn cut(depth: &Depth, colours: &[Colour], background: Colour, plane: f64, reach: f64) -> Tile {
    Tile::gather(depth, |seen, _| {
        if seen.is_nothing() {
            return None;
        }
        let base = colours[usize::from(seen.kind)];
        if seen.cut {
            let [share, ..] = seen.normal();
            let rim = ((share - 0.72) / 0.2).clamp(0.0, 1.0);
            return Some(base.map(|part| 0.95 * part * (1.0 - 0.75 * rim)));
        }
        let behind = ((plane as f32 - seen.near) / reach as f32).clamp(0.0, 1.0);
        let colour = lit(base, Vec3::from(seen.normal()), 0.8, 0.8);
        Some(mix(colour, background, 0.5 + 0.45 * behind))
    })
}

/// The surface that the fibers make, at the pixels of a repeat.
struct Relief {
    size: [usize; 2],
    /// Its normals where it is smooth over a yarn.
    normals: Vec<Vec3>,
    /// Shares of direct and of ambient light that reach it.
    sun: Vec<f32>,
    sky: Vec<f32>,
}

impl Relief {
    fn new(depth: &Depth, per_mm: f32, spacing: f32, thickness: f32) -> Relief {
        let size = depth.size().map(|size| size / FINE);
        let heights = heights(depth, size);
        let blur = |share: f32| {
            let reach = (share * spacing * per_mm).round().max(1.0) as usize;
            let once = smooth(&heights, size, reach);
            smooth(&once, size, reach)
        };
        let (yarns, around) = (blur(0.06), blur(0.3));
        let mut relief = Relief { size, normals: Vec::new(), sun: Vec::new(), sky: Vec::new() };
        for place in 0..heights.len() {
            let at = |right: i64, up: i64| yarns[relief.step(place, right, up)];
            let slope = [at(1, 0) - at(-1, 0), at(0, 1) - at(0, -1)].map(|rise| rise * per_mm / 2.0);
            relief.normals.push(Vec3::new(-slope[0], -slope[1], 1.0).normalize());
            // Let what lies lower than all around it be darker.
            let low = (around[place] - yarns[place]) / thickness;
            relief.sky.push((1.0 - 2.2 * low.max(0.0)).clamp(0.25, 1.0));
            let sun = 1.0 - relief.shadow(&yarns, place, per_mm, thickness);
            relief.sun.push(sun);
        }
        relief
    }

    /// The place so many pixels to the right and up.
    fn step(&self, place: usize, right: i64, up: i64) -> usize {
        let [columns, rows] = self.size.map(|size| size as i64);
        let (column, row) = (place as i64 % columns + right, place as i64 / columns + up);
        (row.rem_euclid(rows) * columns + column.rem_euclid(columns)) as usize
    }

    /// How much of the light higher places keep away: go towards it, as far as the cloth is thick.
    fn shadow(&self, heights: &[f32], place: usize, per_mm: f32, thickness: f32) -> f32 {
        let level = LIGHT.truncate().length();
        let (far, soft) = (thickness * level / LIGHT.z * per_mm, 0.12 * thickness);
        let steps = far.ceil().clamp(1.0, 24.0) as usize;
        let mut darkest: f32 = 0.0;
        for step in 1..=steps {
            let away = far * step as f32 / steps as f32;
            let [right, up] = [LIGHT.x, LIGHT.y].map(|part| (part / level * away).round() as i64);
            let ray = heights[place] + away / per_mm * LIGHT.z / level;
            darkest = darkest.max((heights[self.step(place, right, up)] - ray) / soft);
        }
        0.85 * darkest.min(1.0)
    }
}

/// Mean heights of the pixels; openings lie as low as the lowest fiber.
fn heights(depth: &Depth, size: [usize; 2]) -> Vec<f32> {
    let points = || (0..depth.size()[1]).flat_map(|row| (0..depth.size()[0]).map(move |column| (column, row)));
    let near = |(column, row): (usize, usize)| depth.at(column, row).near;
    let floor = points().map(near).filter(|near| near.is_finite()).fold(f32::INFINITY, f32::min);
    let floor = if floor.is_finite() { floor } else { 0.0 };
    let mut heights = vec![0.0; size[0] * size[1]];
    for (column, row) in points() {
        heights[row / FINE * size[0] + column / FINE] += near((column, row)).max(floor) / (FINE * FINE) as f32;
    }
    heights
}

/// The mean over a square of 2 reach + 1 pixels, round the repeat.
fn smooth(heights: &[f32], size: [usize; 2], reach: usize) -> Vec<f32> {
    let [columns, rows] = size;
    let mut level = vec![0.0; heights.len()];
    for row in 0..rows {
        run(reach, columns, |index| heights[row * columns + index], |index, mean| level[row * columns + index] = mean);
    }
    let mut both = vec![0.0; heights.len()];
    for column in 0..columns {
        run(reach, rows, |index| level[index * columns + column], |index, mean| both[index * columns + column] = mean);
    }
    both
}

/// Running means over a closed line.
fn run(reach: usize, count: usize, from: impl Fn(usize) -> f32, mut to: impl FnMut(usize, f32)) {
    let reach = reach.min((count.max(1) - 1) / 2) as i64;
    let at = |index: i64| f64::from(from(index.rem_euclid(count as i64) as usize));
    let mut sum: f64 = (-reach..=reach).map(at).sum();
    for index in 0..count as i64 {
        to(index as usize, (sum / (2 * reach + 1) as f64) as f32);
        sum += at(index + reach + 1) - at(index - reach);
    }
}
