// SPDX-License-Identifier: MIT OR Apache-2.0
//! Which bricks of a volume rays may pass over.

use super::{IsoBound, IsoVolume, PainterlyError};
use crate::core::{Bricks, Transfer};
use crate::gpu::Gpu;
use crate::pass::Pass;
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;

/// Finds the bricks in which anything may be solid, and the distances of the others to them.
pub struct SolidBricks {
    bricks: Bricks,
    pass: Pass,
    sampler: Sampler,
}

/// Least and greatest values of the bricks of a volume: they stay for as long as the volume, whatever is solid.
pub struct BrickRanges {
    texture: Texture,
}

impl SolidBricks {
    /// Builds the passes.
    ///
    /// # Errors
    /// [`PainterlyError::Pass`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PainterlyError> {
        let pass = Pass::compute(gpu, shaders, "painterly/solid_bricks", "default")?;
        Ok(Self { bricks: Bricks::new(gpu, shaders)?, pass, sampler: Sampler::linear(gpu) })
    }

    /// Records the ranges of a volume's bricks.
    ///
    /// # Errors
    /// [`PainterlyError::Pass`].
    pub fn ranges(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &IsoVolume,
    ) -> Result<BrickRanges, PainterlyError> {
        Ok(BrickRanges { texture: self.bricks.record_ranges(gpu, encoder, &volume.texture)? })
    }

    /// Records what rays pass over: after [`super::IsoRaycast::set`], once and whenever the iso-value has changed. `transfer`:
    /// the function that the rays are bound to.
    ///
    /// # Errors
    /// [`PainterlyError::Pass`].
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        ranges: &BrickRanges,
        transfer: &Transfer,
        rays: &IsoBound,
    ) -> Result<(), PainterlyError> {
        let size = ranges.texture.size();
        let occupied = Texture::storage_volume(gpu, size, wgpu::TextureFormat::R32Uint);
        let entries = u64::from(transfer.texture.size()[0]);
        let counts = Buffer::storage(gpu, 4 * (entries + 1));
        let resources = [
            ("volume", rays.volume().into()),
            ("surface", rays.surface().into()),
            ("transfer", (&transfer.texture).into()),
            ("linear_sampler", (&self.sampler).into()),
            ("ranges", (&ranges.texture).into()),
            ("counts", (&counts).into()),
            ("distances", (&occupied).into()),
        ];
        let bound = self.pass.bind(gpu, &resources)?;
        self.pass.dispatch_groups(encoder, &bound, "count_entries", [1; 3])?;
        let groups = [size[0].div_ceil(8), size[1].div_ceil(4), size[2].div_ceil(2)];
        self.pass.dispatch_groups(encoder, &bound, "solid_bricks", groups)?;
        let distances = self.bricks.record_distances(gpu, encoder, occupied)?;
        encoder.copy_texture_to_texture(
            distances.raw.as_image_copy(),
            rays.brick_distances().raw.as_image_copy(),
            distances.raw.size(),
        );
        Ok(())
    }
}
