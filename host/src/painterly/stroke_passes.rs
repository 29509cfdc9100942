// SPDX-License-Identifier: MIT OR Apache-2.0
//! The passes of strokes.

use super::StrokeError;
use crate::core::Scan;
use crate::gpu::Gpu;
use crate::pass::{Pass, PassError, RenderStages};
use crate::shaders::Shaders;

/// Format of densities and pictures.
pub(super) const TARGET: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Premultiplied colour over what is there.
const OVER: wgpu::BlendState = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;

pub(super) struct StrokePasses {
    pub(super) update: Pass,
    pub(super) density: Pass,
    pub(super) population: Pass,
    pub(super) compact: Pass,
    pub(super) order: Pass,
    pub(super) draw: Pass,
    pub(super) scan: Scan,
    /// Whether strokes can follow curvature.
    pub(super) curvature: bool,
}

impl StrokePasses {
    pub(super) fn new(gpu: &Gpu, shaders: &Shaders, curvature: bool) -> Result<Self, StrokeError> {
        let permutation = if curvature { "curvature" } else { "default" };
        let compute = |pass: &str, permutation: &str| Pass::compute(gpu, shaders, pass, permutation);
        let stages = |vertex: &'static str, fragment: &'static str| RenderStages {
            vertex,
            fragment: Some(fragment),
            vertices: None,
            target: Some(TARGET),
            depth: None,
            samples: 1,
        };
        let composed = |pass: &str| shaders.compose(pass, "default").map_err(PassError::from);
        let density = composed("painterly/stroke_density")?;
        let draw = composed("painterly/draw_strokes")?;
        Ok(Self {
            update: compute("painterly/stroke_update", permutation)?,
            density: Pass::additive(gpu, &density, &stages("vertex_density", "fragment_density"), 1)?,
            population: compute("painterly/stroke_population", "default")?,
            compact: compute("painterly/stroke_compact", permutation)?,
            order: compute("painterly/stroke_order", "default")?,
            draw: Pass::blended(gpu, &draw, &stages("vertex_stroke", "fragment_stroke"), OVER, 1)?,
            scan: Scan::new(gpu, shaders)?,
            curvature,
        })
    }
}
