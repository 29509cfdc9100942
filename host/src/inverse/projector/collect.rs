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

pub(super) struct Collector {
    form: ProjectorForm,
    /// Of emission and of albedo.
    weigh: [Option<Pass>; 2],
    collect: Pass,
    /// Bytes of weighed steps in one piece at most.
    piece: u64,
}

impl Collector {
    pub(super) fn new(gpu: &Gpu, shaders: &Shaders, form: ProjectorForm) -> Result<Self, InverseError> {
        let paths = ("PATHS", form.solved == Solved::Extinction);
        let rgb = ("RGB", form.channels == Channels::Rgb);
        let boxes = ("BOX", form.basis == Basis::Box);
        let weigh = |wanted: bool, albedo: bool| {
            let flags = [rgb, ("ALBEDO", albedo)];
            wanted.then(|| compute(gpu, shaders, "inverse/weigh_slices", &flags)).transpose()
        };
        let [emission, albedo] = form.radiance();
        Ok(Self {
            form,
            weigh: [weigh(emission, false)?, weigh(albedo, true)?],
            collect: compute(gpu, shaders, "inverse/cg_backproject", &[paths, rgb, boxes])?,
            piece: gpu.limits.max_storage_buffer_binding_size,
        })
    }

    pub(super) fn backproject(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (view, medium, picture): (&ViewImages, &Medium, &Texture),
        collected: &[Collected<'_>],
    ) -> Result<(), InverseError> {
        // Without a pass that weighs steps, a step weighs its length.
        let weighing: Vec<Option<&Pass>> = match self.form.solved {
            Solved::Extinction => vec![None],
            _ => self.weigh.iter().flatten().map(Some).collect(),
        };
        let [width, height] = view.size;
        let row = u64::from(width) * u64::from(view.slices) * 4 * self.form.channels.numbers() as u64;
        let together = match self.form.solved {
            Solved::Extinction => height,
            _ => (self.piece / row.max(1)).clamp(1, u64::from(height)) as u32,
        };
        let steps = match self.form.solved {
            Solved::Extinction => [1; 3],
            _ => [width, together, view.slices],
        };
        let weighed = Texture::storage_volume(gpu, steps, self.form.channels.format());
        for (weigh, part) in weighing.into_iter().zip(collected) {
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
                if let Some(weigh) = weigh {
                    let bound = weigh.bind_known(gpu, &resources)?;
                    weigh.dispatch_groups(encoder, &bound, "weigh_slices", tiles([width, count]))?;
                }
                let bound = self.collect.bind_known(gpu, &resources)?;
                self.collect.dispatch_groups(encoder, &bound, "cg_backproject", groups)?;
            }
        }
        Ok(())
    }
}
