// SPDX-License-Identifier: MIT OR Apache-2.0
//! Voxels that are drawn.

use super::SplattingError;
use super::passes::{GROUP, rows_of_groups};
use crate::core::{Scan, VolumeTextureError};
use crate::data::Volume;
use crate::gpu::Gpu;
use crate::pass::Pass;
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;
use glam::{Mat4, UVec3, Vec3};

/// The uniform `SplatVolume` of `splatting/splat`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SplatVolume {
    /// Voxel space, in which the middle of voxel (i, j, k) is (i, j, k), to the world, metres.
    pub world_from_voxel: Mat4,
    /// Its inverse.
    pub voxel_from_world: Mat4,
    /// Voxels along x, y and z.
    pub size: UVec3,
    /// Voxels of no greater value are left out.
    pub threshold: f32,
}

impl SplatVolume {
    /// How far a splat of `radius` voxels reaches along a unit vector of the world, metres.
    pub fn reach_along(&self, direction: Vec3, radius: f32) -> f32 {
        radius * (glam::Mat3::from_mat4(self.world_from_voxel).transpose() * direction).length()
    }
}

impl SplatVolume {
    /// Corners in the world, metres, of the box that holds all splats of `radius` voxels.
    pub(super) fn hull(&self, radius: f32) -> [Vec3; 8] {
        std::array::from_fn(|corner| {
            let high = [0, 1, 2].map(|axis| corner >> axis & 1 == 1);
            let last = self.size.as_vec3() - 1.0 + radius;
            let place = [0, 1, 2].map(|axis| if high[axis] { last[axis] } else { -radius });
            self.world_from_voxel.transform_point3(Vec3::from(place))
        })
    }
}

/// The uniform `SplatBatch` of `splatting/find_splats`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SplatBatch {
    /// Number of the first voxel.
    pub first: u32,
    /// How many.
    pub count: u32,
    /// Padding.
    pub reserved_a: u32,
    /// Padding.
    pub reserved_b: u32,
}

/// Splats that fit into one binding.
pub(super) struct Batch {
    /// How many splats there are.
    pub(super) uniform: Buffer,
    pub(super) splats: Buffer,
    pub(super) keys: Buffer,
    pub(super) order: Buffer,
    pub(super) count: u32,
}

/// The voxels of a volume above a threshold, on the GPU.
pub struct Splats {
    pub(super) uniform: Buffer,
    pub(super) batches: Vec<Batch>,
    /// Where the volume lies.
    pub volume: SplatVolume,
    /// Points in the world, metres, whose convex hull holds the middles of all voxels.
    pub(super) corners: Vec<Vec3>,
}

impl Splats {
    /// Uploads a volume and finds its splats. Waits for the GPU. `threshold`: voxels of no greater value are left out; below 0 it
    /// counts as 0. `most`: splats in a batch; as many as a binding holds where it is none.
    ///
    /// # Errors
    /// [`SplattingError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        volume: &Volume,
        threshold: f32,
        most: Option<u32>,
    ) -> Result<Self, SplattingError> {
        let limit = gpu.limits.max_texture_dimension_3d;
        if volume.size.iter().any(|side| *side == 0 || *side > limit) {
            return Err(VolumeTextureError::Size { size: volume.size, limit }.into());
        }
        let voxels = volume.size.iter().try_fold(1_u32, |count, side| count.checked_mul(*side));
        let voxels = voxels.ok_or(SplattingError::Voxels(volume.size))?;
        let values = Texture::volume(gpu, volume.size, wgpu::TextureFormat::R16Float);
        values.write(gpu, &volume.values)?;
        let size = Vec3::from(volume.size.map(|side| side as f32));
        let world_from_voxel = volume.world_from_unit
            * Mat4::from_scale(size.recip())
            * Mat4::from_translation(Vec3::splat(0.5));
        let uniform = SplatVolume {
            world_from_voxel,
            voxel_from_world: world_from_voxel.as_dmat4().inverse().as_mat4(),
            size: UVec3::from(volume.size),
            threshold: if threshold.is_finite() { threshold.max(0.0) } else { 0.0 },
        };
        let corners = (0..8_u8).map(|corner| {
            let unit = Vec3::from([0, 1, 2].map(|axis| f32::from(corner >> axis & 1)));
            world_from_voxel.transform_point3(unit * (size - 1.0))
        });
        let corners = corners.collect();
        let mut splats =
            Self { uniform: Buffer::uniform(gpu, &uniform), batches: Vec::new(), volume: uniform, corners };
        let in_binding = u64::from(gpu.limits.max_storage_buffer_binding_size as u32) / 8 - 1;
        let batch = most.unwrap_or(u32::MAX).clamp(1, in_binding.min(u64::from(u32::MAX)) as u32);
        let pass = Pass::compute(gpu, shaders, "splatting/find_splats", "default")?;
        let scan = Scan::new(gpu, shaders)?;
        let mut first = 0;
        while first < voxels {
            let count = batch.min(voxels - first);
            splats.find(
                gpu,
                &pass,
                &scan,
                &values,
                SplatBatch { first, count, reserved_a: 0, reserved_b: 0 },
            )?;
            first += count;
        }
        Ok(splats)
    }

    fn find(
        &mut self,
        gpu: &Gpu,
        pass: &Pass,
        scan: &Scan,
        values: &Texture,
        batch: SplatBatch,
    ) -> Result<(), SplattingError> {
        let marks = Buffer::storage(gpu, 4 * (u64::from(batch.count) + 1));
        let uniform = Buffer::uniform(gpu, &batch);
        let run = |splats: &Buffer, entry: &str| -> Result<(), SplattingError> {
            let resources = [
                ("volume", (&self.uniform).into()),
                ("batch", (&uniform).into()),
                ("values", values.into()),
                ("marks", (&marks).into()),
                ("splats", splats.into()),
            ];
            let bound = pass.bind(gpu, &resources)?;
            let mut encoder = gpu.encoder();
            let groups = rows_of_groups((batch.count + 1).div_ceil(GROUP));
            pass.dispatch_groups(&mut encoder, &bound, entry, groups)?;
            if entry == "mark_voxels" {
                scan.record(gpu, &mut encoder, &marks, batch.count + 1)?;
            }
            gpu.submit(encoder)?;
            Ok(())
        };
        run(&Buffer::storage(gpu, 8), "mark_voxels")?;
        // Sizes of buffers are the host's; a volume is read once, not in every frame.
        let count = marks.read_words(gpu)?.get(batch.count as usize).copied().unwrap_or(0);
        if count > 0 {
            let [splats, keys, order] = [8, 4, 4].map(|bytes| Buffer::storage(gpu, bytes * u64::from(count)));
            run(&splats, "gather_splats")?;
            let uniform = Buffer::uniform(gpu, &SplatBatch { first: 0, count, reserved_a: 0, reserved_b: 0 });
            self.batches.push(Batch { uniform, splats, keys, order, count });
        }
        Ok(())
    }

    /// How many splats there are.
    pub fn count(&self) -> u64 {
        self.batches.iter().map(|batch| u64::from(batch.count)).sum()
    }

    /// Bytes of its buffers.
    pub fn memory(&self) -> u64 {
        let of = |batch: &Batch| {
            let buffers = [&batch.uniform, &batch.splats, &batch.keys, &batch.order];
            buffers.iter().map(|buffer| buffer.raw.size()).sum::<u64>()
        };
        self.uniform.raw.size() + self.batches.iter().map(of).sum::<u64>()
    }

    /// In how many batches they are drawn.
    pub fn batches(&self) -> usize {
        self.batches.len()
    }
}
