// SPDX-License-Identifier: MIT OR Apache-2.0
//! Maps of volumes.

use super::{MapSettings, TransmittanceError, TransmittanceMap};
use crate::data::Volume;
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass};
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;
use glam::Mat4;

/// The uniform `VolumeSpace` of `transmittance/volume`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct VolumeSpace {
    /// World to the box 0..1.
    pub unit_from_world: Mat4,
    /// Its inverse.
    pub world_from_unit: Mat4,
    /// From values to 1/m.
    pub extinction_scale: f32,
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
    reading: Reading,
}

impl VolumeTexture {
    /// Uploads a volume. `scale`: from its values to extinction in 1/m.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn new(gpu: &Gpu, volume: &Volume, scale: f32, reading: Reading) -> Result<Self, TransmittanceError> {
        let limit = gpu.limits.max_texture_dimension_3d;
        if volume.size.iter().any(|side| *side == 0 || *side > limit) {
            return Err(TransmittanceError::Size { what: "a volume", size: volume.size.to_vec(), limit });
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
            extinction_scale: scale,
            step_length: volume.voxel(),
            reserved_a: 0.0,
            reserved_b: 0.0,
        };
        Ok(Self { texture, space: Buffer::uniform(gpu, &space), reading })
    }

    pub(super) fn check(&self, reading: Reading) -> Result<(), TransmittanceError> {
        if reading == Reading::Linear && self.reading == Reading::Nearest {
            return Err(crate::gpu::GpuError::Refused(
                "r32float does not filter: upload the volume for `Reading::Linear`".to_owned(),
            )
            .into());
        }
        Ok(())
    }
}

/// Builds maps of volumes by a march along each light ray.
pub struct Voxels {
    pass: Pass,
    settings: MapSettings,
    sampler: Sampler,
    reading: Reading,
}

impl Voxels {
    /// Builds the pass.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        settings: MapSettings,
        reading: Reading,
    ) -> Result<Self, TransmittanceError> {
        settings.check(gpu)?;
        let mut definitions = settings.building_definitions();
        if reading == Reading::Linear {
            definitions = definitions.flag("LINEAR");
        }
        let pass = Pass::compute_with(gpu, shaders, "transmittance/voxels", &definitions)?;
        Ok(Self { pass, settings, sampler: Sampler::linear(gpu), reading })
    }

    /// Binds a map and a volume that was uploaded for the same kind of reading.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn bind(
        &self,
        gpu: &Gpu,
        map: &TransmittanceMap,
        volume: &VolumeTexture,
    ) -> Result<Bound, TransmittanceError> {
        map.check(self.settings)?;
        volume.check(self.reading)?;
        let mut resources = map.resources();
        resources.extend([
            ("volume", (&volume.space).into()),
            ("extinction", (&volume.texture).into()),
            ("volume_sampler", (&self.sampler).into()),
        ]);
        Ok(self.pass.bind_known(gpu, &resources)?)
    }

    /// Records the march of every texel.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound) {
        let [width, height] = self.settings.size;
        self.pass.dispatch(encoder, bound, [width, height, 1]);
    }
}
