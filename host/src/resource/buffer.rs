// SPDX-License-Identifier: MIT OR Apache-2.0
//! Buffers.

use super::map;
use crate::gpu::{Gpu, GpuError};
use crate::pass::watch::Held;
use encase::ShaderType;
use encase::internal::WriteInto;

/// A buffer. Clones are the same buffer.
#[derive(Clone)]
pub struct Buffer {
    /// The buffer itself.
    pub raw: wgpu::Buffer,
}

impl Buffer {
    /// A uniform buffer with the WGSL layout of `value`.
    pub fn uniform<T: ShaderType + WriteInto>(gpu: &Gpu, value: &T) -> Self {
        let mut bytes = encase::UniformBuffer::new(Vec::<u8>::new());
        // Writing to a growing vector cannot fail: the error is about fixed capacities.
        bytes.write(value).unwrap_or_default();
        Self::with_bytes(gpu, &bytes.into_inner(), wgpu::BufferUsages::UNIFORM)
    }

    /// A zeroed storage buffer of `size` bytes, which later passes may also bind as a uniform.
    pub fn storage(gpu: &Gpu, size: u64) -> Self {
        Self {
            raw: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: size.next_multiple_of(16).max(16),
                usage: Self::usages(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::UNIFORM),
                mapped_at_creation: false,
            }),
        }
    }

    /// A buffer with the given contents, padded with zeros to a multiple of 16 bytes.
    pub fn with_bytes(gpu: &Gpu, bytes: &[u8], usage: wgpu::BufferUsages) -> Self {
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().next_multiple_of(16).max(16), 0);
        let raw = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: padded.len() as u64,
            usage: Self::usages(usage),
            mapped_at_creation: false,
        });
        gpu.queue.write_buffer(&raw, 0, &padded);
        Self { raw }
    }

    fn usages(usage: wgpu::BufferUsages) -> wgpu::BufferUsages {
        usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC
    }

    /// A storage buffer of numbers.
    pub fn of_floats(gpu: &Gpu, values: &[f32]) -> Self {
        Self::with_bytes(gpu, &bytes_of(values), wgpu::BufferUsages::STORAGE)
    }

    /// Writes numbers from its beginning on.
    pub fn write_floats(&self, gpu: &Gpu, values: &[f32]) {
        gpu.queue.write_buffer(&self.raw, 0, &bytes_of(values));
    }

    /// Replaces the start of the contents by the WGSL layout of `value`.
    pub fn write<T: ShaderType + WriteInto>(&self, gpu: &Gpu, value: &T) {
        let mut bytes = encase::UniformBuffer::new(Vec::<u8>::new());
        bytes.write(value).unwrap_or_default();
        gpu.queue.write_buffer(&self.raw, 0, bytes.as_ref());
    }

    /// The contents.
    ///
    /// # Errors
    /// [`GpuError::Reading`], [`GpuError::Refused`].
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<u8>, GpuError> {
        let copy = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: self.raw.size(),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.encoder();
        encoder.copy_buffer_to_buffer(&self.raw, 0, &copy, 0, self.raw.size());
        gpu.submit(encoder)?;
        let contents = map(gpu, &copy)?;
        if let Some(watcher) = gpu.watcher() {
            watcher.read(Held::Buffer(self.clone()), &contents);
        }
        Ok(contents)
    }

    /// The contents as little-endian 32-bit words.
    ///
    /// # Errors
    /// As [`Buffer::read`].
    pub fn read_words(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let bytes = self.read(gpu)?;
        Ok(bytes
            .chunks_exact(4)
            .map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
            .collect())
    }

    /// The contents as 32-bit floats.
    ///
    /// # Errors
    /// As [`Buffer::read`].
    pub fn read_floats(&self, gpu: &Gpu) -> Result<Vec<f32>, GpuError> {
        Ok(self.read_words(gpu)?.into_iter().map(f32::from_bits).collect())
    }
}

/// Bytes as buffers hold them.
fn bytes_of(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}
