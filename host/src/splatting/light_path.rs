// SPDX-License-Identifier: MIT OR Apache-2.0
//! How light goes from sheet to sheet.

use super::SplattingError;
use super::means::Means;
use super::order::{Order, tiles};
use super::passes::LIGHT;
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;

/// Draws what sheets are along light rays.
pub(super) struct LightSheets<'p> {
    pub(super) pass: &'p Pass,
    pub(super) order: &'p Order<'p>,
    pub(super) means: &'p Means,
    /// Mean values of the sheet that was drawn last.
    pub(super) target: &'p Texture,
}

impl LightSheets<'_> {
    /// Records the mean values of a sheet.
    pub(super) fn record(&self, encoder: &mut wgpu::CommandEncoder, sheet: u32) {
        self.means.record(encoder, self.pass, self.order, sheet, self.target);
    }
}

/// What a way of light through the sheets does, in the order in which it is asked.
pub(super) trait LightPath {
    /// Before the first sheet.
    fn begin(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sheets: &LightSheets<'_>,
    ) -> Result<(), SplattingError>;

    /// Before a sheet is put into the picture: its mean values along light rays are in the target, and what arrives of the light
    /// at it in `shadow`.
    fn arrive(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sheets: &LightSheets<'_>,
        sheet: u32,
    ) -> Result<(), SplattingError>;

    /// After that.
    fn leave(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sheets: &LightSheets<'_>,
        sheet: u32,
    ) -> Result<(), SplattingError>;

    /// What arrives at the sheet that is put into the picture next; behind the last, what is left.
    fn shadow(&self) -> &Texture;

    /// What else the picture's pass is to be given.
    fn resources(&self) -> Vec<(&'static str, Resource<'_>)>;
}

/// Light that is only taken away.
pub(super) struct DirectLight {
    pass: Pass,
    bound: Bound,
    shadow: Texture,
}

impl DirectLight {
    /// `resources`: all that the picture has, by name. `textured`: a light texture among them.
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        resources: &[(&str, Resource<'_>)],
        [width, height]: [u32; 2],
        textured: bool,
    ) -> Result<Self, SplattingError> {
        let form = if textured { "textured" } else { "default" };
        let pass = Pass::compute(gpu, shaders, "splatting/light_sheet", form)?;
        let shadow = Texture::storage(gpu, [width, height], LIGHT);
        let left = Buffer::storage(gpu, 16 * u64::from(width) * u64::from(height));
        let mut all = resources.to_vec();
        all.extend([("left", (&left).into()), ("shadow", (&shadow).into())]);
        let bound = pass.bind_known(gpu, &all)?;
        Ok(Self { pass, bound, shadow })
    }
}

impl LightPath for DirectLight {
    fn begin(&self, encoder: &mut wgpu::CommandEncoder, _: &LightSheets<'_>) -> Result<(), SplattingError> {
        Ok(self.pass.dispatch_groups(encoder, &self.bound, "begin_light", tiles(&self.shadow))?)
    }

    fn arrive(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sheets: &LightSheets<'_>,
        sheet: u32,
    ) -> Result<(), SplattingError> {
        sheets.record(encoder, sheet);
        Ok(())
    }

    fn leave(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sheets: &LightSheets<'_>,
        sheet: u32,
    ) -> Result<(), SplattingError> {
        let groups = sheets.order.over_shadow(sheet);
        Ok(self.pass.dispatch_indirect(encoder, &self.bound, "light_sheet_left", groups)?)
    }

    fn shadow(&self) -> &Texture {
        &self.shadow
    }

    fn resources(&self) -> Vec<(&'static str, Resource<'_>)> {
        Vec::new()
    }
}
