// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the solver holds of each volume.

use super::super::descent::{Descent, VectorStart, Vectors};
use super::super::error::exact;
use super::super::{InverseError, Projector, Regulariser, Unknown, VoxelGrid};
use super::Passes;
use crate::gpu::Gpu;
use crate::pass::{Bound, Resource};
use crate::resource::{Buffer, Texture};
use glam::UVec3;

/// What it holds of a volume.
pub(super) struct Part {
    pub(super) vectors: Vectors,
    pub(super) regulariser: Regulariser,
    /// Values to begin with, 0 where it is not solved for.
    pub(super) start: Vec<f32>,
    pub(super) texture: Texture,
    /// Of the solution and of the direction.
    pub(super) packs: [Bound; 2],
}

impl Part {
    /// `first_group`: of its sums, of `groups` of all volumes.
    pub(super) fn new(
        gpu: &Gpu,
        projector: &Projector,
        passes: &Passes,
        descent: &Descent,
        unknown: &Unknown,
        [first_group, groups]: [u32; 2],
    ) -> Result<Self, InverseError> {
        let (size, channels) = (unknown.size, projector.channels().numbers());
        let voxels: usize = size.iter().map(|side| *side as usize).product();
        exact("voxels that are solved for", voxels, unknown.solved.len())?;
        exact("values to begin with", channels * voxels, unknown.start.len())?;
        let solved: Vec<f32> = unknown.solved.iter().map(|solved| f32::from(u8::from(*solved))).collect();
        let values = unknown.start.iter().enumerate();
        let start = values.map(|(place, value)| value * solved[place / channels]).collect();
        let begin = VectorStart { size, first_group, groups, high: unknown.high, solved };
        let vectors = Vectors::new(gpu, projector, &passes.volume, descent, &begin)?;
        let texture = Texture::storage_volume(gpu, size, projector.format());
        let grid = Buffer::uniform(gpu, &VoxelGrid { size: UVec3::from(size), reserved_a: 0 });
        let packing = |vector: &Buffer| {
            let resources: [(&str, Resource<'_>); 3] =
                [("grid", (&grid).into()), ("vector", vector.into()), ("volume", (&texture).into())];
            passes.pack.bind_known(gpu, &resources)
        };
        let packs = [packing(&vectors.solution)?, packing(&vectors.direction)?];
        Ok(Self { vectors, regulariser: unknown.regulariser, start, texture, packs })
    }
}
