// SPDX-License-Identifier: MIT OR Apache-2.0
//! Finds how bright lights of the surroundings are: conjugate gradients on the GPU, whose coefficients never fall below 0.

mod held;
mod strategy;

pub use strategy::LightNumber;

use super::error::exact;
use super::projector::{bricks, tiles};
use super::{InverseError, Projector, Solved, SolverSums, Target};
use crate::gpu::Gpu;
use crate::out_of_range::in_range;
use crate::pass::{Bound, Pass};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use held::{Coefficients, Scratch, Sitting};
use strategy::{Columns, Operator, Volumes, check_columns};

/// Scalars before the residuals.
const FIRST_RESIDUAL: usize = 3;
/// Least of what a pace is one over, of the mean.
const STEEPEST: f32 = 1e-3;
/// Most iterations of one solver.
const MOST_ITERATIONS: u32 = 1024;
/// Most lights.
const MOST_LIGHTS: u32 = 1024;
/// The vectors of coefficients.
const SOLUTION: usize = 0;
const DIRECTION: usize = 1;
const TRIAL: usize = 2;

/// How pictures of all lights are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightStrategy {
    /// What all lights scatter is added up in one volume, which is rendered; a picture is projected back into a volume, which is
    /// multiplied with that of each light. Holds a volume a light.
    Volumes,
    /// The picture of each light in each view is rendered once and stored: fast where there are few lights and pixels.
    Columns,
}

/// Lights that are solved for.
pub struct LightUnknown {
    /// What each light alone makes the volume scatter where its coefficient is 1, such as [`super::LightPasses::scattered_each`] makes of
    /// disc lights; all of one size and of the projector's channels.
    pub volumes: Vec<Texture>,
    /// Coefficients to begin with, from 0 up: the projector's numbers a light.
    pub start: Vec<f32>,
    /// Weight of the squared coefficients, as a multiple of the mean of T'C T 1.
    pub smallness: f32,
    /// How it is solved.
    pub strategy: LightStrategy,
}

/// What it runs besides the projector.
struct Passes {
    pictures: Pass,
    volume: Pass,
    scalars: Pass,
}

/// Finds coefficients of lights whose pictures are nearest to those that are wanted.
pub struct LightSolver {
    projector: Projector,
    passes: Passes,
    scratch: Scratch,
    sittings: Vec<Sitting>,
    coefficients: Coefficients,
    operator: Operator,
    counts: Buffer,
    numbers: SolverSums,
    bound: Bound,
}

