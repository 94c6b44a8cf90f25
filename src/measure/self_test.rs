//! A quick check that an engine gives right answers on this machine.

use super::run::{Prepared, prepare};
use crate::distribution::{Cell, CellGrid, SpecificLength, direction_of, surface};
use crate::error::{Error, Result};
use crate::goniometer::{Goniometer, Tally};
use crate::reference::Reference;
use crate::scene::{Scene, Source};
use crate::tables::SamplingTables;
use crate::walk::{Engine, FirstHit, FirstHits, MetFiber, Purpose, WalkPlan, draw, uniform};
use glam::DVec2;
use std::sync::Arc;

/// Isotropic fibers, H·d = 2 R L d π/4 = 1.
const PLAIN: &str = r#"
[fiber.test]
radius_um = 10
ior = 1.5
[sheet]
thickness_um = 1000
[[sheet.fibers]]
fiber = "test"
length_density_per_mm2 = 63.66197723675813
orientation = "isotropic"
[measure]
incident = [[20, 65], [60, 25]]
"#;
/// Two kinds of fibers that absorb, of every orientation, through which light is carried and remembers.
const DYED: &str = r#"
[fiber.red]
radius_um = 10
ior = 1.5
absorption_per_mm = { rgb = [12, 30, 60] }
[fiber.blue]
radius_um = 6
ior = 1.33
absorption_per_mm = { rgb = [50, 20, 9] }
[sheet]
thickness_um = 1000
[[sheet.fibers]]
fiber = "red"
length_density_per_mm2 = 60
orientation = "isotropic"
[[sheet.fibers]]
fiber = "blue"
length_density_per_mm2 = 40
orientation = "aligned"
axis = [0.6, 0.5, 0.2]
spread_deg = 20
[[sheet.fibers]]
fiber = "blue"
length_density_per_mm2 = 40
orientation = "planar"
[model]
placement = "carried"
memory = "flight"
[measure]
sides = ["front", "back"]
incident = [[20, 65], [60, 25]]
exit = 8
"#;
/// cos θ of the two directions.
const COSINES: [f64; 2] = [0.939_692_620_785_908_4, 0.5];
const SEED: u64 = 20_240_229;
/// Walks of a direction through the plain sheet, and of a direction and side through dyed cells.
const WALKS: u64 = 1 << 16;
const WALKS_IN_CELLS: u64 = 1 << 13;
/// The same walks may end elsewhere in so many of them: rounding decides near ties.
const MOST_MOVED: f64 = 1e-3;
/// Cells of the dyed cloth and their densities relative to the sheet's: half of them are empty.
const COUNTS: [u32; 3] = [4, 3, 5];
const SHARES: [f64; 6] = [0.0, 2.6, 0.0, 1.0, 0.0, 1.7];
/// Rays of a direction that meet fibers; every eighth goes straight through.
const RAYS: usize = 256;

/// What a self-test found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelfTest {
    /// Largest |z| of the direct light of a plain sheet against exp(−H d / cos θ).
    pub direct_z: f64,
    /// Share of walks through a plain sheet that end in another bin than the same walks of the f64 engine.
    pub moved: f64,
    /// The same of walks that set out from given fibers through cells of absorbing ones, are carried through them, remember
    /// their last flight, and are ended by roulette.
    pub moved_in_cells: f64,
    /// Share of the light of these walks that lies in another bin and channel, or is absorbed in another.
    pub light_moved: f64,
}

impl SelfTest {
    /// The larger of the shares of walks that end in another bin than in f64.
    pub fn most_moved(&self) -> f64 {
        self.moved.max(self.moved_in_cells)
    }
}

