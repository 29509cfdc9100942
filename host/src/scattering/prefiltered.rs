// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light shafts by prefiltered visibility (thesis 4.3).

use super::{
    Evaluated, Inputs, Prefilter, Rectification, ScatteringError, Settings, check_size, light_resources,
    picture_pass,
};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, PassError, Resource};
use crate::resource::{Sampler, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use wgpu::TextureFormat;

/// Light shafts by prefiltered visibility.
pub struct Prefiltered {
    settings: Settings,
    /// The map that is filtered.
    pub rectification: Rectification,
    /// What the filter stores.
    pub prefilter: Prefilter,
    evaluate_pass: Pass,
    light_sampler: Sampler,
    /// Radiance, and visibility in alpha.
    pub scattered: Texture,
}

/// Inputs bound to every pass of [`Prefiltered`].
pub struct PrefilteredBound {
    rectification: [Bound; 2],
    filter: Bound,
    evaluate: Bound,
}

impl Prefiltered {
    /// Builds all passes and textures for pictures of `viewport` pixels.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        settings: Settings,
        viewport: [u32; 2],
    ) -> Result<Self, ScatteringError> {
        settings.validate(gpu)?;
        check_size(gpu, "a picture", viewport)?;
        let evaluate = settings.evaluate_definitions();
        let (pass, entry) = if settings.light.local() {
            ("scattering/evaluate_local", "fragment_evaluate_local")
        } else {
            ("scattering/evaluate", "fragment_evaluate")
        };
        Ok(Self {
            settings,
            rectification: Rectification::from_settings(gpu, shaders, &settings)?,
            prefilter: Prefilter::new(gpu, shaders, &settings, false)?,
            evaluate_pass: picture_pass(gpu, shaders, pass, &evaluate, entry)?,
            light_sampler: Sampler::linear(gpu),
            scattered: Texture::target(gpu, viewport, TextureFormat::Rgba16Float),
        })
    }

    /// Binds the inputs.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn bind(&self, gpu: &Gpu, inputs: &Inputs<'_>) -> Result<PrefilteredBound, PassError> {
        let resources = self.evaluation_resources(inputs);
        Ok(PrefilteredBound {
            rectification: self.rectification.bind(gpu, inputs)?,
            filter: self.prefilter.bind(gpu, &resources)?,
            evaluate: self.evaluate_pass.bind_known(gpu, &resources)?,
        })
    }

    /// Records everything from shadow map and depth buffer to radiance.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &PrefilteredBound) {
        self.record_rectification(encoder, bound);
        self.record_filter(encoder, bound);
        self.record_evaluation(encoder, bound);
    }

    /// Records the bounds of the slices and the rectified map (thesis 4.4.1).
    pub fn record_rectification(&self, encoder: &mut wgpu::CommandEncoder, bound: &PrefilteredBound) {
        self.rectification.record(encoder, &bound.rectification);
    }

    /// Records the filter of the map (thesis 4.3.3, Listings 4.1 to 4.3).
    pub fn record_filter(&self, encoder: &mut wgpu::CommandEncoder, bound: &PrefilteredBound) {
        self.prefilter.record(encoder, &bound.filter);
    }

    /// Records the evaluation of every pixel (thesis 4.3.3, Listing 4.4).
    pub fn record_evaluation(&self, encoder: &mut wgpu::CommandEncoder, bound: &PrefilteredBound) {
        self.evaluate_pass.fill(encoder, &bound.evaluate, &self.scattered);
    }

    /// Bytes of the textures between shadow map and picture.
    pub fn memory(&self) -> u64 {
        self.prefilter.memory() + self.rectification.rectified.memory() + self.rectification.slices.memory()
    }
}

impl Evaluated for Prefiltered {
    fn evaluation_definitions(&self) -> Definitions {
        self.settings.evaluate_definitions()
    }

    fn evaluation_resources<'a>(&'a self, inputs: &Inputs<'a>) -> Vec<(&'static str, Resource<'a>)> {
        let mut resources = vec![
            ("camera", inputs.camera.into()),
            ("light", inputs.light.into()),
            ("medium", inputs.medium.into()),
            ("frame", (&self.rectification.frame).into()),
            ("slices", (&self.rectification.slices).into()),
            ("depth", inputs.depth.into()),
            ("rectified", (&self.rectification.rectified).into()),
        ];
        resources.extend(self.prefilter.resources());
        resources.extend(light_resources(inputs, &self.light_sampler));
        resources
    }

    fn scattered(&self) -> &Texture {
        &self.scattered
    }
}
