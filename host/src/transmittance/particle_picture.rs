// SPDX-License-Identifier: MIT OR Apache-2.0
//! Pictures of particles.

use super::particles::groups;
use super::{MapSettings, MediumView, ParticleBuffer, TransmittanceError, TransmittanceMap};
use crate::core::Sort;
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, Render, RenderStages, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;

/// Radiance and transmittance of what is drawn before what is there.
const OVER: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::SrcAlpha,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::SrcAlpha,
        operation: wgpu::BlendOperation::Add,
    },
};

/// Lights particles through a map, or by the sum over all of them, sorts them back to front and blends them, all on the GPU.
pub struct ParticlePicture {
    light: Pass,
    sort: Sort,
    render: Pass,
    settings: Option<MapSettings>,
}

/// What particles are seen with, bound.
pub struct ParticlePictureBound {
    light: Bound,
    render: Bound,
    keys: Buffer,
    /// Numbers of particles, from the farthest to the nearest; those that are dropped last.
    pub order: Buffer,
    /// From the light to each particle, 0..1; -1 for what is dropped.
    pub transmittances: Buffer,
    /// Premultiplied linear RGB radiance, and in alpha the transmittance to the background; rgba16float.
    pub picture: Texture,
    count: u32,
}

impl ParticlePicture {
    /// Columns and rows by which the reference tells which particles lie outside: those that a fine map would drop.
    pub const REFERENCE_SIZE: [u32; 2] = [4096, 4096];

    /// Builds the passes for maps of `settings`. `monotone`: extinction maps with the Fejér window.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        settings: MapSettings,
        monotone: bool,
    ) -> Result<Self, TransmittanceError> {
        settings.check(gpu)?;
        let definitions = settings.lighting_definitions(monotone);
        Self::with(gpu, shaders, Some(settings), definitions)
    }

    /// Builds the passes without a map: the reference, which sums the optical depths of all particles towards the light for each.
    /// Its cost grows with the square of their number.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn reference(gpu: &Gpu, shaders: &Shaders) -> Result<Self, TransmittanceError> {
        Self::with(gpu, shaders, None, Definitions::new().flag("REFERENCE"))
    }

    fn with(
        gpu: &Gpu,
        shaders: &Shaders,
        settings: Option<MapSettings>,
        definitions: Definitions,
    ) -> Result<Self, TransmittanceError> {
        let light = Pass::compute_with(gpu, shaders, "transmittance/light_particles", &definitions)?;
        let composed = shaders
            .compose("transmittance/render_particles", "default")
            .map_err(crate::pass::PassError::from)?;
        let stages = RenderStages {
            vertex: "vertex_particle",
            fragment: Some("fragment_particle"),
            vertices: None,
            target: Some(wgpu::TextureFormat::Rgba16Float),
            depth: None,
            samples: 1,
        };
        let render = Pass::blended(gpu, &composed, &stages, OVER, 1)?;
        Ok(Self { light, sort: Sort::new(gpu, shaders)?, render, settings })
    }

    /// Binds a map of the particles, and the particles.
    ///
    /// # Errors
    /// [`TransmittanceError`], also for passes that were built as the reference.
    pub fn bind(
        &self,
        gpu: &Gpu,
        view: &MediumView<'_>,
        map: &TransmittanceMap,
        particles: &ParticleBuffer,
    ) -> Result<ParticlePictureBound, TransmittanceError> {
        map.check(self.settings.ok_or(TransmittanceError::Reference("takes no map"))?)?;
        map.check_particles()?;
        self.bind_light(gpu, view, (map.resources(), &map.light), map.settings.size, particles)
    }

    /// Binds the uniform of a directional light alone, fitted to the particles, for the reference.
    ///
    /// # Errors
    /// [`TransmittanceError`], also for passes that were built for maps.
    pub fn bind_reference(
        &self,
        gpu: &Gpu,
        view: &MediumView<'_>,
        light: &Buffer,
        particles: &ParticleBuffer,
    ) -> Result<ParticlePictureBound, TransmittanceError> {
        if self.settings.is_some() {
            return Err(TransmittanceError::Reference("was not built: this pass takes a map"));
        }
        self.bind_light(gpu, view, (vec![("light", light.into())], light), Self::REFERENCE_SIZE, particles)
    }

    fn bind_light<'a>(
        &'a self,
        gpu: &Gpu,
        view: &MediumView<'a>,
        (mut resources, of): (Vec<(&'static str, Resource<'a>)>, &'a Buffer),
        size: [u32; 2],
        particles: &'a ParticleBuffer,
    ) -> Result<ParticlePictureBound, TransmittanceError> {
        let splat = particles.target(gpu, size);
        let [keys, order, transmittances] =
            [0; 3].map(|_| Buffer::storage(gpu, 4 * u64::from(particles.count)));
        resources.extend([
            ("camera", view.camera.into()),
            ("splat", (&splat).into()),
            ("particles", (&particles.particles).into()),
            ("keys", (&keys).into()),
            ("order", (&order).into()),
            ("transmittances", (&transmittances).into()),
        ]);
        let light = self.light.bind_known(gpu, &resources)?;
        let resources = [
            ("camera", view.camera.into()),
            ("light", of.into()),
            ("lighting", view.lighting.into()),
            ("particles", (&particles.particles).into()),
            ("order", (&order).into()),
            ("transmittances", (&transmittances).into()),
            ("depth", view.depth.into()),
        ];
        let render = self.render.bind(gpu, &resources)?;
        let (picture, count) = (view.picture(gpu), particles.count);
        Ok(ParticlePictureBound { light, render, keys, order, transmittances, picture, count })
    }

    /// Records light, sort and picture.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        bound: &ParticlePictureBound,
    ) -> Result<(), TransmittanceError> {
        let invocations = groups(bound.count.div_ceil(64));
        self.light.dispatch_groups(encoder, &bound.light, "light_particles", invocations)?;
        if self.settings.is_none() {
            self.light.dispatch_groups(encoder, &bound.light, "sum_particles", invocations)?;
        }
        self.sort.record(gpu, encoder, [&bound.keys, &bound.order], bound.count, 32)?;
        let clear = wgpu::Color { r: 0.0, g: 0.0, b: 0.0, a: 1.0 };
        let mut render = Render::onto(encoder, &bound.picture, wgpu::LoadOp::Clear(clear));
        render.set(&self.render, &bound.render);
        render.draw(0..6, 0..bound.count);
        Ok(())
    }
}
