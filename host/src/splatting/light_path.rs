// SPDX-License-Identifier: MIT OR Apache-2.0
//! How light goes from sheet to sheet.

use super::means::Means;
use super::order::{Order, tiles};
use super::passes::LIGHT;
use super::{SheetFrame, Sheets, SplattingError};
use crate::core::Camera;
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, Resource};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use glam::Vec3;

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
    /// Before a frame: the camera of the shadow buffer. `points`: metres, whose convex hull holds all splats.
    fn set(
        &self,
        _gpu: &Gpu,
        _sheets: &Sheets,
        frame: &SheetFrame,
        _points: &[Vec3],
    ) -> Result<Camera, SplattingError> {
        let [width, height, _] = self.shadow().size();
        Ok(frame.light_camera([width, height]))
    }

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

    /// What comes back out of the first sheet, where anything does.
    fn returned(&self) -> Option<&Texture> {
        None
    }

    /// What else the picture's pass is to be given.
    fn resources(&self) -> Vec<(&'static str, Resource<'_>)>;

    /// Bytes of its textures and larger buffers.
    fn memory(&self) -> u64;
}

/// Light that is only taken away.
pub(super) struct DirectLight {
    pass: Pass,
    /// Of each sheet.
    bound: Vec<Bound>,
    left: Buffer,
    shadow: Texture,
}

impl DirectLight {
    /// `resources`: all that the picture has, by name, with or without surfaces and a light texture; `numbers`: of the sheets.
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        resources: &[(&str, Resource<'_>)],
        numbers: &[Buffer],
        [width, height]: [u32; 2],
    ) -> Result<Self, SplattingError> {
        let has = |wanted: &str| resources.iter().any(|(name, _)| *name == wanted);
        let flags = [("POLYGONS", has("light_heights")), ("LIGHT_TEXTURE", has("light_texture"))];
        let definitions = Definitions::new().flags(&flags);
        let pass = Pass::compute_with(gpu, shaders, "splatting/light_sheet", &definitions)?;
        let shadow = Texture::storage(gpu, [width, height], LIGHT);
        let left = Buffer::storage(gpu, 16 * u64::from(width) * u64::from(height));
        let mut all = resources.to_vec();
        all.extend([("left", (&left).into()), ("shadow", (&shadow).into())]);
        let bind = |number: &Buffer| {
            let mut all = all.clone();
            all.push(("number", number.into()));
            pass.bind_known(gpu, &all)
        };
        let bound = numbers.iter().map(bind).collect::<Result<_, _>>()?;
        Ok(Self { pass, bound, left, shadow })
    }
}

impl LightPath for DirectLight {
    fn begin(&self, encoder: &mut wgpu::CommandEncoder, _: &LightSheets<'_>) -> Result<(), SplattingError> {
        Ok(self.pass.dispatch_groups(encoder, &self.bound[0], "begin_light", tiles(&self.shadow))?)
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
        Ok(self.pass.dispatch_indirect(encoder, &self.bound[sheet as usize], "light_sheet_left", groups)?)
    }

    fn shadow(&self) -> &Texture {
        &self.shadow
    }

    fn resources(&self) -> Vec<(&'static str, Resource<'_>)> {
        Vec::new()
    }

    fn memory(&self) -> u64 {
        self.left.raw.size() + self.shadow.memory()
    }
}
