// SPDX-License-Identifier: MIT OR Apache-2.0
//! The full picture from a reduced one.

use super::{Inputs, Reduced, ScatteringError, check_size, picture_pass};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, PassError};
use crate::resource::Texture;
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use wgpu::TextureFormat;

/// What is interpolated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolated {
    /// Visibility: radiance follows from each pixel's own distance. For directional lights, and rays from the eye on.
    #[default]
    Visibility,
    /// Radiance and visibility, for light that is no product of visibility and a function of the ray.
    Radiance,
}

/// Makes the full picture of one that was evaluated at a half or a quarter of the resolution.
pub struct Upsample {
    pass: Pass,
    /// Radiance, and visibility in alpha.
    pub scattered: Texture,
}

impl Upsample {
    /// Builds the pass for full pictures of `viewport` pixels.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        interpolated: Interpolated,
        viewport: [u32; 2],
    ) -> Result<Self, ScatteringError> {
        check_size(gpu, "a picture", viewport)?;
        let definitions = match interpolated {
            Interpolated::Visibility => Definitions::new(),
            Interpolated::Radiance => Definitions::new().flag("RADIANCE"),
        };
        Ok(Self {
            pass: picture_pass(gpu, shaders, "scattering/upsample", &definitions, "fragment_upsample")?,
            scattered: Texture::target(gpu, viewport, TextureFormat::Rgba16Float),
        })
    }

    /// Binds the full picture's inputs, its reduction, and what was scattered into the reduced picture.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn bind(
        &self,
        gpu: &Gpu,
        inputs: &Inputs<'_>,
        reduced: &Reduced,
        scattered: &Texture,
    ) -> Result<Bound, PassError> {
        let resources = [
            ("camera", inputs.camera.into()),
            ("light", inputs.light.into()),
            ("medium", inputs.medium.into()),
            ("reduction", (&reduced.reduction).into()),
            ("depth", inputs.depth.into()),
            ("reduced_depth", (&reduced.depth).into()),
            ("reduced", scattered.into()),
        ];
        self.pass.bind_known(gpu, &resources)
    }

    /// Records the interpolation of every pixel.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound) {
        self.pass.fill(encoder, bound, &self.scattered);
    }
}
