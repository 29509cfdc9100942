// SPDX-License-Identifier: MIT OR Apache-2.0
//! Single scattering of a light in a homogeneous medium: the host's side of `wgsl/scattering`.
//!
//! The order of [`Prefiltered::record`] is that of the thesis, 4.3: bounds of the slices, rectified
//! shadow map, filtered bases, one dot product a pixel.

mod composite;
mod evaluated;
mod light_form;
mod march;
mod medium;
mod prefilter;
mod prefiltered;
mod projective;
mod projective_map;
mod projective_prefiltered;
mod rectification;
mod resolution;
mod settings;
mod upsample;
mod views;

pub use composite::Composite;
pub use evaluated::Evaluated;
pub use light_form::LightForm;
pub use march::{Along, March, MarchParameters};
pub use medium::Medium;
pub use prefilter::{Prefilter, RANK_BITS, RANK_COLUMNS, Visibility};
pub use prefiltered::{Prefiltered, PrefilteredBound};
pub use projective::{
    Choice, OBLIQUENESS_LIMIT, Projective, ProjectiveError, ProjectiveRows, ProjectiveSplit, choose,
    projective_rows,
};
pub use projective_map::{ProjectiveMap, ProjectiveRaster, ProjectiveRasterBound};
pub use projective_prefiltered::{ProjectivePrefiltered, ProjectivePrefilteredBound};
pub use rectification::{Frame, Rectification};
pub use resolution::{Reduced, Reduction, Resolution, TOLERANCE};
pub use settings::{
    BasisFormat, Filtering, Reference, ScatteringError, Settings, SettingsError, Start, Weighting,
    check_size, epipole_near_picture,
};
pub use upsample::{Interpolated, Upsample};
pub use views::{Method, ViewPasses, ViewSettings, ViewShafts, Views, ViewsBound};

use crate::gpu::Gpu;
use crate::pass::{Pass, PassError, Resource};
use crate::resource::{Buffer, Sampler, Texture};
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

/// The resources that only some lights have, by name.
pub(crate) fn light_resources<'a>(
    inputs: &Inputs<'a>,
    sampler: &'a Sampler,
) -> Vec<(&'static str, Resource<'a>)> {
    let mut resources = vec![("shadow_map", inputs.shadow_map.into()), ("light_sampler", sampler.into())];
    resources.extend(inputs.shadow_views.map(|views| ("shadow_views", views.into())));
    resources.extend(inputs.shadow_maps.map(|maps| ("shadow_maps", maps.into())));
    resources.extend(inputs.light_texture.map(|texture| ("light_texture", texture.into())));
    resources
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
