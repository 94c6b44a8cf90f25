//! The buffers and textures that every kernel binds, in one group.

use super::device::OpenDevice;
use super::layout::{Counters, Lane, Params, Trace, UNIFORM_ENTRIES, group_layout};
use super::pack::texture;
use crate::error::Result;
use crate::scene::MAX_CHANNELS;
use wgpu::{BindGroup, BindingResource, Buffer, BufferUsages};

/// The tables of a run, packed.
pub struct Packed<'a> {
    pub directions: &'a [[u32; 4]],
    pub incident: &'a [[f32; 4]],
    pub absorption: &'a [[f32; 4]],
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
    pub fn new(device: &OpenDevice, packed: &Packed, table_in_texture: bool, sizes: Sizes) -> Result<Buffers> {
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
        let in_texture = if table_in_texture { packed.directions } else { &[] };
        if !table_in_texture {
            device.queue.write_buffer(&table, 0, bytemuck::cast_slice(packed.directions));
        }
        device.queue.write_buffer(&incident, 0, bytemuck::cast_slice(packed.incident));
        device.queue.write_buffer(&absorption, 0, bytemuck::cast_slice(packed.absorption));
        let view = texture(&device.device, &device.queue, in_texture);
        let resources = [
            params.as_entire_binding(),
            table.as_entire_binding(),
            BindingResource::TextureView(&view),
            incident.as_entire_binding(),
            lanes.as_entire_binding(),
            bins.as_entire_binding(),
            counters.as_entire_binding(),
            traces.as_entire_binding(),
            absorption.as_entire_binding(),
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
