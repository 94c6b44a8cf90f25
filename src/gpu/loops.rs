//! Whether a driver ends the loops of a shader early, as lavapipe of Mesa 22.3 does after 65,535 passes of all loops.

use super::buffers::bind;
use super::device::OpenDevice;
use super::shader::Shader;
use crate::error::Result;
use wgpu::BufferUsages;

/// Passes of the trial: somewhat more than 2¹⁶, a millisecond on any device.
const PASSES: u32 = 70_000;

/// Passes after which the driver ends a loop; none where a loop of 70,000 comes to its end.
///
/// # Errors
/// [`Error::Device`](crate::Error::Device) when the device fails.
pub fn most_passes(device: &OpenDevice) -> Result<Option<u32>> {
    let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
    let words = device.buffer("loop_words", 16, storage)?;
    let staging = device.buffer("staging", 16, BufferUsages::MAP_READ | BufferUsages::COPY_DST)?;
    device.queue.write_buffer(&words, 0, bytemuck::cast_slice(&[PASSES, 0, 0, 0]));
    let pipeline = device.pipeline(&Shader::loops(), "loops", &[2], &[])?;
    let group = bind(device, 2, [words.as_entire_binding()]);
    let mut encoder = device.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(2, &group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&words, 0, &staging, 0, 16);
    let words = device.submit_and_read(encoder, &staging, 4)?;
    Ok(judge(words[1], words[2]))
}

/// Judge a loop by what it counted, and by the number that it made.
fn judge(made: u32, number: u32) -> Option<u32> {
    (made != PASSES || number != xorshift(PASSES)).then_some(made.min(PASSES))
}

fn xorshift(passes: u32) -> u32 {
    (0..passes).fold(1u32, |number, _| {
        let number = number ^ number << 13;
        let number = number ^ number >> 17;
        number ^ number << 5
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_that_was_ended_early_is_told_from_one_that_was_not() {
        assert_eq!(judge(PASSES, xorshift(PASSES)), None);
        assert_eq!(judge(65_535, xorshift(65_535)), Some(65_535));
        assert_eq!(judge(PASSES, xorshift(65_535)), Some(PASSES));
        assert_eq!(judge(0, 0), Some(0));
    }
}
