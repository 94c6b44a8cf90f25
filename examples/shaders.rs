//! Write the shaders as other compilers get them: the WGSL of each whole, and a sample of its entry points and overrides as
//! SPIR-V, HLSL and the values (JSON): `cargo run --release --example shaders -- FOLDER`.

use fiberwalk::gpu::shader::Shader;
use fiberwalk::gpu::translate::{Translation, sample};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::{env, fs};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(env::args().nth(1).ok_or("name a folder")?);
    fs::create_dir_all(&folder)?;
    let mut written = 0;
    for (name, shader) in [("walk", Shader::walk()), ("probe", Shader::probe()), ("loops", Shader::loops())] {
        let (module, info) = shader.check()?;
        fs::write(folder.join(format!("{name}.wgsl")), shader.text())?;
        for entry in &module.entry_points {
            for (number, values) in sample(&module).into_iter().enumerate() {
                let Translation { spirv, hlsl, .. } = Translation::new(&module, &info, &entry.name, &values)?;
                let path = |ending: &str| folder.join(format!("{name}.{}.{number}.{ending}", entry.name));
                let bytes: Vec<u8> = spirv.iter().flat_map(|word| word.to_le_bytes()).collect();
                fs::write(path("spv"), bytes)?;
                fs::write(path("hlsl"), hlsl)?;
                let values: BTreeMap<String, f64> = values.into_iter().collect();
                fs::write(path("json"), serde_json::to_string(&values)?)?;
                written += 1;
            }
        }
    }
    println!("{written} modules in {}", folder.display());
    Ok(())
}
