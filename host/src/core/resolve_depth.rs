// SPDX-License-Identifier: MIT OR Apache-2.0
//! The pass `core/resolve_depth`: a multisampled depth buffer to one depth a pixel.

use crate::gpu::Gpu;
use crate::pass::{Bound, Pass, PassError};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use encase::ShaderType;
use wgpu::TextureFormat::R32Float;

/// The uniform `ResolveDepthParameters` of the pass.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct ResolveDepthParameters {
    /// Extinction of the medium, 1/m; zero for the mean distance.
    pub extinction: f32,
    /// Distances count up to here, metres.
    pub distance_limit: f32,
    /// Padding.
    pub reserved_a: f32,
    /// Padding.
    pub reserved_b: f32,
}

/// Which depth stands for a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SampleChoice {
    /// That at which the transmittance is the mean of the samples'.
    Mean {
        /// Extinction of the medium, 1/m, not negative; zero for the mean distance.
        extinction: f32,
        /// Limit of distances, metres, positive; as the medium's.
        distance_limit: f32,
    },
    /// The nearest sample's.
    Nearest,
    /// The farthest sample's.
    Farthest,
}

/// A multisampled depth buffer to one depth a pixel.
pub struct ResolveDepth {
    pass: Pass,
    parameters: Buffer,
    /// The depths, r32float.
    pub depth: Texture,
}

impl ResolveDepth {
    /// Builds the pass for pictures of `viewport` pixels.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        choice: SampleChoice,
        viewport: [u32; 2],
    ) -> Result<Self, PassError> {
        let (definition, extinction, distance_limit) = match choice {
            SampleChoice::Mean { extinction, distance_limit } => (None, extinction, distance_limit),
            SampleChoice::Nearest => (Some("NEAREST"), 0.0, 0.0),
            SampleChoice::Farthest => (Some("FARTHEST"), 0.0, 0.0),
        };
        let definitions = definition.into_iter().fold(Definitions::new(), Definitions::flag);
        let parameters =
            ResolveDepthParameters { extinction, distance_limit, reserved_a: 0.0, reserved_b: 0.0 };
        Ok(Self {
            pass: Pass::compute_with(gpu, shaders, "core/resolve_depth", &definitions)?,
            parameters: Buffer::uniform(gpu, &parameters),
            depth: Texture::storage(gpu, viewport, R32Float),
        })
    }

    /// Binds the uniform of the camera and the multisampled depth buffer.
    ///
    /// # Errors
    /// [`PassError`].
    pub fn bind(&self, gpu: &Gpu, camera: &Buffer, samples: &Texture) -> Result<Bound, PassError> {
        let resources = [
            ("camera", camera.into()),
            ("parameters", (&self.parameters).into()),
            ("samples", samples.into()),
            ("resolved", (&self.depth).into()),
        ];
        self.pass.bind_known(gpu, &resources)
    }

    /// Records the resolution of every pixel.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, bound: &Bound) {
        let [width, height, _] = self.depth.size();
        self.pass.dispatch(encoder, bound, [width, height, 1]);
    }
}
