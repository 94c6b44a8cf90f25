//! What host and shaders share: structures and bindings, spelt once here and checked against the WGSL by a test.

use crate::scene::MAX_KINDS;
use bytemuck::{Pod, Zeroable};
use std::mem::{offset_of, size_of};
use wgpu::{
    BindGroupLayoutEntry, BindingType, BufferBindingType, ShaderStages, TextureSampleType, TextureViewDimension,
};

/// Vectors of 16 bytes in the uniform buffers of directions, of incident cells and of cells of the cloth: 64 KiB, the
/// default limit.
pub const UNIFORM_ENTRIES: u32 = 4096;
/// log₂ of the width of a table as a texture.
pub const TEXTURE_BITS: u32 = 10;
/// Walks that a lane takes at a time.
pub const BLOCK: u32 = 16;

/// Name, offset, size and Rust type of each field of a shared structure.
pub type Fields = &'static [(&'static str, usize, usize, &'static str)];

macro_rules! gpu_struct {
    ($(#[$doc:meta])* $name:ident { $($field:ident: $type:ty),* $(,)? }) => {
        $(#[$doc])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
        #[allow(missing_docs, reason = "the fields are described beside their twins in shaders/layout.wgsl")]
        pub struct $name { $(pub $field: $type),* }

        impl $name {
            /// Name, offset, size and type of each field.
            pub const FIELDS: Fields =
                &[$((stringify!($field), offset_of!($name, $field), size_of::<$type>(), stringify!($type))),*];
        }
    };
}

gpu_struct! {
    /// Parameters of a run of dispatches.
    Params {
        seed: [u32; 2], base: [u32; 2], id_stride: u32, starts: u32, front_starts: u32, walks: u32, blocks: u32,
        threshold_bits: u32, max_events: u32, exit_n: u32, exit_cells: u32, start_words: u32, mean_free_path: f32,
        thickness: f32, patch_unit: f32, incident_edge: f32, starts_reciprocal: f32, half_length: f32,
        kinds: [[f32; 4]; MAX_KINDS], clearest: [f32; 4], counts: [f32; 4], per_edge: [f32; 4],
        carry: [f32; 4], first_hits: [u32; 4],
    }
}

gpu_struct! {
    /// A lane between two dispatches.
    Lane {
        ray: [f32; 4], id: [u32; 2], start: u32, event: u32, hits: u32, state: u32, drained: u32, next_ready: u32,
        next: [f32; 4], next_id: [u32; 2], next_start: u32, pending_full: u32, pending: [f32; 4],
        pending_id: [u32; 2], pending_start: u32, pending_hits: u32, pending_events: u32, block_start: u32,
        block_walk: u32, block_end: u32, lengths: [f32; 4], pending_lengths: [f32; 4], next_lengths: [f32; 4], log_gain: f32,
        pending_log_gain: f32, roulette: f32, roulette_ready: u32, base_exits: u32, pending_base_exits: u32,
        place: [f32; 2], next_place: [f32; 2], reach: u32, next_reach: u32,
        depth_left: f32, refused: u32, next_hits: u32, next_base_exits: u32, flight_from: [f32; 4], flight_to: [f32; 4],
        left_axis: [f32; 4], left_fiber: [f32; 4], known_fiber: [f32; 4], next_flight_from: [f32; 4],
        next_flight_to: [f32; 4], next_left_axis: [f32; 4], next_left_fiber: [f32; 4],
    }
}

gpu_struct! {
    /// Sums over all lanes.
    Counters {
        next_block: u32, launched: u32, finished: u32, resumed: u32, tentative_low: u32, tentative_high: u32,
        collisions_low: u32, collisions_high: u32, base_exits_low: u32, base_exits_high: u32,
    }
}

gpu_struct! {
    /// How one walk went.
    Trace { bin: u32, events: u32, hits: u32, counted: u32 }
}

gpu_struct! {
    /// A straight ray, and the fiber that it meets first.
    FirstHit { ray: [f32; 4], place: [f32; 4], fiber: [f32; 4] }
}

gpu_struct! {
    /// Inputs of one call of a probe.
    ProbeInput { a: [u32; 4], b: [u32; 4], c: [u32; 4] }
}

/// Every shared structure: name, size, fields.
pub const STRUCTS: &[(&str, usize, Fields)] = &[
    ("Params", size_of::<Params>(), Params::FIELDS),
    ("Lane", size_of::<Lane>(), Lane::FIELDS),
    ("Counters", size_of::<Counters>(), Counters::FIELDS),
    ("Trace", size_of::<Trace>(), Trace::FIELDS),
    ("FirstHit", size_of::<FirstHit>(), FirstHit::FIELDS),
    ("ProbeInput", size_of::<ProbeInput>(), ProbeInput::FIELDS),
];

/// What is bound at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resource {
    /// Uniform buffer.
    Uniform,
    /// Storage buffer, read only.
    Read,
    /// Storage buffer, read and written.
    ReadWrite,
    /// Texture of u32.
    Texture,
}

/// Every binding: group, binding, name in the shader, what it is.
pub const BINDINGS: &[(u32, u32, &str, Resource)] = &[
    (0, 0, "params", Resource::Uniform),
    (0, 1, "table_uniform", Resource::Uniform),
    (0, 2, "table_texture", Resource::Texture),
    (0, 3, "incident", Resource::Uniform),
    (0, 4, "lanes", Resource::ReadWrite),
    (0, 5, "bins", Resource::ReadWrite),
    (0, 6, "counters", Resource::ReadWrite),
    (0, 7, "traces", Resource::ReadWrite),
    (0, 8, "absorption", Resource::Uniform),
    (0, 9, "cells_uniform", Resource::Uniform),
    (0, 10, "cells_texture", Resource::Texture),
    (0, 11, "first_hits", Resource::Read),
    (0, 12, "rings", Resource::Uniform),
    (1, 0, "probe_inputs", Resource::Read),
    (1, 1, "probe_outputs", Resource::ReadWrite),
    (2, 0, "loop_words", Resource::ReadWrite),
];

/// The bind-group layout of a group.
pub fn group_layout(device: &wgpu::Device, group: u32) -> wgpu::BindGroupLayout {
    let entries: Vec<BindGroupLayoutEntry> = BINDINGS
        .iter()
        .filter(|(of, ..)| *of == group)
        .map(|(_, binding, _, resource)| BindGroupLayoutEntry {
            binding: *binding,
            visibility: ShaderStages::COMPUTE,
            ty: binding_type(*resource),
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
}

fn binding_type(resource: Resource) -> BindingType {
    let buffer = |ty| BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    match resource {
        Resource::Uniform => buffer(BufferBindingType::Uniform),
        Resource::Read => buffer(BufferBindingType::Storage { read_only: true }),
        Resource::ReadWrite => buffer(BufferBindingType::Storage { read_only: false }),
        Resource::Texture => BindingType::Texture {
            sample_type: TextureSampleType::Uint,
            view_dimension: TextureViewDimension::D2,
            multisampled: false,
        },
    }
}
