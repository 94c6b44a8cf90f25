//! What compilers of other languages get of a shader.

use crate::error::{Error, Result};
use naga::back::pipeline_constants::process_overrides;
use naga::back::{PipelineConstants, hlsl, msl, spv};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage};

/// One entry point of a shader in the three languages of the backends.
pub struct Translation {
    /// SPIR-V, for Vulkan.
    pub spirv: Vec<u32>,
    /// Metal's language.
    pub msl: String,
    /// That of DX12.
    pub hlsl: String,
}

impl Translation {
    /// Translate an entry point with values for its overrides, booleans as 0 and 1.
    ///
    /// # Errors
    /// [`Error::Failed`] when a step refuses it, with the name of that step.
    pub fn new(module: &Module, info: &ModuleInfo, entry: &str, constants: &PipelineConstants) -> Result<Translation> {
        let refused = |step: &str, message: String| Error::Failed(format!("{entry}: {step}: {message}"));
        let stage = Some((ShaderStage::Compute, entry));
        let (module, _) =
            process_overrides(module, info, stage, constants).map_err(|e| refused("overrides", e.to_string()))?;
        let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .map_err(|e| refused("validation", format!("{:?}", e.into_inner())))?;
        let pipeline = spv::PipelineOptions { shader_stage: ShaderStage::Compute, entry_point: entry.into() };
        let spirv = spv::write_vec(&module, &info, &spv::Options::default(), Some(&pipeline))
            .map_err(|e| refused("SPIR-V", e.to_string()))?;
        let options = msl::Options { fake_missing_bindings: true, ..Default::default() };
        let pipeline =
            msl::PipelineOptions { entry_point: Some((ShaderStage::Compute, entry.into())), ..Default::default() };
        let (msl, _) =
            msl::write_string(&module, &info, &options, &pipeline).map_err(|e| refused("MSL", e.to_string()))?;
        let options = hlsl::Options { fake_missing_bindings: true, ..Default::default() };
        let pipeline = hlsl::PipelineOptions { entry_point: Some((ShaderStage::Compute, entry.into())) };
        let mut text = String::new();
        hlsl::Writer::new(&mut text, &options, &pipeline)
            .write(&module, &info, None)
            .map_err(|e| refused("HLSL", e.to_string()))?;
        Ok(Translation { spirv, msl, hlsl: text })
    }
}

/// Overrides that are no flags: rays of the table of H, placement, incidence, and whether exits are counted in rings.
const FLIGHT_NAMES: [&str; 4] = ["VISIBLE_N", "PLACEMENT", "INCIDENCE", "EXIT_RINGS"];
/// Flights by null collisions, from hits and in two ways from fibers, and by a table of 16 × 16 rays; light from cells, a
/// list and rings, counted in cells and in rings.
pub const FLIGHTS: [[f64; 4]; 4] =
    [[0.0, 0.0, 0.0, 1.0], [0.0, 1.0, 1.0, 0.0], [0.0, 2.0, 2.0, 1.0], [16.0, 0.0, 2.0, 0.0]];

/// Names of the boolean overrides of a module.
pub fn flags(module: &Module) -> Vec<&str> {
    let boolean = |over: &naga::Override| matches!(module.types[over.ty].inner, naga::TypeInner::Scalar(scalar) if scalar.kind == naga::ScalarKind::Bool);
    module.overrides.iter().filter(|(_, over)| boolean(over)).filter_map(|(_, over)| over.name.as_deref()).collect()
}

/// Values for the overrides of a module: flags by the bits of a number, the rest by one of [`FLIGHTS`].
pub fn values(module: &Module, on: u32, flight: [f64; 4]) -> PipelineConstants {
    let flags = flags(module).into_iter().enumerate().map(|(i, name)| (name, f64::from(on >> i & 1)));
    let known = |name: &str| module.overrides.iter().any(|(_, over)| over.name.as_deref() == Some(name));
    let flight = FLIGHT_NAMES.into_iter().zip(flight).filter(|(name, _)| known(name));
    flags.chain(flight).map(|(name, value)| (name.to_owned(), value)).collect()
}

/// A few choices of values that turn every flag on and off: all off, all on, each alone on and alone off, with each flight
/// in its turn.
pub fn sample(module: &Module) -> Vec<PipelineConstants> {
    let count = flags(module).len();
    let all = (1 << count) - 1;
    let mut choices: Vec<u32> = (0..count).flat_map(|flag| [1 << flag, all ^ 1 << flag]).chain([0, all]).collect();
    choices.sort_unstable();
    choices.dedup();
    choices.into_iter().zip(FLIGHTS.into_iter().cycle()).map(|(on, flight)| values(module, on, flight)).collect()
}
