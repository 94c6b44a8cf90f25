//! The fibers of one realization by place, for rays and points among them.

use super::curves::Curve;
use super::realization::Realization;
use super::tube::{Meeting, Tube};
use crate::error::{Error, Result};
use glam::{DVec2, DVec3, IVec3};
use std::ops::Range;

/// Edge of a cell in radii of the thinnest fiber.
const EDGE: f64 = 3.0;
/// Most cells.
const MOST_CELLS: f64 = (1u64 << 19) as f64;
/// Bits of an entry that are the tube; the others are three bits for the image along x and along y.
const TUBE_BITS: u32 = 26;
/// Images that an entry can name: from −4 to 3 repeats.
const IMAGES: Range<i32> = -4..4;
/// A ray that passes so many cells without an end is given up.
const MOST_STEPS: u64 = 1 << 24;

/// A periodic uniform grid over the fibers of a realization. Every cell lists the pieces that may reach into it.
///
/// Lengths in mm. x and y are periodic; z goes from the lowest to the highest point of any fiber.
#[derive(Clone, Debug)]
pub struct FiberGrid {
    tubes: Vec<Tube>,
    period: DVec2,
    low: f64,
    high: f64,
    counts: IVec3,
    edges: DVec3,
    /// Where the entries of each cell begin, and at the end their number.
    first: Vec<u32>,
    entries: Vec<u32>,
}

/// Where a ray goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// Into a fiber.
    Fiber {
        /// Index of the piece in [`FiberGrid::tubes`].
        tube: usize,
        /// Where it enters, inside the repeat.
        point: DVec3,
        /// How.
        meeting: Meeting,
    },
    /// Out of the cloth.
    Out,
    /// Nowhere within 2²⁴ cells.
    Endless,
}

/// What rays have cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Cells passed.
    pub cells: u64,
    /// Pieces tested.
    pub tests: u64,
}

impl FiberGrid {
    /// Sort the fibers of a realization with this repeat into cells of three radii of the thinnest, or larger ones where these
    /// would be too many.
    ///
    /// # Errors
    /// [`Error::Input`] when there are more or longer pieces than can be sorted.
    pub fn new(fibers: &[Curve], period: DVec2) -> Result<FiberGrid> {
        FiberGrid::sorted(fibers, period, |size, thinnest| {
            let volume = size.x * size.y * size.z;
            let edge = (EDGE * thinnest).max((volume / MOST_CELLS).cbrt());
            (size / edge).ceil().as_ivec3()
        })
    }

    /// [`FiberGrid::new`] of a realization.
    ///
    /// # Errors
    /// Those of [`FiberGrid::new`].
    pub fn of(realization: &Realization) -> Result<FiberGrid> {
        FiberGrid::new(&realization.fibers, realization.period)
    }

    /// Sort them into so many cells along x, y and z; into one cell for a search of all fibers.
    ///
    /// # Errors
    /// Those of [`FiberGrid::new`].
    pub fn with_cells(fibers: &[Curve], period: DVec2, counts: [u8; 3]) -> Result<FiberGrid> {
        FiberGrid::sorted(fibers, period, |_, _| IVec3::from_array(counts.map(i32::from)))
    }

    /// Sort them into cells, of which there are as many as follow from the size of the grid and the thinnest radius.
    fn sorted(fibers: &[Curve], period: DVec2, counts: impl Fn(DVec3, f64) -> IVec3) -> Result<FiberGrid> {
        let mut tubes = Vec::new();
        for (fiber, curve) in fibers.iter().enumerate() {
            Tube::of_curve(curve, fiber as u32, |start| inside(start, period), |tube| tubes.push(tube));
        }
        if tubes.len() >= 1 << TUBE_BITS {
            let (count, most) = (tubes.len(), 1 << TUBE_BITS);
            return Err(Error::Input(format!(
                "a realization of {count} pieces of fibers cannot be used, allowed: fewer than {most}"
            )));
        }
        let span = |tube: &Tube| {
            let [before, after] = tube.overhang();
            let (p, reach) = (tube.direction().z, tube.radius());
            let ends = [tube.start().z - before * p, tube.start().z + (tube.length() + after) * p];
            (ends[0].min(ends[1]) - reach, ends[0].max(ends[1]) + reach)
        };
        let fold = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
        // Where there is no fiber, any height will do.
        let (low, high) = tubes.iter().map(span).reduce(fold).unwrap_or((-1.0, 0.0));
        let thinnest = tubes.iter().map(Tube::radius).fold(f64::INFINITY, f64::min);
        let size = period.extend(high - low);
        let counts = counts(size, thinnest).max(IVec3::ONE);
        let edges = size / counts.as_dvec3();
        let mut grid = FiberGrid { tubes, period, low, high, counts, edges, first: Vec::new(), entries: Vec::new() };
        grid.sort()?;
        Ok(grid)
    }

