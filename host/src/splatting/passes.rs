// SPDX-License-Identifier: MIT OR Apache-2.0
//! The passes of sheets.

use super::{LightTransport, Shading, SheetSettings, SplattingError};
use crate::gpu::Gpu;
use crate::pass::{Pass, PassError, RenderStages};
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
    /// Splats as the eye sees them.
    pub(super) splat: Pass,
    /// Splats as the light sees them.
    pub(super) light_splat: Pass,
    pub(super) composite: Pass,
}

impl Passes {
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        settings: &SheetSettings,
        polygons: bool,
    ) -> Result<Self, SplattingError> {
        let flags = |names: &[(&str, bool)]| Definitions::new().flags(names);
        let composed = |pass: &str, definitions: &Definitions| {
            shaders.compose_with(pass, definitions).map_err(PassError::from)
        };
        let spread = polygons && settings.transport != LightTransport::Direct;
        let splat = |cut| {
            let flags = flags(&[("SCANNING", settings.scanning), ("POLYGONS", cut)]);
            composed("splatting/splat_sheet", &flags)
        };
        let stages = RenderStages {
            vertex: "vertex_splat",
            fragment: Some("fragment_splat"),
            vertices: None,
            target: Some(MEANS),
            depth: None,
            samples: 1,
        };
        let (scattering, back) = match settings.transport {
            LightTransport::Direct | LightTransport::Soft(_) => (false, false),
            LightTransport::Scattering(scattering) => (true, scattering.back),
        };
        let composite = flags(&[
            ("PHONG", settings.shading == Shading::Phong),
            ("SCATTERING", scattering),
            ("BACK", back),
            ("POLYGONS", polygons),
            ("SPREAD", spread),
        ]);
        Ok(Self {
            splat: Pass::additive(gpu, &splat(polygons)?, &stages, 1)?,
            // What light gets behind surfaces goes on through the medium there.
            light_splat: Pass::additive(gpu, &splat(polygons && !spread)?, &stages, 1)?,
            composite: Pass::compute_with(gpu, shaders, "splatting/composite_sheet", &composite)?,
        })
    }
}
