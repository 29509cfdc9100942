// SPDX-License-Identifier: MIT OR Apache-2.0
//! Screen-space directional occlusion, the competitor of bent cones: each open direction's light is looked up.

use crate::ambient::{AmbientError, BentBlur, OcclusionSettings, SurfaceImages};
use crate::data::{Environment, EnvironmentLight};
use crate::pass::{Pass, PassError, Resource};
use crate::{Buffer, Gpu, Shaders, Texture};
use airlight_validate::Definitions;
use std::f32::consts::PI;
use wgpu::TextureFormat::Rgba16Float;

/// How directions are spread over the hemisphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spread {
    /// With the cosine: each counts alike.
    Cosine,
    /// Evenly over the solid angle, weighted with the cosine.
    Even,
    /// As the environment is bright: lights drawn from it.
    Lights,
}

/// The passes of the competitor.
pub struct Ssdo {
    /// The binding of the environment.
    environment: &'static str,
    gather: Pass,
    blur: Pass,
    shade: Pass,
}

impl Ssdo {
    /// Composes the passes; `shaders` are of [`super::baselines::with_baselines`].
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(gpu: &Gpu, shaders: &Shaders, spread: Spread) -> Result<Self, PassError> {
        let pass = |name: &str, flags: &[(&str, bool)]| {
            Pass::compute_with(gpu, shaders, name, &Definitions::new().flags(flags))
        };
        let spreads = [("UNIFORM", spread == Spread::Even), ("LIGHTS", spread == Spread::Lights)];
        Ok(Self {
            environment: if spread == Spread::Lights { "lights" } else { "radiance" },
            gather: pass("baselines/ssdo", &spreads)?,
            blur: pass("baselines/ssdo_blur", &[("SHADED", false)])?,
            shade: pass("baselines/ssdo_blur", &[("SHADED", true)])?,
        })
    }

    /// Records the picture, blurred over the sampling pattern: rgba16float, linear RGB radiance, alpha 1 where a surface is seen.
    /// `albedos`: linear RGB, 0..1; `environment`: of [`environment_texture`](crate::ambient::environment_texture), or of [`lights_buffer`] with [`Spread::Lights`].
    ///
    /// # Errors
    /// [`AmbientError::Setting`], [`AmbientError::Pass`].
    pub fn record<'a>(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        seen: SurfaceImages<'_>,
        settings: &OcclusionSettings,
        albedos: &Texture,
        environment: impl Into<Resource<'a>>,
    ) -> Result<Texture, AmbientError> {
        settings.check()?;
        let [width, height, _] = seen.depth.size();
        let size = [width, height];
        let uniform = Buffer::uniform(gpu, settings);
        let image = || Texture::storage(gpu, size, Rgba16Float);
        let [gathered, blurred, picture] = [image(), image(), image()];
        let resources = [
            ("settings", (&uniform).into()),
            (self.environment, environment.into()),
            ("light", (&gathered).into()),
        ];
        seen.dispatch(gpu, encoder, &self.gather, size, &resources)?;
        let [along, across] = [0, 1].map(|axis| Buffer::uniform(gpu, &BentBlur::over(settings, axis)));
        let resources =
            [("blur", (&along).into()), ("light", (&gathered).into()), ("blurred", (&blurred).into())];
        seen.dispatch(gpu, encoder, &self.blur, size, &resources)?;
        let resources = [
            ("blur", (&across).into()),
            ("light", (&blurred).into()),
            ("albedos", albedos.into()),
            ("blurred", (&picture).into()),
        ];
        seen.dispatch(gpu, encoder, &self.shade, size, &resources)?;
        Ok(picture)
    }
}

/// Lights drawn from a map that is not black, as many as `settings` has directions in all pixels of its pattern.
pub fn lights_buffer(gpu: &Gpu, environment: &Environment, settings: &OcclusionSettings) -> Buffer {
    let lights = environment.sample_lights(settings.samples * settings.side * settings.side, 1);
    let row = |light: &EnvironmentLight| {
        let [direction, light] = [light.direction, light.irradiance / PI].map(|part| part.extend(0.0));
        [direction.to_array(), light.to_array()]
    };
    let rows: Vec<[f32; 4]> = lights.iter().flat_map(row).collect();
    Buffer::of_floats(gpu, rows.as_flattened())
}
