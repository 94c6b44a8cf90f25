//! The distribution calculator: f(p, x) of a cloth of yarns from its explicit fibers (paper §5).

use super::cells::CellGrid;
use super::count::{Count, Grids, SURFACE_UNIT, count};
use super::directions::DirectionGrid;
use super::placement::MAX_SEPARATE_FRACTION;
use super::sheet::SpecificLength;
use super::sums::Sums;
use super::voids::{VoidCount, Voids};
use crate::cloth::{Cloth, DrawnFor, Realization, Realizer};
use crate::error::{Error, Result};
use crate::scene::{Model, Placement, Yarn, dark_beside_light};
use glam::DVec3;
use rayon::prelude::*;

/// Edge of a cell in radii of the thinnest fiber where the file does not say, and that of filaments without twist, opaque ones beside
/// others: light passes the opaque ones only between them, and the rims of such yarns are sharp.
const EDGE: f64 = 2.0;
const FINER_EDGE: f64 = 1.4;
/// Largest width of a direction list in shares of the distance of two yarns and of the thickness: fibers of a twisted yarn
/// change their direction from its one side to the other.
const LIST_WIDTH: f64 = 1.0 / 16.0;
/// Most cells along an axis, and in all.
const MOST_ALONG: u32 = 256;
const MOST_CELLS: usize = 1 << 20;
/// Most cells of the grid of lists: more take more memory than they are worth.
const MOST_LISTS: usize = 1 << 17;
/// The effort of a run.
const USUAL: Effort = Effort::Precision(0.15);
/// Fewest and most realizations.
const FEWEST: u64 = 32;
const MOST: u64 = 4096;
/// Fewest realizations to add.
const CHUNK: u64 = 16;
/// Fibers that are laid independently overlap: of a volume fraction v they cover 1 − exp(−v), at this one 0.9.
const MAX_VOLUME_FRACTION: f64 = 2.3;
/// Sums of R·length, in units of the count, that a word holds with certainty.
const MOST_UNITS: f64 = (1u64 << 62) as f64;
/// Standard errors by which a cell must be too full to be refused: once in 3·10⁶ cells by chance.
const SURELY: f64 = 5.0;

/// How many realizations to count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effort {
    /// So many, at least 2.
    Realizations(u64),
    /// As many, from 32 to 4096, as bring the standard error of the densities of cells below this share of their root mean
    /// square.
    Precision(f64),
}

impl Default for Effort {
    fn default() -> Effort {
        USUAL
    }
}

/// How the specific length of a cloth was gathered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gathering {
    /// Realizations that it is the mean of.
    pub realizations: u64,
    /// Standard error of the densities of cells, relative to their root mean square.
    pub error: f64,
    /// Mean share of the volume that is fiber.
    pub volume_fraction: f64,
    /// The largest of any cell.
    pub largest_fraction: f64,
    /// Cells that hold any fiber.
    pub filled: usize,
    /// Grid of the direction lists.
    pub list_counts: [u32; 3],
    /// What fibers leave free, where the placement asks for it.
    pub voids: Option<Voids>,
}

impl Gathering {
    /// A warning when a cell holds more fiber than separate fibers can fill.
    pub fn warning(&self) -> Option<String> {
        let full = self.largest_fraction;
        (full > MAX_SEPARATE_FRACTION).then(|| {
            format!(
                "fibers fill up to {full:.2} of a cell, more than separate fibers can ({MAX_SEPARATE_FRACTION}): they overlap \
                 there; wider yarns or fewer fibers would mend it"
            )
        })
    }
}

/// What is counted: fibers as straight pieces in a periodic element, drawn at random.
#[derive(Clone, Copy)]
pub struct Element<'a> {
    /// The cells of densities.
    pub cells: CellGrid,
    /// A list of directions serves a block of cells that is no wider than this in mm; up to four cells along each axis.
    pub list_width: DVec3,
    /// Radius of each kind of fiber in mm.
    pub radii: &'a [f64],
    /// The fibers of a realization, from its number.
    pub realize: &'a (dyn Fn(u64) -> Result<Realization> + Sync),
}

