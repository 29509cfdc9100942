// SPDX-License-Identifier: MIT OR Apache-2.0
//! Maps of volumes.

use super::{MapSettings, TransmittanceError, TransmittanceMap};
use crate::core::{Reading, VolumeTexture};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass};
use crate::resource::Sampler;
use crate::shaders::Shaders;

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
            ("brick_distances", (&volume.brick_distances).into()),
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
