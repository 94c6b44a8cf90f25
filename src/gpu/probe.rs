//! Calls of single functions of the kernel, for tests.

use super::buffers::{Buffers, InTexture, Packed, Sizes, bind};
use super::device::OpenDevice;
use super::engine::Gpu;
pub use super::layout::ProbeInput;
use super::pack::{absorption_table, cell_table, direction_table, incidence, incident_table, ring_table};
use super::params;
use super::shader::Shader;
use crate::error::Result;
use crate::goniometer::{Basis, Goniometer};
use crate::tables::SamplingTables;
use crate::walk::WalkPlan;
use wgpu::BufferUsages;

/// The words that one call gives.
pub type ProbeOutput = [u32; 4];

/// The functions of the kernel for one medium and one instrument.
pub struct Probe<'a> {
    gpu: &'a Gpu,
    tables: &'a SamplingTables,
    goniometer: &'a Goniometer,
    /// Read the tables of directions and of cells from textures.
    pub in_texture: bool,
}

impl<'a> Probe<'a> {
    /// Set up for a medium and an instrument.
    pub fn new(gpu: &'a Gpu, tables: &'a SamplingTables, goniometer: &'a Goniometer) -> Probe<'a> {
        Probe { gpu, tables, goniometer, in_texture: false }
    }

    /// Call the entry point `probe_…` once for each input.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the device fails.
    pub fn call(&self, entry: &str, inputs: &[ProbeInput]) -> Result<Vec<ProbeOutput>> {
        let device = &self.gpu.device;
        let calls = inputs.len().next_multiple_of(64);
        let mut padded = inputs.to_vec();
        padded.resize(calls, ProbeInput::default());
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let input = device.buffer("probe_inputs", (calls * size_of::<ProbeInput>()) as u64, storage)?;
        let output = device.buffer("probe_outputs", (calls * 16) as u64, storage)?;
        let readable = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let staging = device.buffer("staging", (calls * 16) as u64, readable)?;
        device.queue.write_buffer(&input, 0, bytemuck::cast_slice(&padded));
        // Poison the output: a call that did not happen shows.
        device.queue.write_buffer(&output, 0, &vec![0xa5; calls * 16]);
        let flag = |on: bool| f64::from(u8::from(on));
        let overrides = [
            ("TABLE_IN_TEXTURE", flag(self.in_texture)),
            ("CELLS", flag(self.tables.cells.is_some())),
            ("VISIBLE_N", self.tables.visible.as_ref().map_or(0.0, |visible| f64::from(visible.n))),
            ("CELLS_IN_TEXTURE", flag(self.in_texture)),
            ("INCIDENCE", f64::from(incidence(self.goniometer))),
            ("EXIT_RINGS", flag(matches!(self.goniometer.exit, Basis::Rings(_)))),
            ("PLACEMENT", f64::from(params::placement(self.tables))),
            ("KINDS", self.tables.kinds.len() as f64),
            ("BASES", flag(self.tables.half_length.is_finite())),
        ];
        let pipeline = device.pipeline(&Shader::probe(), entry, &[0, 1], &overrides)?;
        let medium = self.bind_medium(device)?;
        let io = bind(device, 1, [input.as_entire_binding(), output.as_entire_binding()]);
        let mut encoder = device.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &medium, &[]);
            pass.set_bind_group(1, &io, &[]);
            pass.dispatch_workgroups((calls / 64) as u32, 1, 1);
        }
        encoder.copy_buffer_to_buffer(&output, 0, &staging, 0, (calls * 16) as u64);
        let words = device.submit_and_read(encoder, &staging, calls * 4)?;
        Ok(words.chunks_exact(4).take(inputs.len()).map(|word| [word[0], word[1], word[2], word[3]]).collect())
    }

    /// The tables of the medium and the instrument; a probe walks in no lane and counts nothing.
    fn bind_medium(&self, device: &OpenDevice) -> Result<wgpu::BindGroup> {
        let directions = direction_table(self.tables, true);
        let incident = incident_table(self.goniometer);
        let absorption = absorption_table(self.tables);
        let cells = cell_table(self.tables);
        let rings = ring_table(self.goniometer);
        let packed = Packed {
            directions: &directions,
            cells: &cells,
            incident: &incident,
            absorption: &absorption,
            first_hits: &[],
            rings: &rings,
        };
        let in_texture = InTexture { directions: self.in_texture, cells: self.in_texture };
        // Each binding must hold one item of its kind.
        let sizes = Sizes { lanes: 1, bins: 1, traces: 1 };
        let buffers = Buffers::new(device, &packed, in_texture, sizes)?;
        let starts = 0..self.goniometer.starts();
        let values = params::params(self.tables, self.goniometer, &WalkPlan::new(0, 1), starts, 0..1);
        device.queue.write_buffer(&buffers.params, 0, bytemuck::bytes_of(&values));
        Ok(buffers.group)
    }
}
