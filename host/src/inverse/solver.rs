// SPDX-License-Identifier: MIT OR Apache-2.0
//! Conjugate gradients between bounds on the GPU.

mod held;
mod uniforms;

pub use uniforms::{SolverPart, SolverScalars, SolverSums};

use super::error::exact;
use super::projector::{bricks, tiles};
use super::{Collected, Fields, InverseError, Projector, Solved, Target, Unknown};
use crate::gpu::Gpu;
use crate::out_of_range::in_range;
use crate::pass::{Bound, Pass};
use crate::resource::Buffer;
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use held::{Part, Sitting};

/// Scalars before the residuals.
const FIRST_RESIDUAL: usize = 3;
/// Least of what a pace is one over, of the mean: voxels that hardly any ray meets do not jump.
const STEEPEST: f32 = 1e-3;
/// Most iterations of one solver.
const MOST_ITERATIONS: u32 = 1024;

/// What the solver runs besides the projector.
struct Passes {
    pack: Pass,
    pictures: Pass,
    volume: Pass,
    scalars: Pass,
}

/// What all volumes and views share.
struct Scratch {
    sums: Buffer,
    /// [`SolverScalars`], then the residual of each iteration.
    scalars: Buffer,
}

/// Finds volumes whose pictures are nearest to those that are wanted.
pub struct Solver {
    projector: Projector,
    passes: Passes,
    scratch: Scratch,
    sittings: Vec<Sitting>,
    parts: Vec<Part>,
    counts: Buffer,
    numbers: SolverSums,
    bound: Bound,
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
        let pass =
            |name: &str, definitions: &Definitions| Pass::compute_with(gpu, shaders, name, definitions);
        let passes = Passes {
            pack: pass("inverse/pack_volume", &definitions)?,
            pictures: pass("inverse/picture_sums", &definitions)?,
            volume: pass("inverse/solver_volume", &definitions)?,
            scalars: pass("inverse/solver_scalars", &Definitions::new())?,
        };
        let groups_of = |unknown: &Unknown| bricks(unknown.size).into_iter().product::<u32>();
        let sums_of = |target: &Target| tiles(target.view.size()).into_iter().product::<u32>();
        let groups: u32 = unknowns.iter().map(groups_of).sum();
        let pictures: u32 = targets.iter().map(sums_of).sum();
        let numbers = SolverSums { groups, first_picture: 2 * groups, pictures, iteration: 0 };
        let counts = Buffer::uniform(gpu, &numbers);
        let scratch = Scratch {
            sums: Buffer::storage(gpu, 16 * u64::from(2 * groups + pictures)),
            scalars: Buffer::storage(gpu, 16 * (FIRST_RESIDUAL as u64 + u64::from(MOST_ITERATIONS))),
        };
        let mut first = numbers.first_picture;
        let mut sittings = Vec::new();
        for target in targets {
            let own = sums_of(&target);
            sittings.push(Sitting::new(gpu, &projector, &passes, &scratch, target, first)?);
            first += own;
        }
        let mut first = 0;
        let mut parts = Vec::new();
        for unknown in unknowns {
            parts.push(Part::new(gpu, &projector, &passes, &scratch, unknown, [first, groups])?);
            first += groups_of(unknown);
        }
        let resources = [
            ("counts", (&counts).into()),
            ("sums", (&scratch.sums).into()),
            ("scalars", (&scratch.scalars).into()),
        ];
        let bound = passes.scalars.bind_known(gpu, &resources)?;
        let mut solver = Self { projector, passes, scratch, sittings, parts, counts, numbers, bound };
        solver.prepare(gpu, unknowns)?;
        Ok(solver)
    }

    /// Scales the regularisers by the mean of W'C W 1 over the n voxels that are solved for, which is 1'W'C W 1 / n: the weighed squares
    /// of the pictures of ones; what those send back says how far each voxel goes. Then the solution begins where it should.
    fn prepare(&mut self, gpu: &Gpu, unknowns: &[Unknown]) -> Result<(), InverseError> {
        let mut encoder = gpu.encoder();
        self.pack(&mut encoder, 0)?;
        self.pictures(gpu, &mut encoder, "weigh_picture")?;
        self.scalars(&mut encoder, "keep_residual")?;
        self.collect(gpu, &mut encoder)?;
        gpu.submit(encoder)?;
        let squares = self.scratch.scalars.read_floats(gpu)?[4 * FIRST_RESIDUAL..][..3].iter().sum::<f32>();
        let solved = unknowns.iter().flat_map(|unknown| &unknown.solved).filter(|solved| **solved).count();
        let scale = squares / (self.projector.channels().used() * solved).max(1) as f32;
        for part in &mut self.parts {
            part.solution.write_floats(gpu, &part.start);
            let settings = &mut part.settings;
            settings.laplacian = scale * part.regulariser.laplacian;
            settings.smallness = scale * part.regulariser.smallness;
            settings.oneness = scale * part.regulariser.oneness;
            settings.steepest = scale * STEEPEST;
            part.uniform.write(gpu, settings);
        }
        let mut encoder = gpu.encoder();
        self.voxels(&mut encoder, "solver_paces")?;
        Ok(gpu.submit(encoder)?)
    }

    /// Puts the solution (0) or the direction (1) where it is rendered from.
    fn pack(&self, encoder: &mut wgpu::CommandEncoder, which: usize) -> Result<(), InverseError> {
        for part in &self.parts {
            self.passes.pack.dispatch_groups(
                encoder,
                &part.packs[which],
                "pack_volume",
                bricks(part.size),
            )?;
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
        for sitting in &self.sittings {
            self.projector.render(gpu, encoder, &sitting.view, &sitting.medium, fields)?;
            let groups = tiles(sitting.view.size());
            self.passes.pictures.dispatch_groups(encoder, &sitting.bound, entry, groups)?;
        }
        Ok(())
    }

    /// Projects all weighed differences back.
    fn collect(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), InverseError> {
        let collected: Vec<Collected<'_>> = self
            .parts
            .iter()
            .map(|part| Collected { grid: part.size, wanted: &part.solved, sums: &part.gradient })
            .collect();
        for sitting in &self.sittings {
            let Sitting { view, medium, difference, .. } = sitting;
            self.projector.backproject(gpu, encoder, view, medium, difference, &collected)?;
        }
        Ok(())
    }

    fn voxels(&self, encoder: &mut wgpu::CommandEncoder, entry: &str) -> Result<(), InverseError> {
        for part in &self.parts {
            self.passes.volume.dispatch_groups(encoder, &part.bound, entry, bricks(part.size))?;
        }
        Ok(())
    }

    fn scalars(&self, encoder: &mut wgpu::CommandEncoder, entry: &str) -> Result<(), InverseError> {
        Ok(self.passes.scalars.dispatch_groups(encoder, &self.bound, entry, [1, 1, 1])?)
    }

    /// One iteration.
    ///
    /// # Errors
    /// [`InverseError`].
    pub fn iterate(&mut self, gpu: &Gpu) -> Result<(), InverseError> {
        in_range(
            "number of iterations",
            (self.numbers.iteration + 1) as f32,
            1.0..=MOST_ITERATIONS as f32,
            "from 1 to 1024",
        )?;
        self.counts.write(gpu, &self.numbers);
        let mut encoder = gpu.encoder();
        self.pack(&mut encoder, 0)?;
        self.pictures(gpu, &mut encoder, "weigh_difference")?;
        self.scalars(&mut encoder, "keep_residual")?;
        self.collect(gpu, &mut encoder)?;
        self.voxels(&mut encoder, "smooth_solution")?;
        self.voxels(&mut encoder, "solver_gradient")?;
        self.scalars(&mut encoder, "choose_direction")?;
        self.voxels(&mut encoder, "solver_direction")?;
        self.pack(&mut encoder, 1)?;
        self.pictures(gpu, &mut encoder, "weigh_picture")?;
        self.voxels(&mut encoder, "solver_curvature")?;
        self.scalars(&mut encoder, "choose_step")?;
        self.voxels(&mut encoder, "solver_advance")?;
        gpu.submit(encoder)?;
        self.numbers.iteration += 1;
        Ok(())
    }

    /// The weighed sum of squares of what was wrong when each iteration began, by channel.
    ///
    /// # Errors
    /// [`InverseError::Gpu`].
    pub fn residuals(&self, gpu: &Gpu) -> Result<Vec<[f32; 3]>, InverseError> {
        let all = self.scratch.scalars.read_floats(gpu)?;
        let rows = all.chunks_exact(4).skip(FIRST_RESIDUAL).take(self.numbers.iteration as usize);
        Ok(rows.map(|row| [row[0], row[1], row[2]]).collect())
    }

    /// The volumes as they are: the projector's numbers a voxel.
    ///
    /// # Errors
    /// [`InverseError::Gpu`].
    pub fn solutions(&self, gpu: &Gpu) -> Result<Vec<Vec<f32>>, InverseError> {
        let channels = self.projector.channels().numbers();
        let read = |part: &Part| {
            let mut values = part.solution.read_floats(gpu)?;
            values.truncate(channels * part.size.iter().map(|side| *side as usize).product::<usize>());
            Ok(values)
        };
        self.parts.iter().map(read).collect()
    }
}
