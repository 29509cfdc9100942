// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pass `stylize/evaluate`: light shafts evaluated as a transfer function has them.

use super::{TransferError, TransferFunction};
use crate::gpu::Gpu;
use crate::pass::{Bound, Pass};
use crate::resource::{Buffer, Sampler, Texture};
use crate::scattering::{Evaluated, Inputs, picture_pass};
use crate::shaders::Shaders;
use wgpu::TextureFormat::Rgba16Float;

/// The evaluation of a prefiltered method and [`Restyle`](super::Restyle) in one pass, which costs little more than the
/// evaluation alone: nothing is written and read between the two. It takes the place of `record_evaluation`.
///
/// ```no_run
/// # use airlight::{Buffer, Gpu, Shaders, Stage, scattering::*, stylize::*};
/// # fn shown(gpu: &Gpu, shaders: &Shaders, stage: &Stage) -> Result<(), Box<dyn std::error::Error>> {
/// let style = read_transfer("sunset.toml")?;
/// let map = Baker::new(gpu, shaders)?.bake_frame(gpu, &style, 0.0, None)?;
/// let function = style.function(0.0, &stage.medium);
/// let method = Prefiltered::new(gpu, shaders, Settings::tuned(gpu), [640, 480])?;
/// let bound = method.bind(gpu, &stage.inputs())?;
/// let stylized = StylizedEvaluation::new(gpu, shaders, &function, &method)?;
/// let uniform = Buffer::uniform(gpu, &function);
/// let evaluation = stylized.bind(gpu, &stage.inputs(), &method, &map, &uniform)?;
/// let mut encoder = gpu.encoder();
/// method.record_rectification(&mut encoder, &bound);
/// method.record_filter(&mut encoder, &bound);
/// stylized.record(&mut encoder, &evaluation);
/// gpu.submit(encoder)?;
/// // `stylized.restyled` goes where `method.scattered` went: into `scattering::Composite`.
/// # Ok(())
/// # }
/// ```
pub struct StylizedEvaluation {
    pass: Pass,
    sampler: Sampler,
    /// Radiance, and in alpha the mean visibility, rgba16float: it goes where the scattered light went.
    pub restyled: Texture,
}

impl StylizedEvaluation {
    /// Builds the pass for functions that ask for the same properties and phase function as `function`, and for pictures of
    /// the size of `method`'s, [`Prefiltered`](crate::scattering::Prefiltered) or
    /// [`ProjectivePrefiltered`](crate::scattering::ProjectivePrefiltered).
    ///
    /// # Errors
    /// [`TransferError::VisibleDepth`] for a function that asks for the mean distance of lit points,
    /// [`TransferError::Pass`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        function: &TransferFunction,
        method: &dyn Evaluated,
    ) -> Result<Self, TransferError> {
        if function.needs_visible_depth() {
            return Err(TransferError::VisibleDepth);
        }
        let needed = [("ANGLES", function.needs_angles()), ("ANISOTROPIC", function.is_anisotropic())];
        let definitions = method.evaluation_definitions().flags(&needed);
        let pass = picture_pass(gpu, shaders, "stylize/evaluate", &definitions, "fragment_evaluate")?;
        let [width, height, _] = method.scattered().size();
        let restyled = Texture::target(gpu, [width, height], Rgba16Float);
        Ok(Self { pass, sampler: Sampler::linear(gpu), restyled })
    }

    /// Binds a scene, what `method` prefilters of it, and a function with its uniform. `method`: of the settings that the pass
    /// was built for.
    ///
    /// # Errors
    /// [`TransferError::OtherSize`], [`TransferError::Pass`].
    pub fn bind(
        &self,
        gpu: &Gpu,
        inputs: &Inputs<'_>,
        method: &dyn Evaluated,
        map: &Texture,
        function: &Buffer,
    ) -> Result<Bound, TransferError> {
        let ([width, height, _], [wide, high, _]) = (inputs.depth.size(), self.restyled.size());
        if [width, height] != [wide, high] {
            let (what, given, expected) = ("a depth buffer", [width, height], [wide, high]);
            return Err(TransferError::OtherSize { what, given, expected });
        }
        let mut resources = method.evaluation_resources(inputs);
        resources.extend([
            ("transfer_function", function.into()),
            ("transfer_map", map.into()),
            ("transfer_sampler", (&self.sampler).into()),
        ]);
        Ok(self.pass.bind_known(gpu, &resources)?)
    }

    /// Records the pass over every pixel, once the method has recorded its filter.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound) {
        self.pass.fill(encoder, bound, &self.restyled);
    }
}
