// SPDX-License-Identifier: MIT OR Apache-2.0
//! Single scattering of a directional light in a homogeneous medium: the host's side of `wgsl/scattering`.
//!
//! The order of [`Prefiltered::record`] is that of the thesis, 4.3: bounds of the slices, rectified
//! shadow map, filtered bases, one dot product a pixel.

mod composite;
mod march;
mod medium;
mod prefiltered;
mod rectification;
mod resolution;
mod settings;
mod upsample;

pub use composite::Composite;
pub use march::{Along, March, MarchParameters};
pub use medium::Medium;
pub use prefiltered::{Prefiltered, PrefilteredBound};
pub use rectification::{Frame, Rectification};
pub use resolution::{Reduced, Reduction, Resolution, TOLERANCE};
pub use settings::{
    BasisFormat, Filtering, Reference, ScatteringError, Settings, SettingsError, Start, Weighting,
    check_size, epipole_near_picture,
};
pub use upsample::{Interpolated, Upsample};

use crate::gpu::Gpu;
use crate::pass::{Pass, PassError};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use wgpu::TextureFormat;

/// What an engine brings: uniforms and two depth textures.
#[derive(Clone, Copy)]
pub struct Inputs<'a> {
    /// Uniform `Camera`.
    pub camera: &'a Buffer,
    /// Uniform `Light`.
    pub light: &'a Buffer,
    /// Uniform `Medium`.
    pub medium: &'a Buffer,
    /// Depth buffer of the picture.
    pub depth: &'a Texture,
    /// Standard shadow map.
    pub shadow_map: &'a Texture,
}

/// The fragment form of a pass: a fifth faster than its compute form on a software adapter, and as good elsewhere.
pub(crate) fn picture_pass(
    gpu: &Gpu,
    shaders: &Shaders,
    pass: &str,
    definitions: &Definitions,
    fragment: &str,
) -> Result<Pass, PassError> {
    Pass::picture(gpu, shaders, pass, definitions, fragment, TextureFormat::Rgba16Float)
}
