//! Which pieces may come to touch which.

use super::chains::Chains;
use super::contact::closest;
use glam::{DVec2, DVec3, IVec3};
use rayon::prelude::*;

/// Distance at which neighbours are listed, in sums of the radii beyond touching.
const SKIN: f64 = 0.3;
/// Pieces nearer than this along a fiber, in radii, are no neighbours.
const OWN: f64 = 4.0;
/// Pieces that are listed together.
const BLOCK: usize = 1024;
/// Most cells along an axis.
const MOST_CELLS: f64 = 1024.0;

/// A neighbour of a piece: another piece, moved by so many periods.
#[derive(Clone, Copy, Debug)]
pub struct Neighbour {
    pub piece: u32,
    pub shift: [i16; 2],
}

impl Neighbour {
    /// Its corners, where it is a neighbour.
    pub fn ends(&self, chains: &Chains) -> [DVec3; 2] {
        let offset = image(self.shift.map(i32::from), chains.period);
        chains.ends(self.piece as usize).map(|end| end + offset)
    }
}

/// The neighbours of all pieces.
pub struct Neighbours {
    /// Those of the piece k stand from `start[k]` to `start[k + 1]`.
    start: Vec<usize>,
    list: Vec<Neighbour>,
    /// How far a corner may move before the lists are too short, in mm.
    pub reach: f64,
}

impl Neighbours {
    /// List the neighbours of all pieces.
    pub fn new(chains: &Chains) -> Neighbours {
        let grid = Grid::new(chains);
        let pieces = chains.len();
        let blocks: Vec<(Vec<usize>, Vec<Neighbour>)> = (0..pieces.div_ceil(BLOCK))
            .into_par_iter()
            .map(|block| {
                let (mut counts, mut list) = (Vec::with_capacity(BLOCK), Vec::new());
                for piece in block * BLOCK..((block + 1) * BLOCK).min(pieces) {
                    let before = list.len();
                    if chains.starts(piece) {
                        grid.around(chains, piece, &mut list);
                    }
                    counts.push(list.len() - before);
                }
                (counts, list)
            })
            .collect();
        let mut start = vec![0];
        let mut list = Vec::with_capacity(blocks.iter().map(|(_, list)| list.len()).sum());
        for (counts, part) in blocks {
            for count in counts {
                start.push(start[start.len() - 1] + count);
            }
            list.extend(part);
        }
        let thinnest = chains.radius.iter().copied().fold(f64::INFINITY, f64::min);
        Neighbours { start, list, reach: SKIN * thinnest }
    }

    /// The neighbours of a piece.
    pub fn of(&self, piece: usize) -> &[Neighbour] {
        &self.list[self.start[piece]..self.start[piece + 1]]
    }
}

/// A periodic grid of cells.
struct Grid {
    counts: IVec3,
    edge: DVec3,
    /// Lowest middle of a piece.
    low: f64,
    /// Radius of the largest ball.
    widest: f64,
    /// Pieces by cell, those of cell c from `start[c]` to `start[c + 1]`.
    start: Vec<u32>,
    pieces: Vec<Ball>,
}

/// A ball around a piece.
#[derive(Clone, Copy, Default)]
struct Ball {
    /// Middle of the piece, moved into the element.
    middle: DVec3,
    /// Half of its length and so much of the radius that balls of neighbours meet.
    radius: f64,
    piece: u32,
    /// Periods that it was moved by.
    turns: [i16; 2],
}

