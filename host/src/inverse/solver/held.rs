// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the solver holds of each view and of each volume.

use super::super::error::exact;
use super::super::projector::tiles;
use super::super::{
    InverseError, Medium, PictureRows, Projector, Regulariser, Target, Unknown, ViewImages, VoxelGrid,
};
use super::{Passes, Scratch, SolverPart};
use crate::gpu::Gpu;
use crate::pass::{Bound, Resource};
use crate::resource::{Buffer, Texture};
use glam::UVec3;
use std::sync::Arc;
use wgpu::TextureFormat::R32Float;

/// What it holds of a view.
pub(super) struct Sitting {
    pub(super) view: ViewImages,
    pub(super) medium: Arc<Medium>,
    /// What is wrong with its picture, weighed.
    pub(super) difference: Texture,
    pub(super) bound: Bound,
}

/// What it holds of a volume.
pub(super) struct Part {
    pub(super) size: [u32; 3],
    pub(super) uniform: Buffer,
    pub(super) settings: SolverPart,
    pub(super) regulariser: Regulariser,
    /// Its pace, a number a voxel.
    pub(super) solved: Buffer,
    /// Ones where it is solved for, until the solver has scaled its regularisers; then the values to begin with.
    pub(super) solution: Buffer,
    pub(super) start: Vec<f32>,
    pub(super) gradient: Buffer,
    pub(super) texture: Texture,
    pub(super) bound: Bound,
    /// Of the solution and of the direction.
    pub(super) packs: [Bound; 2],
}

impl Sitting {
    /// `first`: of its sums.
    pub(super) fn new(
        gpu: &Gpu,
        projector: &Projector,
        passes: &Passes,
        scratch: &Scratch,
        target: Target,
        first: u32,
    ) -> Result<Self, InverseError> {
        let size = target.view.size();
        let pixels = size[0] as usize * size[1] as usize;
        exact("pictures that are wanted", projector.channels().numbers() * pixels, target.wanted.len())?;
        exact("weights of a picture", pixels, target.weights.len())?;
        let wanted = Texture::storage(gpu, size, projector.format());
        wanted.write(gpu, &target.wanted)?;
        let weights = Texture::storage(gpu, size, R32Float);
        weights.write(gpu, &target.weights)?;
        let difference = Texture::storage(gpu, size, projector.format());
        let count = tiles(size).into_iter().product();
        let rows = Buffer::uniform(gpu, &PictureRows { first, count, reserved_a: 0, reserved_b: 0 });
        let resources = [
            ("rows", (&rows).into()),
            ("rendered", (&target.view.rendered).into()),
            ("wanted", (&wanted).into()),
            ("weights", (&weights).into()),
            ("difference", (&difference).into()),
            ("sums", (&scratch.sums).into()),
        ];
        let bound = passes.pictures.bind_known(gpu, &resources)?;
        Ok(Self { view: target.view, medium: target.medium, difference, bound })
    }
}

impl Part {
    /// `first_group`: of its sums, of `groups` of all volumes.
    pub(super) fn new(
        gpu: &Gpu,
        projector: &Projector,
        passes: &Passes,
        scratch: &Scratch,
        unknown: &Unknown,
        [first_group, groups]: [u32; 2],
    ) -> Result<Self, InverseError> {
        let (size, channels) = (unknown.size, projector.channels().numbers());
        let voxels: usize = size.iter().map(|side| *side as usize).product();
        exact("voxels that are solved for", voxels, unknown.solved.len())?;
        exact("values to begin with", channels * voxels, unknown.start.len())?;
        let bytes = 4 * channels as u64 * voxels as u64;
        let limit = gpu.limits.max_storage_buffer_binding_size;
        if bytes > limit {
            return Err(InverseError::Memory { name: "volumes that are solved for", bytes, limit });
        }
        let settings = SolverPart {
            size: UVec3::from(size),
            first_group,
            laplacian: 0.0,
            smallness: 0.0,
            oneness: 0.0,
            low: 0.0,
            high: unknown.high,
            groups,
            steepest: 0.0,
            reserved_a: 0,
        };
        let uniform = Buffer::uniform(gpu, &settings);
        let counts: Vec<f32> = unknown.solved.iter().map(|solved| f32::from(u8::from(*solved))).collect();
        let solved = Buffer::of_floats(gpu, &counts);
        let ones: Vec<f32> = (0..channels * voxels).map(|place| counts[place / channels]).collect();
        let start = unknown.start.iter().zip(&ones).map(|(value, one)| value * one).collect();
        let solution = Buffer::of_floats(gpu, &ones);
        let [gradient, downward, direction, roughness] = [0; 4].map(|_| Buffer::storage(gpu, bytes));
        let texture = Texture::storage_volume(gpu, size, projector.format());
        let resources = [
            ("part", (&uniform).into()),
            ("solved", (&solved).into()),
            ("solution", (&solution).into()),
            ("gradient", (&gradient).into()),
            ("downward", (&downward).into()),
            ("direction", (&direction).into()),
            ("roughness", (&roughness).into()),
            ("sums", (&scratch.sums).into()),
            ("scalars", (&scratch.scalars).into()),
        ];
        let bound = passes.volume.bind_known(gpu, &resources)?;
        let grid = Buffer::uniform(gpu, &VoxelGrid { size: UVec3::from(size), reserved_a: 0 });
        let packing = |vector: &Buffer| {
            let resources: [(&str, Resource<'_>); 3] =
                [("grid", (&grid).into()), ("vector", vector.into()), ("volume", (&texture).into())];
            passes.pack.bind_known(gpu, &resources)
        };
        let packs = [packing(&solution)?, packing(&direction)?];
        let regulariser = unknown.regulariser;
        Ok(Self {
            size,
            uniform,
            settings,
            regulariser,
            solved,
            solution,
            start,
            gradient,
            texture,
            bound,
            packs,
        })
    }
}
