//! The tables of a cloth.

use super::alias::AliasTable;
use super::blocks::{Reach, reaches};
use super::carry::{Carry, rates};
use super::cut::Cut;
use super::kind::Kind;
use super::visible::VisibleArea;
use crate::concentric::Patch;
use crate::distribution::{Bundle, CellGrid, MOST_ENTRIES, SpecificLength, surface};
use crate::error::{Error, Result};
use crate::scene::{Scene, Tracking};

/// Most cells, and most entries of all lists together.
pub(super) const MOST: usize = MOST_ENTRIES;

/// The bundles of a list: entries `first` to `first + 2ᵏ − 1` of all, and how they are drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct List {
    /// Its first entry.
    pub first: u32,
    /// Its fibers by weight R f.
    pub alias: AliasTable,
}

/// A cell, as the engines see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellEntry {
    /// Share of its tentative events in those of the majorant, 0 to 1.
    pub share: f64,
    /// Factor of the rate for hits here, by the placement of flights.
    pub placement: f64,
    /// Index of its list, or of the list that it borrows.
    pub list: u32,
    /// What may be jumped over.
    pub reach: Reach,
    /// The part of the cell where its fibers are, to which the share belongs.
    pub cut: Cut,
}

/// The cells of a cloth that is not the same everywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// Where they lie.
    pub grid: CellGrid,
    /// What they hold, by index.
    pub entries: Vec<CellEntry>,
}

/// What every engine needs to know of the medium.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplingTables {
    /// Thickness of the cloth in mm; it fills 0 ≥ z ≥ −thickness.
    pub thickness: f64,
    /// Rate of tentative events in the densest cell, 2·Σ R F times its factor, in 1/mm: never below that of collisions.
    pub majorant: f64,
    /// Kinds of fiber, at least one.
    pub kinds: Vec<Kind>,
    /// Half the length of the approximating cylinder in radii; infinite for no bases.
    pub half_length: f64,
    /// Lists of bundles; a sheet has one.
    pub lists: Vec<List>,
    /// The patch of directions of each entry; the padding of a list repeats its first.
    pub patches: Vec<Patch>,
    /// The kind of fiber of each entry, an index of `kinds`.
    pub entry_kinds: Vec<u8>,
    /// Length of which every patch's extent is a whole multiple.
    pub patch_unit: f64,
    /// The cells, if there is more than one.
    pub cells: Option<Cells>,
    /// H(m) by list, for tracking by tables.
    pub visible: Option<VisibleArea>,
    /// How hits and axes belong together; none when flights start at hits.
    pub carry: Option<Carry>,
}

impl SamplingTables {
    /// Build the tables of a cloth.
    ///
    /// # Errors
    /// [`Error::Input`] when the cells do not fit their grid or hold numbers that are not densities, when there is no fiber
    /// at all, or when there are more cells or entries than engines can number.
    pub fn new(scene: &Scene, specific_length: &SpecificLength) -> Result<SamplingTables> {
        let (used, kinds) = (scene.kinds(), Kind::of_scene(scene));
        let place = |kind: usize| used.iter().position(|&known| known == kind).unwrap_or_default();
        let SpecificLength { cells, values, lists, grid, .. } = specific_length;
        check(specific_length)?;
        let radius = |kind: usize| kinds[place(kind)].radius;
        let largest = kinds.iter().map(|kind| kind.radius).fold(0.0, f64::max);
        let rates = rates(specific_length, &scene.model, largest);
        let mut tables = SamplingTables {
            thickness: cells.thickness,
            majorant: rates.majorant,
            kinds: Vec::new(),
            half_length: scene.model.length_over_radius / 2.0,
            lists: Vec::new(),
            patches: Vec::new(),
            entry_kinds: Vec::new(),
            patch_unit: grid.unit(),
            cells: None,
            visible: None,
            carry: rates.carry,
        };
        for bundles in lists {
            tables.add_list(bundles, radius, place)?;
        }
        if values.len() > 1 {
            let empty: Vec<bool> = values.iter().map(|cell| cell.surface == 0.0).collect();
            let entry = |(cell, reach): (usize, Reach)| CellEntry {
                share: rates.shares[cell],
                placement: rates.factors[cell],
                list: rates.lists[cell],
                reach,
                cut: rates.cuts[cell],
            };
            let entries = reaches(cells, &empty).into_iter().enumerate().map(entry).collect();
            tables.cells = Some(Cells { grid: *cells, entries });
        }
        tables.kinds = kinds;
        if let Some(message) = scene.model.conflict() {
            return Err(Error::Input(message));
        }
        if scene.model.tracking == Tracking::Tabulated {
            tables.visible = Some(VisibleArea::new(&tables)?);
        }
        Ok(tables)
    }

