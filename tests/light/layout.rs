//! Structures and bindings spelt in Rust agree with the WGSL, by reflection. No device is needed.

use fiberwalk::gpu::layout::{BINDINGS, Resource, STRUCTS};
use fiberwalk::gpu::shader::Shader;
use fiberwalk::scene::MAX_KINDS;
use naga::{AddressSpace, Module, StorageAccess, TypeInner};
use std::collections::BTreeSet;

type Members = Vec<(String, usize, String)>;

/// A WGSL type as Rust spells its mirror.
fn rust_type(module: &Module, ty: naga::Handle<naga::Type>) -> String {
    let scalar = |scalar: naga::Scalar| match scalar.kind {
        naga::ScalarKind::Float => "f32",
        naga::ScalarKind::Uint => "u32",
        _ => "a scalar that hosts do not share",
    };
    match module.types[ty].inner {
        TypeInner::Scalar(kind) | TypeInner::Atomic(kind) => scalar(kind).into(),
        TypeInner::Vector { size, scalar: kind } => format!("[{}; {}]", scalar(kind), size as u8),
        TypeInner::Array { base, size: naga::ArraySize::Constant(size), .. } => {
            format!("[{}; {size}]", rust_type(module, base))
        }
        _ => "a type that hosts do not share".into(),
    }
}

/// Members with their offsets and types, and the size, of a structure.
fn structure(module: &Module, name: &str) -> Option<(Members, usize)> {
    module.types.iter().find_map(|(_, ty)| match &ty.inner {
        TypeInner::Struct { members, span } if ty.name.as_deref() == Some(name) => {
            let member = |m: &naga::StructMember| {
                (m.name.clone().unwrap_or_default(), m.offset as usize, rust_type(module, m.ty))
            };
            Some((members.iter().map(member).collect(), *span as usize))
        }
        _ => None,
    })
}

/// A Rust type with its named lengths in digits.
fn spelt_out(ty: &str) -> String {
    ty.replace("MAX_KINDS", &MAX_KINDS.to_string())
}

/// How a structure of the module differs from its mirror.
fn difference(module: &Module, name: &str, size: usize, fields: &[(&str, usize, usize, &str)]) -> Option<String> {
    let (members, span) = structure(module, name)?;
    let mirror: Members =
        fields.iter().map(|(field, offset, _, ty)| ((*field).to_owned(), *offset, spelt_out(ty))).collect();
    if members != mirror {
        return Some(format!("{name}: WGSL has {members:?}, Rust has {mirror:?}"));
    }
    (span != size).then(|| format!("{name}: WGSL takes {span} bytes, Rust takes {size}"))
}

/// Names of structures behind uniform and storage bindings.
fn shared_structures(module: &Module) -> BTreeSet<String> {
    let bound = module.global_variables.iter().filter(|(_, variable)| variable.binding.is_some());
    let base = |(_, variable): (_, &naga::GlobalVariable)| match module.types[variable.ty].inner {
        TypeInner::Array { base, .. } => base,
        _ => variable.ty,
    };
    let structure = |ty| match &module.types[ty] {
        naga::Type { name: Some(name), inner: TypeInner::Struct { .. } } => Some(name.clone()),
        _ => None,
    };
    bound.map(base).filter_map(structure).collect()
}

fn modules() -> [Module; 3] {
    [Shader::walk(), Shader::probe(), Shader::loops()].map(|shader| shader.check().expect("the shader is valid").0)
}

#[test]
fn rust_and_wgsl_lay_out_the_same_structures() {
    let mut shared = BTreeSet::new();
    for module in &modules() {
        for (name, size, fields) in STRUCTS {
            assert_eq!(difference(module, name, *size, fields), None);
        }
        shared.extend(shared_structures(module));
    }
    let mirrored: BTreeSet<String> = STRUCTS.iter().map(|(name, ..)| (*name).to_owned()).collect();
    assert_eq!(shared, mirrored, "structures on one side only");
}

#[test]
fn a_moved_renamed_or_resized_field_is_noticed() {
    let [walk, ..] = modules();
    let (name, size, fields) = STRUCTS[0];
    let mut moved = fields.to_vec();
    moved[3].1 += 4;
    let mut renamed = fields.to_vec();
    renamed[3].0 = "other";
    assert!(difference(&walk, name, size, &moved).is_some());
    assert!(difference(&walk, name, size, &renamed).is_some());
    let mut retyped = fields.to_vec();
    retyped[3].3 = "f32";
    assert!(difference(&walk, name, size, &retyped).is_some());
    assert!(difference(&walk, name, size + 16, fields).is_some());
}

#[test]
fn rust_and_wgsl_bind_the_same_resources() {
    let mut declared = BTreeSet::new();
    for module in &modules() {
        for (_, variable) in module.global_variables.iter() {
            let Some(at) = &variable.binding else { continue };
            let resource = match variable.space {
                AddressSpace::Uniform => Resource::Uniform,
                AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => Resource::ReadWrite,
                AddressSpace::Storage { .. } => Resource::Read,
                AddressSpace::Handle => Resource::Texture,
                _ => panic!("{:?} cannot be bound", variable.space),
            };
            declared.insert((at.group, at.binding, variable.name.clone().unwrap_or_default(), format!("{resource:?}")));
        }
    }
    let bound = BINDINGS
        .iter()
        .map(|(group, binding, name, resource)| (*group, *binding, (*name).to_owned(), format!("{resource:?}")));
    assert_eq!(declared, bound.collect::<BTreeSet<_>>());
}

#[test]
fn shared_structures_have_no_type_that_hosts_lay_out_differently() {
    for module in &modules() {
        for name in shared_structures(module) {
            let (_, ty) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(&name)).expect("it is there");
            let TypeInner::Struct { members, .. } = &ty.inner else { panic!("{name} is a structure") };
            for member in members {
                let bad = match module.types[member.ty].inner {
                    TypeInner::Vector { size, .. } => size == naga::VectorSize::Tri,
                    TypeInner::Matrix { .. } => true,
                    _ => false,
                };
                assert!(!bad, "{name}.{:?} must not be a vec3 or a matrix", member.name);
            }
        }
    }
}