    /// List the pieces by cell.
    fn sort(&mut self) -> Result<()> {
        let cells = (self.counts.x * self.counts.y * self.counts.z) as usize;
        // Count first, then fill from the back.
        let mut first = vec![0u32; cells + 1];
        let mut too_long = false;
        for tube in &self.tubes {
            self.reached(tube, |cell, image| match image {
                Some(_) => first[cell] += 1,
                None => too_long = true,
            });
        }
        let total: u64 = first.iter().map(|count| u64::from(*count)).sum();
        if too_long || total > u64::from(u32::MAX) {
            return Err(Error::Input(
                "pieces of fibers are too long for the repeat: they go through it more than thrice".into(),
            ));
        }
        let mut sum = 0;
        for count in &mut first {
            sum += *count;
            *count = sum;
        }
        let mut entries = vec![0; sum as usize];
        for (index, tube) in self.tubes.iter().enumerate() {
            self.reached(tube, |cell, image| {
                first[cell] -= 1;
                entries[first[cell] as usize] = image.unwrap_or_default() << TUBE_BITS | index as u32;
            });
        }
        (self.first, self.entries) = (first, entries);
        Ok(())
    }

    /// The cells that a piece may reach into, each with the image of the piece there; none for one too far away.
    fn reached(&self, tube: &Tube, mut take: impl FnMut(usize, Option<u32>)) {
        let (start, p, radius) = (tube.start(), tube.direction(), tube.radius());
        let [before, after] = tube.overhang();
        let (from, to) = (start - p * before, start + p * (tube.length() + after));
        let reach = radius * (DVec3::ONE - p * p).max(DVec3::ZERO).map(f64::sqrt);
        let base = DVec3::new(0.0, 0.0, self.low);
        let cell = |point: DVec3| ((point - base) / self.edges).floor().as_ivec3();
        let half = self.edges / 2.0;
        let (middle, half_length) = ((from + to) / 2.0, from.distance(to) / 2.0);
        let along_half = half.dot(p.abs()) + half_length;
        // Go from layer to layer of cells across the axis that the piece follows most.
        let main = p.abs().max_position();
        let (first, last) = (cell(from.min(to) - reach)[main], cell(from.max(to) + reach)[main]);
        for layer in first..=last {
            // The part of the axis whose surface may reach into the layer.
            let bound = |side: i32| f64::from(layer + side) * self.edges[main] + base[main];
            let (low, high) = (bound(0) - reach[main], bound(1) + reach[main]);
            let at = |bound: f64| ((bound - from[main]) / p[main]).clamp(0.0, 2.0 * half_length);
            let (one, other) = (from + p * at(low), from + p * at(high));
            let (mut least, mut most) = (cell(one.min(other) - reach), cell(one.max(other) + reach));
            (least[main], most[main]) = (layer, layer);
            (least.z, most.z) = (least.z.max(0), most.z.min(self.counts.z - 1));
            for z in least.z..=most.z {
                for y in least.y..=most.y {
                    for x in least.x..=most.x {
                        // Leave out boxes that a plane parts from the cylinder.
                        let centre = base + (IVec3::new(x, y, z).as_dvec3() + 0.5) * self.edges - middle;
                        let along = centre.dot(p);
                        let off = centre - p * along;
                        let away = off.length();
                        let beside = away * away - half.dot(off.abs()) > radius * away;
                        if !beside && along.abs() <= along_half {
                            self.take_home(IVec3::new(x, y, z), &mut take);
                        }
                    }
                }
            }
        }
    }

    /// Bring a cell home into the repeat, and tell the image that a piece has there.
    fn take_home(&self, cell: IVec3, take: &mut impl FnMut(usize, Option<u32>)) {
        let (x, y) = (cell.x.div_euclid(self.counts.x), cell.y.div_euclid(self.counts.y));
        let home = cell - IVec3::new(x * self.counts.x, y * self.counts.y, 0);
        let code = |image: i32| (image - IMAGES.start) as u32;
        let known = IMAGES.contains(&x) && IMAGES.contains(&y);
        take(self.index(home), known.then(|| code(x) | code(y) << 3));
    }

    fn index(&self, cell: IVec3) -> usize {
        ((cell.z * self.counts.y + cell.y) * self.counts.x + cell.x) as usize
    }

