// SPDX-License-Identifier: MIT OR Apache-2.0
//! The rectified shadow map (thesis 4.4).

use super::{Inputs, ScatteringError, Settings, check_size};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, PassError};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;
use glam::{Vec3, Vec4};
use wgpu::TextureFormat;

/// The uniform `Frame` of `scattering/rectify`, which the pass `slices` writes.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Frame {
    /// Unit vector TOWARDS the light.
    pub light: Vec3,
    /// Azimuth of row 0, radians.
    pub azimuth_min: f32,
    /// Unit vector of azimuth 0.
    pub axis_a: Vec3,
    /// Rows per radian.
    pub rows_per_radian: f32,
    /// Unit vector of azimuth pi / 2.
    pub axis_b: Vec3,
    /// Number of rows.
    pub rows: f32,
    /// Position of the eye.
    pub eye: Vec3,
    /// 1 where rows wrap.
    pub wraps: f32,
    /// Towards the light: what the view ray through ndc has, times (x, y, 1).
    pub ray_light: Vec3,
    /// Padding.
    pub reserved_a: f32,
    /// Along axis_a.
    pub ray_a: Vec3,
    /// Padding.
    pub reserved_b: f32,
    /// Along axis_b.
    pub ray_b: Vec3,
    /// Padding.
    pub reserved_c: f32,
    /// Scale of a ray's length, times (x, y, depth, 1).
    pub ray_scale: Vec4,
}

/// The rectified shadow map: slices, their frame, and the map itself.
pub struct Rectification {
    slices_pass: Pass,
    rectify_pass: Pass,
    /// Uniform `Frame`, written by the pass `slices`.
    pub frame: Buffer,
    /// Bounds of the slices, one texel each.
    pub slices: Texture,
    /// The rectified map.
    pub rectified: Texture,
}

impl Rectification {
    /// Builds the passes and the textures for a map of `map` columns and rows, by the default settings.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders, map: [u32; 2]) -> Result<Self, ScatteringError> {
        Self::from_settings(gpu, shaders, &Settings { map, ..Settings::default() })
    }

    /// Builds the passes and the textures by the settings.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn from_settings(gpu: &Gpu, shaders: &Shaders, settings: &Settings) -> Result<Self, ScatteringError> {
        let map = settings.map;
        check_size(gpu, "a rectified map", map)?;
        let compute = |pass, definitions| Pass::compute_with(gpu, shaders, pass, &definitions);
        Ok(Self {
            slices_pass: compute("scattering/slices", settings.slices_definitions())?,
            rectify_pass: compute("scattering/rectify", settings.rectify_definitions())?,
            frame: Buffer::storage(gpu, u64::from(Frame::min_size())),
            slices: Texture::storage(gpu, [map[1], 1], TextureFormat::Rgba32Float),
            rectified: Texture::storage(gpu, map, TextureFormat::R32Float),
        })
    }

    /// Binds the inputs.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn bind(&self, gpu: &Gpu, inputs: &Inputs<'_>) -> Result<[Bound; 2], PassError> {
        let resources = [
            ("camera", inputs.camera.into()),
            ("light", inputs.light.into()),
            ("medium", inputs.medium.into()),
            ("frame", (&self.frame).into()),
            ("slices", (&self.slices).into()),
            ("shadow_map", inputs.shadow_map.into()),
            ("rectified", (&self.rectified).into()),
        ];
        Ok([self.slices_pass.bind_known(gpu, &resources)?, self.rectify_pass.bind_known(gpu, &resources)?])
    }

    /// Records both passes.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, [slices, rectify]: &[Bound; 2]) {
        let [width, height, _] = self.rectified.size();
        self.slices_pass.dispatch(encoder, slices, [height, 1, 1]);
        // A thread takes four texels of a row.
        self.rectify_pass.dispatch(encoder, rectify, [width.div_ceil(4), height, 1]);
    }
}
