// SPDX-License-Identifier: MIT OR Apache-2.0
//! The passes `core/brick_ranges`, `core/brick_occupied` and `core/brick_distances`: what marches skip empty space by.

use super::VolumeTexture;
use crate::gpu::Gpu;
use crate::pass::{Pass, PassError};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;

/// Voxels along a brick.
const BRICK: u32 = 8;
/// Bricks a workgroup takes.
const WORKGROUP: [u32; 3] = [8, 4, 2];

/// The uniform `BrickThreshold` of `core/brick_occupied`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct BrickThreshold {
    /// A brick is occupied if its greatest value exceeds this.
    pub value: f32,
    /// Padding.
    pub reserved_a: f32,
    /// Padding.
    pub reserved_b: f32,
    /// Padding.
    pub reserved_c: f32,
}

/// Finds ranges of bricks and distances between them.
pub struct Bricks {
    ranges: Pass,
    occupied: Pass,
    distances: Pass,
}

impl Bricks {
    /// Builds the passes.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PassError> {
        let pass = |name| Pass::compute(gpu, shaders, name, "default");
        Ok(Self {
            ranges: pass("core/brick_ranges")?,
            occupied: pass("core/brick_occupied")?,
            distances: pass("core/brick_distances")?,
        })
    }

    /// Records the least and greatest value of each brick of `volume`, a 3D texture: rg32float, a texel a brick. They hold for
    /// as long as the volume stays, whatever makes a brick occupied.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn record_ranges(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &Texture,
    ) -> Result<Texture, PassError> {
        let ranges = Texture::storage_volume(gpu, brick_count(volume.size()), wgpu::TextureFormat::Rg32Float);
        let bound = self.ranges.bind(gpu, &[("volume", volume.into()), ("ranges", (&ranges).into())])?;
        self.ranges.dispatch(encoder, &bound, ranges.size());
        Ok(ranges)
    }

    /// Records the distance of each brick to the nearest one that holds values above `threshold`: r32uint, in bricks.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn record_above(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        ranges: &Texture,
        threshold: f32,
    ) -> Result<Texture, PassError> {
        let distances = Texture::storage_volume(gpu, ranges.size(), wgpu::TextureFormat::R32Uint);
        let threshold =
            BrickThreshold { value: threshold, reserved_a: 0.0, reserved_b: 0.0, reserved_c: 0.0 };
        let threshold = Buffer::uniform(gpu, &threshold);
        let resources = [
            ("threshold", (&threshold).into()),
            ("ranges", ranges.into()),
            ("distances", (&distances).into()),
        ];
        let bound = self.occupied.bind(gpu, &resources)?;
        self.occupied.dispatch(encoder, &bound, distances.size());
        self.record_distances(gpu, encoder, distances)
    }

    /// Records the distances of bricks of which `occupied`, r32uint, holds 0 where they are occupied and 4096 elsewhere: r32uint,
    /// in bricks. `occupied` is overwritten.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn record_distances(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        occupied: Texture,
    ) -> Result<Texture, PassError> {
        let size = occupied.size();
        let mut from = occupied;
        let mut to = Texture::storage_volume(gpu, size, wgpu::TextureFormat::R32Uint);
        let groups = std::array::from_fn(|axis| size[axis].div_ceil(WORKGROUP[axis]));
        for entry in ["spread_x", "spread_y", "spread_z"] {
            let resources = [("from_distances", (&from).into()), ("to_distances", (&to).into())];
            let bound = self.distances.bind(gpu, &resources)?;
            self.distances.dispatch_groups(encoder, &bound, entry, groups)?;
            std::mem::swap(&mut from, &mut to);
        }
        Ok(from)
    }

    /// Gives `volume` bricks, so that marches skip those of which no value is above 0.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn give(&self, gpu: &Gpu, volume: &mut VolumeTexture) -> Result<(), PassError> {
        let mut encoder = gpu.encoder();
        let ranges = self.record_ranges(gpu, &mut encoder, &volume.texture)?;
        volume.brick_distances = self.record_above(gpu, &mut encoder, &ranges, 0.0)?;
        Ok(gpu.submit(encoder)?)
    }
}

/// Bricks along each axis of a volume of `size` voxels.
pub fn brick_count(size: [u32; 3]) -> [u32; 3] {
    size.map(|side| side.div_ceil(BRICK))
}