/// Measure a known sheet with an engine, and hold it against the closed form of direct light and the f64 engine; then a cloth
/// that asks for all that the model has, against the f64 engine.
///
/// # Errors
/// [`Error::Failed`] when the result is wrong (a right engine fails once in a million seeds; the seed is fixed), and
/// the engine's own errors.
pub fn self_test(engine: &dyn Engine) -> Result<SelfTest> {
    let Prepared { tables, goniometer, .. } = prepare(&scene(PLAIN)?)?;
    let plan = WalkPlan::new(SEED, WALKS);
    let [tally, expected] = both(engine, &tables, &goniometer, &plan)?;
    let (tables, goniometer, plan) = dyed_cells()?;
    let [in_cells, expected_in_cells] = both(engine, &tables, &goniometer, &plan)?;
    let result = SelfTest {
        direct_z: direct_z(&tally),
        moved: moved(&tally, &expected),
        moved_in_cells: moved(&in_cells, &expected_in_cells),
        light_moved: light_moved(&in_cells, &expected_in_cells),
    };
    let lost = [&tally, &in_cells].map(|tally| (0..tally.starts()).map(|start| tally.lost(start)).sum::<u64>());
    let mut faults = Vec::new();
    if result.direct_z >= 5.0 {
        faults.push(format!("direct light is off by {:.1} standard errors (allowed: 5)", result.direct_z));
    }
    for (cloth, moved) in [("a plain sheet", result.moved), ("cells of dyed fibers", result.moved_in_cells)] {
        if moved >= MOST_MOVED {
            faults
                .push(format!("{moved:.1e} of the walks through {cloth} differ from f64 (allowed: {MOST_MOVED:.0e})"));
        }
    }
    if result.light_moved >= MOST_MOVED {
        let moved = result.light_moved;
        faults.push(format!("{moved:.1e} of the light of dyed fibers differs from f64 (allowed: {MOST_MOVED:.0e})"));
    }
    if lost != [0, 0] {
        faults.push(format!("{} walks are lost (allowed: 0)", lost[0] + lost[1]));
    }
    if faults.is_empty() { Ok(result) } else { Err(Error::Failed(format!("self-test failed: {}", faults.join(", ")))) }
}

fn scene(text: &str) -> Result<Scene> {
    Scene::parse(&Source { file: "self-test".into(), stem: "self-test".into(), text: text.into(), folder: None })
}

/// The walks of an engine, and the same in f64.
fn both(engine: &dyn Engine, tables: &SamplingTables, goniometer: &Goniometer, plan: &WalkPlan) -> Result<[Tally; 2]> {
    let tally = engine.run(tables, goniometer, plan, &mut |_| {})?;
    tally.check(plan.walks_per_incident)?;
    Ok([tally, Reference.run(tables, goniometer, plan, &mut |_| {})?])
}

/// Cells of dyed fibers, put together without counting, and walks that set out from fibers drawn at random.
fn dyed_cells() -> Result<(SamplingTables, Goniometer, WalkPlan)> {
    let scene = scene(DYED)?;
    let Prepared { specific_length: sheet, goniometer, .. } = prepare(&scene)?;
    let whole = sheet.lists.first().map_or(0.0, |list| surface(list, |kind| scene.fibers[kind].radius));
    let thickness = sheet.cells.thickness;
    let cells = CellGrid { counts: COUNTS, period: DVec2::new(0.9, 0.7), thickness };
    let cell = |number: usize| Cell {
        surface: SHARES[number % SHARES.len()] * whole,
        placement: 1.0,
        list: 0,
        // Fibers lie in a part of each cell.
        centroid: [3, 7, 11].map(|step| 0.2 + 0.6 * ((number * step) % 13) as f32 / 12.0),
    };
    let values = (0..cells.len()).map(cell).collect();
    let period = cells.period;
    let tables = SamplingTables::new(&scene, &SpecificLength { cells, values, ..sheet })?;
    let ray = |number: usize| {
        let start = number / RAYS;
        let words = |event| draw(SEED, number as u64, event, Purpose::Start).map(uniform);
        let ([x, y, z, offset], [a, b, ..]) = (words(0), words(1));
        let m = (-goniometer.start_direction(start, DVec2::splat(0.5))).as_vec3().to_array();
        let p = direction_of(2.0 * DVec2::new(a, b) - 1.0).as_vec3().to_array();
        let place = [x * period.x, y * period.y, -z * thickness].map(|number| number as f32);
        let kind = (number % tables.kinds.len()) as u32;
        let fiber = MetFiber { place, p, offset: (2.0 * offset - 1.0) as f32, kind };
        FirstHit { m, fiber: (!number.is_multiple_of(8)).then_some(fiber) }
    };
    let rays = (0..RAYS * goniometer.starts()).map(ray).collect();
    let first_hits = Some(Arc::new(FirstHits { of_start: RAYS, rays }));
    Ok((tables, goniometer, WalkPlan { first_hits, ..WalkPlan::new(SEED, WALKS_IN_CELLS) }))
}

