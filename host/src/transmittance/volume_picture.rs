// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of volumes.

use super::{MapSettings, MediumView, TransmittanceError, TransmittanceMap};
use crate::core::{Reading, VolumeTexture};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, Resource};
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;

/// Marches view rays through a volume that is lit through a map, or by a march to the light from every step.
pub struct VolumePicture {
    pass: Pass,
    settings: Option<MapSettings>,
    sampler: Sampler,
    reading: Reading,
}

/// What a volume is seen with, bound.
pub struct VolumePictureBound {
    bound: Bound,
    /// Premultiplied linear RGB radiance, and in alpha the transmittance to the background; rgba16float.
    pub picture: Texture,
}

impl VolumePicture {
    /// Builds the pass for maps of `settings`. `monotone`: extinction maps with the Fejér window.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        settings: MapSettings,
        monotone: bool,
        reading: Reading,
    ) -> Result<Self, TransmittanceError> {
        settings.check(gpu)?;
        let definitions = settings.lighting_definitions(monotone);
        Self::with(gpu, shaders, Some(settings), definitions, reading)
    }

    /// Builds the pass without a map: the reference, which marches to the light by steps of a voxel.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn reference(gpu: &Gpu, shaders: &Shaders, reading: Reading) -> Result<Self, TransmittanceError> {
        Self::with(gpu, shaders, None, Definitions::new().flag("REFERENCE"), reading)
    }

    fn with(
        gpu: &Gpu,
        shaders: &Shaders,
        settings: Option<MapSettings>,
        mut definitions: Definitions,
        reading: Reading,
    ) -> Result<Self, TransmittanceError> {
        if reading == Reading::Linear {
            definitions = definitions.flag("LINEAR");
        }
        let pass = Pass::picture(
            gpu,
            shaders,
            "transmittance/march_volume",
            &definitions,
            "fragment_march_volume",
            wgpu::TextureFormat::Rgba16Float,
        )?;
        Ok(Self { pass, settings, sampler: Sampler::linear(gpu), reading })
    }

    /// Binds a map of the volume, and the volume, uploaded for the same kind of reading.
    ///
    /// # Errors
    /// [`TransmittanceError`], also for a pass that was built as the reference.
    pub fn bind(
        &self,
        gpu: &Gpu,
        view: &MediumView<'_>,
        map: &TransmittanceMap,
        volume: &VolumeTexture,
    ) -> Result<VolumePictureBound, TransmittanceError> {
        map.check(self.settings.ok_or(TransmittanceError::Reference("takes no map"))?)?;
        self.bind_light(gpu, view, map.resources(), volume)
    }

    /// Binds the uniform of a directional light alone, for the reference.
    ///
    /// # Errors
    /// [`TransmittanceError`], also for a pass that was built for maps.
    pub fn bind_reference(
        &self,
        gpu: &Gpu,
        view: &MediumView<'_>,
        light: &Buffer,
        volume: &VolumeTexture,
    ) -> Result<VolumePictureBound, TransmittanceError> {
        if self.settings.is_some() {
            return Err(TransmittanceError::Reference("was not built: this pass takes a map"));
        }
        self.bind_light(gpu, view, vec![("light", light.into())], volume)
    }

    fn bind_light<'a>(
        &'a self,
        gpu: &Gpu,
        view: &MediumView<'a>,
        mut resources: Vec<(&'static str, Resource<'a>)>,
        volume: &'a VolumeTexture,
    ) -> Result<VolumePictureBound, TransmittanceError> {
        volume.check(self.reading)?;
        resources.extend([
            ("camera", view.camera.into()),
            ("lighting", view.lighting.into()),
            ("volume", (&volume.space).into()),
            ("extinction", (&volume.texture).into()),
            ("brick_distances", (&volume.brick_distances).into()),
            ("volume_sampler", (&self.sampler).into()),
            ("depth", view.depth.into()),
        ]);
        let bound = self.pass.bind_known(gpu, &resources)?;
        Ok(VolumePictureBound { bound, picture: view.picture(gpu) })
    }

    /// Records the march of every pixel.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &VolumePictureBound) {
        self.pass.fill(encoder, &bound.bound, &bound.picture);
    }
}
