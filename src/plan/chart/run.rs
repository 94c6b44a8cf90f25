//! The order of the work: a few configurations at once, then more of them, all by turns.

use super::super::averaging::Averaging;
use super::super::budget::refinements;
use super::super::configuration::{Configuration, Extent};
use super::super::trial::{BLOCKS, Trial};
use super::engines::{Class, Engines};
use super::series::Series;
use super::state::Store;
use super::sweep::sweep;
use crate::error::Result;
use crate::scene::{Direct, FirstHit, Model, Scene};
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Configurations of the first round: the fibers, the scene's own medium, and two far from it.
const FIRST: usize = 4;
/// Share of the time that walks of one visit take at first, by how much longer those of the next round are, and the longest.
const SLICE: f64 = 1.0 / 300.0;
const LONGER: f64 = 1.6;
const LONGEST: f64 = 1.0 / 25.0;
/// How much longer the walks are that others are held against, and again if they are fewer than those of the scene's own medium;
/// and how much longer these are.
const FIBERS: f64 = 4.0;
const MORE: f64 = 3.0;
const OWN: f64 = 2.0;
/// A visit is begun if so many times the seconds that it is expected to take are left.
const MARGIN: f64 = 1.2;
/// Share of a visit that the processor has for a medium where another engine walks through it as well: enough to be timed.
const TIMED: f64 = 0.3;
/// Share of the time left that new configurations may take to be prepared and walked through, and that those may take which the
/// error budget needs.
const NEW: f64 = 0.25;
const NEEDED: f64 = 0.6;
/// Share of the time that the averaging part of the error budget may take to walk.
const AVERAGING: f64 = 1.0 / 20.0;
/// Realizations that straight rays go through, drawn on all threads; the rays take about as long again.
const REALIZATIONS_OF_RAYS: f64 = 32.0;
/// Memory in bytes of the media that are kept from one round to the next. Beside its tables a medium holds the densities that
/// they are made of: some times as much.
const KEPT: usize = 1 << 30;
const BESIDE: usize = 4;

/// What a chart is made with.
pub struct Settings<'a> {
    /// The cloth, its measurement and the model that it asks for.
    pub scene: &'a Scene,
    /// What its cells are cut from.
    pub extent: &'a Extent,
    /// The engines.
    pub engines: &'a Engines,
    /// Seed of the walks.
    pub seed: u64,
    /// Time for the whole chart, with what earlier runs of it have spent.
    pub time: Duration,
}

/// How far a chart has come.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Seconds spent, by this run and earlier ones.
    pub spent: f64,
    /// Seconds in all.
    pub time: f64,
    /// What is being done.
    pub doing: String,
    /// Configurations that have been measured.
    pub measured: usize,
    /// A round has been finished: a good moment to write the chart.
    pub round: bool,
}

/// Is told each step, with all that is known.
type Watcher<'a> = dyn FnMut(&Store, Progress, &[Series]) -> Result<()> + 'a;

/// A chart in the making.
struct Work<'a> {
    settings: &'a Settings<'a>,
    store: &'a mut Store,
    series: Vec<Series>,
    trials: HashMap<usize, Trial>,
    begun: Instant,
    before: f64,
}

/// Spend the time that is left on a chart whose state is in `store`; `progress` sees each step, with all that is known.
///
/// However little time there is, the fibers and the scene's own medium are measured.
///
/// # Errors
/// Those of the fibers and of the scene's own medium; a configuration that is refused for this cloth is noted. [`Error::File`]
/// when the state cannot be kept.
///
/// [`Error::File`]: crate::Error::File
pub fn run(
    settings: &Settings,
    store: &mut Store,
    mut progress: impl FnMut(&Store, Progress, &[Series]) -> Result<()>,
) -> Result<Vec<Series>> {
    let (begun, before) = (Instant::now(), store.head.spent);
    let list = sweep(settings.scene, settings.extent);
    let series: Vec<Series> = list.into_iter().map(|configuration| store.load(configuration)).collect::<Result<_>>()?;
    if store.head.opening == 0.0 {
        store.head.opening = settings.engines.opening;
    }
    let mut work = Work { settings, store, series, trials: HashMap::new(), begun, before };
    work.all(&mut progress)?;
    Ok(work.series)
}

