// SPDX-License-Identifier: MIT OR Apache-2.0
//! Maps of particles by blending.

use super::{Form, MapSettings, ParticleBuffer, Precision, TransmittanceError, TransmittanceMap};
use crate::gpu::Gpu;
use crate::pass::{Bound, ColorTarget, Pass, Render, RenderStages};
use crate::shaders::Shaders;

/// Splats particles by additive blending, in any order: [`Form::Extinction`] and [`Form::Opacity`] in half floats.
pub struct Splat {
    pass: Pass,
    settings: MapSettings,
}

impl Splat {
    /// Builds the pass.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders, settings: MapSettings) -> Result<Self, TransmittanceError> {
        settings.check(gpu)?;
        if !matches!(settings.form, Form::Extinction | Form::Opacity) {
            return Err(TransmittanceError::Splat(
                settings.form,
                "by blending: take `SplatFixed`, or `Voxels`",
            ));
        }
        if settings.precision != Precision::Half {
            return Err(TransmittanceError::Blend(settings.precision));
        }
        // Blending does not ask for the format of the storage texture.
        let composed = shaders
            .compose_with("transmittance/splat", &settings.form_definitions())
            .map_err(crate::pass::PassError::from)?;
        let stages = RenderStages {
            vertex: "vertex_particle",
            fragment: Some("fragment_particle"),
            vertices: None,
            target: Some(settings.format()),
            depth: None,
            samples: 1,
        };
        let pass = Pass::additive(gpu, &composed, &stages, settings.layers() as usize)?;
        Ok(Self { pass, settings })
    }

    /// Binds a map and particles.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn bind(
        &self,
        gpu: &Gpu,
        map: &TransmittanceMap,
        particles: &ParticleBuffer,
    ) -> Result<Bound, TransmittanceError> {
        map.check(self.settings)?;
        map.check_particles()?;
        let splat = particles.target(gpu, self.settings.size);
        let resources = [
            ("light", (&map.light).into()),
            ("splat", (&splat).into()),
            ("particles", (&particles.particles).into()),
        ];
        Ok(self.pass.bind(gpu, &resources)?)
    }

    /// Records the splats into the map, which is cleared before.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        bound: &Bound,
        map: &TransmittanceMap,
        particles: &ParticleBuffer,
    ) {
        let color = |layer| ColorTarget::cleared(&map.coefficients.of_layer(layer), wgpu::Color::TRANSPARENT);
        let mut render = Render::new(encoder, (0..self.settings.layers()).map(color).collect(), None);
        render.set(&self.pass, bound);
        render.draw(0..6, 0..particles.count);
    }
}
