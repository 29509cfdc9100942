// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transmittance at points.

use super::{MapSettings, TransmittanceError, TransmittanceMap};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass};
use crate::resource::Buffer;
use crate::shaders::Shaders;
use glam::Vec3;

/// Asks a map for the transmittance from the light to points in the world.
pub struct Query {
    pass: Pass,
    settings: MapSettings,
}

/// A map and points, bound.
pub struct QueryBound {
    bound: Bound,
    count: u32,
    /// One 0..1 a point, in order.
    pub transmittances: Buffer,
}

impl QueryBound {
    /// One 0..1 a point, in order.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<f32>, TransmittanceError> {
        let mut all = self.transmittances.read_floats(gpu)?;
        all.truncate(self.count as usize);
        Ok(all)
    }
}

impl Query {
    /// Builds the pass, with bilinear reads. `monotone`: extinction maps with the Fejer window.
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
        let pass = Pass::compute_with(gpu, shaders, "transmittance/query", &definitions)?;
        Ok(Self { pass, settings })
    }

    /// Binds a map and points, metres.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn bind(
        &self,
        gpu: &Gpu,
        map: &TransmittanceMap,
        points: &[Vec3],
    ) -> Result<QueryBound, TransmittanceError> {
        map.check(self.settings)?;
        let values = points.iter().flat_map(|point| [point.x, point.y, point.z, 1.0]);
        let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
        let given = Buffer::with_bytes(gpu, &bytes, wgpu::BufferUsages::STORAGE);
        let transmittances = Buffer::storage(gpu, 4 * points.len() as u64);
        let mut resources = map.resources();
        resources.extend([("points", (&given).into()), ("transmittances", (&transmittances).into())]);
        let bound = self.pass.bind_known(gpu, &resources)?;
        Ok(QueryBound { bound, count: points.len() as u32, transmittances })
    }

    /// Records the query.
    ///
    /// # Errors
    /// [`TransmittanceError`].
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        bound: &QueryBound,
    ) -> Result<(), TransmittanceError> {
        let groups = super::particles::groups(bound.count.div_ceil(64));
        Ok(self.pass.dispatch_groups(encoder, &bound.bound, "query", groups)?)
    }
}
