// SPDX-License-Identifier: MIT OR Apache-2.0
//! How a medium scatters light, and what its pictures are seen with.

use super::TransmittanceError;
use crate::gpu::Gpu;
use crate::pass::{Pass, PassError};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;
use glam::Vec3;
use wgpu::TextureFormat;

/// The uniform `MediumLighting` of `transmittance/medium`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct MediumLighting {
    /// Single-scattering albedo, 0..1.
    pub albedo: Vec3,
    /// Mean cosine of the phase function.
    pub g: f32,
    /// View rays end here, metres.
    pub distance_limit: f32,
    /// Padding.
    pub reserved_a: f32,
    /// Padding.
    pub reserved_b: f32,
    /// Padding.
    pub reserved_c: f32,
}

impl MediumLighting {
    /// Checked numbers.
    ///
    /// # Errors
    /// [`TransmittanceError::Lighting`] for a value out of range or not finite.
    pub fn new(albedo: Vec3, g: f32, distance_limit: f32) -> Result<Self, TransmittanceError> {
        let check = |name, value: f32, fits: bool, range| {
            if fits { Ok(()) } else { Err(TransmittanceError::Lighting { name, value, range }) }
        };
        for value in albedo.to_array() {
            check("albedo", value, (0.0..=1.0).contains(&value), "from 0 to 1")?;
        }
        check("g", g, (-0.999..=0.999).contains(&g), "from -0.999 to 0.999")?;
        let fits = distance_limit > 0.0 && distance_limit <= 1e7;
        check("distance limit", distance_limit, fits, "positive and at most 1e7 metres")?;
        Ok(Self { albedo, g, distance_limit, reserved_a: 0.0, reserved_b: 0.0, reserved_c: 0.0 })
    }
}

/// What a medium is seen with.
#[derive(Clone, Copy)]
pub struct MediumView<'a> {
    /// Uniform of the camera, [`crate::core::Camera`].
    pub camera: &'a Buffer,
    /// Uniform of [`MediumLighting`].
    pub lighting: &'a Buffer,
    /// Depth buffer; the picture has its size.
    pub depth: &'a Texture,
}

impl MediumView<'_> {
    /// A picture of the medium, rgba16float: premultiplied linear RGB radiance, transmittance to the background in alpha.
    pub(super) fn picture(&self, gpu: &Gpu) -> Texture {
        let [width, height, _] = self.depth.size();
        Texture::target(gpu, [width, height], TextureFormat::Rgba16Float)
    }
}

/// Puts the picture of a medium over what lies behind it.
pub struct Composite {
    pass: Pass,
}

impl Composite {
    /// Builds the pass.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PassError> {
        Ok(Self { pass: Pass::compute(gpu, shaders, "transmittance/composite", "default")? })
    }

    /// `surface`, linear RGB radiance, seen through the medium of `picture`; rgba16float.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn run(&self, gpu: &Gpu, surface: &Texture, picture: &Texture) -> Result<Texture, PassError> {
        let [width, height, _] = picture.size();
        let composed = Texture::storage(gpu, [width, height], TextureFormat::Rgba16Float);
        let resources =
            [("surface", surface.into()), ("picture", picture.into()), ("composed", (&composed).into())];
        let bound = self.pass.bind(gpu, &resources)?;
        let mut encoder = gpu.encoder();
        self.pass.dispatch(&mut encoder, &bound, [width, height, 1]);
        gpu.submit(encoder)?;
        Ok(composed)
    }
}
