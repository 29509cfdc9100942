// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes whose surfaces are seen.

use super::PainterlyError;
use crate::core::VolumeTextureError;
use crate::data::{Volume, value_range};
use crate::gpu::Gpu;
use crate::resource::Texture;
use glam::Mat4;

/// A volume on the GPU, r16float.
pub struct IsoVolume {
    /// Texels: value 0..1 is a texel times `scale` plus `offset`.
    pub texture: Texture,
    /// From texels to values 0..1.
    pub scale: f32,
    /// Value of texel 0.
    pub offset: f32,
    /// Voxels along x, y and z.
    pub size: [u32; 3],
    /// Where the volume's file puts it: the box 0..1 to the world, metres.
    pub world_from_unit: Mat4,
}

impl IsoVolume {
    /// Uploads a volume. `range`: what becomes value 0 and value 1; without one the least and the greatest finite number of
    /// the volume. What is not finite counts as value 0, and what lies beyond the range as its end.
    ///
    /// Half floats are finest about 0, so that texels are centred: 8-bit volumes lose nothing.
    ///
    /// # Errors
    /// [`PainterlyError::Volume`] for a side of no voxels or of more than a 3D texture has, [`PainterlyError::Range`].
    pub fn new(gpu: &Gpu, volume: &Volume, range: Option<[f32; 2]>) -> Result<Self, PainterlyError> {
        let limit = gpu.limits.max_texture_dimension_3d;
        if volume.size.iter().any(|side| *side == 0 || *side > limit) {
            return Err(VolumeTextureError::Size { size: volume.size, limit }.into());
        }
        let [low, high] = range.unwrap_or_else(|| value_range(&volume.values)).map(f64::from);
        if !(low.is_finite() && high.is_finite() && high > low) {
            return Err(PainterlyError::Range(low as f32, high as f32));
        }
        let middle = 0.5 * (low + high);
        // A power of two: whole numbers stay exact.
        let unit = (0.5 * (high - low)).log2().ceil().exp2();
        let texels: Vec<f32> = volume
            .values
            .iter()
            .map(|value| {
                let value = if value.is_finite() { f64::from(*value).clamp(low, high) } else { low };
                ((value - middle) / unit) as f32
            })
            .collect();
        let texture = Texture::volume(gpu, volume.size, wgpu::TextureFormat::R16Float);
        texture.write(gpu, &texels)?;
        let scale = (unit / (high - low)) as f32;
        let (size, world_from_unit) = (volume.size, volume.world_from_unit);
        Ok(Self { texture, scale, offset: 0.5, size, world_from_unit })
    }

    /// The shortest side of a voxel in metres where the volume lies by `world_from_unit`.
    pub fn voxel(&self, world_from_unit: Mat4) -> f32 {
        let sides = [world_from_unit.x_axis, world_from_unit.y_axis, world_from_unit.z_axis];
        let voxel = |axis: usize| sides[axis].truncate().length() / self.size[axis] as f32;
        voxel(0).min(voxel(1)).min(voxel(2))
    }
}
