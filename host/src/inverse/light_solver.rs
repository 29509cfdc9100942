// SPDX-License-Identifier: MIT OR Apache-2.0
//! Finds how bright lights of the surroundings are: conjugate gradients on the GPU, whose coefficients never fall below 0.

mod strategy;

pub use strategy::LightNumber;

use super::descent::{Descent, VectorStart, Vectors};
use super::error::exact;
use super::projector::bricks;
use super::{InverseError, Projector, Regulariser, Solved, Target};
use crate::gpu::Gpu;
use crate::out_of_range::in_range;
use crate::pass::Pass;
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use strategy::{Columns, Operator, Volumes, check_columns};

/// Most lights.
const MOST_LIGHTS: u32 = 1024;
/// The vectors of coefficients that pictures are rendered of.
const VECTORS: usize = 3;
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

/// Finds coefficients of lights whose pictures are nearest to those that are wanted.
pub struct LightSolver {
    projector: Projector,
    volume: Pass,
    descent: Descent,
    /// The coefficients: to the passes a volume of one row.
    vectors: Vectors,
    /// Coefficients to try.
    trial: Buffer,
    lights: usize,
    operator: Operator,
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
        let channels = projector.channels().numbers();
        in_range("number of lights", lights as f32, 1.0..=MOST_LIGHTS as f32, "from 1 to 1024")?;
        in_range("weight of small coefficients", smallness, 0.0..=f32::MAX, "0 or more and finite")?;
        check_volumes(channels, &volumes)?;
        exact("coefficients to begin with", channels * lights, start.len())?;
        for value in &start {
            in_range("coefficient of a light", *value, 0.0..=f32::MAX, "0 or more and finite")?;
        }
        check_columns(gpu, strategy, channels, lights, &targets)?;
        let definitions = projector.definitions();
        let volume = Pass::compute_with(gpu, shaders, "inverse/solver_volume", &definitions)?;
        let size = [lights as u32, 1, 1];
        let groups: u32 = bricks(size).into_iter().product();
        let descent = Descent::new(gpu, shaders, &projector, targets, groups)?;
        let begin = VectorStart { size, first_group: 0, groups, high: f32::MAX, solved: vec![1.0; lights] };
        let vectors = Vectors::new(gpu, &projector, &volume, &descent, &begin)?;
        let trial = Buffer::storage(gpu, 4 * (channels * lights) as u64);
        let rendered = [&vectors.solution, &vectors.direction, &trial];
        let products = &vectors.gradient;
        let operator = match strategy {
            LightStrategy::Volumes => Operator::Volumes(Box::new(Volumes::new(
                gpu, shaders, &projector, &volumes, &rendered, products,
            )?)),
            LightStrategy::Columns => Operator::Columns(Columns::new(
                gpu,
                shaders,
                &projector,
                &volumes,
                &rendered,
                products,
                &descent.sittings,
            )?),
        };
        let mut solver = Self { projector, volume, descent, vectors, trial, lights, operator };
        solver.prepare(gpu, &start, smallness)?;
        Ok(solver)
    }

    /// Scales the regulariser and finds paces: what the pictures of ones send back to a light says how far it goes.
    fn prepare(&mut self, gpu: &Gpu, start: &[f32], smallness: f32) -> Result<(), InverseError> {
        let mut encoder = gpu.encoder();
        self.pictures_of(gpu, &mut encoder, SOLUTION, "weigh_picture")?;
        self.descent.scalars(&mut encoder, "keep_residual")?;
        self.collect(gpu, &mut encoder)?;
        gpu.submit(encoder)?;
        let scale = self.descent.scale(gpu, self.projector.channels().used() * self.lights)?;
        self.vectors.prepare(gpu, scale, Regulariser { smallness, ..Regulariser::default() }, start);
        let mut encoder = gpu.encoder();
        self.vectors.dispatch(&mut encoder, &self.volume, "solver_paces")?;
        Ok(gpu.submit(encoder)?)
    }

    /// Pictures of all views in the lights of a vector.
    fn render(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        vector: usize,
    ) -> Result<(), InverseError> {
        self.operator.render(gpu, encoder, &self.projector, &self.descent.sittings, vector)
    }

    /// These pictures, with each of which something is done.
    fn pictures_of(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        vector: usize,
        entry: &str,
    ) -> Result<(), InverseError> {
        self.render(gpu, encoder, vector)?;
        self.descent.sittings.iter().try_for_each(|sitting| self.descent.picture(encoder, sitting, entry))
    }

    /// What the differences of all views say of each light.
    fn collect(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), InverseError> {
        self.operator.collect(gpu, encoder, &self.projector, &self.descent.sittings)
    }

    /// One iteration.
    ///
    /// # Errors
    /// [`InverseError`].
    pub fn iterate(&mut self, gpu: &Gpu) -> Result<(), InverseError> {
        self.descent.begin(gpu)?;
        let mut encoder = gpu.encoder();
        self.pictures_of(gpu, &mut encoder, SOLUTION, "weigh_difference")?;
        self.descent.scalars(&mut encoder, "keep_residual")?;
        self.collect(gpu, &mut encoder)?;
        self.vectors.dispatch(&mut encoder, &self.volume, "solver_gradient")?;
        self.descent.scalars(&mut encoder, "choose_direction")?;
        self.vectors.dispatch(&mut encoder, &self.volume, "solver_direction")?;
        self.pictures_of(gpu, &mut encoder, DIRECTION, "weigh_picture")?;
        self.vectors.dispatch(&mut encoder, &self.volume, "solver_curvature")?;
        self.descent.scalars(&mut encoder, "choose_step")?;
        self.vectors.dispatch(&mut encoder, &self.volume, "solver_advance")?;
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

    /// The coefficients as they are: the projector's numbers a light.
    ///
    /// # Errors
    /// [`InverseError::Gpu`].
    pub fn coefficients(&self, gpu: &Gpu) -> Result<Vec<f32>, InverseError> {
        self.vectors.read(gpu, &self.projector, &self.vectors.solution)
    }

    /// T L: pictures of all views with coefficients of one's own, numbers of the projector's channels a pixel.
    ///
    /// # Errors
    /// [`InverseError::Count`], [`InverseError::Gpu`].
    pub fn pictures(&self, gpu: &Gpu, coefficients: &[f32]) -> Result<Vec<Vec<f32>>, InverseError> {
        let needed = self.projector.channels().numbers() * self.lights;
        exact("coefficients of lights", needed, coefficients.len())?;
        self.trial.write_floats(gpu, coefficients);
        let mut encoder = gpu.encoder();
        self.render(gpu, &mut encoder, TRIAL)?;
        gpu.submit(encoder)?;
        self.descent.sittings.iter().map(|sitting| Ok(sitting.view.rendered.read(gpu)?)).collect()
    }

    /// T' c: what pictures of all views say of each light.
    ///
    /// # Errors
    /// [`InverseError::Count`], [`InverseError::Gpu`].
    pub fn products(&self, gpu: &Gpu, pictures: &[Vec<f32>]) -> Result<Vec<f32>, InverseError> {
        exact("pictures of views", self.descent.sittings.len(), pictures.len())?;
        for (sitting, picture) in self.descent.sittings.iter().zip(pictures) {
            sitting.difference.write(gpu, picture)?;
        }
        let mut encoder = gpu.encoder();
        self.collect(gpu, &mut encoder)?;
        gpu.submit(encoder)?;
        let products = self.vectors.read(gpu, &self.projector, &self.vectors.gradient);
        // An iteration finds zeros there.
        let mut encoder = gpu.encoder();
        encoder.clear_buffer(&self.vectors.gradient.raw, 0, None);
        gpu.submit(encoder)?;
        products
    }
}

/// Light volumes of one size and of the channels that are solved for.
fn check_volumes(channels: usize, volumes: &[Texture]) -> Result<(), InverseError> {
    let values = |volume: &Texture| {
        let texels: usize = volume.size().into_iter().map(|side| side as usize).product();
        texels * usize::from(volume.raw.format().components())
    };
    for volume in volumes {
        exact("channels of light volumes", channels, usize::from(volume.raw.format().components()))?;
        if volume.size() != volumes[0].size() {
            exact("light volumes of one size", values(&volumes[0]), values(volume))?;
        }
    }
    Ok(())
}
