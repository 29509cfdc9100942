// SPDX-License-Identifier: MIT OR Apache-2.0
//! Conjugate gradients between bounds on the GPU.

mod held;

use super::descent::Descent;
use super::error::exact;
use super::projector::bricks;
use super::{Collected, Fields, InverseError, Projector, Solved, Target, Unknown};
use crate::gpu::Gpu;
use crate::pass::Pass;
use crate::shaders::Shaders;
use held::Part;

/// What the solver runs besides the projector.
struct Passes {
    pack: Pass,
    volume: Pass,
}

/// Finds volumes whose pictures are nearest to those that are wanted.
pub struct Solver {
    projector: Projector,
    passes: Passes,
    descent: Descent,
    parts: Vec<Part>,
}

impl Solver {
    /// Prepares everything. `unknowns`: emission, albedo, both in this order, or extinction, as the projector solves for.
    ///
    /// # Errors
    /// [`InverseError`]: numbers that are missing or too many, passes that cannot be made.
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        projector: Projector,
        targets: Vec<Target>,
        unknowns: &[Unknown],
    ) -> Result<Self, InverseError> {
        let needed = if projector.solved() == Solved::Both { 2 } else { 1 };
        exact("volumes that are solved for", needed, unknowns.len())?;
        let definitions = projector.definitions();
        let pass = |name: &str| Pass::compute_with(gpu, shaders, name, &definitions);
        let passes = Passes { pack: pass("inverse/pack_volume")?, volume: pass("inverse/solver_volume")? };
        let groups_of = |unknown: &Unknown| bricks(unknown.size).into_iter().product::<u32>();
        let groups: u32 = unknowns.iter().map(groups_of).sum();
        let descent = Descent::new(gpu, shaders, &projector, targets, groups)?;
        let mut first = 0;
        let mut parts = Vec::new();
        for unknown in unknowns {
            parts.push(Part::new(gpu, &projector, &passes, &descent, unknown, [first, groups])?);
            first += groups_of(unknown);
        }
        let mut solver = Self { projector, passes, descent, parts };
        solver.prepare(gpu, unknowns)?;
        Ok(solver)
    }

    /// Scales the regularisers and finds paces: what the pictures of ones send back says how far each voxel goes.
    fn prepare(&mut self, gpu: &Gpu, unknowns: &[Unknown]) -> Result<(), InverseError> {
        let mut encoder = gpu.encoder();
        self.pack(&mut encoder, 0)?;
        self.pictures(gpu, &mut encoder, "weigh_picture")?;
        self.descent.scalars(&mut encoder, "keep_residual")?;
        self.collect(gpu, &mut encoder)?;
        gpu.submit(encoder)?;
        let solved = unknowns.iter().flat_map(|unknown| &unknown.solved).filter(|solved| **solved).count();
        let scale = self.descent.scale(gpu, self.projector.channels().used() * solved)?;
        for part in &mut self.parts {
            part.vectors.prepare(gpu, scale, part.regulariser, &part.start);
        }
        let mut encoder = gpu.encoder();
        self.voxels(&mut encoder, "solver_paces")?;
        Ok(gpu.submit(encoder)?)
    }

    /// Puts the solution (0) or the direction (1) where it is rendered from.
    fn pack(&self, encoder: &mut wgpu::CommandEncoder, which: usize) -> Result<(), InverseError> {
        for part in &self.parts {
            let groups = bricks(part.vectors.size());
            self.passes.pack.dispatch_groups(encoder, &part.packs[which], "pack_volume", groups)?;
        }
        Ok(())
    }

    /// Renders what was packed, and does something with each picture.
    fn pictures(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        entry: &str,
    ) -> Result<(), InverseError> {
        let [Some(first), last] = [self.parts.first(), self.parts.last()] else { return Ok(()) };
        let last = last.unwrap_or(first);
        let fields = Fields { emission: &first.texture, albedo: &last.texture, extinction: &first.texture };
        for sitting in &self.descent.sittings {
            self.projector.render(gpu, encoder, &sitting.view, &sitting.medium, fields)?;
            self.descent.picture(encoder, sitting, entry)?;
        }
        Ok(())
    }

    /// Projects all weighed differences back.
    fn collect(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), InverseError> {
        let collected: Vec<Collected<'_>> = self
            .parts
            .iter()
            .map(|Part { vectors, .. }| Collected {
                grid: vectors.size(),
                wanted: &vectors.solved,
                sums: &vectors.gradient,
            })
            .collect();
        for sitting in &self.descent.sittings {
            let (view, medium) = (&sitting.view, &sitting.medium);
            self.projector.backproject(gpu, encoder, view, medium, &sitting.difference, &collected)?;
        }
        Ok(())
    }

    fn voxels(&self, encoder: &mut wgpu::CommandEncoder, entry: &str) -> Result<(), InverseError> {
        self.parts.iter().try_for_each(|part| part.vectors.dispatch(encoder, &self.passes.volume, entry))
    }

    /// One iteration.
    ///
    /// # Errors
    /// [`InverseError`].
    pub fn iterate(&mut self, gpu: &Gpu) -> Result<(), InverseError> {
        self.descent.begin(gpu)?;
        let mut encoder = gpu.encoder();
        self.pack(&mut encoder, 0)?;
        self.pictures(gpu, &mut encoder, "weigh_difference")?;
        self.descent.scalars(&mut encoder, "keep_residual")?;
        self.collect(gpu, &mut encoder)?;
        self.voxels(&mut encoder, "smooth_solution")?;
        self.voxels(&mut encoder, "solver_gradient")?;
        self.descent.scalars(&mut encoder, "choose_direction")?;
        self.voxels(&mut encoder, "solver_direction")?;
        self.pack(&mut encoder, 1)?;
        self.pictures(gpu, &mut encoder, "weigh_picture")?;
        self.voxels(&mut encoder, "solver_curvature")?;
        self.descent.scalars(&mut encoder, "choose_step")?;
        self.voxels(&mut encoder, "solver_advance")?;
        gpu.submit(encoder)?;
        self.descent.end();
        Ok(())
    }

    /// The weighed sum of squares of what was wrong when each iteration began, by channel.
    ///
    /// # Errors
    /// [`InverseError::Gpu`].
    pub fn residuals(&self, gpu: &Gpu) -> Result<Vec<[f32; 3]>, InverseError> {
        self.descent.residuals(gpu)
    }

    /// The volumes as they are: the projector's numbers a voxel.
    ///
    /// # Errors
    /// [`InverseError::Gpu`].
    pub fn solutions(&self, gpu: &Gpu) -> Result<Vec<Vec<f32>>, InverseError> {
        let read = |Part { vectors, .. }: &Part| vectors.read(gpu, &self.projector, &vectors.solution);
        self.parts.iter().map(read).collect()
    }
}
