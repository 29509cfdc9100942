// SPDX-License-Identifier: MIT OR Apache-2.0
//! Draws noise out along the directions of curvature.

use super::PainterlyError;
use crate::gpu::Gpu;
use crate::out_of_range::in_range;
use crate::pass::{Bound, Pass};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use encase::ShaderType;

/// The uniform `StreakParameters` of `painterly/advection`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct StreakParameters {
    /// Steps each way, at most 256.
    pub steps: u32,
    /// Length of a step, pixels, 0.1 to 8.
    pub step_length: f32,
    /// Which noise.
    pub seed: u32,
    /// 0 for the mean along a line, 1 for the contrast of the noise itself.
    pub contrast: f32,
}

impl Default for StreakParameters {
    fn default() -> Self {
        Self { steps: 10, step_length: 1.0, seed: 0, contrast: 1.0 }
    }
}

impl StreakParameters {
    /// Checks all numbers.
    ///
    /// # Errors
    /// [`PainterlyError::Setting`].
    pub fn check(&self) -> Result<(), PainterlyError> {
        in_range("steps of streaks", self.steps as f32, 0.0..=256.0, "from 0 to 256")?;
        in_range("step of streaks", self.step_length, 0.1..=8.0, "from 0.1 to 8 pixels")?;
        Ok(in_range("contrast of streaks", self.contrast, 0.0..=1.0, "from 0 to 1")?)
    }
}

/// Draws noise out along directions in the picture.
pub struct Advect {
    pass: Pass,
}

/// Directions and streaks along them, bound.
pub struct AdvectBound {
    bound: Bound,
    parameters: Buffer,
    /// 0..1, and 0.5 where there is no direction; r32float.
    pub streaks: Texture,
}

impl Advect {
    /// Builds the pass.
    ///
    /// # Errors
    /// [`PainterlyError::Pass`].
    pub fn new(gpu: &Gpu, shaders: &Shaders) -> Result<Self, PainterlyError> {
        Ok(Self { pass: Pass::compute(gpu, shaders, "painterly/advect", "default")? })
    }

    /// Binds directions: [`super::IsoTargets::curvature`], or any texture of (cos 2a, sin 2a) in its third and fourth channel.
    ///
    /// # Errors
    /// [`PainterlyError::Setting`], [`PainterlyError::Pass`].
    pub fn bind(
        &self,
        gpu: &Gpu,
        curvature: &Texture,
        parameters: &StreakParameters,
    ) -> Result<AdvectBound, PainterlyError> {
        parameters.check()?;
        let parameters = Buffer::uniform(gpu, parameters);
        let [width, height, _] = curvature.size();
        let streaks = Texture::storage(gpu, [width, height], wgpu::TextureFormat::R32Float);
        let resources = [
            ("parameters", (&parameters).into()),
            ("curvature", curvature.into()),
            ("streaks", (&streaks).into()),
        ];
        let bound = self.pass.bind(gpu, &resources)?;
        Ok(AdvectBound { bound, parameters, streaks })
    }

    /// Changes how streaks are drawn from the next recorded frame on.
    ///
    /// # Errors
    /// [`PainterlyError::Setting`].
    pub fn set(
        &self,
        gpu: &Gpu,
        bound: &AdvectBound,
        parameters: &StreakParameters,
    ) -> Result<(), PainterlyError> {
        parameters.check()?;
        bound.parameters.write(gpu, parameters);
        Ok(())
    }

    /// Records the streaks of all pixels.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &AdvectBound) {
        let [width, height, _] = bound.streaks.size();
        self.pass.dispatch(encoder, &bound.bound, [width, height, 1]);
    }
}
