//! The buffers and textures that every kernel binds, in one group.

use super::device::OpenDevice;
use super::layout::{Counters, FirstHit, Lane, Params, Trace, UNIFORM_ENTRIES, group_layout};
use crate::error::Result;
use crate::goniometer::MOST_RINGS;
use crate::scene::MAX_CHANNELS;
use wgpu::{BindGroup, BindingResource, Buffer, BufferUsages};

/// The tables of a run, packed.
pub struct Packed<'a> {
    pub directions: &'a [[u32; 4]],
    pub cells: &'a [[u32; 4]],
    pub incident: &'a [[f32; 4]],
    pub absorption: &'a [[f32; 4]],
    pub first_hits: &'a [FirstHit],
    pub rings: &'a [[f32; 4]],
}

/// Which tables are textures, not uniform buffers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct InTexture {
    pub directions: bool,
    pub cells: bool,
}

/// How much a kernel needs of the buffers that grow.
#[derive(Clone, Copy)]
pub struct Sizes {
    pub lanes: u32,
    /// Words.
    pub bins: usize,
    pub traces: usize,
}

/// What group 0 binds, and what the host writes and reads again.
pub struct Buffers {
    pub group: BindGroup,
    pub params: Buffer,
    pub lanes: Buffer,
    pub bins: Buffer,
    pub counters: Buffer,
    pub traces: Buffer,
}

impl Buffers {
    /// Allocate, and write the tables.
    pub fn new(device: &OpenDevice, packed: &Packed, in_texture: InTexture, sizes: Sizes) -> Result<Buffers> {
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let uniform = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let entries = u64::from(UNIFORM_ENTRIES) * 16;
        let params = device.buffer("params", size_of::<Params>() as u64, uniform)?;
        let table = device.buffer("table_uniform", entries, uniform)?;
        let incident = device.buffer("incident", entries, uniform)?;
        let lanes = device.buffer("lanes", u64::from(sizes.lanes) * size_of::<Lane>() as u64, storage)?;
        let bins = device.buffer("bins", sizes.bins as u64 * 4, storage)?;
        let counters = device.buffer("counters", size_of::<Counters>() as u64, storage)?;
        let traces = device.buffer("traces", (sizes.traces * size_of::<Trace>()) as u64, storage)?;
        let absorption = device.buffer("absorption", (MAX_CHANNELS * 16) as u64, uniform)?;
        let cells = device.buffer("cells_uniform", entries, uniform)?;
        let rays = size_of_val(packed.first_hits).max(size_of::<FirstHit>()) as u64;
        let first_hits = device.buffer("first_hits", rays, storage)?;
        let rings = device.buffer("rings", (MOST_RINGS * 16) as u64, uniform)?;
        let mut views = Vec::new();
        let tables = [
            ("table_texture", packed.directions, in_texture.directions, &table),
            ("cells_texture", packed.cells, in_texture.cells, &cells),
        ];
        for (label, entries, in_texture, buffer) in tables {
            views.push(device.texture(label, if in_texture { entries } else { &[] })?);
            if !in_texture {
                device.queue.write_buffer(buffer, 0, bytemuck::cast_slice(entries));
            }
        }
        device.queue.write_buffer(&incident, 0, bytemuck::cast_slice(packed.incident));
        device.queue.write_buffer(&absorption, 0, bytemuck::cast_slice(packed.absorption));
        device.queue.write_buffer(&first_hits, 0, bytemuck::cast_slice(packed.first_hits));
        device.queue.write_buffer(&rings, 0, bytemuck::cast_slice(packed.rings));
        let resources = [
            params.as_entire_binding(),
            table.as_entire_binding(),
            BindingResource::TextureView(&views[0]),
            incident.as_entire_binding(),
            lanes.as_entire_binding(),
            bins.as_entire_binding(),
            counters.as_entire_binding(),
            traces.as_entire_binding(),
            absorption.as_entire_binding(),
            cells.as_entire_binding(),
            BindingResource::TextureView(&views[1]),
            first_hits.as_entire_binding(),
            rings.as_entire_binding(),
        ];
        let group = bind(device, 0, resources);
        Ok(Buffers { group, params, lanes, bins, counters, traces })
    }
}

/// A bind group of resources in the order of their bindings.
pub fn bind<const N: usize>(device: &OpenDevice, group: u32, resources: [BindingResource; N]) -> BindGroup {
    let entries: Vec<wgpu::BindGroupEntry> =
        (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    let layout = group_layout(&device.device, group);
    device.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries })
}
