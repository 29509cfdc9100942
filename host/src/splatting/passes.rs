// SPDX-License-Identifier: MIT OR Apache-2.0
//! The passes of sheets.

use super::{Shading, SplattingError};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, PassError, RenderStages};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use wgpu::{BlendComponent, BlendFactor, BlendOperation, BlendState, TextureFormat};

/// Threads of a workgroup over voxels and splats.
pub(super) const GROUP: u32 = 256;
/// Format of mean values.
pub(super) const MEANS: TextureFormat = TextureFormat::R16Float;
/// Format of pictures and of the shadow buffer.
pub(super) const LIGHT: TextureFormat = TextureFormat::Rgba16Float;

/// Groups in rows of 65535.
pub(super) fn rows_of_groups(groups: u32) -> [u32; 3] {
    let row = groups.clamp(1, 65_535);
    [row, groups.div_ceil(row), 1]
}

const fn blend(src_factor: BlendFactor, dst_factor: BlendFactor) -> BlendComponent {
    BlendComponent { src_factor, dst_factor, operation: BlendOperation::Add }
}

/// Alphas are transmittances, and multiply.
const THROUGH: BlendComponent = blend(BlendFactor::Zero, BlendFactor::SrcAlpha);
const FRONT_TO_BACK: BlendState =
    BlendState { color: blend(BlendFactor::DstAlpha, BlendFactor::One), alpha: THROUGH };
const BACK_TO_FRONT: BlendState =
    BlendState { color: blend(BlendFactor::One, BlendFactor::SrcAlpha), alpha: THROUGH };
const DIMMED: BlendState = BlendState { color: blend(BlendFactor::Zero, BlendFactor::Src), alpha: THROUGH };

pub(super) struct Passes {
    pub(super) order: Pass,
    pub(super) splat: Pass,
    pub(super) dim: Pass,
    pub(super) front_to_back: Pass,
    pub(super) back_to_front: Pass,
}

impl Passes {
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        shading: Shading,
        scanning: bool,
    ) -> Result<Self, SplattingError> {
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
        let light = composed("splatting/light_sheet", &Definitions::new())?;
        let composite = composed("splatting/composite_sheet", &flag("PHONG", shading == Shading::Phong))?;
        let over = stages("vertex_picture", "fragment_composite_sheet", LIGHT);
        let dim = stages("vertex_picture", "fragment_light_sheet", LIGHT);
        Ok(Self {
            order: Pass::compute(gpu, shaders, "splatting/order_splats", "default")?,
            splat: Pass::additive(gpu, &splat, &stages("vertex_splat", "fragment_splat", MEANS), 1)?,
            dim: Pass::blended(gpu, &light, &dim, DIMMED, 1)?,
            front_to_back: Pass::blended(gpu, &composite, &over, FRONT_TO_BACK, 1)?,
            back_to_front: Pass::blended(gpu, &composite, &over, BACK_TO_FRONT, 1)?,
        })
    }
}

/// Draws into `target`: what was bound, with arguments of which those of `sheet` count. `clear`: or keep what is there.
pub(super) fn draw<'a>(
    encoder: &mut wgpu::CommandEncoder,
    target: &Texture,
    clear: Option<wgpu::Color>,
    pass: &Pass,
    sheet: u32,
    drawn: impl IntoIterator<Item = (&'a Bound, &'a Buffer)>,
) {
    let load = clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear);
    let mut render = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("splatting"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &target.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        ..Default::default()
    });
    for (bound, draws) in drawn {
        pass.set(&mut render, bound);
        render.draw_indirect(&draws.raw, 16 * u64::from(sheet));
    }
}
