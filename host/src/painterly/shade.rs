// SPDX-License-Identifier: MIT OR Apache-2.0
//! Lights colours that were left unlit.

use super::{IsoBound, PainterlyError};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass};
use crate::resource::Texture;
use crate::shaders::Shaders;

/// Lights what a deferred [`super::IsoRaycast`] has written.
pub struct Shade {
    pass: Pass,
}

/// Targets and the picture of them, bound.
pub struct ShadeBound {
    bound: Bound,
    /// Linear RGB radiance, premultiplied, and 1 where the surface is seen, else 0; rgba16float.
    pub picture: Texture,
}

impl Shade {
    /// Builds the pass.
    ///
    /// # Errors
    /// [`PainterlyError::Pass`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PainterlyError> {
        Ok(Self { pass: Pass::compute(gpu, shaders, "painterly/shade", "default")? })
    }

    /// Binds what rays have written, with their camera and light.
    ///
    /// # Errors
    /// [`PainterlyError::Pass`].
    pub fn bind(&self, gpu: &Gpu, rays: &IsoBound) -> Result<ShadeBound, PainterlyError> {
        self.bind_color(gpu, rays, &rays.targets.color)
    }

    /// Binds colours that were made of those that rays have written, [`super::Ridges`] for one.
    ///
    /// # Errors
    /// [`PainterlyError::Pass`].
    pub fn bind_color(
        &self,
        gpu: &Gpu,
        rays: &IsoBound,
        color: &Texture,
    ) -> Result<ShadeBound, PainterlyError> {
        let [width, height, _] = rays.targets.color.size();
        let picture = Texture::storage(gpu, [width, height], wgpu::TextureFormat::Rgba16Float);
        let resources = [
            ("camera", rays.camera().into()),
            ("lighting", rays.lighting().into()),
            ("color", color.into()),
            ("surface", (&rays.targets.surface).into()),
            ("picture", (&picture).into()),
        ];
        Ok(ShadeBound { bound: self.pass.bind(gpu, &resources)?, picture })
    }

    /// Records the light of all pixels.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &ShadeBound) {
        let [width, height, _] = bound.picture.size();
        self.pass.dispatch(encoder, &bound.bound, [width, height, 1]);
    }
}
