// SPDX-License-Identifier: MIT OR Apache-2.0
//! Maps of particles in fixed point.

use super::particles::groups;
use super::{Form, MapSettings, ParticleBuffer, TransmittanceError, TransmittanceMap};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass};
use crate::resource::Buffer;
use crate::shaders::Shaders;

/// Splats particles by adding whole numbers: the map does not depend on their order at all.
pub struct SplatFixed {
    pass: Pass,
    settings: MapSettings,
}

/// A map and particles, bound, with the sums.
pub struct SplatFixedBound {
    bound: Bound,
    sums: Buffer,
    bounds: Buffer,
    counts: wgpu::Buffer,
    count: u32,
}

impl SplatFixed {
    /// Builds the pass.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders, settings: MapSettings) -> Result<Self, TransmittanceError> {
        settings.check(gpu)?;
        if matches!(settings.form, Form::Function | Form::FunctionPeriodic) {
            let why = "since they hold transmittance, which does not add up: take another form, or `Voxels`";
            return Err(TransmittanceError::Splat(settings.form, why));
        }
        let bytes = Self::bytes(settings);
        let limit = gpu.limits.max_storage_buffer_binding_size;
        if bytes > limit {
            return Err(TransmittanceError::Sums { bytes, limit });
        }
        let pass =
            Pass::compute_with(gpu, shaders, "transmittance/splat_fixed", &settings.building_definitions())?;
        Ok(Self { pass, settings })
    }

    fn bytes(settings: MapSettings) -> u64 {
        let [width, height] = settings.size.map(u64::from);
        width * height * u64::from(settings.coefficients) * 4
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
    ) -> Result<SplatFixedBound, TransmittanceError> {
        map.check(self.settings)?;
        map.check_particles()?;
        let splat = particles.target(gpu, self.settings.size);
        let sums = Buffer::storage(gpu, Self::bytes(self.settings));
        let [width, height] = self.settings.size.map(u64::from);
        let texels = if self.settings.form == Form::Bounded { width * height } else { 1 };
        let bounds = Buffer::storage(gpu, 8 * texels);
        let mut resources = map.resources();
        resources.extend([
            ("splat", (&splat).into()),
            ("particles", (&particles.particles).into()),
            ("sums", (&sums).into()),
            ("counts", (&particles.counts).into()),
            ("bounds", (&bounds).into()),
        ]);
        let bound = self.pass.bind_known(gpu, &resources)?;
        let counts = particles.counts.raw.clone();
        Ok(SplatFixedBound { bound, sums, bounds, counts, count: particles.count })
    }

    /// Records the splats. Overflows are counted from zero.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        bound: &SplatFixedBound,
    ) -> Result<(), TransmittanceError> {
        encoder.clear_buffer(&bound.sums.raw, 0, None);
        encoder.clear_buffer(&bound.bounds.raw, 0, None);
        // The sixth count.
        encoder.clear_buffer(&bound.counts, 20, Some(4));
        let mut passes = vec!["accumulate"];
        if self.settings.form == Form::Bounded {
            passes.insert(0, "occupy");
        }
        for entry_point in passes {
            self.pass.dispatch_groups(encoder, &bound.bound, entry_point, groups(bound.count))?;
        }
        let [width, height] = self.settings.size;
        let texels = [width.div_ceil(16), height.div_ceil(8), 1];
        Ok(self.pass.dispatch_groups(encoder, &bound.bound, "resolve", texels)?)
    }
}
