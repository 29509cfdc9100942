// SPDX-License-Identifier: MIT OR Apache-2.0
//! Picture and scattered light, put together.

use super::Inputs;
use crate::gpu::Gpu;
use crate::pass::{Pass, PassError};
use crate::resource::Texture;
use crate::shaders::Shaders;
use wgpu::TextureFormat;

/// Puts a picture and the light scattered before it together.
pub struct Composite {
    pass: Pass,
}

impl Composite {
    /// Builds the pass.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PassError> {
        Ok(Self { pass: Pass::compute(gpu, shaders, "scattering/composite", "default")? })
    }

    /// `surface` seen through the medium, plus `scattered`, as linear RGB radiance.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn run(
        &self,
        gpu: &Gpu,
        inputs: &Inputs<'_>,
        surface: &Texture,
        scattered: &Texture,
    ) -> Result<Texture, PassError> {
        let [width, height, _] = scattered.size();
        let composed = Texture::storage(gpu, [width, height], TextureFormat::Rgba16Float);
        let bound = self.pass.bind(
            gpu,
            &[
                ("camera", inputs.camera.into()),
                ("medium", inputs.medium.into()),
                ("depth", inputs.depth.into()),
                ("surface", surface.into()),
                ("scattered", scattered.into()),
                ("composed", (&composed).into()),
            ],
        )?;
        let mut encoder = gpu.encoder();
        self.pass.dispatch(&mut encoder, &bound, [width, height, 1]);
        gpu.submit(encoder)?;
        Ok(composed)
    }
}
