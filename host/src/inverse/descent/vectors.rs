// SPDX-License-Identifier: MIT OR Apache-2.0
//! The vectors of what is solved for, a number or four a voxel.

use super::super::projector::bricks;
use super::super::{InverseError, Projector, Regulariser};
use super::{Descent, STEEPEST, SolverPart};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass};
use crate::resource::Buffer;
use glam::UVec3;

/// What vectors begin with.
pub(in super::super) struct VectorStart {
    /// Voxels along x, y and z.
    pub(in super::super) size: [u32; 3],
    /// First of its sums.
    pub(in super::super) first_group: u32,
    /// Sums of all that is solved for.
    pub(in super::super) groups: u32,
    /// Greatest value.
    pub(in super::super) high: f32,
    /// 1 where a voxel is solved for, else 0.
    pub(in super::super) solved: Vec<f32>,
}

/// The vectors of one volume, or of lights in a row.
pub(in super::super) struct Vectors {
    size: [u32; 3],
    uniform: Buffer,
    settings: SolverPart,
    /// 1 where it is solved for and 0 elsewhere; after `solver_paces` its pace, a number a voxel.
    pub(in super::super) solved: Buffer,
    /// Ones where it is solved for, until regularisers are scaled.
    pub(in super::super) solution: Buffer,
    pub(in super::super) gradient: Buffer,
    pub(in super::super) direction: Buffer,
    bound: Bound,
}

impl Vectors {
    /// `pass`: inverse/solver_volume.
    pub(in super::super) fn new(
        gpu: &Gpu,
        projector: &Projector,
        pass: &Pass,
        descent: &Descent,
        start: &VectorStart,
    ) -> Result<Self, InverseError> {
        let channels = projector.channels().numbers();
        let bytes = 4 * (channels * start.solved.len()) as u64;
        let limit = gpu.limits.max_storage_buffer_binding_size;
        if bytes > limit {
            return Err(InverseError::Memory { name: "volumes that are solved for", bytes, limit });
        }
        let settings = SolverPart {
            size: UVec3::from(start.size),
            first_group: start.first_group,
            laplacian: 0.0,
            smallness: 0.0,
            oneness: 0.0,
            low: 0.0,
            high: start.high,
            groups: start.groups,
            steepest: 0.0,
            reserved_a: 0,
        };
        let uniform = Buffer::uniform(gpu, &settings);
        let ones = (0..channels * start.solved.len()).map(|place| start.solved[place / channels]);
        let solution = Buffer::of_floats(gpu, &ones.collect::<Vec<f32>>());
        let solved = Buffer::of_floats(gpu, &start.solved);
        let [gradient, downward, direction, roughness] = [0; 4].map(|_| Buffer::storage(gpu, bytes));
        let resources = [
            ("part", (&uniform).into()),
            ("solved", (&solved).into()),
            ("solution", (&solution).into()),
            ("gradient", (&gradient).into()),
            ("downward", (&downward).into()),
            ("direction", (&direction).into()),
            ("roughness", (&roughness).into()),
            ("sums", (&descent.scratch.sums).into()),
            ("scalars", (&descent.scratch.scalars).into()),
        ];
        let bound = pass.bind_known(gpu, &resources)?;
        Ok(Self { size: start.size, uniform, settings, solved, solution, gradient, direction, bound })
    }

    /// Voxels along x, y and z.
    pub(in super::super) fn size(&self) -> [u32; 3] {
        self.size
    }

    /// Sets regularisers and paces by their scale ([`Descent::scale`]), and the values to begin with.
    pub(in super::super) fn prepare(&mut self, gpu: &Gpu, scale: f32, known: Regulariser, start: &[f32]) {
        self.solution.write_floats(gpu, start);
        self.settings.laplacian = scale * known.laplacian;
        self.settings.smallness = scale * known.smallness;
        self.settings.oneness = scale * known.oneness;
        self.settings.steepest = scale * STEEPEST;
        self.uniform.write(gpu, &self.settings);
    }

    /// Runs an entry point of inverse/solver_volume over all voxels.
    pub(in super::super) fn dispatch(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &Pass,
        entry: &str,
    ) -> Result<(), InverseError> {
        Ok(pass.dispatch_groups(encoder, &self.bound, entry, bricks(self.size))?)
    }

    /// One of the vectors: the projector's numbers a voxel.
    pub(in super::super) fn read(
        &self,
        gpu: &Gpu,
        projector: &Projector,
        vector: &Buffer,
    ) -> Result<Vec<f32>, InverseError> {
        let mut values = vector.read_floats(gpu)?;
        let voxels: usize = self.size.iter().map(|side| *side as usize).product();
        values.truncate(projector.channels().numbers() * voxels);
        Ok(values)
    }
}
