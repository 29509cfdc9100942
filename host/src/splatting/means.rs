// SPDX-License-Identifier: MIT OR Apache-2.0
//! Mean values of sheets along the rays of a camera, or of the light.

use super::SplattingError;
use super::order::Order;
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, Render, Resource};
use crate::resource::{Buffer, Texture};

/// Draws the splats of one sheet at a time as seen by one camera.
pub(super) struct Means {
    /// Of each sheet, all batches.
    sheets: Vec<Vec<Bound>>,
}

impl Means {
    /// Binds all sheets. `heights`: of the first surface along each ray, where the pass takes them.
    pub(super) fn new(
        gpu: &Gpu,
        pass: &Pass,
        order: &Order<'_>,
        camera: &Buffer,
        [sheets, kernel]: [&Buffer; 2],
        numbers: &[Buffer],
        heights: Option<&Texture>,
    ) -> Result<Self, SplattingError> {
        let bind = |number: &Buffer| -> Result<Vec<Bound>, SplattingError> {
            let of_batch = |sorted: &super::order::SortedBatch<'_>| {
                let mut resources: Vec<(&str, Resource<'_>)> = vec![
                    ("camera", camera.into()),
                    ("volume", (&sorted.splats.uniform).into()),
                    ("sheets", sheets.into()),
                    ("kernel", kernel.into()),
                    ("number", number.into()),
                    ("splats", (&sorted.batch.splats).into()),
                    ("order", (&sorted.batch.order).into()),
                    ("ranges", (&sorted.ranges).into()),
                ];
                resources.extend(heights.map(|heights| ("heights", heights.into())));
                Ok(pass.bind_known(gpu, &resources)?)
            };
            order.batches.iter().map(of_batch).collect()
        };
        Ok(Self { sheets: numbers.iter().map(bind).collect::<Result<_, _>>()? })
    }

    /// Records the mean values of a sheet into `target`, which is cleared; zeros of a sheet that there is not.
    pub(super) fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &Pass,
        order: &Order<'_>,
        sheet: u32,
        target: &Texture,
    ) {
        let mut render = Render::onto(encoder, target, wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT));
        let bound = self.sheets.get(sheet as usize).into_iter().flatten();
        for (bound, sorted) in bound.zip(&order.batches) {
            render.set(pass, bound);
            render.draw_indirect(&sorted.draws, 16 * u64::from(sheet));
        }
    }
}
