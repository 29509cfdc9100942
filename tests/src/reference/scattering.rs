// SPDX-License-Identifier: MIT OR Apache-2.0
//! Single scattering in a homogeneous medium: of a directional light over the frame and slices of
//! `docs/src/rectification.md` or over projective rows, and of a light at a point over local rows. For
//! each the rectified map, exact visibility along view rays over it, whole pictures, and the truth
//! without rectification.
//!
//! For a directional light `L = albedo p(cos) radiance (1 − e^(−extinction s)) V`, V the visibility averaged along the ray
//! with transmittance as weight (thesis Eq. 4.1, EQUATIONS.md 0).

mod airlight;
mod directional;
mod frame;
mod light_texture;
mod local;
mod local_light;
mod local_rows;
mod moments;
mod picture;
mod projective;
mod quadrature;
mod rank;
mod reference_ray;
mod shadow_map;
mod slice;
mod stretch;
#[cfg(test)]
mod test_scenes;
mod truth;
mod views;
mod visibility;

pub use airlight::{Airlight, Complex, exponential_integral};
pub use directional::shadow_views_picture;
pub use frame::{Frame, Polar};
pub use light_texture::LightTexture;
pub use local::LocalScene;
pub use local_light::{Cone, LocalLight};
pub use local_rows::{EyeAtLight, LocalRay, LocalRows, LocalSlice, Over, Weights};
pub use moments::{chebyshev_moments, signed_depth, visibility_bounds};
pub use picture::{Light, Medium, Picture, Pixel, Scene, Start, ViewRay, picture};
pub use projective::{Drift, Failure, Projective, light_in_view, projective_picture};
pub use quadrature::integrate;
pub use rank::{SteppedRow, depth_step};
pub use reference_ray::{
    Fan, ReferenceRay, ReferenceRayError, filtered_bases, filtered_visibility, reference_ray_error,
};
pub use shadow_map::{RectifiedTexel, ShadowMap, rectify, rectify_views};
pub use slice::{GUARD, Rectification, Slice};
pub use stretch::{Stretch, rectified_picture, stretch_visibility};
pub use truth::shadow_map_picture;
pub use views::{LitRun, ShadowViews};
pub use visibility::{RowEnd, Visibility, row_visibility, row_visibility_direct};
