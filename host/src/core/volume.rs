// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes on the GPU.

use crate::data::Volume;
use crate::gpu::{Gpu, GpuError};
use crate::resource::{Buffer, Texture};
use encase::ShaderType;
use glam::Mat4;

/// Why a volume cannot be uploaded, or read in some way.
#[derive(Debug, thiserror::Error)]
pub enum VolumeTextureError {
    /// A side is zero, or longer than a 3D texture's may be.
    #[error(
        "a volume of {size:?} voxels is impossible: every side must lie between 1 and {limit} on this device"
    )]
    Size {
        /// Voxels along x, y and z.
        size: [u32; 3],
        /// The device's limit.
        limit: u32,
    },
    /// Trilinear reads of what was uploaded for nearest ones.
    #[error("r32float does not filter: upload the volume for `Reading::Linear`")]
    Filter,
    /// The device refused it.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// The uniform `VolumeSpace` of `core/volume`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct VolumeSpace {
    /// World to the box 0..1.
    pub unit_from_world: Mat4,
    /// Its inverse.
    pub world_from_unit: Mat4,
    /// What values are multiplied by.
    pub value_scale: f32,
    /// Metres from sample to sample at most.
    pub step_length: f32,
    /// Padding.
    pub reserved_a: f32,
    /// Padding.
    pub reserved_b: f32,
}

/// How values between voxels are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// The nearest voxel, r32float.
    Nearest,
    /// Trilinear, r16float.
    Linear,
}

/// A volume on the GPU.
pub struct VolumeTexture {
    /// Values.
    pub texture: Texture,
    /// Where it lies.
    pub space: Buffer,
    /// Distance of each brick to the nearest occupied one, in bricks, r32uint; a single 0 until [`super::Bricks::give`].
    pub brick_distances: Texture,
    reading: Reading,
}

impl VolumeTexture {
    /// Uploads a volume. `scale`: what its values are multiplied by, from values to extinction in 1/m, say.
    ///
    /// # Errors
    /// [`VolumeTextureError`].
    pub fn new(gpu: &Gpu, volume: &Volume, scale: f32, reading: Reading) -> Result<Self, VolumeTextureError> {
        let limit = gpu.limits.max_texture_dimension_3d;
        if volume.size.iter().any(|side| *side == 0 || *side > limit) {
            return Err(VolumeTextureError::Size { size: volume.size, limit });
        }
        let format = match reading {
            Reading::Nearest => wgpu::TextureFormat::R32Float,
            Reading::Linear => wgpu::TextureFormat::R16Float,
        };
        let texture = Texture::volume(gpu, volume.size, format);
        texture.write(gpu, &volume.values)?;
        let space = VolumeSpace {
            unit_from_world: volume.world_from_unit.as_dmat4().inverse().as_mat4(),
            world_from_unit: volume.world_from_unit,
            value_scale: scale,
            step_length: volume.voxel(),
            reserved_a: 0.0,
            reserved_b: 0.0,
        };
        // A new texture holds zeros.
        let brick_distances = Texture::volume(gpu, [1; 3], wgpu::TextureFormat::R32Uint);
        Ok(Self { texture, space: Buffer::uniform(gpu, &space), brick_distances, reading })
    }

    /// Whether it can be read so.
    ///
    /// # Errors
    /// [`VolumeTextureError::Filter`].
    pub fn check(&self, reading: Reading) -> Result<(), VolumeTextureError> {
        if reading == Reading::Linear && self.reading == Reading::Nearest {
            return Err(VolumeTextureError::Filter);
        }
        Ok(())
    }
}
