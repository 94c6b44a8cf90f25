//! Every entry point with every combination of boolean overrides validates with no optional capability and translates
//! to SPIR-V, MSL and HLSL. No device is needed.

use fiberwalk::gpu::shader::Shader;
use naga::back::pipeline_constants::process_overrides;
use naga::back::{PipelineConstants, hlsl, msl, spv};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, Scalar, ScalarKind, ShaderStage};

fn boolean_overrides(module: &Module) -> Vec<String> {
    let boolean = |ty| matches!(module.types[ty].inner, naga::TypeInner::Scalar(Scalar { kind: ScalarKind::Bool, .. }));
    let names = module.overrides.iter().filter(|(_, over)| boolean(over.ty)).map(|(_, over)| over.name.clone());
    names.map(|name| name.expect("overrides are set by name")).collect()
}

fn translate(module: &Module, info: &ModuleInfo, entry: &str, constants: &PipelineConstants) -> Result<(), String> {
    let stage = Some((ShaderStage::Compute, entry));
    let (module, _) = process_overrides(module, info, stage, constants).map_err(|e| format!("overrides: {e}"))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|e| format!("validation: {:?}", e.into_inner()))?;
    let pipeline = spv::PipelineOptions { shader_stage: ShaderStage::Compute, entry_point: entry.into() };
    let words = spv::write_vec(&module, &info, &spv::Options::default(), Some(&pipeline))
        .map_err(|e| format!("SPIR-V: {e}"))?;
    assert!(words.len() > 100);
    let options = msl::Options { fake_missing_bindings: true, ..Default::default() };
    let pipeline =
        msl::PipelineOptions { entry_point: Some((ShaderStage::Compute, entry.into())), ..Default::default() };
    let (text, _) = msl::write_string(&module, &info, &options, &pipeline).map_err(|e| format!("MSL: {e}"))?;
    assert!(text.contains(entry));
    let options = hlsl::Options { fake_missing_bindings: true, ..Default::default() };
    let pipeline = hlsl::PipelineOptions { entry_point: Some((ShaderStage::Compute, entry.into())) };
    let mut text = String::new();
    hlsl::Writer::new(&mut text, &options, &pipeline).write(&module, &info, None).map_err(|e| format!("HLSL: {e}"))?;
    assert!(text.contains("numthreads"));
    Ok(())
}

fn check_all(shader: &Shader) -> usize {
    let (module, info) = shader.check().expect("the shader is valid");
    let flags = boolean_overrides(&module);
    let mut translated = 0;
    for entry in &module.entry_points {
        for combination in 0..1u32 << flags.len() {
            // Flights by null collisions, from hits and in two ways from fibers, and by a table of 16 × 16 rays; light from
            // cells, a list and rings, counted in cells and in rings.
            for [visible, placement, incidence, rings] in
                [[0.0, 0.0, 0.0, 1.0], [0.0, 1.0, 1.0, 0.0], [0.0, 2.0, 2.0, 1.0], [16.0, 0.0, 2.0, 0.0]]
            {
                let values = flags.iter().enumerate().map(|(i, name)| (name.clone(), f64::from(combination >> i & 1)));
                let values = values.chain([("VISIBLE_N".to_owned(), visible), ("PLACEMENT".to_owned(), placement)]);
                let values = values.chain([("INCIDENCE".to_owned(), incidence), ("EXIT_RINGS".to_owned(), rings)]);
                translate(&module, &info, &entry.name, &values.collect()).unwrap_or_else(|error| {
                    panic!(
                        "{}, {flags:?} = {combination:b}, {visible} rays, placement {placement}: {error}",
                        entry.name
                    )
                });
                translated += 1;
            }
        }
    }
    translated
}

#[test]
fn the_kernel_runs_everywhere_with_every_combination_of_flags() {
    assert_eq!(check_all(&Shader::walk()), 4 * 1024, "one entry point, ten flags, four kinds of flight");
}

#[test]
fn the_probes_run_everywhere_with_every_combination_of_flags() {
    assert_eq!(check_all(&Shader::probe()), 4 * 12 * 64, "twelve entry points, six flags, four kinds of flight");
}

#[test]
fn a_shader_that_needs_an_optional_capability_is_refused() {
    let text = "@compute @workgroup_size(1) fn main() { var x: f64 = 1.0lf; x = x + x; }".to_owned();
    let error = Shader::new(vec![("double.wgsl", text)]).check().expect_err("f64 is optional");
    assert!(error.to_string().starts_with("shaders/double.wgsl:1:"), "{error}");
}

#[test]
fn every_part_says_what_it_uses_and_uses_only_parts_before_it() {
    for shader in [Shader::walk(), Shader::probe()] {
        let names: Vec<&str> = shader.parts().iter().map(|(name, _)| *name).collect();
        for (i, (name, text)) in shader.parts().iter().enumerate().skip(1) {
            let line = text.lines().nth(1).unwrap_or_default();
            let uses = line.strip_prefix("// uses: ").unwrap_or_else(|| panic!("{name}: line 2 must say what it uses"));
            for used in uses.split(", ").filter(|used| *used != "nothing") {
                let known = names[..i].contains(&format!("{used}.wgsl").as_str());
                assert!(known, "{name} uses {used}, which is not a part before it");
            }
        }
    }
}
