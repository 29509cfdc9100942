// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pass `stylize/transfer`: scattered light as a transfer function has it.

use super::{TransferError, TransferFunction};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass};
use crate::resource::{Buffer, Sampler, Texture};
use crate::scattering::{Inputs, light_resources, picture_pass};
use crate::shaders::Shaders;
use crate::stylize::error::check_size;
use airlight_validate::Definitions;
use wgpu::TextureFormat::Rgba16Float;

/// Applies a transfer function to what any scattering method wrote.
///
/// ```no_run
/// # use airlight::{Buffer, Gpu, Shaders, Stage, Texture, stylize::*};
/// # fn shown(gpu: &Gpu, shaders: &Shaders, stage: &Stage, scattered: &Texture) -> Result<(), TransferError> {
/// let style = read_transfer("sunset.toml")?;
/// let (frame, movements) = (12.0, Default::default());
/// let (camera, medium, inputs) = (&stage.camera, &stage.medium, stage.inputs());
/// let scene = PickScene { camera, medium, inputs, scattered, movements: &movements };
/// let map = Baker::new(gpu, shaders)?.bake_frame(gpu, &style, frame, Some(&scene))?;
/// let function = style.function(frame, &stage.medium);
/// let restyle = Restyle::new(gpu, shaders, &function, &stage.inputs(), [640, 480])?;
/// let bound = restyle.bind(gpu, &stage.inputs(), scattered, &map, &Buffer::uniform(gpu, &function))?;
/// let mut encoder = gpu.encoder();
/// restyle.record(&mut encoder, &bound);
/// gpu.submit(encoder)?;
/// // `restyle.restyled` goes where `scattered` went: into `scattering::Composite`.
/// # Ok(())
/// # }
/// ```
pub struct Restyle {
    pass: Pass,
    sampler: Sampler,
    /// Radiance, and in alpha the mean visibility, rgba16float: it goes where the scattered light went.
    pub restyled: Texture,
}

impl Restyle {
    /// Builds the pass for pictures of `size` pixels and functions that ask for the same properties as `function`.
    ///
    /// # Errors
    /// [`TransferError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        function: &TransferFunction,
        inputs: &Inputs<'_>,
        size: [u32; 2],
    ) -> Result<Self, TransferError> {
        check_size(gpu, "a picture", size)?;
        let permutation = function.permutation(inputs.shadow_views.is_some());
        let mut definitions = Definitions::new();
        for name in ["VISIBLE_DEPTH", "SHADOW_ARRAY"].into_iter().take(permutation) {
            definitions = definitions.flag(name);
        }
        let pass = picture_pass(gpu, shaders, "stylize/transfer", &definitions, "fragment_transfer")?;
        let restyled = Texture::target(gpu, size, Rgba16Float);
        Ok(Self { pass, sampler: Sampler::linear(gpu), restyled })
    }

    /// Binds a scene, what was scattered in it, and a function with its uniform.
    ///
    /// # Errors
    /// [`TransferError`].
    pub fn bind(
        &self,
        gpu: &Gpu,
        inputs: &Inputs<'_>,
        scattered: &Texture,
        map: &Texture,
        function: &Buffer,
    ) -> Result<Bound, TransferError> {
        for (what, texture) in [("scattered light", scattered), ("a depth buffer", inputs.depth)] {
            let ([width, height, _], [wide, high, _]) = (texture.size(), self.restyled.size());
            if [width, height] != [wide, high] {
                return Err(TransferError::OtherSize {
                    what,
                    given: [width, height],
                    expected: [wide, high],
                });
            }
        }
        let mut resources = vec![
            ("camera", inputs.camera.into()),
            ("light", inputs.light.into()),
            ("transfer_function", function.into()),
            ("depth", inputs.depth.into()),
            ("scattered", scattered.into()),
            ("transfer_map", map.into()),
            ("transfer_sampler", (&self.sampler).into()),
        ];
        resources.extend(light_resources(inputs, &self.sampler));
        Ok(self.pass.bind_known(gpu, &resources)?)
    }

    /// Records the pass over every pixel.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound) {
        self.pass.fill(encoder, bound, &self.restyled);
    }
}
