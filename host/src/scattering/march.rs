// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light shafts by marching.

use super::{
    Inputs, LightForm, ProjectiveMap, Rectification, ScatteringError, Weighting, check_size, light_resources,
    picture_pass,
};
use crate::core::{Jitter, blue_noise_texture};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, PassError};
use crate::resource::{Buffer, Sampler, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use encase::ShaderType;
use wgpu::TextureFormat;

/// The uniform `MarchParameters` of the pass `march`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct MarchParameters {
    /// Steps a ray.
    pub steps: u32,
    /// Where in each step the sample lies.
    pub offset: f32,
    /// Number of the frame, for jitter.
    pub frame: u32,
    /// Padding.
    pub reserved: u32,
}

/// What a march goes along.
pub enum Along<'a> {
    /// Rows of a rectified map, one step a texel.
    Rows(&'a Rectification),
    /// Rows of a rectified map by equal steps, average visibility: the fastest march there is.
    RowSteps {
        /// The map.
        map: &'a Rectification,
        /// Steps a ray, at least 1.
        steps: u32,
    },
    /// Rows of a projective map, the exact sum over its texels.
    Projective(&'a ProjectiveMap),
    /// The standard shadow map, by equal steps.
    ShadowMap {
        /// Steps a ray, at least 1.
        steps: u32,
    },
}

/// Light shafts by marching: the baseline.
pub struct March {
    pass: Pass,
    settings: MarchParameters,
    parameters: Buffer,
    light_sampler: Sampler,
    blue_noise: Option<Texture>,
    /// Radiance, and visibility in alpha.
    pub scattered: Texture,
}

impl March {
    /// Builds the pass for pictures of `viewport` pixels.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        along: &Along<'_>,
        weighting: Weighting,
        viewport: [u32; 2],
    ) -> Result<Self, ScatteringError> {
        Self::jittered(gpu, shaders, along, weighting, Jitter::None, viewport)
    }

    /// Like [`March::new`], with the samples of each pixel shifted by `jitter`. [`Along::Rows`] takes every
    /// texel anyway and is not shifted.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn jittered(
        gpu: &Gpu,
        shaders: &Shaders,
        along: &Along<'_>,
        weighting: Weighting,
        jitter: Jitter,
        viewport: [u32; 2],
    ) -> Result<Self, ScatteringError> {
        check_size(gpu, "a picture", viewport)?;
        let mut definitions = Definitions::new();
        let mut steps = 0;
        match along {
            Along::Rows(_) => {}
            Along::Projective(_) => definitions = definitions.flag("PROJECTIVE"),
            Along::RowSteps { steps: asked, .. } => {
                definitions = definitions.flag("STEPS");
                steps = *asked;
            }
            Along::ShadowMap { steps: asked } => {
                definitions = definitions.flag("SHADOW_MAP");
                steps = *asked;
            }
        }
        if weighting == Weighting::Average {
            definitions = definitions.flag("AVERAGE");
        }
        let jitter = if matches!(along, Along::Rows(_)) { Jitter::None } else { jitter };
        if let Some(definition) = jitter.definition() {
            definitions = definitions.flag(definition);
        }
        let blue_noise = match jitter {
            Jitter::BlueNoise => Some(blue_noise_texture(gpu).map_err(PassError::from)?),
            Jitter::None | Jitter::Gradient => None,
        };
        let settings = MarchParameters { steps, offset: 0.5, frame: 0, reserved: 0 };
        Ok(Self {
            pass: picture_pass(gpu, shaders, "scattering/march", &definitions, "fragment_march")?,
            settings,
            parameters: Buffer::uniform(gpu, &settings),
            light_sampler: Sampler::linear(gpu),
            blue_noise,
            scattered: Texture::target(gpu, viewport, TextureFormat::Rgba16Float),
        })
    }

    /// Builds the pass that marches the shadow maps of a light of any kind by `steps` equal steps a ray, at least 1.
    ///
    /// # Errors
    /// [`ScatteringError`].
    pub fn of_light(
        gpu: &Gpu,
        shaders: &Shaders,
        form: LightForm,
        steps: u32,
        weighting: Weighting,
        viewport: [u32; 2],
    ) -> Result<Self, ScatteringError> {
        if form.plain() {
            return Self::new(gpu, shaders, &Along::ShadowMap { steps }, weighting, viewport);
        }
        check_size(gpu, "a picture", viewport)?;
        form.validate()?;
        let mut definitions = form.texture_definitions(form.shadow_definitions(Definitions::new()));
        if weighting == Weighting::Average {
            definitions = definitions.flag("AVERAGE");
        }
        let settings = MarchParameters { steps, offset: 0.5, frame: 0, reserved: 0 };
        Ok(Self {
            pass: picture_pass(gpu, shaders, "scattering/march_light", &definitions, "fragment_march")?,
            settings,
            parameters: Buffer::uniform(gpu, &settings),
            light_sampler: Sampler::linear(gpu),
            blue_noise: None,
            scattered: Texture::target(gpu, viewport, TextureFormat::Rgba16Float),
        })
    }

    /// Binds the inputs.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn bind(&self, gpu: &Gpu, inputs: &Inputs<'_>, along: &Along<'_>) -> Result<Bound, PassError> {
        let mut resources = vec![
            ("camera", inputs.camera.into()),
            ("light", inputs.light.into()),
            ("medium", inputs.medium.into()),
            ("depth", inputs.depth.into()),
            ("parameters", (&self.parameters).into()),
        ];
        resources.extend(light_resources(inputs, &self.light_sampler));
        if let Along::Rows(map) | Along::RowSteps { map, .. } = along {
            resources.extend([
                ("frame", (&map.frame).into()),
                ("slices", (&map.slices).into()),
                ("rectified", (&map.rectified).into()),
            ]);
        }
        if let Along::Projective(map) = along {
            resources.extend([("rows", (&map.rows).into()), ("rectified", (&map.rectified).into())]);
        }
        if let Some(tile) = &self.blue_noise {
            resources.push(("blue_noise", tile.into()));
        }
        self.pass.bind_known(gpu, &resources)
    }

    /// Sets the number of the frame, by which jitter changes; 0 until then.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn set_frame(&self, gpu: &Gpu, frame: u32) -> Result<(), PassError> {
        self.parameters.write(gpu, &MarchParameters { frame, ..self.settings });
        Ok(gpu.check()?)
    }

    /// Records the march of every pixel.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound) {
        self.pass.fill(encoder, bound, &self.scattered);
    }
}