impl Work<'_> {
    fn all(&mut self, progress: &mut Watcher) -> Result<()> {
        let time = self.settings.time.as_secs_f64();
        let known = self.series.iter().take_while(|series| series.made > 0 || series.refused.is_some()).count();
        let mut active: Vec<usize> = (0..known.max(FIRST).min(self.series.len())).collect();
        active.extend((active.len()..self.series.len()).filter(|i| self.series[*i].made > 0));
        let mut slice = SLICE * time;
        let mut first = true;
        while first || self.left() > 0.0 {
            let mut walked = false;
            for &index in &active {
                self.tell(progress, self.series[index].configuration.name(), false)?;
                // The fibers and the scene's own medium are the least that a chart has.
                let needed = first && index < 2 && self.series[index].made == 0;
                walked |= self.visit(index, slice, needed)?;
            }
            first = false;
            self.tell(progress, "a round".into(), true)?;
            let more = self.admit(&mut active, slice);
            // Of the error budget, averaging takes the longest: it comes when the other parts have been seen to.
            let seen_to = |i: usize| active.contains(&i) || self.series[i].refused.is_some();
            let rest = self.needed().into_iter().all(seen_to);
            if self.store.head.averaging.is_none() && (rest || !more) && self.can_average(time) {
                self.tell(progress, "averaging".into(), false)?;
                self.average(time)?;
            }
            if !walked && !more {
                break;
            }
            slice = (LONGER * slice).min(LONGEST * time);
        }
        Ok(())
    }

    fn tell(&self, progress: &mut Watcher, doing: String, round: bool) -> Result<()> {
        let measured = self.series.iter().filter(|series| series.made > 0).count();
        let time = self.settings.time.as_secs_f64();
        progress(self.store, Progress { spent: time - self.left(), time, doing, measured, round }, &self.series)
    }

    /// Seconds left.
    fn left(&self) -> f64 {
        self.settings.time.as_secs_f64() - self.before - self.begun.elapsed().as_secs_f64()
    }

    /// Classes that walk through a configuration.
    fn classes(&self, index: usize) -> Vec<Class> {
        if self.series[index].explicit() { vec![Class::Cpu] } else { self.settings.engines.of_media() }
    }

    /// Seconds that a visit is expected to take.
    fn expected(&self, index: usize, slice: f64) -> f64 {
        let series = &self.series[index];
        let preparing = if self.trials.contains_key(&index) { 0.0 } else { self.expected_preparing(index) };
        let slice = slice * self.weight(index);
        let walking = if series.explicit() {
            let own = series.rates(Class::Cpu).last().copied();
            let rate = own.or_else(|| self.series[0].rates(Class::Cpu).last().copied()).unwrap_or_default();
            let starts = self.series[0].blocks.first().map_or(1, |block| block.starts());
            let least = rate * (BLOCKS * series.configuration.each.unwrap_or(1)) as f64 * starts as f64;
            least.max(slice)
        } else {
            slice * self.classes(index).len() as f64
        };
        preparing + walking
    }

    /// Seconds that a preparation is expected to take: as the last one, or by the cells of one that is known and has
    /// straight rays like it, or none; if none has and it has some, their realizations are still to be drawn.
    fn expected_preparing(&self, index: usize) -> f64 {
        let series = &self.series[index];
        if let Some(seconds) = series.prepare_seconds() {
            return seconds;
        }
        let cells = |series: &Series| {
            let cells = series.configuration.cells(self.settings.extent).unwrap_or([1; 3]);
            cells.iter().map(|count| f64::from(*count)).product::<f64>()
        };
        let rays = |series: &Series| {
            let Model { direct, first_hit, .. } = series.configuration.model;
            direct == Direct::Straight || first_hit == FirstHit::Fibers
        };
        let far = |other: &Series| (rays(other) != rays(series), (cells(other) / cells(series)).ln().abs());
        let known = self.series.iter().filter(|other| other.explicit() == series.explicit());
        let known = known.filter_map(|other| Some((far(other), cells(other), other.prepare_seconds()?)));
        let nearest = known.min_by(|(a, ..), (b, ..)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let Some(((unlike, _), other, seconds)) = nearest else { return 0.0 };
        let drawing = if unlike && rays(series) { REALIZATIONS_OF_RAYS * self.series[0].drawing } else { 0.0 };
        drawing + seconds * (cells(series) / other).max(1.0)
    }

    /// Walk through a configuration on all of its engines and keep what was found; whether anything was done.
    fn visit(&mut self, index: usize, slice: f64, needed: bool) -> Result<bool> {
        if self.series[index].refused.is_some() || (!needed && MARGIN * self.expected(index, slice) > self.left()) {
            return Ok(false);
        }
        if !self.trials.contains_key(&index) {
            let Settings { scene, extent, .. } = self.settings;
            match Trial::prepare(scene, extent, self.series[index].configuration) {
                Ok(trial) => {
                    self.series[index].note(&trial);
                    self.trials.insert(index, trial);
                }
                Err(error) if index >= 2 => {
                    self.series[index].refused = Some(error.to_string());
                    self.keep(index)?;
                    return Ok(true);
                }
                Err(error) => return Err(error),
            }
        }
        let classes = self.classes(index);
        let Settings { engines, seed, .. } = self.settings;
        let slice = slice * self.weight(index);
        if let Some(trial) = self.trials.get(&index) {
            for &class in &classes {
                let share = if class == Class::Cpu && classes.len() > 1 { TIMED } else { 1.0 };
                self.series[index].visit(trial, engines, class, *seed, share * slice)?;
            }
        }
        // The scene's own medium is kept: the error budget goes on with it.
        let held: usize = self.trials.values().map(|trial| BESIDE * trial.bytes()).sum();
        if held > KEPT && index != 1 {
            self.trials.remove(&index);
        }
        self.keep(index)?;
        Ok(true)
    }

    /// How many times longer than others a configuration is walked through.
    fn weight(&self, index: usize) -> f64 {
        match index {
            0 if self.series[0].made < self.series[1].made => FIBERS * MORE,
            0 => FIBERS,
            1 => OWN,
            _ => 1.0,
        }
    }

    /// Write down what is known of a configuration.
    fn keep(&mut self, index: usize) -> Result<()> {
        self.store.head.spent = self.before + self.begun.elapsed().as_secs_f64();
        self.store.save(&self.series[index])
    }

    /// Whether the averaging part of the error budget leaves half of the time for the rest: its media take as long to make as
    /// the scene's own, or twice as long.
    fn can_average(&self, time: f64) -> bool {
        let own = &self.series[1];
        own.prepare_seconds().is_some_and(|seconds| 2.0 * (2.0 * seconds + AVERAGING * time) < self.left())
    }

    /// Measure the averaging part of the error budget, once.
    fn average(&mut self, time: f64) -> Result<()> {
        let Settings { scene, extent, engines, seed, .. } = self.settings;
        let own = &self.series[1];
        let Some(trial) = self.trials.get(&1) else { return Ok(()) };
        let class = engines.of_media()[0];
        let Some(rate) = own.rates(class).last().copied() else { return Ok(()) };
        // Twice as many walks as of one medium.
        let starts = trial.goniometer().starts() as f64;
        let walks = AVERAGING * time / rate / (2.0 * BLOCKS as f64 * starts);
        let walks = (walks as u64).clamp(64, 1 << 22);
        let found = Averaging::of(scene, extent, trial, engines.of(class), *seed, walks, &self.series[0].blocks);
        self.store.head.averaging = Some(found);
        self.store.head.spent = self.before + self.begun.elapsed().as_secs_f64();
        self.store.save_head()
    }

    /// The configurations that the error budget holds the scene's own medium against.
    fn needed(&self) -> Vec<usize> {
        let (directions, cells, finest) = refinements(self.series[1].configuration, self.settings.extent);
        let place = |wanted: Configuration| self.series.iter().position(|series| series.configuration == wanted);
        [Some(directions), cells, Some(finest)].into_iter().flatten().filter_map(place).collect()
    }

    /// Take in more configurations, at most as many as there are, as far as they leave time to walk; whether there were any.
    fn admit(&self, active: &mut Vec<usize>, slice: f64) -> bool {
        let needed = self.needed();
        let (mut spent, before) = (0.0, active.len());
        for index in 0..self.series.len() {
            if active.len() >= 2 * before {
                break;
            }
            if active.contains(&index) || self.series[index].refused.is_some() {
                continue;
            }
            let share = if needed.contains(&index) { NEEDED } else { NEW };
            let expected = self.expected(index, slice);
            if spent + expected <= share * self.left() {
                spent += expected;
                active.push(index);
            }
        }
        active.len() > before
    }
}

/// The configurations of a chart by their place: the fibers, and the scene's own medium.
pub(super) fn roles(series: &[Series]) -> Option<(&Series, &Series)> {
    Some((series.first()?, series.get(1)?))
}

/// A configuration among the series.
pub(super) fn find<'a>(series: &'a [Series], configuration: &Configuration) -> Option<&'a Series> {
    series.iter().find(|series| series.configuration == *configuration)
}
