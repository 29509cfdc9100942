// SPDX-License-Identifier: MIT OR Apache-2.0
//! Textures.

use super::map;
use super::texels::{decode, encode};
use crate::gpu::{Gpu, GpuError};
use crate::pass::watch::Held;

/// The part of a texture that a view shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// First level and how many.
    pub levels: [u32; 2],
    /// First layer and how many.
    pub layers: [u32; 2],
}

/// A 2D texture, an array of them or a 3D texture, with one view of the whole. Clones are the same texture.
#[derive(Clone)]
pub struct Texture {
    /// The texture itself.
    pub raw: wgpu::Texture,
    /// A view of all layers.
    pub view: wgpu::TextureView,
    /// How `view` presents it.
    pub dimension: wgpu::TextureViewDimension,
    /// What `view` shows.
    pub part: Part,
}

impl Texture {
    /// A texture of one layer.
    pub fn new(gpu: &Gpu, size: [u32; 2], format: wgpu::TextureFormat, usage: wgpu::TextureUsages) -> Self {
        Self::create(gpu, [size[0], size[1], 1], format, usage, wgpu::TextureViewDimension::D2)
    }

    /// An array of `size[2]` layers, also where that is one.
    pub fn array(gpu: &Gpu, size: [u32; 3], format: wgpu::TextureFormat, usage: wgpu::TextureUsages) -> Self {
        Self::create(gpu, size, format, usage, wgpu::TextureViewDimension::D2Array)
    }

    /// What most passes write: a storage texture that the next pass reads, of one layer.
    pub fn storage(gpu: &Gpu, size: [u32; 2], format: wgpu::TextureFormat) -> Self {
        Self::new(
            gpu,
            size,
            format,
            wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
        )
    }

    /// A render target that later passes read, of one layer.
    pub fn target(gpu: &Gpu, size: [u32; 2], format: wgpu::TextureFormat) -> Self {
        Self::new(
            gpu,
            size,
            format,
            wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        )
    }

