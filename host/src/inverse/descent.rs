// SPDX-License-Identifier: MIT OR Apache-2.0
//! What every solver by conjugate gradients has: wanted pictures, sums over groups, scalars and the residual of each iteration.

mod sitting;
mod uniforms;
mod vectors;

pub(super) use sitting::Sitting;
pub use uniforms::{SolverPart, SolverScalars, SolverSums};
pub(super) use vectors::{VectorStart, Vectors};

use super::projector::tiles;
use super::{InverseError, Projector, Target};
use crate::gpu::Gpu;
use crate::out_of_range::in_range;
use crate::pass::{Bound, Pass};
use crate::resource::Buffer;
use crate::shaders::Shaders;
use airlight_validate::Definitions;

/// Scalars before the residuals.
const FIRST_RESIDUAL: usize = 3;
/// Least of what a pace is one over, of the mean: what hardly any ray meets does not jump.
const STEEPEST: f32 = 1e-3;
/// Most iterations of one solver.
const MOST_ITERATIONS: u32 = 1024;

/// Sums of groups, and what they say.
pub(super) struct Scratch {
    sums: Buffer,
    /// [`SolverScalars`], then the residual of each iteration.
    scalars: Buffer,
}

/// The way down to the pictures that are wanted.
pub(super) struct Descent {
    pictures: Pass,
    scalars: Pass,
    scratch: Scratch,
    pub(super) sittings: Vec<Sitting>,
    counts: Buffer,
    numbers: SolverSums,
    bound: Bound,
}

impl Descent {
    /// `groups`: sums of all that is solved for.
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        projector: &Projector,
        targets: Vec<Target>,
        groups: u32,
    ) -> Result<Self, InverseError> {
        let definitions = projector.definitions();
        let pictures = Pass::compute_with(gpu, shaders, "inverse/picture_sums", &definitions)?;
        let scalars = Pass::compute_with(gpu, shaders, "inverse/solver_scalars", &Definitions::new())?;
        let sums_of = |target: &Target| tiles(target.view.size()).into_iter().product::<u32>();
        let sums: u32 = targets.iter().map(sums_of).sum();
        let numbers = SolverSums { groups, first_picture: 2 * groups, pictures: sums, iteration: 0 };
        let counts = Buffer::uniform(gpu, &numbers);
        let scratch = Scratch {
            sums: Buffer::storage(gpu, 16 * u64::from(numbers.first_picture + sums)),
            scalars: Buffer::storage(gpu, 16 * (FIRST_RESIDUAL as u64 + u64::from(MOST_ITERATIONS))),
        };
        let mut first = numbers.first_picture;
        let mut sittings = Vec::new();
        for target in targets {
            let own = sums_of(&target);
            sittings.push(Sitting::new(gpu, projector, &pictures, &scratch, target, first)?);
            first += own;
        }
        let resources = [
            ("counts", (&counts).into()),
            ("sums", (&scratch.sums).into()),
            ("scalars", (&scratch.scalars).into()),
        ];
        let bound = scalars.bind_known(gpu, &resources)?;
        Ok(Self { pictures, scalars, scratch, sittings, counts, numbers, bound })
    }

    /// Does something with the picture that a view was rendered to.
    pub(super) fn picture(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sitting: &Sitting,
        entry: &str,
    ) -> Result<(), InverseError> {
        let groups = tiles(sitting.view.size());
        Ok(self.pictures.dispatch_groups(encoder, &sitting.bound, entry, groups)?)
    }

    /// Does something with the sums.
    pub(super) fn scalars(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        entry: &str,
    ) -> Result<(), InverseError> {
        Ok(self.scalars.dispatch_groups(encoder, &self.bound, entry, [1, 1, 1])?)
    }

    /// The scale of regularisers and paces: the mean of W'C W 1 over `solved` numbers, which is 1'W'C W 1 over how many there are: the
    /// weighed squares of the pictures of ones. After `keep_residual` of these.
    pub(super) fn scale(&self, gpu: &Gpu, solved: usize) -> Result<f32, InverseError> {
        let squares: f32 = self.scratch.scalars.read_floats(gpu)?[4 * FIRST_RESIDUAL..][..3].iter().sum();
        Ok(squares / solved.max(1) as f32)
    }

    /// Before an iteration.
    pub(super) fn begin(&self, gpu: &Gpu) -> Result<(), InverseError> {
        let iterations = (self.numbers.iteration + 1) as f32;
        in_range("number of iterations", iterations, 1.0..=MOST_ITERATIONS as f32, "from 1 to 1024")?;
        self.counts.write(gpu, &self.numbers);
        Ok(())
    }

    /// After it.
    pub(super) fn end(&mut self) {
        self.numbers.iteration += 1;
    }

    /// The weighed sum of squares of what was wrong when each iteration began, by channel.
    pub(super) fn residuals(&self, gpu: &Gpu) -> Result<Vec<[f32; 3]>, InverseError> {
        let all = self.scratch.scalars.read_floats(gpu)?;
        let rows = all.chunks_exact(4).skip(FIRST_RESIDUAL).take(self.numbers.iteration as usize);
        Ok(rows.map(|row| [row[0], row[1], row[2]]).collect())
    }
}