impl Grid {
    fn new(chains: &Chains) -> Grid {
        let balls: Vec<Ball> =
            (0..chains.len()).filter(|piece| chains.starts(*piece)).map(|piece| ball(chains, piece)).collect();
        let widest = balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
        let [low, high] = balls.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], ball| {
            [low.min(ball.middle.z), high.max(ball.middle.z)]
        });
        let edge = widest;
        let size = chains.period.extend((high - low).max(edge));
        let counts = (size / edge).floor().clamp(DVec3::ONE, DVec3::splat(MOST_CELLS));
        let mut grid =
            Grid { counts: counts.as_ivec3(), edge: size / counts, low, widest, start: Vec::new(), pieces: Vec::new() };
        // Sort by cell.
        let cells = (grid.counts.x * grid.counts.y * grid.counts.z) as usize;
        let mut start = vec![0u32; cells + 1];
        let of: Vec<u32> = balls.iter().map(|ball| grid.index(grid.cell(ball)) as u32).collect();
        of.iter().for_each(|cell| start[*cell as usize + 1] += 1);
        for cell in 0..cells {
            start[cell + 1] += start[cell];
        }
        let mut next = start.clone();
        grid.pieces = vec![Ball::default(); balls.len()];
        for (ball, cell) in balls.iter().zip(of) {
            let place = &mut next[cell as usize];
            grid.pieces[*place as usize] = *ball;
            *place += 1;
        }
        grid.start = start;
        grid
    }

    fn cell(&self, ball: &Ball) -> IVec3 {
        self.place(ball.middle).clamp(IVec3::ZERO, self.counts - 1)
    }

    /// The cell of a point, of this element or another.
    fn place(&self, point: DVec3) -> IVec3 {
        ((point - DVec3::new(0.0, 0.0, self.low)) / self.edge).floor().as_ivec3()
    }

    fn index(&self, cell: IVec3) -> usize {
        ((cell.z * self.counts.y + cell.y) * self.counts.x + cell.x) as usize
    }

    /// Append the neighbours of a piece.
    fn around(&self, chains: &Chains, piece: usize, list: &mut Vec<Neighbour>) {
        let ball = ball(chains, piece);
        let reach = DVec3::splat(ball.radius + self.widest);
        let (low, high) = (self.place(ball.middle - reach), self.place(ball.middle + reach));
        let own = chains.ends(piece);
        let radius = chains.radius_at(piece);
        let layers = low.z.clamp(0, self.counts.z - 1)..=high.z.clamp(0, self.counts.z - 1);
        let rows = layers.flat_map(|z| (low.y..=high.y).map(move |y| (y, z)));
        for there in rows.flat_map(|(y, z)| (low.x..=high.x).map(move |x| IVec3::new(x, y, z))) {
            let over = [there.x.div_euclid(self.counts.x), there.y.div_euclid(self.counts.y)];
            let index = self.index(there - IVec3::new(over[0] * self.counts.x, over[1] * self.counts.y, 0));
            let seen = ball.middle - image(over, chains.period);
            for other in &self.pieces[self.start[index] as usize..self.start[index + 1] as usize] {
                if (other.middle - seen).length_squared() > (ball.radius + other.radius).powi(2) {
                    continue;
                }
                let number = other.piece as usize;
                let shift = [0, 1].map(|axis| ball.turns[axis] + over[axis] as i16 - other.turns[axis]);
                if chains.between(piece, number, shift) < OWN * radius {
                    continue;
                }
                let neighbour = Neighbour { piece: other.piece, shift };
                let near = (radius + chains.radius_at(number)) * (1.0 + SKIN);
                if closest(own, neighbour.ends(chains)).apart.length_squared() < near * near {
                    list.push(neighbour);
                }
            }
        }
    }
}

/// The ball around a piece.
fn ball(chains: &Chains, piece: usize) -> Ball {
    let [a, b] = chains.ends(piece);
    let middle = (a + b) / 2.0;
    let turns = (middle.truncate() / chains.period).floor();
    let radius = a.distance(b) / 2.0 + chains.radius_at(piece) * (1.0 + SKIN);
    Ball {
        middle: middle - (turns * chains.period).extend(0.0),
        radius,
        piece: piece as u32,
        turns: [turns.x as i16, turns.y as i16],
    }
}

/// The way to the element so many periods away.
fn image(periods: [i32; 2], period: DVec2) -> DVec3 {
    let [x, y] = periods.map(f64::from);
    DVec3::new(x * period.x, y * period.y, 0.0)
}