    /// The pieces that may reach into a cell, each with how many repeats it lies further than its image here.
    fn listed(&self, cell: IVec3) -> impl Iterator<Item = (usize, DVec2)> + '_ {
        let index = self.index(cell);
        self.entries[self.first[index] as usize..self.first[index + 1] as usize].iter().map(|entry| {
            let image = |shift: u32| f64::from((entry >> (TUBE_BITS + shift) & 7) as i32 + IMAGES.start);
            ((entry & ((1 << TUBE_BITS) - 1)) as usize, DVec2::new(image(0), image(3)))
        })
    }

    /// The nearest fiber that a ray from `origin` along the unit vector `m` enters from outside. Fibers that hold the origin
    /// are not entered, nor is `left`, the piece from whose surface the ray starts.
    pub fn first_entry(&self, origin: DVec3, m: DVec3, left: Option<usize>, work: &mut Work) -> Way {
        let mut origin = self.come_back(origin);
        // Come to the slab that holds the fibers.
        let outer = if m.z > 0.0 { self.low } else { self.high };
        if (origin.z - outer) * m.z < 0.0 {
            origin = self.come_back((origin + m * ((outer - origin.z) / m.z)).with_z(outer));
        } else if (origin.z > self.high && m.z >= 0.0) || (origin.z < self.low && m.z <= 0.0) {
            return Way::Out;
        }
        let place = (origin - DVec3::new(0.0, 0.0, self.low)) / self.edges;
        let mut cell = place.floor().as_ivec3().clamp(IVec3::ZERO, self.counts - 1);
        let forwards = m.cmpgt(DVec3::ZERO);
        let faces = cell.as_dvec3() + DVec3::select(forwards, DVec3::ONE, DVec3::ZERO);
        let step = IVec3::new(sign(forwards.x), sign(forwards.y), sign(forwards.z));
        let moving = m.cmpne(DVec3::ZERO);
        let never = DVec3::splat(f64::INFINITY);
        let mut times = DVec3::select(moving, (faces - place) * self.edges / m, never);
        let each = DVec3::select(moving, self.edges / m.abs(), never);
        let mut nearest: Option<(usize, Meeting)> = None;
        // Count repeats instead of moving the origin: what is met does not depend on the cells on the way.
        let mut repeats = DVec2::ZERO;
        for _ in 0..MOST_STEPS {
            work.cells += 1;
            for (tube, image) in self.listed(cell) {
                work.tests += 1;
                let there = origin + (self.period * (image - repeats)).extend(0.0);
                let Some(meeting) = self.tubes[tube].meet(there, m) else { continue };
                let first = nearest.is_none_or(|(_, known)| meeting.distance < known.distance);
                // Its images lie further off.
                let start = left == Some(tube) && meeting.distance < self.tubes[tube].radius();
                if first && !start {
                    nearest = Some((tube, meeting));
                }
            }
            let time = times.min_element();
            if let Some((tube, meeting)) = nearest.filter(|(_, meeting)| meeting.distance <= time) {
                return Way::Fiber { tube, point: self.come_back(origin + m * meeting.distance), meeting };
            }
            // Step into the next cell.
            let axis = if times.x == time {
                0
            } else if times.y == time {
                1
            } else {
                2
            };
            times[axis] += each[axis];
            cell[axis] += step[axis];
            if cell[axis] < 0 || cell[axis] >= self.counts[axis] {
                if axis == 2 {
                    // Rounding may put what is met behind the last face.
                    let enter = |(tube, meeting): (usize, Meeting)| Way::Fiber {
                        tube,
                        point: self.come_back(origin + m * meeting.distance),
                        meeting,
                    };
                    return nearest.map_or(Way::Out, enter);
                }
                cell[axis] -= step[axis] * self.counts[axis];
                repeats[axis] += f64::from(step[axis]);
            }
        }
        Way::Endless
    }

    /// The pieces that hold a point.
    pub fn holding(&self, point: DVec3) -> impl Iterator<Item = usize> + '_ {
        let point = self.come_back(point);
        let cell = ((point - DVec3::new(0.0, 0.0, self.low)) / self.edges).floor().as_ivec3();
        let inside = point.z >= self.low && point.z <= self.high;
        let cell = cell.clamp(IVec3::ZERO, self.counts - 1);
        let listed = inside.then(|| self.listed(cell)).into_iter().flatten();
        let holds =
            move |(tube, image): &(usize, DVec2)| self.tubes[*tube].holds(point + (self.period * *image).extend(0.0));
        listed.filter(holds).map(|(tube, _)| tube)
    }

    /// The image of a point inside the repeat.
    pub fn come_back(&self, point: DVec3) -> DVec3 {
        inside(point, self.period)
    }

    /// Its pieces; those of a fiber follow each other. Their starts lie inside the repeat.
    pub fn tubes(&self) -> &[Tube] {
        &self.tubes
    }

    /// Size of the repeat.
    pub fn period(&self) -> DVec2 {
        self.period
    }

    /// The lowest and the highest z that a fiber may reach.
    pub fn span(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Memory in bytes: of the pieces, and of the grid.
    pub fn bytes(&self) -> [usize; 2] {
        [self.tubes.len() * size_of::<Tube>(), (self.first.len() + self.entries.len()) * size_of::<u32>()]
    }
}

/// The image of a point inside a repeat with this period.
fn inside(point: DVec3, period: DVec2) -> DVec3 {
    let across = point.truncate();
    let inside = across - period * (across / period).floor();
    // Rounding may bring it to the far face.
    DVec2::select(inside.cmplt(period), inside, DVec2::ZERO).extend(point.z)
}

fn sign(forwards: bool) -> i32 {
    if forwards { 1 } else { -1 }
}
