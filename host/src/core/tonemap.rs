// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pass `core/tonemap`.

use crate::gpu::Gpu;
use crate::pass::{Pass, PassError};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;

/// The uniform of the pass.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct TonemapParameters {
    /// Factor on the radiance.
    pub exposure: f32,
    /// Amplitude of the dither in steps of 1/255.
    pub dither: f32,
    /// Padding.
    pub reserved_a: f32,
    /// Padding.
    pub reserved_b: f32,
}

/// Scene-linear radiance to an sRGB picture.
pub struct Tonemap {
    pass: Pass,
}

impl Tonemap {
    /// Builds the pass.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PassError> {
        Ok(Self { pass: Pass::compute(gpu, shaders, "core/tonemap", "default")? })
    }

    /// The picture of `radiance`: width x height x RGBA, 8 bits, sRGB-encoded.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn run(&self, gpu: &Gpu, radiance: &Texture, exposure: f32) -> Result<Vec<u8>, PassError> {
        let [width, height, _] = radiance.size();
        let parameters = TonemapParameters { exposure, dither: 1.0, reserved_a: 0.0, reserved_b: 0.0 };
        let parameters = Buffer::uniform(gpu, &parameters);
        let picture = Texture::storage(gpu, [width, height], wgpu::TextureFormat::Rgba8Unorm);
        let bound = self.pass.bind(
            gpu,
            &[
                ("parameters", (&parameters).into()),
                ("radiance", radiance.into()),
                ("picture", (&picture).into()),
            ],
        )?;
        let mut encoder = gpu.encoder();
        self.pass.dispatch(&mut encoder, &bound, [width, height, 1]);
        gpu.submit(encoder)?;
        Ok(picture.read(gpu)?.into_iter().map(|value| (value * 255.0).round() as u8).collect())
    }
}
