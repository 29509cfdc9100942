// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light shafts by prefiltered visibility over a projectively rectified map (thesis 4.3 and 4.4.2).

use super::{
    Evaluated, Inputs, Prefilter, Projective, ProjectiveMap, ScatteringError, Settings, SettingsError, Start,
    Visibility, check_size, picture_pass,
};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, PassError, Resource};
use crate::resource::Texture;
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use wgpu::TextureFormat;

/// Light shafts by prefiltered visibility over a projective map.
pub struct ProjectivePrefiltered {
    settings: Settings,
    /// The map that is filtered; [`Self::write`] takes its rows. A map that is drawn is drawn before
    /// [`Self::record`].
    pub map: ProjectiveMap,
    /// What the filter stores.
    pub prefilter: Prefilter,
    evaluate_pass: Pass,
    /// Radiance, and visibility in alpha.
    pub scattered: Texture,
}

/// Inputs bound to every pass of [`ProjectivePrefiltered`].
pub struct ProjectivePrefilteredBound {
    resample: Option<Bound>,
    filter: Bound,
    evaluate: Bound,
}

impl ProjectivePrefiltered {
    /// Builds all passes and textures for pictures of `viewport` pixels. The size of `map` takes the place of the
    /// settings'.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        map: ProjectiveMap,
        settings: Settings,
        viewport: [u32; 2],
    ) -> Result<Self, ScatteringError> {
        let [width, height, _] = map.rectified.size();
        let settings = Settings { map: [width, height], ..settings };
        settings.validate(gpu)?;
        check_size(gpu, "a picture", viewport)?;
        if matches!(settings.visibility, Visibility::Wavelet { .. }) {
            let method = settings.visibility.name();
            return Err(SettingsError::Visibility { method, reason: "epipolar rows" }.into());
        }
        let evaluate = settings.projective_definitions();
        Ok(Self {
            settings,
            map,
            prefilter: Prefilter::new(gpu, shaders, &settings, true)?,
            evaluate_pass: picture_pass(
                gpu,
                shaders,
                "scattering/evaluate_projective",
                &evaluate,
                "fragment_evaluate_projective",
            )?,
            scattered: Texture::target(gpu, viewport, TextureFormat::Rgba16Float),
        })
    }

    /// Takes the rows of a frame.
    ///
    /// # Errors
    /// [`SettingsError::OrthographicStart`] for an orthographic camera where rays are to begin at the eye.
    pub fn write(&self, gpu: &Gpu, projective: &Projective) -> Result<(), SettingsError> {
        if projective.rows.projection != 0 && self.settings.start == Start::Eye {
            return Err(SettingsError::OrthographicStart);
        }
        self.map.write(gpu, projective);
        Ok(())
    }

    /// Binds the inputs.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn bind(&self, gpu: &Gpu, inputs: &Inputs<'_>) -> Result<ProjectivePrefilteredBound, PassError> {
        let resources = self.evaluation_resources(inputs);
        Ok(ProjectivePrefilteredBound {
            resample: self.map.bind(gpu, inputs)?,
            filter: self.prefilter.bind(gpu, &resources)?,
            evaluate: self.evaluate_pass.bind_known(gpu, &resources)?,
        })
    }

    /// Records everything from the map, which is resampled here unless it is drawn, to radiance.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &ProjectivePrefilteredBound) {
        self.map.record(encoder, bound.resample.as_ref());
        self.record_filter(encoder, bound);
        self.record_evaluation(encoder, bound);
    }

    /// Records the filter of the bases (thesis 4.3.3, Listings 4.1 to 4.3).
    pub fn record_filter(&self, encoder: &mut wgpu::CommandEncoder, bound: &ProjectivePrefilteredBound) {
        self.prefilter.record(encoder, &bound.filter);
    }

    /// Records the evaluation of every pixel (thesis 4.3.3, Listing 4.4).
    pub fn record_evaluation(&self, encoder: &mut wgpu::CommandEncoder, bound: &ProjectivePrefilteredBound) {
        self.evaluate_pass.fill(encoder, &bound.evaluate, &self.scattered);
    }
}

impl Evaluated for ProjectivePrefiltered {
    fn evaluation_definitions(&self) -> Definitions {
        self.settings.projective_definitions().flag("PROJECTIVE")
    }

    fn evaluation_resources<'a>(&'a self, inputs: &Inputs<'a>) -> Vec<(&'static str, Resource<'a>)> {
        let mut resources = vec![
            ("camera", inputs.camera.into()),
            ("light", inputs.light.into()),
            ("medium", inputs.medium.into()),
            ("rows", (&self.map.rows).into()),
            ("depth", inputs.depth.into()),
            ("shadow_map", inputs.shadow_map.into()),
            ("rectified", (&self.map.rectified).into()),
        ];
        resources.extend(self.prefilter.resources());
        resources
    }

    fn scattered(&self) -> &Texture {
        &self.scattered
    }
}
