// SPDX-License-Identifier: MIT OR Apache-2.0
//! Buffers, textures and samplers that know enough of themselves to be bound by name and read back.

mod buffer;
mod sampler;
mod texels;
mod texture;

pub use buffer::Buffer;
pub use sampler::Sampler;
pub use texture::{Part, Texture};

use crate::gpu::{Gpu, GpuError};

/// The contents of a buffer that was made to be mapped.
fn map(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // A closed channel means that the reader is gone already.
        let _ = sender.send(result);
    });
    gpu.wait()?;
    let reading = |message: String| GpuError::Reading(message);
    receiver
        .recv()
        .map_err(|error| reading(error.to_string()))?
        .map_err(|error| reading(error.to_string()))?;
    let view = buffer.get_mapped_range(..).map_err(|error| reading(error.to_string()))?;
    Ok(view.to_vec())
}
