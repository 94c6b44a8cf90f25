//! A device, its pipelines, and waiting for it.

use super::adapter::{AdapterSummary, Found};
use super::layout::{TEXTURE_BITS, group_layout};
use super::shader::Shader;
use crate::error::{Error, Result};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use wgpu::util::DeviceExt;
use wgpu::{Buffer, BufferUsages, Device, Limits, Queue};

/// A dispatch that takes longer has hung.
const PATIENCE: Duration = Duration::from_secs(120);

/// An open device.
pub struct OpenDevice {
    pub device: Device,
    pub queue: Queue,
    pub summary: AdapterSummary,
    /// What wgpu complained of outside of error scopes.
    complaint: Arc<Mutex<Option<String>>>,
}

impl OpenDevice {
    /// Open an adapter, with default limits and no optional feature.
    pub fn open(Found { adapter, summary }: &Found) -> Result<OpenDevice> {
        let descriptor = wgpu::DeviceDescriptor { required_limits: Limits::default(), ..Default::default() };
        let opened = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) = opened.map_err(|error| Error::Device {
            needed: "the gpu engine needs a device with default limits".into(),
            found: format!("{} gives none: {error}", summary.name),
        })?;
        let complaint = Arc::new(Mutex::new(None));
        let place = Arc::clone(&complaint);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let Ok(mut place) = place.lock() {
                place.get_or_insert_with(|| error.to_string());
            }
        }));
        Ok(OpenDevice { device, queue, summary: summary.clone(), complaint })
    }

    /// A zeroed buffer; its size is checked against the limits first.
    pub fn buffer(&self, label: &str, bytes: u64, usage: BufferUsages) -> Result<Buffer> {
        let limits = self.device.limits();
        let most = if usage.contains(BufferUsages::STORAGE) {
            limits.max_storage_buffer_binding_size
        } else {
            limits.max_buffer_size
        };
        if bytes > most {
            return Err(Error::Device {
                needed: format!("the buffer `{label}` needs {bytes} bytes"),
                found: format!("{} allows {most}", self.summary.name),
            });
        }
        let descriptor =
            wgpu::BufferDescriptor { label: Some(label), size: bytes.max(16), usage, mapped_at_creation: false };
        Ok(self.device.create_buffer(&descriptor))
    }

    /// A table of vectors as a texture of 2ᵏ columns; its size is checked against the limits first.
    pub fn texture(&self, label: &str, entries: &[[u32; 4]]) -> Result<wgpu::TextureView> {
        let width = 1u32 << TEXTURE_BITS;
        let height = entries.len().div_ceil(width as usize).max(1);
        let most = self.device.limits().max_texture_dimension_2d;
        if height > most as usize {
            return Err(Error::Device {
                needed: format!("the table `{label}` needs {} vectors", entries.len()),
                found: format!("{} allows {}", self.summary.name, u64::from(most) * u64::from(width)),
            });
        }
        let mut texels = entries.to_vec();
        texels.resize(height * width as usize, [0; 4]);
        let descriptor = wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width, height: height as u32, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Uint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        };
        let order = wgpu::util::TextureDataOrder::LayerMajor;
        let bytes = bytemuck::cast_slice(&texels);
        let texture = self.device.create_texture_with_data(&self.queue, &descriptor, order, bytes);
        Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
    }

    /// A pipeline of one entry point; overrides by name, booleans as 0 and 1.
    pub fn pipeline(
        &self,
        shader: &Shader,
        entry: &str,
        groups: &[u32],
        overrides: &[(&str, f64)],
    ) -> Result<wgpu::ComputePipeline> {
        shader.check()?;
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let source = wgpu::ShaderSource::Wgsl(shader.text().into());
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(entry), source });
        // Each group has the place of its number.
        let places = groups.iter().max().map_or(0, |most| most + 1);
        let group = |place| groups.contains(&place).then(|| group_layout(&self.device, place));
        let layouts: Vec<_> = (0..places).map(group).collect();
        let layouts: Vec<_> = layouts.iter().map(Option::as_ref).collect();
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(entry),
            bind_group_layouts: &layouts,
            immediate_size: 0,
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions { constants: overrides, ..Default::default() },
            cache: None,
        });
        match pollster::block_on(scope.pop()) {
            None => Ok(pipeline),
            Some(error) => Err(self.fault(&format!("the kernel `{entry}` does not compile: {error}"))),
        }
    }

    /// Submit commands, wait for them, and read the words of a staging buffer.
    pub fn submit_and_read(&self, encoder: wgpu::CommandEncoder, staging: &Buffer, words: usize) -> Result<Vec<u32>> {
        let index = self.queue.submit([encoder.finish()]);
        self.complain()?;
        let slice = staging.slice(..(words * 4) as u64);
        slice.map_async(wgpu::MapMode::Read, |_| {});
        let wait = wgpu::PollType::Wait { submission_index: Some(index), timeout: Some(PATIENCE) };
        let waited = self.device.poll(wait);
        self.complain()?;
        waited.map_err(|error| self.fault(&format!("a dispatch did not come to an end: {error}")))?;
        let view = slice.get_mapped_range().map_err(|error| self.fault(&format!("results cannot be read: {error}")))?;
        let result =
            view.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect();
        drop(view);
        staging.unmap();
        Ok(result)
    }

    /// Give what wgpu has complained of, once.
    fn complain(&self) -> Result<()> {
        match self.complaint.lock().ok().and_then(|mut place| place.take()) {
            Some(complaint) => Err(self.fault(&complaint)),
            None => Ok(()),
        }
    }

    /// A fault of the device.
    pub fn fault(&self, message: &str) -> Error {
        Error::Device {
            needed: "the gpu engine needs a device that works".into(),
            found: format!("{} failed: {message}", self.summary.description),
        }
    }
}
