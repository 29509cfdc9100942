// SPDX-License-Identifier: MIT OR Apache-2.0
//! Scattered light at a fraction of the resolution: what the passes at that size are given.

use super::{Inputs, ScatteringError, check_size};
use crate::core::Camera;
use crate::gpu::{Gpu, GpuError};
use crate::pass::{Bound, Pass, PassError};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;
use glam::{DMat4, DVec4, Vec2};

/// Share of the distance by which a neighbour may differ and still count half.
pub const TOLERANCE: f32 = 0.05;

/// How many pixels are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Resolution {
    /// Every second one in x and y.
    Half,
    /// Every fourth one in x and y.
    Quarter,
}

impl Resolution {
    /// Pixels of the full picture from one evaluated pixel to the next, in x and in y.
    pub fn factor(self) -> u32 {
        match self {
            Self::Half => 2,
            Self::Quarter => 4,
        }
    }
}

/// The uniform `Reduction` of `scattering/upsample`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct Reduction {
    /// Pixels from one evaluated pixel to the next.
    pub factor: u32,
    /// Relative difference of distance at which a neighbour counts half.
    pub tolerance: f32,
    /// Padding.
    pub reserved_a: u32,
    /// Padding.
    pub reserved_b: u32,
}

impl Camera {
    /// The camera of a picture that holds every `factor`-th pixel of this one's in x and in y, from the top
    /// left on: the centre of its pixel (x, y) is that of (`factor` x, `factor` y). It has
    /// `ceil(size / factor)` pixels a side; depths and the projection stay what they are. A factor of 0
    /// counts as 1.
    #[must_use]
    pub fn reduced(&self, factor: u32) -> Self {
        let factor = f64::from(factor.max(1));
        let full = self.viewport.as_dvec2();
        let size = (full / factor).ceil();
        // ndc = scale * reduced ndc + shift, in x and (downwards) in y: pixel centres fall onto pixel centres.
        let scale = factor * size / full;
        let shift = (factor * (size - 1.0) + 1.0) / full - 1.0;
        let full_from_reduced = DMat4::from_cols(
            DVec4::new(scale.x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, scale.y, 0.0, 0.0),
            DVec4::Z,
            DVec4::new(shift.x, -shift.y, 0.0, 1.0),
        );
        let reduced_from_full = DMat4::from_cols(
            DVec4::new(1.0 / scale.x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 1.0 / scale.y, 0.0, 0.0),
            DVec4::Z,
            DVec4::new(-shift.x / scale.x, shift.y / scale.y, 0.0, 1.0),
        );
        Self {
            clip_from_world: (reduced_from_full * self.clip_from_world.as_dmat4()).as_mat4(),
            world_from_clip: (self.world_from_clip.as_dmat4() * full_from_reduced).as_mat4(),
            viewport: Vec2::new(size.x as f32, size.y as f32),
            ..*self
        }
    }
}

/// A picture of every second or fourth pixel: its camera and its depth buffer.
///
/// [`super::March`] and [`super::Prefiltered`] run at [`Reduced::viewport`] with [`Reduced::inputs`], their
/// rectification included: a frame holds the rays of the camera that it was made for. [`super::Upsample`] makes
/// the full picture of the result.
pub struct Reduced {
    pass: Pass,
    resolution: Resolution,
    pub(super) reduction: Buffer,
    /// Uniform of the reduced camera.
    pub camera: Buffer,
    /// Depth of the evaluated pixels, r32float.
    pub depth: Texture,
}

impl Reduced {
    /// Builds the pass and the textures for pictures of `camera`.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        camera: &Camera,
        resolution: Resolution,
    ) -> Result<Self, ScatteringError> {
        let reduced = camera.reduced(resolution.factor());
        let viewport = [reduced.viewport.x as u32, reduced.viewport.y as u32];
        check_size(gpu, "a picture", viewport)?;
        let reduction =
            Reduction { factor: resolution.factor(), tolerance: TOLERANCE, reserved_a: 0, reserved_b: 0 };
        Ok(Self {
            pass: Pass::compute(gpu, shaders, "scattering/reduce_depth", "default")?,
            resolution,
            reduction: Buffer::uniform(gpu, &reduction),
            camera: Buffer::uniform(gpu, &reduced),
            depth: Texture::storage(gpu, viewport, wgpu::TextureFormat::R32Float),
        })
    }

    /// Width and height of the reduced picture in pixels.
    pub fn viewport(&self) -> [u32; 2] {
        let [width, height, _] = self.depth.size();
        [width, height]
    }

    /// Takes a camera that has moved; its viewport must be that of the first.
    ///
    /// # Errors
    /// [`GpuError`].
    pub fn set_camera(&self, gpu: &Gpu, camera: &Camera) -> Result<(), GpuError> {
        self.camera.write(gpu, &camera.reduced(self.resolution.factor()));
        gpu.check()
    }

    /// Binds the full picture's inputs.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn bind(&self, gpu: &Gpu, inputs: &Inputs<'_>) -> Result<Bound, PassError> {
        let resources = [
            ("camera", inputs.camera.into()),
            ("reduction", (&self.reduction).into()),
            ("depth", inputs.depth.into()),
            ("reduced_depth", (&self.depth).into()),
        ];
        self.pass.bind(gpu, &resources)
    }

    /// Records the choice of depths.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound) {
        let [width, height] = self.viewport();
        self.pass.dispatch(encoder, bound, [width, height, 1]);
    }

    /// What passes at the reduced size are given: `full` with the reduced camera and depths.
    pub fn inputs<'a>(&'a self, full: &Inputs<'a>) -> Inputs<'a> {
        Inputs { camera: &self.camera, depth: &self.depth, ..*full }
    }
}
