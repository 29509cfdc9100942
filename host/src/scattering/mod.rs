// SPDX-License-Identifier: MIT OR Apache-2.0
//! Single scattering of a directional light in a homogeneous medium: the host's side of `wgsl/scattering`.
//!
//! The order of [`Prefiltered::record`] is that of the thesis, 4.3: bounds of the slices, rectified
//! shadow map, filtered bases, one dot product a pixel.

mod composite;
mod march;
mod medium;
mod prefiltered;
mod projective;
mod projective_map;
mod projective_prefiltered;
mod rectification;
mod settings;

pub use composite::Composite;
pub use march::{Along, March, MarchParameters};
pub use medium::Medium;
pub use prefiltered::{Prefiltered, PrefilteredBound};
pub use projective::{
    Choice, OBLIQUENESS_LIMIT, Projective, ProjectiveError, ProjectiveRows, ProjectiveSplit, choose,
    projective_rows,
};
pub use projective_map::{ProjectiveMap, ProjectiveRaster, ProjectiveRasterBound};
pub use projective_prefiltered::{ProjectivePrefiltered, ProjectivePrefilteredBound};
pub use rectification::{Frame, Rectification};
pub use settings::{
    BasisFormat, Filtering, Reference, ScatteringError, Settings, SettingsError, Start, Weighting,
    check_size, epipole_near_picture,
};

use crate::gpu::Gpu;
use crate::pass::{Pass, PassError};
use crate::resource::{Buffer, Texture};
use crate::shaders::Shaders;
use airlight_validate::Definitions;
use wgpu::TextureFormat;

/// What an engine brings: uniforms, depth textures, and what its light may have besides.
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
    /// Standard shadow map; one empty texel for a point light.
    pub shadow_map: &'a Texture,
    /// Uniform `ShadowViews`, where shadow maps come in an array.
    pub shadow_views: Option<&'a Buffer>,
    /// The array of shadow maps, a layer a view.
    pub shadow_maps: Option<&'a Texture>,
    /// What colours the light, over the whole standard shadow map.
    pub light_texture: Option<&'a Texture>,
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
