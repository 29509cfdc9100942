// SPDX-License-Identifier: MIT OR Apache-2.0
//! The textures of a map.

use super::{Form, MapSettings, TransmittanceError};
use crate::core::{DIRECTIONAL, Light};
use crate::gpu::Gpu;
use crate::pass::Resource;
use crate::resource::{Buffer, Sampler, Texture};

/// A transmittance map of a directional light, over the clip space of its shadow map.
pub struct TransmittanceMap {
    /// What it is.
    pub settings: MapSettings,
    /// The uniform of its light.
    pub light: Buffer,
    /// The layers.
    pub coefficients: Texture,
    /// Least and greatest occupied depth, 0..1, of each texel; of [`Form::Bounded`] only.
    pub intervals: Option<Texture>,
    sampler: Sampler,
    leaning: bool,
}

impl TransmittanceMap {
    /// A map without content.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn new(gpu: &Gpu, settings: MapSettings, light: &Light) -> Result<Self, TransmittanceError> {
        settings.check(gpu)?;
        let range = light.world_from_clip.z_axis.truncate().length();
        if light.kind != DIRECTIONAL || !(range > 0.0 && range.is_finite()) {
            return Err(TransmittanceError::Range(range));
        }
        let [width, height] = settings.size;
        let usage = wgpu::TextureUsages::STORAGE_BINDING
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::RENDER_ATTACHMENT;
        let coefficients = Texture::array(gpu, [width, height, settings.layers()], settings.format(), usage);
        let intervals = (settings.form == Form::Bounded)
            .then(|| Texture::storage(gpu, settings.size, wgpu::TextureFormat::Rg32Float));
        let across = [light.world_from_clip.x_axis, light.world_from_clip.y_axis];
        let along = |axis: glam::Vec4| axis.truncate().normalize_or_zero().dot(light.direction).abs();
        let leaning = across.into_iter().any(|axis| along(axis) > 1e-3);
        let (light, sampler) = (Buffer::uniform(gpu, light), Sampler::linear(gpu));
        Ok(Self { settings, light, coefficients, intervals, sampler, leaning })
    }

    /// What passes bind of it.
    pub fn resources(&self) -> Vec<(&'static str, Resource<'_>)> {
        let mut resources = vec![
            ("light", (&self.light).into()),
            ("coefficients", (&self.coefficients).into()),
            ("map_sampler", (&self.sampler).into()),
        ];
        if let Some(intervals) = &self.intervals {
            resources.push(("intervals", intervals.into()));
        }
        resources
    }

    /// Bytes of its textures.
    pub fn memory(&self) -> u64 {
        self.coefficients.memory() + self.intervals.as_ref().map_or(0, Texture::memory)
    }

    pub(super) fn check_particles(&self) -> Result<(), TransmittanceError> {
        if self.leaning { Err(TransmittanceError::Leaning) } else { Ok(()) }
    }

    pub(super) fn check(&self, expected: MapSettings) -> Result<(), TransmittanceError> {
        if self.settings == expected {
            return Ok(());
        }
        Err(TransmittanceError::OtherMap { given: Box::new(self.settings), expected: Box::new(expected) })
    }
}
