// SPDX-License-Identifier: MIT OR Apache-2.0
//! Surfaces in the light of an environment.

use super::{AmbientError, SurfaceImages};
use crate::gpu::Gpu;
use crate::pass::Pass;
use crate::resource::{Sampler, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use wgpu::TextureFormat::Rgba16Float;

/// How light and what is open come together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Light about the normal, times openness.
    Occlusion,
    /// Light about the bent normal.
    Normals,
    /// Light of the bent cone, its angle by Eq. 3.6.
    Cones,
    /// Light of the bent cone whose directions have the mean's length.
    ExactCones,
}

/// Lights surfaces.
pub struct ShadePass {
    shade: Pass,
    sampler: Sampler,
}

impl ShadePass {
    /// Composes the pass. `printed`: brightness as the thesis prints it, too dark in even light where little is open.
    ///
    /// # Errors
    /// [`AmbientError::Pass`].
    pub fn new(gpu: &Gpu, shaders: &Shaders, method: Method, printed: bool) -> Result<Self, AmbientError> {
        let definitions = Definitions::new().flags(&[
            ("OCCLUSION", method == Method::Occlusion),
            ("NORMALS", method == Method::Normals),
            ("EXACT", method == Method::ExactCones),
            // Occlusion alone is as printed.
            ("PRINTED", printed && method != Method::Occlusion),
        ]);
        let shade = Pass::compute_with(gpu, shaders, "ambient/shade_bent", &definitions)?;
        Ok(Self { shade, sampler: Sampler::linear(gpu) })
    }

    /// Records the picture: rgba16float, linear RGB radiance, alpha 1 where a surface is seen. `albedos`: linear RGB, 0..1; `bent`: of
    /// [`super::BentPasses`]; `lights`: the preconvolved environment.
    ///
    /// # Errors
    /// [`AmbientError::Pass`].
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        seen: SurfaceImages<'_>,
        albedos: &Texture,
        bent: &Texture,
        lights: &Texture,
    ) -> Result<Texture, AmbientError> {
        let [width, height, _] = seen.depth.size();
        let picture = Texture::storage(gpu, [width, height], Rgba16Float);
        let resources = [
            ("albedos", albedos.into()),
            ("bent", bent.into()),
            ("lights", lights.into()),
            ("light_sampler", (&self.sampler).into()),
            ("picture", (&picture).into()),
        ];
        seen.dispatch(gpu, encoder, &self.shade, [width, height], &resources)?;
        Ok(picture)
    }
}
