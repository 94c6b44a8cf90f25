//! Tables as the shaders read them.

use super::layout::TEXTURE_BITS;
use crate::concentric::Patch;
use crate::distribution::direction_of;
use crate::goniometer::{Goniometer, Incidence};
use crate::tables::SamplingTables;
use wgpu::util::DeviceExt;

/// One vector an entry: the patch, or its middle direction when there is no jitter; w = alias and threshold.
pub fn direction_table(tables: &SamplingTables, jitter: bool) -> Vec<[u32; 4]> {
    let entry = |(patch, word): (&Patch, &u32)| {
        if jitter {
            let [x, y] = [patch.corner.x, patch.corner.y].map(|value| (value as f32).to_bits());
            [x, y, extents(patch, tables.patch_unit), *word]
        } else {
            let [x, y, z] = direction_of(patch.centre()).to_array().map(|value| (value as f32).to_bits());
            [x, y, z, *word]
        }
    };
    tables.patches.iter().zip(tables.alias.words()).map(entry).collect()
}

/// Both extents in units, 16 bits each.
fn extents(patch: &Patch, unit: f64) -> u32 {
    let units = |extent: f64| {
        let units = (extent / unit).round();
        assert!((extent - units * unit).abs() < 1e-9 && units < 65536.0, "extent {extent} is not a multiple of {unit}");
        units as u32
    };
    units(patch.extent.x) | units(patch.extent.y) << 16
}

/// One vector an incident cell: the corner on the square, or wi when directions are listed.
pub fn incident_table(goniometer: &Goniometer) -> Vec<[f32; 4]> {
    match &goniometer.incidence {
        Incidence::Listed(list) => list.iter().map(|wi| [wi.x as f32, wi.y as f32, wi.z as f32, 0.0]).collect(),
        Incidence::Disc(disc) => {
            let corner = |cell| disc.patch(cell).corner;
            (0..disc.cells()).map(corner).map(|c| [c.x as f32, c.y as f32, 0.0, 0.0]).collect()
        }
    }
}

/// The direction table as a texture.
pub fn texture(device: &wgpu::Device, queue: &wgpu::Queue, entries: &[[u32; 4]]) -> wgpu::TextureView {
    let width = 1u32 << TEXTURE_BITS;
    let height = (entries.len() as u32).div_ceil(width).max(1);
    let mut texels = entries.to_vec();
    texels.resize((width * height) as usize, [0; 4]);
    let descriptor = wgpu::TextureDescriptor {
        label: Some("table_texture"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Uint,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    let texture = device.create_texture_with_data(queue, &descriptor, order, bytemuck::cast_slice(&texels));
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