fn direct_z(tally: &Tally) -> f64 {
    let z = |(cell, cosine): (usize, f64)| {
        let probability = (-1.0 / cosine).exp();
        let (n, count) = (WALKS as f64, tally.direct(cell) as f64);
        ((count - n * probability) / (n * probability * (1.0 - probability)).sqrt()).abs()
    };
    COSINES.into_iter().enumerate().map(z).fold(0.0, f64::max)
}

fn moved(tally: &Tally, expected: &Tally) -> f64 {
    let differing: u64 = tally.bins.iter().zip(&expected.bins).map(|(a, b)| a.abs_diff(*b)).sum();
    differing as f64 / 2.0 / tally.counts.launched as f64
}

fn light_moved(tally: &Tally, expected: &Tally) -> f64 {
    let (Some(weights), Some(others)) = (&tally.weights, &expected.weights) else { return 1.0 };
    let pairs = weights.moments.iter().zip(&others.moments);
    let differing: u64 = pairs.map(|(a, b)| a.sum.abs_diff(b.sum)).sum();
    let all: u64 = others.moments.iter().map(|moments| moments.sum).sum();
    differing as f64 / 2.0 / all.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The f64 engine with bent tables and plans.
    struct Bent<F>(F);

    impl<F: Fn(&mut SamplingTables, &mut WalkPlan) + Sync> Engine for Bent<F> {
        fn run(
            &self,
            tables: &SamplingTables,
            goniometer: &Goniometer,
            plan: &WalkPlan,
            progress: &mut dyn FnMut(&Tally),
        ) -> Result<Tally> {
            let (mut tables, mut plan) = (tables.clone(), plan.clone());
            (self.0)(&mut tables, &mut plan);
            Reference.run(&tables, goniometer, &plan, progress)
        }
    }

    /// What a self-test of the f64 engine says once it is bent.
    fn complaint(bend: impl Fn(&mut SamplingTables, &mut WalkPlan) + Sync) -> String {
        let error = self_test(&Bent(bend)).expect_err("a bent engine is wrong");
        assert_eq!(error.exit_code(), 1, "{error}");
        error.to_string()
    }

    #[test]
    fn a_right_engine_passes() {
        let result = self_test(&Reference).expect("the f64 engine is right");
        assert_eq!((result.moved, result.moved_in_cells, result.light_moved), (0.0, 0.0, 0.0));
    }

    #[test]
    fn a_wrong_engine_fails() {
        for (index, thickness) in [(1.01, 1.0), (1.0, 1.03)] {
            let said = complaint(|tables, _| {
                tables.thickness *= thickness;
                tables.kinds[0].ior *= index;
            });
            assert!(said.contains("a plain sheet"), "{said}");
        }
    }

    /// A bend that walks through the plain sheet do not notice.
    fn assert_noticed_in_cells(what: &str, bend: impl Fn(&mut SamplingTables, &mut WalkPlan) + Sync) {
        let said = complaint(bend);
        println!("{what}: {said}");
        assert!(said.contains("dyed fibers") && !said.contains("plain") && !said.contains("direct"), "{what}: {said}");
    }

    #[test]
    fn an_engine_that_forgets_a_part_of_the_model_fails() {
        assert_noticed_in_cells("no roulette", |_, plan| plan.roulette = false);
        assert_noticed_in_cells("no first hits", |_, plan| plan.first_hits = None);
        assert_noticed_in_cells("no memory", |tables, _| {
            tables.carry.iter_mut().for_each(|carry| carry.memory = false);
        });
        assert_noticed_in_cells("not carried", |tables, _| tables.carry = None);
        assert_noticed_in_cells("cells in another order", |tables, _| {
            tables.cells.iter_mut().for_each(|cells| cells.entries.rotate_left(1));
        });
        assert_noticed_in_cells("one cell a fiftieth denser", |tables, _| {
            let cells = tables.cells.iter_mut().flat_map(|cells| &mut cells.entries);
            cells.filter(|cell| cell.share > 0.0).take(1).for_each(|cell| cell.share *= 0.98);
        });
        assert_noticed_in_cells("channels in another order", |tables, _| {
            tables.kinds.iter_mut().for_each(|kind| kind.absorption.reverse());
        });
        assert_noticed_in_cells("absorption one percent too high", |tables, _| {
            tables.kinds.iter_mut().flat_map(|kind| &mut kind.absorption).for_each(|sigma| *sigma *= 1.01);
        });
        assert_noticed_in_cells("one kind for both", |tables, _| {
            let first = tables.kinds[0].ior;
            tables.kinds.iter_mut().for_each(|kind| kind.ior = first);
        });
    }
}