impl SpecificLength {
    /// Count the fibers of a woven or knitted cloth: the mean over realizations; `progress` is told the share that is done.
    ///
    /// # Errors
    /// Those of [`SpecificLength::of_pieces`].
    pub fn of_cloth(
        cloth: &Cloth,
        model: &Model,
        effort: Effort,
        progress: impl FnMut(f64),
    ) -> Result<(SpecificLength, Gathering)> {
        let realizer = Realizer::of_yarns(cloth.clone(), model, DrawnFor::Medium);
        SpecificLength::of_draws(cloth, model, effort, &|number| realizer.draw(number), progress)
    }

    /// The same from realizations of the cloth that `draw` draws from their numbers.
    ///
    /// # Errors
    /// Those of [`SpecificLength::of_pieces`].
    pub fn of_draws(
        cloth: &Cloth,
        model: &Model,
        effort: Effort,
        draw: &(dyn Fn(u64) -> Result<Realization> + Sync),
        progress: impl FnMut(f64),
    ) -> Result<(SpecificLength, Gathering)> {
        let radii: Vec<f64> = cloth.kinds().iter().map(|fiber| fiber.radius).collect();
        let counts = model.cells.unwrap_or_else(|| cells_of_edge(cloth, usual_edge(cloth)));
        let element = Element {
            cells: CellGrid { counts, period: cloth.period(), thickness: cloth.thickness() },
            list_width: cloth.spacing().extend(cloth.thickness()) * LIST_WIDTH,
            radii: &radii,
            realize: draw,
        };
        SpecificLength::of_pieces(&element, model, effort, progress)
    }

    /// Count the pieces of an element: the mean over realizations. Of `model`, the number of directions and the cone matter.
    /// `progress` is told the share that is done.
    ///
    /// # Errors
    /// [`Error::Input`] when there are no pieces, or more than can be counted; when so many fibers lie in a cell
    /// that they cover more than 0.9 of it: it names the cell and a grid that cures it.
    pub fn of_pieces(
        element: &Element,
        model: &Model,
        effort: Effort,
        progress: impl FnMut(f64),
    ) -> Result<(SpecificLength, Gathering)> {
        let grids = grids(element, model);
        let sums = gather(element, &grids, effort, progress)?;
        if sums.total == 0.0 {
            return Err(Error::Input("there is no fiber to count".into()));
        }
        if sums.total * SURFACE_UNIT > MOST_UNITS {
            let area = sums.total / sums.realizations as f64;
            let message = format!("radius × length of the fibers is {area:.0} mm² in all, too much to be counted");
            return Err(Error::Input(message));
        }
        let (mut specific_length, mut gathering, fractions) = sums.finish(element, model, grids);
        if let Some(full) = too_full(&fractions, &sums) {
            return Err(refuse(element, model, &sums, full));
        }
        match &sums.voids {
            Some(voids) => gathering.voids = Some(voids.place(&mut specific_length)),
            None => specific_length.place(model.placement, |kind| element.radii[kind])?,
        }
        Ok((specific_length, gathering))
    }
}

/// Count as many realizations as are wanted.
fn gather(element: &Element, grids: &Grids, effort: Effort, mut progress: impl FnMut(f64)) -> Result<Sums> {
    let mut sums = Sums::new(grids);
    let mut wanted = match effort {
        Effort::Realizations(count) => count.max(2),
        Effort::Precision(_) => FEWEST,
    };
    loop {
        // One realization for each thread at a time: no more of them are held.
        let side_by_side = rayon::current_num_threads() as u64;
        for first in (sums.realizations..wanted).step_by(side_by_side as usize) {
            let numbers = first..(first + side_by_side).min(wanted);
            let one = |number| {
                let realization = (element.realize)(number)?;
                let voids = grids.voids.then(|| VoidCount::new(&realization, &grids.cells, number)).transpose()?;
                Ok((count(&realization.pieces(), grids), voids))
            };
            let counts: Vec<(Count, Option<VoidCount>)> = numbers.into_par_iter().map(one).collect::<Result<_>>()?;
            counts.iter().for_each(|(count, voids)| sums.add(count, voids.as_ref()));
            progress(sums.realizations as f64 / wanted as f64);
        }
        let Effort::Precision(precision) = effort else { return Ok(sums) };
        let error = sums.error();
        if error <= precision || wanted >= MOST {
            return Ok(sums);
        }
        // The error falls with the root of the realizations.
        let needed = (sums.realizations as f64 * (error / precision).powi(2)).ceil() as u64;
        wanted = needed.max(wanted + CHUNK).min(MOST);
    }
}

