// SPDX-License-Identifier: MIT OR Apache-2.0
//! What a solver holds of each view.

use super::super::error::exact;
use super::super::projector::tiles;
use super::super::{InverseError, Medium, PictureRows, Projector, Target, ViewImages};
use super::Scratch;
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass};
use crate::resource::{Buffer, Texture};
use std::sync::Arc;
use wgpu::TextureFormat::R32Float;

/// A view and what is wrong with its picture.
pub(in super::super) struct Sitting {
    pub(in super::super) view: ViewImages,
    pub(in super::super) medium: Arc<Medium>,
    /// What is wrong with its picture, weighed.
    pub(in super::super) difference: Texture,
    pub(super) bound: Bound,
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
