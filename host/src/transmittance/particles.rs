// SPDX-License-Identifier: MIT OR Apache-2.0
//! Particles on the GPU, and how many of them a map takes.

use super::{TransmittanceError, TransmittanceMap};
use crate::data::Particles;
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass};
use crate::resource::Buffer;
use crate::shaders::Shaders;
use encase::ShaderType;
use glam::Vec2;

/// The uniform `SplatTarget` of `transmittance/particles`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SplatTarget {
    /// Columns and rows of the map.
    pub size: Vec2,
    /// Number of particles.
    pub count: u32,
    /// Padding.
    pub reserved: u32,
}

/// How many particles a map took, and why it dropped the others.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ParticleCounts {
    /// Splatted.
    pub kept: u32,
    /// A number of theirs is NaN or infinite.
    pub not_finite: u32,
    /// Their radius is not positive, or greater than the range of the map.
    pub radius: u32,
    /// Their extinction is negative.
    pub extinction: u32,
    /// They lie outside of the map.
    pub outside: u32,
    /// Additions in fixed point that overflowed; [`super::SplatFixed`] only. The map is wrong unless this is 0.
    pub overflows: u32,
}

impl ParticleCounts {
    /// All that were dropped.
    pub fn dropped(&self) -> u32 {
        self.not_finite + self.radius + self.extinction + self.outside
    }
}

/// Particles on the GPU, with counts of what maps made of them.
pub struct ParticleBuffer {
    /// All of them.
    pub particles: Buffer,
    /// What [`CheckParticles`] and [`super::SplatFixed`] count.
    pub counts: Buffer,
    pub(super) count: u32,
}

impl ParticleBuffer {
    /// Uploads particles.
    ///
    /// # Errors
    /// [`TransmittanceError`] where they do not fit into a storage buffer.
    pub fn new(gpu: &Gpu, particles: &Particles) -> Result<Self, TransmittanceError> {
        let mut bytes = particles.bytes();
        let (needed, limit) = (bytes.len() as u64, gpu.limits.max_storage_buffer_binding_size);
        if needed > limit {
            return Err(crate::gpu::GpuError::Refused(format!(
                "{} particles take {needed} bytes and a storage buffer at most {limit}: splat them in parts",
                particles.list.len()
            ))
            .into());
        }
        // A binding holds one particle at least.
        bytes.resize(bytes.len().max(32), 0);
        Ok(Self {
            particles: Buffer::with_bytes(gpu, &bytes, wgpu::BufferUsages::STORAGE),
            counts: Buffer::storage(gpu, 32),
            count: particles.list.len() as u32,
        })
    }

    /// How many there are.
    pub fn len(&self) -> u32 {
        self.count
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// What was counted since the last check was recorded.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn read_counts(&self, gpu: &Gpu) -> Result<ParticleCounts, TransmittanceError> {
        let words = self.counts.read_words(gpu)?;
        let [kept, not_finite, radius, extinction, outside, overflows] =
            std::array::from_fn(|i| words.get(i).copied().unwrap_or(0));
        Ok(ParticleCounts { kept, not_finite, radius, extinction, outside, overflows })
    }

    pub(super) fn target(&self, gpu: &Gpu, size: [u32; 2]) -> Buffer {
        let size = Vec2::new(size[0] as f32, size[1] as f32);
        Buffer::uniform(gpu, &SplatTarget { size, count: self.count, reserved: 0 })
    }
}

/// Workgroups in two dimensions, at most 65535 in each, for `count` of them.
pub(super) fn groups(count: u32) -> [u32; 3] {
    let across = count.clamp(1, 65_535);
    [across, count.div_ceil(across).max(1), 1]
}

/// Counts what a map takes of particles and what it drops.
pub struct CheckParticles {
    pass: Pass,
}

impl CheckParticles {
    /// Builds the pass.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, TransmittanceError> {
        Ok(Self { pass: Pass::compute(gpu, shaders, "transmittance/check_particles", "default")? })
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
        map.check_particles()?;
        self.bind_light(gpu, &map.light, map.settings.size, particles)
    }

    /// Binds the uniform of a directional light and the size of a map that there need not be, and particles.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn bind_light(
        &self,
        gpu: &Gpu,
        light: &Buffer,
        size: [u32; 2],
        particles: &ParticleBuffer,
    ) -> Result<Bound, TransmittanceError> {
        let splat = particles.target(gpu, size);
        let resources = [
            ("light", light.into()),
            ("splat", (&splat).into()),
            ("particles", (&particles.particles).into()),
            ("counts", (&particles.counts).into()),
        ];
        Ok(self.pass.bind(gpu, &resources)?)
    }

    /// Records the count, from zero.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        bound: &Bound,
        particles: &ParticleBuffer,
    ) -> Result<(), TransmittanceError> {
        encoder.clear_buffer(&particles.counts.raw, 0, None);
        Ok(self.pass.dispatch_groups(
            encoder,
            bound,
            "count_particles",
            groups(particles.count.div_ceil(64)),
        )?)
    }
}
