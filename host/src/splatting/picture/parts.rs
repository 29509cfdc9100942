// SPDX-License-Identifier: MIT OR Apache-2.0
//! Parts of a picture by themselves, for their cost; together they are no picture.

use super::{LightSheets, SheetPicture, SplattingError};
use crate::gpu::Gpu;

impl SheetPicture<'_> {
    /// Records the sort of splats by sheet.
    pub(crate) fn record_order(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), SplattingError> {
        self.order.record(gpu, encoder)
    }

    /// Records the splats of all sheets as the eye sees them. The sort must have run.
    pub(crate) fn record_eye_splats(&self, encoder: &mut wgpu::CommandEncoder) {
        for index in 0..self.settings.count {
            let target = &self.means[index as usize % 3];
            self.eye.record(encoder, &self.passes.splat, &self.order, index, target);
        }
    }

    /// Records the splats of all sheets as the light sees them. The sort must have run.
    pub(crate) fn record_light_splats(&self, encoder: &mut wgpu::CommandEncoder) {
        for index in 0..self.settings.count {
            self.light.record(encoder, &self.passes.light_splat, &self.order, index, &self.light_means);
        }
    }

    /// Records what is done over pixels of each sheet that has splats, in the picture and for what is left of direct light, with
    /// whatever the textures of mean values hold. The sort must have run.
    pub(crate) fn record_composites(&self, encoder: &mut wgpu::CommandEncoder) -> Result<(), SplattingError> {
        let (splat, order) = (&self.passes.splat, &self.order);
        let sheets = LightSheets { pass: splat, order, means: &self.light, target: &self.light_means };
        for (index, bound) in (0..self.settings.count).zip(&self.composites) {
            let groups = order.over_picture(index);
            self.passes.composite.dispatch_indirect(encoder, bound, "composite_sheet", groups)?;
            self.path.leave(encoder, &sheets, index)?;
        }
        Ok(())
    }
}
