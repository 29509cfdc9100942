// SPDX-License-Identifier: MIT OR Apache-2.0
//! The passes: background, map, medium, and one over the other.

use super::flags::{Options, SplatSpelling};
use super::framing::Framing;
use super::medium::{Matter, Medium, described};
use crate::command::CommandError;
use crate::command::scattering::Buffers;
use crate::command::sky::behind;
use crate::core::{Bricks, VolumeTexture};
use crate::data::{Particles, Volume};
use crate::formats::{Array, ArrayData};
use crate::scattering::check_size;
use crate::transmittance::{
    CheckParticles, Composite, MapSettings, MediumView, ParticleBuffer, ParticleCounts, ParticlePicture,
    Splat, SplatFixed, TransmittanceMap, VolumePicture, Voxels,
};
use crate::{Buffer, Gpu, Shaders, Texture};

/// What was drawn.
pub struct Drawn {
    /// The medium over its background.
    pub composed: Texture,
    /// The picture, and all that was on the way to it.
    pub buffers: Buffers,
    /// What is to be said of it, a line each.
    pub report: Vec<String>,
}

/// Draws.
///
/// # Errors
/// Misuse and failures of all kinds.
pub fn draw(
    (gpu, shaders): (&Gpu, &Shaders),
    flags: &Options,
    medium: &Medium,
    framing: &Framing,
) -> Result<Drawn, CommandError> {
    check_size(gpu, "a picture", flags.size)?;
    let studio = Studio { gpu, shaders, flags, framing };
    let behind = behind((gpu, shaders), &framing.camera, &framing.light, flags.background)?;
    let [camera, lighting] = [Buffer::uniform(gpu, &framing.camera), Buffer::uniform(gpu, &framing.lighting)];
    let view = MediumView { camera: &camera, lighting: &lighting, depth: &behind.depth };
    let mut buffers = Buffers::default();
    let (picture, report) = match &medium.matter {
        Matter::Volume(volume, scale) => (studio.volume(&view, volume, *scale, &mut buffers)?, Vec::new()),
        Matter::Particles(particles, dropped) => studio.particles(&view, particles, dropped, &mut buffers)?,
    };
    let composed = Composite::new(gpu, shaders)?.run(gpu, &behind.surface, &picture)?;
    // Memory that ran out is said here.
    gpu.check()?;
    if flags.buffers.is_some() {
        buffers.texture(gpu, "background", &behind.surface)?;
        buffers.texture(gpu, "medium", &picture)?;
        buffers.texture(gpu, "composed", &composed)?;
    }
    Ok(Drawn { composed, buffers, report })
}

struct Studio<'a> {
    gpu: &'a Gpu,
    shaders: &'a Shaders,
    flags: &'a Options,
    framing: &'a Framing,
}

