//! Every entry point with every combination of boolean overrides validates with no optional capability and translates
//! to SPIR-V, MSL and HLSL. No device is needed.

use fiberwalk::gpu::shader::Shader;
use fiberwalk::gpu::translate::{FLIGHTS, Translation, flags, sample, values};

fn check_all(shader: &Shader) -> usize {
    let (module, info) = shader.check().expect("the shader is valid");
    let mut translated = 0;
    for entry in &module.entry_points {
        for combination in 0..1u32 << flags(&module).len() {
            for flight in FLIGHTS {
                let values = values(&module, combination, flight);
                let Translation { spirv, msl, hlsl } = Translation::new(&module, &info, &entry.name, &values)
                    .unwrap_or_else(|error| panic!("{error}, with {values:?}"));
                assert!(spirv.len() > 100 && msl.contains(&entry.name) && hlsl.contains("numthreads"));
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
fn the_trial_of_loops_runs_everywhere() {
    assert_eq!(check_all(&Shader::loops()), 4, "one entry point without flags, four times");
}

#[test]
fn a_sample_turns_every_flag_on_and_off() {
    let (module, _) = Shader::walk().check().expect("the shader is valid");
    let sample = sample(&module);
    assert_eq!(sample.len(), 2 + 2 * flags(&module).len());
    for flag in flags(&module) {
        for value in [0.0, 1.0] {
            assert!(sample.iter().filter(|values| values[flag] == value).count() > 1, "{flag} is never {value}");
        }
    }
}

#[test]
fn a_shader_that_needs_an_optional_capability_is_refused() {
    let text = "@compute @workgroup_size(1) fn main() { var x: f64 = 1.0lf; x = x + x; }".to_owned();
    let error = Shader::new(vec![("double.wgsl", text)]).check().expect_err("f64 is optional");
    assert!(error.to_string().starts_with("shaders/double.wgsl:1:"), "{error}");
}

#[test]
fn every_part_says_what_it_uses_and_uses_only_parts_before_it() {
    for shader in [Shader::walk(), Shader::probe(), Shader::loops()] {
        let names: Vec<&str> = shader.parts().iter().map(|(name, _)| *name).collect();
        let parts = shader.parts().iter().enumerate().filter(|(_, (name, _))| *name != "constants");
        for (i, (name, text)) in parts {
            let line = text.lines().nth(1).unwrap_or_default();
            let uses = line.strip_prefix("// uses: ").unwrap_or_else(|| panic!("{name}: line 2 must say what it uses"));
            for used in uses.split(", ").filter(|used| *used != "nothing") {
                let known = names[..i].contains(&format!("{used}.wgsl").as_str());
                assert!(known, "{name} uses {used}, which is not a part before it");
            }
        }
    }
}
