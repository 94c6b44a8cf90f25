//! The pipeline and the buffers of one batch of starts, and its dispatches.

use super::buffers::{Buffers, InTexture, Packed, Sizes};
use super::device::OpenDevice;
use super::layout::{Counters, Params, Trace};
use super::shader::Shader;
use crate::error::Result;
use crate::goniometer::Tally;
use std::mem::size_of;
use wgpu::{Buffer, BufferUsages, CommandEncoder, ComputePipeline};

/// What the kernel is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Shape {
    pub workgroup: u32,
    pub lanes: u32,
    pub budget: u32,
    pub flush_every: u32,
    pub in_texture: InTexture,
    pub jitter: bool,
    /// As the shaders number it.
    pub incidence: u32,
    pub exit_rings: bool,
    pub trace: bool,
    pub kinds: u32,
    pub channels: u32,
    pub absorbing: bool,
    pub bases: bool,
    pub roulette: bool,
    pub cells: bool,
    /// Cells along an edge of the table of H(m); 0 for null collisions.
    pub visible_n: u32,
    /// As the shaders number it.
    pub placement: u32,
    pub memory: bool,
    pub first_hits: bool,
}

/// A pipeline with its buffers.
pub struct Session<'a> {
    device: &'a OpenDevice,
    pub shape: Shape,
    pipeline: ComputePipeline,
    buffers: Buffers,
    staging: Buffer,
    /// Bins run on modulo 2³²; what was last seen of them.
    seen: Vec<u32>,
}

const COUNTER_WORDS: usize = size_of::<Counters>() / 4;

impl<'a> Session<'a> {
    /// The kernel of a shape.
    pub fn compile(device: &OpenDevice, shape: &Shape) -> Result<ComputePipeline> {
        device.pipeline(&Shader::walk(), "walk", &[0], &overrides(shape))
    }

