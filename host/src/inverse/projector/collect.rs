// SPDX-License-Identifier: MIT OR Apache-2.0
//! The transpose in which voxels collect.

use super::{
    BRICK, Basis, Channels, Collected, InverseError, Medium, ProjectorForm, Solved, ViewImages, compute,
    tiles,
};
use crate::gpu::Gpu;
use crate::inverse::{PictureRows, VoxelGrid};
use crate::pass::{Pass, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use glam::UVec3;
use std::sync::{Mutex, PoisonError};

pub(super) struct Collector {
    form: ProjectorForm,
    /// Of emission, of albedo, of both in this order, or of extinction.
    weigh: Vec<Pass>,
    collect: Pass,
    steps: Mutex<Option<Texture>>,
    /// Bytes of weighed steps in one piece at most.
    piece: u64,
}

impl Collector {
    pub(super) fn new(gpu: &Gpu, shaders: &Shaders, form: ProjectorForm) -> Result<Self, InverseError> {
        let paths = form.solved == Solved::Extinction;
        let rgb = ("RGB", form.channels == Channels::Rgb);
        let boxes = ("BOX", form.basis == Basis::Box);
        let [emission, albedo] = form.radiance();
        let weigh = [("EMISSION", emission), ("ALBEDO", albedo), ("PATHS", paths)];
        let weigh = weigh.iter().filter(|(_, wanted)| *wanted);
        let weigh = weigh.map(|(name, _)| {
            compute(gpu, shaders, "inverse/weigh_slices", &[rgb, (name, *name != "EMISSION")])
        });
        Ok(Self {
            form,
            weigh: weigh.collect::<Result<_, _>>()?,
            collect: compute(gpu, shaders, "inverse/cg_backproject", &[("PATHS", paths), rgb, boxes])?,
            steps: Mutex::new(None),
            piece: gpu.limits.max_storage_buffer_binding_size,
        })
    }

    /// Where the weighed steps of a view go: the same for all views of a size, so that many of them need no more memory than one.
    fn steps(&self, gpu: &Gpu, size: [u32; 3]) -> Texture {
        let mut kept = self.steps.lock().unwrap_or_else(PoisonError::into_inner);
        match &*kept {
            Some(steps) if steps.size() == size => steps.clone(),
            _ => {
                let steps = Texture::storage_volume(gpu, size, self.form.channels.format());
                kept.insert(steps).clone()
            }
        }
    }

    pub(super) fn backproject(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (view, medium, picture): (&ViewImages, &Medium, &Texture),
        collected: &[Collected<'_>],
    ) -> Result<(), InverseError> {
        let paths = self.form.solved == Solved::Extinction;
        // Of paths one slice stands for all.
        let slices = if paths { 1 } else { view.slices };
        let [width, height] = view.size;
        let row = u64::from(width) * u64::from(slices) * 4 * self.form.channels.numbers() as u64;
        let together = (self.piece / row.max(1)).clamp(1, u64::from(height)) as u32;
        let weighed = self.steps(gpu, [width, together, slices]);
        for (weigh, part) in self.weigh.iter().zip(collected) {
            let size = part.grid;
            let grid = Buffer::uniform(gpu, &VoxelGrid { size: UVec3::from(size), reserved_a: 0 });
            let groups = [0, 1, 2].map(|axis| size[axis].div_ceil(BRICK[axis]));
            for first in (0..height).step_by(together as usize) {
                let count = together.min(height - first);
                let rows = Buffer::uniform(gpu, &PictureRows { first, count, reserved_a: 0, reserved_b: 0 });
                let resources: [(&str, Resource<'_>); 10] = [
                    ("view", (&view.view).into()),
                    ("spans", (&view.spans).into()),
                    ("rows", (&rows).into()),
                    ("grid", (&grid).into()),
                    ("picture", picture.into()),
                    ("extinction", (&medium.extinction).into()),
                    ("scattered", (&medium.scattered).into()),
                    ("weighed", (&weighed).into()),
                    ("solved", part.wanted.into()),
                    ("collected", part.sums.into()),
                ];
                let bound = weigh.bind_known(gpu, &resources)?;
                weigh.dispatch_groups(encoder, &bound, "weigh_slices", tiles([width, count]))?;
                let bound = self.collect.bind_known(gpu, &resources)?;
                self.collect.dispatch_groups(encoder, &bound, "cg_backproject", groups)?;
            }
        }
        Ok(())
    }
}