impl LightSolver {
    /// Prepares everything; stored pictures are rendered here. The projector is one that solves for albedo, for light and albedo are
    /// factors of each other: what media hold as `scattered` is the albedo of the medium here, and the light volumes stand where a
    /// solver of albedo has the albedo. All media have the extinction that the light volumes were made with.
    ///
    /// # Errors
    /// [`InverseError`]: another projector, numbers that are missing, out of range or too many, passes that cannot be made.
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        projector: Projector,
        targets: Vec<Target>,
        unknown: LightUnknown,
    ) -> Result<Self, InverseError> {
        if projector.solved() != Solved::Albedo {
            return Err(InverseError::LightProjector);
        }
        let LightUnknown { volumes, start, smallness, strategy } = unknown;
        let lights = volumes.len();
        in_range("number of lights", lights as f32, 1.0..=MOST_LIGHTS as f32, "from 1 to 1024")?;
        in_range("weight of small coefficients", smallness, 0.0..=f32::MAX, "0 or more and finite")?;
        let channels = projector.channels().numbers();
        let values = |volume: &Texture| {
            let texels: usize = volume.size().into_iter().map(|side| side as usize).product();
            texels * usize::from(volume.raw.format().components())
        };
        for volume in &volumes {
            exact("channels of light volumes", channels, usize::from(volume.raw.format().components()))?;
            if volume.size() != volumes[0].size() {
                exact("light volumes of one size", values(&volumes[0]), values(volume))?;
            }
        }
        check_columns(gpu, strategy, channels, lights, &targets)?;
        let definitions = projector.definitions();
        let pass =
            |name: &str, definitions: &Definitions| Pass::compute_with(gpu, shaders, name, definitions);
        let passes = Passes {
            pictures: pass("inverse/picture_sums", &definitions)?,
            volume: pass("inverse/solver_volume", &definitions)?,
            scalars: pass("inverse/solver_scalars", &Definitions::new())?,
        };
        let groups: u32 = bricks([lights as u32, 1, 1]).into_iter().product();
        let sums_of = |target: &Target| tiles(target.view.size()).into_iter().product::<u32>();
        let pictures: u32 = targets.iter().map(sums_of).sum();
        let numbers = SolverSums { groups, first_picture: 2 * groups, pictures, iteration: 0 };
        let scratch = Scratch::new(gpu, 2 * groups + pictures, MOST_ITERATIONS);
        let coefficients = Coefficients::new(gpu, &projector, &passes.volume, &scratch, lights, &start)?;
        let mut first = numbers.first_picture;
        let mut sittings = Vec::new();
        for target in targets {
            let own = sums_of(&target);
            sittings.push(Sitting::new(gpu, &projector, &passes.pictures, &scratch, target, first)?);
            first += own;
        }
        let (vectors, products) = (&coefficients.vectors, &coefficients.gradient);
        let operator = match strategy {
            LightStrategy::Volumes => Operator::Volumes(Box::new(Volumes::new(
                gpu, shaders, &projector, &volumes, vectors, products,
            )?)),
            LightStrategy::Columns => Operator::Columns(Columns::new(
                gpu, shaders, &projector, &volumes, vectors, products, &sittings,
            )?),
        };
        let counts = Buffer::uniform(gpu, &numbers);
        let resources = [
            ("counts", (&counts).into()),
            ("sums", (&scratch.sums).into()),
            ("scalars", (&scratch.scalars).into()),
        ];
        let bound = passes.scalars.bind_known(gpu, &resources)?;
        let mut solver =
            Self { projector, passes, scratch, sittings, coefficients, operator, counts, numbers, bound };
        solver.prepare(gpu, &start, smallness)?;
        Ok(solver)
    }

    /// Scales the regulariser by the mean of T'C T 1; what is sent back to a light says how far it goes. Then the solution begins
    /// where it should.
    fn prepare(&mut self, gpu: &Gpu, start: &[f32], smallness: f32) -> Result<(), InverseError> {
        let mut encoder = gpu.encoder();
        self.pictures_of(gpu, &mut encoder, SOLUTION, "weigh_picture")?;
        self.scalars(&mut encoder, "keep_residual")?;
        self.operator.collect(gpu, &mut encoder, &self.projector, &self.sittings)?;
        gpu.submit(encoder)?;
        let scalars = self.scratch.scalars.read_floats(gpu)?;
        let squares: f32 = scalars[4 * FIRST_RESIDUAL..][..3].iter().sum();
        let lights = self.coefficients.count as usize;
        let scale = squares / (self.projector.channels().used() * lights) as f32;
        let own = &mut self.coefficients;
        own.vectors[SOLUTION].write_floats(gpu, start);
        own.settings.smallness = scale * smallness;
        own.settings.steepest = scale * STEEPEST;
        own.uniform.write(gpu, &own.settings);
        let mut encoder = gpu.encoder();
        self.lights(&mut encoder, "solver_paces")?;
        Ok(gpu.submit(encoder)?)
    }

    /// Pictures of all views in the lights of a vector, with each of which something is done.
    fn pictures_of(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        vector: usize,
        entry: &str,
    ) -> Result<(), InverseError> {
        self.operator.render(gpu, encoder, &self.projector, &self.sittings, vector)?;
        for sitting in &self.sittings {
            let groups = tiles(sitting.view.size());
            self.passes.pictures.dispatch_groups(encoder, &sitting.bound, entry, groups)?;
        }
        Ok(())
    }

    fn lights(&self, encoder: &mut wgpu::CommandEncoder, entry: &str) -> Result<(), InverseError> {
        let own = &self.coefficients;
        let groups = bricks([own.count, 1, 1]);
        Ok(self.passes.volume.dispatch_groups(encoder, &own.bound, entry, groups)?)
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
        self.pictures_of(gpu, &mut encoder, SOLUTION, "weigh_difference")?;
        self.scalars(&mut encoder, "keep_residual")?;
        self.operator.collect(gpu, &mut encoder, &self.projector, &self.sittings)?;
        self.lights(&mut encoder, "solver_gradient")?;
        self.scalars(&mut encoder, "choose_direction")?;
        self.lights(&mut encoder, "solver_direction")?;
        self.pictures_of(gpu, &mut encoder, DIRECTION, "weigh_picture")?;
        self.lights(&mut encoder, "solver_curvature")?;
        self.scalars(&mut encoder, "choose_step")?;
        self.lights(&mut encoder, "solver_advance")?;
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

    /// The coefficients as they are: the projector's numbers a light.
    ///
    /// # Errors
    /// [`InverseError::Gpu`].
    pub fn coefficients(&self, gpu: &Gpu) -> Result<Vec<f32>, InverseError> {
        self.read(gpu, &self.coefficients.vectors[SOLUTION])
    }

    fn read(&self, gpu: &Gpu, vector: &Buffer) -> Result<Vec<f32>, InverseError> {
        let mut values = vector.read_floats(gpu)?;
        values.truncate(self.projector.channels().numbers() * self.coefficients.count as usize);
        Ok(values)
    }

    /// T L: pictures of all views with coefficients of one's own, numbers of the projector's channels a pixel.
    ///
    /// # Errors
    /// [`InverseError::Count`], [`InverseError::Gpu`].
    pub fn pictures(&self, gpu: &Gpu, coefficients: &[f32]) -> Result<Vec<Vec<f32>>, InverseError> {
        let needed = self.projector.channels().numbers() * self.coefficients.count as usize;
        exact("coefficients of lights", needed, coefficients.len())?;
        self.coefficients.vectors[TRIAL].write_floats(gpu, coefficients);
        let mut encoder = gpu.encoder();
        self.operator.render(gpu, &mut encoder, &self.projector, &self.sittings, TRIAL)?;
        gpu.submit(encoder)?;
        self.sittings.iter().map(|sitting| Ok(sitting.view.rendered.read(gpu)?)).collect()
    }

    /// T' c: what pictures of all views say of each light.
    ///
    /// # Errors
    /// [`InverseError::Count`], [`InverseError::Gpu`].
    pub fn products(&self, gpu: &Gpu, pictures: &[Vec<f32>]) -> Result<Vec<f32>, InverseError> {
        exact("pictures of views", self.sittings.len(), pictures.len())?;
        for (sitting, picture) in self.sittings.iter().zip(pictures) {
            sitting.difference.write(gpu, picture)?;
        }
        let mut encoder = gpu.encoder();
        self.operator.collect(gpu, &mut encoder, &self.projector, &self.sittings)?;
        gpu.submit(encoder)?;
        let products = self.read(gpu, &self.coefficients.gradient);
        // An iteration finds zeros there.
        let mut encoder = gpu.encoder();
        encoder.clear_buffer(&self.coefficients.gradient.raw, 0, None);
        gpu.submit(encoder)?;
        products
    }
}