    /// An array of render targets that later passes read, of `size[2]` layers, also where that is one.
    pub fn target_array(gpu: &Gpu, size: [u32; 3], format: wgpu::TextureFormat) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        Self::array(gpu, size, format, usage)
    }

    /// A render target of `samples` samples a pixel, 1 or 4, that later passes read. With 4 it cannot be read back.
    pub fn multisampled(gpu: &Gpu, size: [u32; 2], format: wgpu::TextureFormat, samples: u32) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        Self::create_sampled(
            gpu,
            [size[0], size[1], 1],
            format,
            usage,
            wgpu::TextureViewDimension::D2,
            samples,
        )
    }

    /// Like [`Texture::storage`] with `levels` levels, each half as wide and high as the one before.
    pub(crate) fn storage_levels(
        gpu: &Gpu,
        size: [u32; 2],
        format: wgpu::TextureFormat,
        levels: u32,
    ) -> Self {
        let raw = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Self::whole(raw, wgpu::TextureViewDimension::D2)
    }

    /// A texture of the caller's with a view of all of it.
    pub fn whole(raw: wgpu::Texture, dimension: wgpu::TextureViewDimension) -> Self {
        let layers = match dimension {
            wgpu::TextureViewDimension::D3 => 1,
            _ => raw.depth_or_array_layers(),
        };
        let part = Part { levels: [0, raw.mip_level_count()], layers: [0, layers] };
        Self::of_part(raw, dimension, part)
    }

    fn of_part(raw: wgpu::Texture, dimension: wgpu::TextureViewDimension, part: Part) -> Self {
        let view = raw.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(dimension),
            base_mip_level: part.levels[0],
            mip_level_count: Some(part.levels[1]),
            base_array_layer: part.layers[0],
            array_layer_count: Some(part.layers[1]),
            ..Default::default()
        });
        Self { raw, view, dimension, part }
    }

    /// One level, to be bound where a pass takes a single one. Its size is still that of the whole.
    pub(crate) fn of_level(&self, level: u32) -> Self {
        Self::of_part(self.raw.clone(), self.dimension, Part { levels: [level, 1], ..self.part })
    }

    /// A 3D texture that passes read.
    pub fn volume(gpu: &Gpu, size: [u32; 3], format: wgpu::TextureFormat) -> Self {
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        Self::create(gpu, size, format, usage, wgpu::TextureViewDimension::D3)
    }

    /// A 3D texture that passes write as storage and read.
    pub fn storage_volume(gpu: &Gpu, size: [u32; 3], format: wgpu::TextureFormat) -> Self {
        let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING;
        Self::create(gpu, size, format, usage, wgpu::TextureViewDimension::D3)
    }

    /// One layer, to be drawn into or bound where a pass takes a single texture. Read back it is still the whole array.
    pub fn of_layer(&self, layer: u32) -> Self {
        let part = Part { layers: [layer, 1], ..self.part };
        Self::of_part(self.raw.clone(), wgpu::TextureViewDimension::D2, part)
    }

    fn create(
        gpu: &Gpu,
        size: [u32; 3],
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
        dimension: wgpu::TextureViewDimension,
    ) -> Self {
        Self::create_sampled(gpu, size, format, usage, dimension, 1)
    }

    fn create_sampled(
        gpu: &Gpu,
        size: [u32; 3],
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
        dimension: wgpu::TextureViewDimension,
        samples: u32,
    ) -> Self {
        let copies = if format.is_depth_stencil_format() {
            wgpu::TextureUsages::COPY_SRC
        } else {
            wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST
        };
        let raw = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: size[2] },
            mip_level_count: 1,
            sample_count: samples,
            dimension: if dimension == wgpu::TextureViewDimension::D3 {
                wgpu::TextureDimension::D3
            } else {
                wgpu::TextureDimension::D2
            },
            format,
            usage: usage | copies,
            view_formats: &[],
        });
        Self::whole(raw, dimension)
    }

    /// Width, height, layers or depth.
    pub fn size(&self) -> [u32; 3] {
        [self.raw.width(), self.raw.height(), self.raw.depth_or_array_layers()]
    }

    /// Bytes of all texels.
    pub fn memory(&self) -> u64 {
        let [width, height, layers] = self.size().map(u64::from);
        width * height * layers * u64::from(self.raw.format().block_copy_size(None).unwrap_or(0))
    }

    /// Replaces all texels. `values`: row-major, layer by layer, all channels of a texel together, in the
    /// range of the format; floats are rounded to it.
    ///
    /// # Errors
    /// [`GpuError::Refused`] for a wrong number of values or a format that cannot be written.
    pub fn write(&self, gpu: &Gpu, values: &[f32]) -> Result<(), GpuError> {
        let format = self.raw.format();
        let [width, height, layers] = self.size();
        let channels = usize::from(format.components());
        let expected = width as usize * height as usize * layers as usize * channels;
        if values.len() != expected {
            return Err(GpuError::Refused(format!(
                "a texture of {expected} values was given {}",
                values.len()
            )));
        }
        let bytes = encode(format, values)?;
        gpu.queue.write_texture(
            self.raw.as_image_copy(),
            &bytes,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some((bytes.len() / (height as usize * layers as usize)) as u32),
                rows_per_image: Some(height),
            },
            self.raw.size(),
        );
        gpu.check()
    }

    /// All texels as floats, in the order that [`Texture::write`] takes.
    ///
    /// # Errors
    /// [`GpuError::Reading`], [`GpuError::Refused`].
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<f32>, GpuError> {
        let mut values = Vec::new();
        for row in self.read_rows(gpu)? {
            decode(self.raw.format(), &row, &mut values)?;
        }
        Ok(values)
    }

    /// All texels as little-endian 32-bit words, in the order of [`Texture::read`].
    ///
    /// # Errors
    /// As [`Texture::read`].
    pub fn read_words(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let word = |b: &[u8]| u32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        Ok(self.read_rows(gpu)?.iter().flat_map(|row| row.chunks_exact(4).map(word)).collect())
    }

    /// The bytes of each row.
    fn read_rows(&self, gpu: &Gpu) -> Result<Vec<Vec<u8>>, GpuError> {
        let format = self.raw.format();
        let [width, height, layers] = self.size();
        if self.raw.sample_count() > 1 {
            return Err(GpuError::Reading("a multisampled texture cannot be read".to_owned()));
        }
        let texel = format.block_copy_size(Some(wgpu::TextureAspect::All)).or(format.block_copy_size(None));
        let texel = texel.ok_or_else(|| GpuError::Reading(format!("{format:?} cannot be read")))?;
        let tight = width * texel;
        let padded = tight.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let rows = u64::from(height) * u64::from(layers);
        let copy = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(padded) * rows,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.encoder();
        encoder.copy_texture_to_buffer(
            self.raw.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &copy,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded),
                    rows_per_image: Some(height),
                },
            },
            self.raw.size(),
        );
        gpu.submit(encoder)?;
        let bytes = map(gpu, &copy)?;
        let rows: Vec<_> =
            bytes.chunks_exact(padded as usize).map(|row| row[..tight as usize].to_vec()).collect();
        if let Some(watcher) = gpu.watcher() {
            watcher.read(Held::Texture(self.clone()), &rows.concat());
        }
        Ok(rows)
    }
}
