// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the solver of lights holds of each view, and of the coefficients.

use super::super::error::exact;
use super::super::projector::{bricks, tiles};
use super::super::{InverseError, Medium, PictureRows, Projector, SolverPart, Target, ViewImages};
use super::FIRST_RESIDUAL;
use crate::gpu::Gpu;
use crate::out_of_range::in_range;
use crate::pass::{Bound, Pass};
use crate::resource::{Buffer, Texture};
use glam::UVec3;
use std::sync::Arc;
use wgpu::TextureFormat::R32Float;

/// Vectors of coefficients: the solution, the direction and one to try.
pub(super) const VECTORS: usize = 3;

/// What it holds of a view.
pub(super) struct Sitting {
    pub(super) view: ViewImages,
    pub(super) medium: Arc<Medium>,
    /// What is wrong with its picture, weighed.
    pub(super) difference: Texture,
    pub(super) bound: Bound,
}

/// Sums of groups, and what they say.
pub(super) struct Scratch {
    pub(super) sums: Buffer,
    pub(super) scalars: Buffer,
}

/// The coefficients of all lights: to the passes a volume of one row.
pub(super) struct Coefficients {
    pub(super) count: u32,
    pub(super) uniform: Buffer,
    pub(super) settings: SolverPart,
    /// Solution, direction, one to try.
    pub(super) vectors: [Buffer; VECTORS],
    pub(super) gradient: Buffer,
    pub(super) bound: Bound,
}

impl Scratch {
    /// For as many sums and iterations.
    pub(super) fn new(gpu: &Gpu, sums: u32, iterations: u32) -> Self {
        Self {
            sums: Buffer::storage(gpu, 16 * u64::from(sums)),
            scalars: Buffer::storage(gpu, 16 * (FIRST_RESIDUAL as u64 + u64::from(iterations))),
        }
    }
}

impl Sitting {
    /// `first`: of its sums.
    pub(super) fn new(
        gpu: &Gpu,
        projector: &Projector,
        pass: &Pass,
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
        let bound = pass.bind_known(gpu, &resources)?;
        Ok(Self { view: target.view, medium: target.medium, difference, bound })
    }
}

impl Coefficients {
    /// Ones, so that regularisers can be scaled. `start`: what the solution begins with, which is only checked.
    pub(super) fn new(
        gpu: &Gpu,
        projector: &Projector,
        pass: &Pass,
        scratch: &Scratch,
        lights: usize,
        start: &[f32],
    ) -> Result<Self, InverseError> {
        let numbers = projector.channels().numbers();
        exact("coefficients to begin with", numbers * lights, start.len())?;
        for value in start {
            in_range("coefficient of a light", *value, 0.0..=f32::MAX, "0 or more and finite")?;
        }
        let count = lights as u32;
        let settings = SolverPart {
            size: UVec3::new(count, 1, 1),
            first_group: 0,
            laplacian: 0.0,
            smallness: 0.0,
            oneness: 0.0,
            low: 0.0,
            high: f32::MAX,
            groups: bricks([count, 1, 1]).into_iter().product(),
            steepest: 0.0,
            reserved_a: 0,
        };
        let uniform = Buffer::uniform(gpu, &settings);
        let ones = |count: usize| Buffer::of_floats(gpu, &vec![1.0; count]);
        let solved = ones(lights);
        let bytes = 4 * (numbers * lights) as u64;
        let [gradient, downward, direction, roughness, trial] = [0; 5].map(|_| Buffer::storage(gpu, bytes));
        let solution = ones(numbers * lights);
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
        let bound = pass.bind_known(gpu, &resources)?;
        Ok(Self { count, uniform, settings, vectors: [solution, direction, trial], gradient, bound })
    }
}
