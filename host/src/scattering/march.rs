// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light shafts by marching.

use super::{
    Inputs, LightForm, ProjectiveMap, Rectification, ScatteringError, Weighting, check_size, light_resources,
    picture_pass,
};
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
    /// Padding.
    pub reserved_a: u32,
    /// Padding.
    pub reserved_b: u32,
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
    parameters: Buffer,
    light_sampler: Sampler,
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
        let parameters = MarchParameters { steps, offset: 0.5, reserved_a: 0, reserved_b: 0 };
        Ok(Self {
            pass: picture_pass(gpu, shaders, "scattering/march", &definitions, "fragment_march")?,
            parameters: Buffer::uniform(gpu, &parameters),
            light_sampler: Sampler::linear(gpu),
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
        let parameters = MarchParameters { steps, offset: 0.5, reserved_a: 0, reserved_b: 0 };
        Ok(Self {
            pass: picture_pass(gpu, shaders, "scattering/march_light", &definitions, "fragment_march")?,
            parameters: Buffer::uniform(gpu, &parameters),
            light_sampler: Sampler::linear(gpu),
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
        self.pass.bind_known(gpu, &resources)
    }

    /// Records the march of every pixel.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound) {
        self.pass.fill(encoder, bound, &self.scattered);
    }
}