    /// Append a list, padded to a power of two.
    fn add_list(
        &mut self,
        bundles: &[Bundle],
        radius: impl Fn(usize) -> f64,
        place: impl Fn(usize) -> usize,
    ) -> Result<()> {
        let weights: Vec<f64> = bundles.iter().map(|bundle| surface(&[*bundle], &radius)).collect();
        let alias = AliasTable::new(&weights);
        let first = self.patches.len();
        let end = first + alias.words().len();
        if end > MOST {
            let message =
                format!("the lists of directions have more than {MOST} entries together, padded to powers of two");
            return Err(Error::Input(message));
        }
        self.patches.extend(bundles.iter().map(|bundle| bundle.patch));
        self.entry_kinds.extend(bundles.iter().map(|bundle| place(bundle.kind) as u8));
        self.patches.resize(end, self.patches[first]);
        self.entry_kinds.resize(end, self.entry_kinds[first]);
        self.lists.push(List { first: first as u32, alias });
        Ok(())
    }

    /// The entry that a word draws from a list.
    pub fn draw_entry(&self, list: u32, word: u32) -> usize {
        let List { first, alias } = &self.lists[list as usize];
        *first as usize + alias.draw(word)
    }

    /// Tentative events along the normal, on the average over the repeat, when empty cells have none.
    ///
    /// This is what the length of walks goes by: the flights of sparse cells are as short as those of the densest, while
    /// blocks of empty cells are jumped over.
    pub fn depth(&self) -> f64 {
        let filled = self.cells.as_ref().map_or(1.0, |cells| {
            cells.entries.iter().filter(|cell| cell.share > 0.0).count() as f64 / cells.entries.len() as f64
        });
        self.majorant * self.thickness * filled
    }

    /// Memory of the tables in bytes.
    pub fn bytes(&self) -> usize {
        let entries = self.patches.len() * (size_of::<Patch>() + size_of::<u8>() + size_of::<u32>());
        let cells = self.cells.as_ref().map_or(0, |cells| cells.entries.len() * size_of::<CellEntry>());
        entries + cells + self.visible.as_ref().map_or(0, |visible| visible.nodes.len() * size_of::<f32>())
    }

    /// Channels that have to be told apart: one when no fiber absorbs.
    pub fn channels(&self) -> usize {
        Kind::channels(&self.kinds).unwrap_or(1)
    }

    /// Whether any fiber absorbs in any channel.
    pub fn absorbing(&self) -> bool {
        Kind::channels(&self.kinds).is_some()
    }
}

/// Refuse cells of which no table can be made.
fn check(specific_length: &SpecificLength) -> Result<()> {
    let SpecificLength { cells, values, lists, .. } = specific_length;
    let complaint = |message: String| Err(Error::Input(message));
    let sizes = [cells.period.x, cells.period.y, cells.thickness];
    if cells.is_empty() || cells.len() > MOST || !sizes.iter().all(|size| size.is_finite() && *size > 0.0) {
        let [nx, ny, nz] = cells.counts;
        return complaint(format!(
            "a grid of {nx} × {ny} × {nz} cells over {} × {} × {} mm cannot be used, allowed: 1 to {MOST} cells of \
             positive size",
            sizes[0], sizes[1], sizes[2]
        ));
    }
    if cells.len() != values.len() {
        return complaint(format!("a grid of {} cells was given {} cells", cells.len(), values.len()));
    }
    for (index, cell) in values.iter().enumerate() {
        let fine =
            cell.surface >= 0.0 && cell.surface.is_finite() && cell.placement >= 0.0 && cell.placement.is_finite();
        if !fine || (cell.surface > 0.0 && cell.list as usize >= lists.len()) {
            return complaint(format!("cell {index} of {} cannot be used: {cell:?}", values.len()));
        }
    }
    if values.iter().all(|cell| cell.surface == 0.0) {
        return complaint("the cells hold no fiber at all".into());
    }
    for (index, list) in lists.iter().enumerate() {
        let fine = |bundle: &Bundle| bundle.length_density >= 0.0 && bundle.length_density.is_finite();
        if !list.iter().all(fine) || !list.iter().any(|bundle| bundle.length_density > 0.0) {
            return complaint(format!("list {index} of directions cannot be used: {list:?}"));
        }
    }
    Ok(())
}