impl Studio<'_> {
    fn volume(
        &self,
        view: &MediumView<'_>,
        volume: &Volume,
        scale: f32,
        buffers: &mut Buffers,
    ) -> Result<Texture, CommandError> {
        let Self { gpu, shaders, flags, framing } = *self;
        let reading = flags.reading();
        let mut uploaded = VolumeTexture::new(gpu, volume, scale, reading)?;
        Bricks::new(gpu, shaders)?.give(gpu, &mut uploaded)?;
        let mut encoder = gpu.encoder();
        let bound = if let Some(settings) = flags.settings() {
            let map = TransmittanceMap::new(gpu, settings, &framing.light)?;
            let voxels = Voxels::new(gpu, shaders, settings, reading)?;
            voxels.record(&mut encoder, &voxels.bind(gpu, &map, &uploaded)?);
            let pass = VolumePicture::new(gpu, shaders, settings, flags.monotone, reading)?;
            let bound = pass.bind(gpu, view, &map, &uploaded)?;
            pass.record(&mut encoder, &bound);
            gpu.submit(encoder)?;
            self.map(&map, buffers)?;
            bound
        } else {
            let light = Buffer::uniform(gpu, &framing.light);
            let pass = VolumePicture::reference(gpu, shaders, reading)?;
            let bound = pass.bind_reference(gpu, view, &light, &uploaded)?;
            pass.record(&mut encoder, &bound);
            gpu.submit(encoder)?;
            bound
        };
        Ok(bound.picture)
    }

    fn particles(
        &self,
        view: &MediumView<'_>,
        particles: &Particles,
        dropped: &ParticleCounts,
        buffers: &mut Buffers,
    ) -> Result<(Texture, Vec<String>), CommandError> {
        let Self { gpu, shaders, flags, framing } = *self;
        let uploaded = ParticleBuffer::new(gpu, particles)?;
        let mut encoder = gpu.encoder();
        let check = CheckParticles::new(gpu, shaders)?;
        let bound = if let Some(settings) = flags.settings() {
            let map = TransmittanceMap::new(gpu, settings, &framing.light)?;
            check.record(&mut encoder, &check.bind(gpu, &map, &uploaded)?, &uploaded)?;
            self.splat(&mut encoder, settings, &map, &uploaded)?;
            let pass = ParticlePicture::new(gpu, shaders, settings, flags.monotone)?;
            let bound = pass.bind(gpu, view, &map, &uploaded)?;
            pass.record(gpu, &mut encoder, &bound)?;
            gpu.submit(encoder)?;
            self.map(&map, buffers)?;
            bound
        } else {
            let light = Buffer::uniform(gpu, &framing.light);
            let checked = check.bind_light(gpu, &light, ParticlePicture::REFERENCE_SIZE, &uploaded)?;
            check.record(&mut encoder, &checked, &uploaded)?;
            let pass = ParticlePicture::reference(gpu, shaders)?;
            let bound = pass.bind_reference(gpu, view, &light, &uploaded)?;
            pass.record(gpu, &mut encoder, &bound)?;
            gpu.submit(encoder)?;
            bound
        };
        let mut counts = uploaded.read_counts(gpu)?;
        if counts.overflows > 0 {
            return Err(CommandError::failure(format!(
                "--particles: {} sums of the map overflowed: give a smaller --extinction-scale",
                counts.overflows
            )));
        }
        counts.not_finite += dropped.not_finite;
        counts.radius += dropped.radius;
        counts.extinction += dropped.extinction;
        counts.outside += dropped.outside;
        if flags.buffers.is_some() {
            let mut lit = bound.transmittances.read_floats(gpu)?;
            lit.truncate(particles.list.len());
            let mut order = bound.order.read_words(gpu)?;
            order.truncate(particles.list.len());
            let shape = vec![lit.len()];
            buffers.array("transmittances", Array { shape: shape.clone(), data: ArrayData::F32(lit) });
            buffers.array("order", Array { shape, data: ArrayData::U32(order) });
        }
        let all = counts.kept + counts.dropped();
        let report = format!("particles: {} of {all}; {}", counts.kept, described(&counts));
        Ok((bound.picture, vec![report]))
    }

    fn splat(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        settings: MapSettings,
        map: &TransmittanceMap,
        particles: &ParticleBuffer,
    ) -> Result<(), CommandError> {
        let Self { gpu, shaders, flags, .. } = *self;
        if flags.splat == Some(SplatSpelling::Blend) {
            let splat = Splat::new(gpu, shaders, settings)?;
            splat.record(encoder, &splat.bind(gpu, map, particles)?, map, particles);
        } else {
            let splat = SplatFixed::new(gpu, shaders, settings)?;
            splat.record(encoder, &splat.bind(gpu, map, particles)?)?;
        }
        Ok(())
    }

    fn map(&self, map: &TransmittanceMap, buffers: &mut Buffers) -> Result<(), CommandError> {
        if self.flags.buffers.is_none() {
            return Ok(());
        }
        buffers.texture(self.gpu, "coefficients", &map.coefficients)?;
        match &map.intervals {
            Some(intervals) => buffers.texture(self.gpu, "intervals", intervals),
            None => Ok(()),
        }
    }
}
