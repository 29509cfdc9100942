// SPDX-License-Identifier: MIT OR Apache-2.0
//! Maps of particles by blending.

use super::{Form, MapSettings, ParticleBuffer, Precision, TransmittanceError, TransmittanceMap};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, RenderStages};
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
        let views: Vec<_> = (0..self.settings.layers()).map(|layer| map.coefficients.layer(layer)).collect();
        let ops = wgpu::Operations {
            load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
            store: wgpu::StoreOp::Store,
        };
        let attachments: Vec<_> = views
            .iter()
            .map(|view| {
                Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
            })
            .collect();
        let mut render = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("transmittance/splat"),
            color_attachments: &attachments,
            ..Default::default()
        });
        self.pass.set(&mut render, bound);
        render.draw(0..6, 0..particles.count);
    }
}
