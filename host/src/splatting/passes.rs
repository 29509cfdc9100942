// SPDX-License-Identifier: MIT OR Apache-2.0
//! The passes of sheets.

use super::{Shading, SplattingError};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, PassError, RenderStages, begin_target};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use wgpu::TextureFormat;

/// Threads of a workgroup over voxels and splats.
pub(super) const GROUP: u32 = 256;
/// Format of mean values.
pub(super) const MEANS: TextureFormat = TextureFormat::Rgba16Float;
/// Format of pictures and of the shadow buffer.
pub(super) const LIGHT: TextureFormat = TextureFormat::Rgba16Float;

/// Groups in rows of 65535.
pub(super) fn rows_of_groups(groups: u32) -> [u32; 3] {
    let row = groups.clamp(1, 65_535);
    [row, groups.div_ceil(row), 1]
}

pub(super) struct Passes {
    pub(super) order: Pass,
    pub(super) splat: Pass,
    pub(super) light: Pass,
    pub(super) composite: Pass,
}

impl Passes {
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        shading: Shading,
        scanning: bool,
    ) -> Result<Self, SplattingError> {
        let shading = if shading == Shading::Phong { "phong" } else { "default" };
        let stages = |vertex: &'static str, fragment: &'static str, target| RenderStages {
            vertex,
            fragment: Some(fragment),
            vertices: None,
            target: Some(target),
            depth: None,
            samples: 1,
        };
        let composed = |pass: &str, definitions: &Definitions| {
            shaders.compose_with(pass, definitions).map_err(PassError::from)
        };
        let flag = |name: &'static str, set: bool| {
            let none = Definitions::new();
            if set { none.flag(name) } else { none }
        };
        let splat = composed("splatting/splat_sheet", &flag("SCANNING", scanning))?;
        Ok(Self {
            order: Pass::compute(gpu, shaders, "splatting/order_splats", "default")?,
            splat: Pass::additive(gpu, &splat, &stages("vertex_splat", "fragment_splat", MEANS), 1)?,
            light: Pass::compute(gpu, shaders, "splatting/light_sheet", "default")?,
            composite: Pass::compute(gpu, shaders, "splatting/composite_sheet", shading)?,
        })
    }
}

/// Draws into `target`, cleared: what was bound, with arguments of which those of `sheet` count.
pub(super) fn draw<'a>(
    encoder: &mut wgpu::CommandEncoder,
    target: &Texture,
    pass: &Pass,
    sheet: u32,
    drawn: impl IntoIterator<Item = (&'a Bound, &'a Buffer)>,
) {
    let load = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
    let mut render = begin_target(encoder, target, load);
    for (bound, draws) in drawn {
        pass.set(&mut render, bound);
        render.draw_indirect(&draws.raw, 16 * u64::from(sheet));
    }
}