    /// Allocate; every bin starts at `preset`.
    pub fn new(
        device: &'a OpenDevice,
        pipeline: ComputePipeline,
        shape: Shape,
        packed: &Packed,
        bins: usize,
        traces: usize,
        preset: u32,
    ) -> Result<Session<'a>> {
        let buffers = Buffers::new(device, packed, shape.in_texture, Sizes { lanes: shape.lanes, bins, traces })?;
        let staging_bytes = (bins * 4).max(size_of::<Counters>()).max(traces * size_of::<Trace>()) as u64;
        let staging = device.buffer("staging", staging_bytes, BufferUsages::MAP_READ | BufferUsages::COPY_DST)?;
        let mut seen = Vec::new();
        if preset > 0 {
            seen = vec![preset; bins];
            device.queue.write_buffer(&buffers.bins, 0, bytemuck::cast_slice(&seen));
        }
        seen.resize(bins, 0);
        Ok(Session { device, shape, pipeline, buffers, staging, seen })
    }

    /// Set new parameters, empty the lanes and the counters; sums of two words start at `preset`.
    pub fn restart(&self, params: &Params, preset: u32) {
        self.device.queue.write_buffer(&self.buffers.params, 0, bytemuck::bytes_of(params));
        let [tentative_low, collisions_low, base_exits_low] = [preset; 3];
        let counters = Counters { tentative_low, collisions_low, base_exits_low, ..Counters::default() };
        self.device.queue.write_buffer(&self.buffers.counters, 0, bytemuck::bytes_of(&counters));
        let mut encoder = self.encoder();
        encoder.clear_buffer(&self.buffers.lanes, 0, None);
        encoder.clear_buffer(&self.buffers.traces, 0, None);
        self.device.queue.submit([encoder.finish()]);
    }

    /// One dispatch; gives the counters since the restart.
    pub fn dispatch(&self) -> Result<Counters> {
        let mut encoder = self.encoder();
        {
            let descriptor = wgpu::ComputePassDescriptor { label: Some("walk"), timestamp_writes: None };
            let mut pass = encoder.begin_compute_pass(&descriptor);
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.buffers.group, &[]);
            pass.dispatch_workgroups(self.shape.lanes / self.shape.workgroup, 1, 1);
        }
        let words = self.read(encoder, &self.buffers.counters, COUNTER_WORDS)?;
        Ok(bytemuck::cast_slice(&words)[0])
    }

    /// Add what the words of the starts from `first` on have counted since the last time.
    ///
    /// A bin gets fewer than 2³² walks between two drains, and a moment fewer than 2⁶⁴ units.
    pub fn drain(&mut self, tally: &mut Tally, first: usize) -> Result<()> {
        let now = self.read(self.encoder(), &self.buffers.bins, self.seen.len())?;
        let (stride, moments) = (tally.layout.stride(), (2 * tally.layout.exit_cells + 1) * tally.channels());
        let words = stride + if tally.weights.is_some() { 4 * moments } else { 0 };
        for (start, (now, seen)) in (first..).zip(now.chunks_exact(words).zip(self.seen.chunks_exact(words))) {
            let bins = &mut tally.bins[start * stride..(start + 1) * stride];
            for (sum, (now, seen)) in bins.iter_mut().zip(now.iter().zip(seen)) {
                *sum += u64::from(now.wrapping_sub(*seen));
            }
            let Some(weights) = &mut tally.weights else { continue };
            let join = |words: &[u32]| u64::from(words[1]) << 32 | u64::from(words[0]);
            let pairs = now[stride..].chunks_exact(4).zip(seen[stride..].chunks_exact(4));
            for (sum, (now, seen)) in weights.moments[start * moments..(start + 1) * moments].iter_mut().zip(pairs) {
                sum.sum += join(&now[..2]).wrapping_sub(join(&seen[..2]));
                sum.square += join(&now[2..]).wrapping_sub(join(&seen[2..]));
            }
        }
        self.seen = now;
        Ok(())
    }

    /// How each walk went, by slot.
    pub fn traces(&self, count: usize) -> Result<Vec<Trace>> {
        let words = self.read(self.encoder(), &self.buffers.traces, count * size_of::<Trace>() / 4)?;
        Ok(bytemuck::cast_slice(&words).to_vec())
    }

    fn encoder(&self) -> CommandEncoder {
        self.device.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    fn read(&self, mut encoder: CommandEncoder, buffer: &Buffer, words: usize) -> Result<Vec<u32>> {
        encoder.copy_buffer_to_buffer(buffer, 0, &self.staging, 0, (words * 4) as u64);
        self.device.submit_and_read(encoder, &self.staging, words)
    }
}

fn overrides(shape: &Shape) -> [(&'static str, f64); 19] {
    let flag = |on: bool| f64::from(u8::from(on));
    [
        ("WORKGROUP", f64::from(shape.workgroup)),
        ("BUDGET", f64::from(shape.budget)),
        ("FLUSH_EVERY", f64::from(shape.flush_every)),
        ("TABLE_IN_TEXTURE", flag(shape.in_texture.directions)),
        ("JITTER", flag(shape.jitter)),
        ("INCIDENCE", f64::from(shape.incidence)),
        ("EXIT_RINGS", flag(shape.exit_rings)),
        ("TRACE", flag(shape.trace)),
        ("KINDS", f64::from(shape.kinds)),
        ("CHANNELS", f64::from(shape.channels)),
        ("ABSORBING", flag(shape.absorbing)),
        ("BASES", flag(shape.bases)),
        ("ROULETTE", flag(shape.roulette)),
        ("VISIBLE_N", f64::from(shape.visible_n)),
        ("PLACEMENT", f64::from(shape.placement)),
        ("MEMORY", flag(shape.memory)),
        ("CELLS", flag(shape.cells)),
        ("CELLS_IN_TEXTURE", flag(shape.in_texture.cells)),
        ("FIRST_HITS", flag(shape.first_hits)),
    ]
}
