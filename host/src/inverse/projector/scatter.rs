// SPDX-License-Identifier: MIT OR Apache-2.0
//! The transpose in which rays scatter.

use super::{
    Basis, Channels, Collected, InverseError, Medium, ProjectorForm, Solved, Transpose, ViewImages, bricks,
    compute, tiles,
};
use crate::gpu::Gpu;
use crate::inverse::VoxelGrid;
use crate::pass::{Pass, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use glam::UVec3;
use std::sync::{Mutex, PoisonError};

/// The passes of one volume that is solved for.
struct PartPasses {
    albedo: bool,
    /// None where sums are floats.
    greatest: Option<Pass>,
    scatter: Pass,
    sums: Pass,
}

pub(super) struct Scatterer {
    form: ProjectorForm,
    parts: Vec<PartPasses>,
    /// Zeros between back-projections.
    words: Mutex<Option<Buffer>>,
}

impl Scatterer {
    pub(super) fn new(gpu: &Gpu, shaders: &Shaders, form: ProjectorForm) -> Result<Self, InverseError> {
        let swap = form.transpose == Transpose::Swap;
        let part = |albedo: bool| {
            let flags = [
                ("PATHS", form.solved == Solved::Extinction),
                ("ALBEDO", albedo),
                ("RGB", form.channels == Channels::Rgb),
                ("SWAP", swap),
                ("BOX", form.basis == Basis::Box),
                ("BENT", form.refraction.is_some()),
            ];
            let greatest = || compute(gpu, shaders, "inverse/greatest_values", &flags[1..2]);
            Ok::<_, InverseError>(PartPasses {
                albedo,
                greatest: (!swap).then(greatest).transpose()?,
                scatter: compute(gpu, shaders, "inverse/scatter_steps", &flags)?,
                sums: compute(gpu, shaders, "inverse/scattered_sums", &flags[2..4])?,
            })
        };
        let parts = match form.solved {
            Solved::Emission | Solved::Extinction => vec![part(false)?],
            Solved::Albedo => vec![part(true)?],
            Solved::Both => vec![part(false)?, part(true)?],
        };
        Ok(Self { form, parts, words: Mutex::new(None) })
    }

    /// Zeros for the sums of the greatest of the volumes. Each leaves zeros to the next, so that many views need no more memory than one.
    fn words(&self, gpu: &Gpu, collected: &[Collected<'_>]) -> Result<Buffer, InverseError> {
        let voxels = |part: &Collected<'_>| part.grid.iter().map(|side| u64::from(*side)).product();
        let most: u64 = collected.iter().map(voxels).max().unwrap_or(0);
        let number = if self.form.transpose == Transpose::Swap { 4 } else { 8 };
        let bytes = most * self.form.channels.used() as u64 * number;
        let limit = gpu.limits.max_storage_buffer_binding_size.min(gpu.limits.max_buffer_size);
        if bytes > limit {
            return Err(InverseError::Memory { name: "sums of a back-projection", bytes, limit });
        }
        let mut kept = self.words.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(match &*kept {
            Some(words) if words.raw.size() >= bytes => words.clone(),
            _ => kept.insert(Buffer::storage(gpu, bytes.max(16))).clone(),
        })
    }

    pub(super) fn backproject(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (view, medium, picture): (&ViewImages, &Medium, &Texture),
        collected: &[Collected<'_>],
    ) -> Result<(), InverseError> {
        let words = self.words(gpu, collected)?;
        for (passes, part) in self.parts.iter().zip(collected) {
            let grid = Buffer::uniform(gpu, &VoxelGrid { size: UVec3::from(part.grid), reserved_a: 0 });
            // Four channels of the picture, then the bounds of row sums: those of albedo are found on the GPU.
            let bound = match self.form.solved {
                Solved::Extinction => view.longest,
                _ if passes.albedo => 0.0,
                _ => 1.0,
            };
            let greatest = Buffer::of_floats(gpu, &[0.0, 0.0, 0.0, 0.0, bound, bound, bound, bound]);
            let mut resources: Vec<(&str, Resource<'_>)> = vec![
                ("view", (&view.view).into()),
                ("spans", (&view.spans).into()),
                ("steps", (&view.steps).into()),
                ("grid", (&grid).into()),
                ("picture", picture.into()),
                ("extinction", (&medium.extinction).into()),
                ("scattered", (&medium.scattered).into()),
                ("greatest", (&greatest).into()),
                ("words", (&words).into()),
                ("solved", part.wanted.into()),
                ("collected", part.sums.into()),
            ];
            if self.form.refraction.is_some() {
                resources.push(("refraction", medium.index.as_ref().ok_or(InverseError::Index)?.into()));
            }
            // All before any dispatch: one that is refused leaves the words alone.
            let scatter = passes.scatter.bind_known(gpu, &resources)?;
            let sums = passes.sums.bind_known(gpu, &resources)?;
            if let Some(pass) = &passes.greatest {
                let bound = pass.bind_known(gpu, &resources)?;
                pass.dispatch_groups(encoder, &bound, "greatest_picture", tiles(view.size))?;
                if passes.albedo {
                    let groups = bricks(medium.scattered.size());
                    pass.dispatch_groups(encoder, &bound, "greatest_light", groups)?;
                }
            }
            passes.scatter.dispatch_groups(encoder, &scatter, "scatter_steps", tiles(view.size))?;
            passes.sums.dispatch_groups(encoder, &sums, "scattered_sums", bricks(part.grid))?;
        }
        Ok(())
    }
}
