//! A quick check that an engine gives right answers on this machine.

use super::run::{Prepared, prepare};
use crate::error::{Error, Result};
use crate::goniometer::Tally;
use crate::reference::Reference;
use crate::scene::{Scene, Source};
use crate::walk::{Engine, WalkPlan};

/// Isotropic fibers, H·d = 2 R L d π/4 = 1.
const CLOTH: &str = r#"
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
/// cos θ of the two directions.
const COSINES: [f64; 2] = [0.939_692_620_785_908_4, 0.5];
const WALKS: u64 = 1 << 16;
/// The same walks may end elsewhere in so many of them: rounding decides near ties.
const MOST_MOVED: f64 = 1e-3;

/// What a self-test found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelfTest {
    /// Largest |z| of the direct light against exp(−H d / cos θ).
    pub direct_z: f64,
    /// Share of walks that end in another bin than the same walks of the f64 engine.
    pub moved: f64,
}

/// Measure a known sheet with an engine; hold it against the closed form of direct light and the f64 engine.
///
/// # Errors
/// [`Error::Failed`] when the result is wrong (a right engine fails once in a million seeds; the seed is fixed), and
/// the engine's own errors.
pub fn self_test(engine: &dyn Engine) -> Result<SelfTest> {
    let source = Source { file: "self-test".into(), stem: "self-test".into(), text: CLOTH.into(), folder: None };
    let Prepared { tables, goniometer, .. } = prepare(&Scene::parse(&source)?)?;
    let plan = WalkPlan::new(20_240_229, WALKS);
    let tally = engine.run(&tables, &goniometer, &plan, &mut |_| {})?;
    let expected = Reference.run(&tables, &goniometer, &plan, &mut |_| {})?;
    let result = SelfTest { direct_z: direct_z(&tally), moved: moved(&tally, &expected) };
    let lost: u64 = (0..tally.starts()).map(|cell| tally.lost(cell)).sum();
    if result.direct_z < 5.0 && result.moved < MOST_MOVED && lost == 0 {
        return Ok(result);
    }
    Err(Error::Failed(format!(
        "self-test failed: direct light is off by {:.1} standard errors (allowed: 5), {:.1e} of the walks differ from \
         the f64 engine (allowed: {MOST_MOVED:.0e}), {lost} walks lost (allowed: 0)",
        result.direct_z, result.moved
    )))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::goniometer::Goniometer;
    use crate::tables::SamplingTables;

    /// The f64 engine with another refractive index, or another thickness.
    struct Bent(f64, f64);

    impl Engine for Bent {
        fn run(
            &self,
            tables: &SamplingTables,
            goniometer: &Goniometer,
            plan: &WalkPlan,
            progress: &mut dyn FnMut(&Tally),
        ) -> Result<Tally> {
            let mut tables = SamplingTables { thickness: tables.thickness * self.1, ..tables.clone() };
            tables.kinds[0].ior *= self.0;
            Reference.run(&tables, goniometer, plan, progress)
        }
    }

    #[test]
    fn a_right_engine_passes() {
        let result = self_test(&Reference).expect("the f64 engine is right");
        assert_eq!(result.moved, 0.0);
    }

    #[test]
    fn a_wrong_engine_fails() {
        for bent in [Bent(1.01, 1.0), Bent(1.0, 1.03)] {
            let error = self_test(&bent).expect_err("a bent engine is wrong");
            assert_eq!(error.exit_code(), 1);
        }
    }
}