/// The grids on which an element is counted.
fn grids(element: &Element, model: &Model) -> Grids {
    let edges = element.cells.edges();
    let block = [0, 1, 2].map(|axis| ((element.list_width[axis] / edges[axis]) as u32).clamp(1, 4));
    // Count directions twice as finely as they are tabulated.
    let n = (2 * model.directions.isqrt()).clamp(64, 512);
    let mut grids = Grids {
        cells: element.cells,
        block,
        raw: DirectionGrid { n },
        voids: model.placement == Placement::CarriedVoid,
        centroids: model.placement == Placement::Carried && element.cells.len() > 1,
    };
    let lists = |grids: &Grids| grids.list_counts().iter().map(|count| *count as usize).product::<usize>();
    while lists(&grids) > MOST_LISTS {
        grids.block[grids.narrowest(element.list_width)] += 1;
    }
    grids
}

/// Radius in mm of the thinnest fiber that the threads of a cloth are made of.
pub fn thinnest_radius(cloth: &Cloth) -> f64 {
    let kinds = cloth.used_kinds();
    kinds.iter().map(|&kind| cloth.kinds()[kind].radius).fold(f64::INFINITY, f64::min)
}

/// Cells along x, y and z of an edge in mm, or somewhat less: at least one, and no more than a grid may have along an axis.
pub fn cells_of_edge(cloth: &Cloth, edge: f64) -> [u32; 3] {
    cloth.size().to_array().map(|size| ((size / edge).ceil() as u32).clamp(1, MOST_ALONG))
}

/// Edge of a cell in mm where the file does not say: two radii of the thinnest fiber, 1.4 of filaments without twist, opaque ones
/// beside others, more where that would be too many cells.
pub fn usual_edge(cloth: &Cloth) -> f64 {
    let filaments = cloth.yarns().iter().all(Yarn::untwisted);
    let dark = dark_beside_light(cloth.kinds(), &cloth.used_kinds());
    let mut edge = thinnest_radius(cloth) * if filaments && dark { FINER_EDGE } else { EDGE };
    while cells_of_edge(cloth, edge).iter().map(|count| *count as usize).product::<usize>() > MOST_CELLS {
        edge *= 1.1;
    }
    edge
}

/// The cell that is most surely too full, and its volume fraction, among those of all cells.
fn too_full(fractions: &[f64], sums: &Sums) -> Option<(usize, f64)> {
    // Of a few realizations the spread is not known.
    if sums.realizations < FEWEST {
        return None;
    }
    let surely = |&i: &usize| fractions[i] * (1.0 - SURELY * sums.relative_error(i));
    let fullest = (0..fractions.len()).max_by(|a, b| surely(a).total_cmp(&surely(b)))?;
    (surely(&fullest) > MAX_VOLUME_FRACTION).then(|| (fullest, fractions[fullest]))
}

/// Name the cell that is too full, and the finest grid of 2, 4, … times the edge that has no such cell.
fn refuse(element: &Element, model: &Model, sums: &Sums, (cell, fraction): (usize, f64)) -> Error {
    let [nx, ny, nz] = element.cells.counts;
    let place = element.cells.places().nth(cell).unwrap_or_default();
    let mut coarse = *element;
    let mut cure = String::new();
    while coarse.cells.counts != [1; 3] && cure.is_empty() {
        coarse.cells.counts = coarse.cells.counts.map(|count| count.div_ceil(2));
        let grids = Grids { voids: false, ..grids(&coarse, model) };
        let Ok(counted) = gather(&coarse, &grids, Effort::Realizations(sums.realizations), |_| {}) else { break };
        if too_full(&counted.finish(&coarse, model, grids).2, &counted).is_none() {
            cure = format!("take fewer cells, such as cells = {:?}, or ", coarse.cells.counts);
        }
    }
    Error::Input(format!(
        "the fibers of cell {place:?} of {nx} × {ny} × {nz} have {fraction:.2} of its volume, allowed: {MAX_VOLUME_FRACTION} \
         (fibers that overlap); {cure}give the yarns more room, or let them climb less steeply"
    ))
}
