// SPDX-License-Identifier: MIT OR Apache-2.0
//! Single scattering of a directional light in a homogeneous medium: the frame and slices of
//! `docs/src/rectification.md`, the rectified map, exact visibility along view rays over it, whole
//! pictures, and the truth without rectification.
//!
//! `L = albedo p(cos) radiance (1 − e^(−extinction s)) V`, V the visibility averaged along the ray
//! with transmittance as weight (thesis Eq. 4.1, EQUATIONS.md 0).

mod frame;
mod picture;
mod projective;
mod shadow_map;
mod slice;
mod stretch;
#[cfg(test)]
mod test_scenes;
mod truth;
mod views;
mod visibility;

pub use frame::{Frame, Polar};
pub use picture::{Light, Medium, Picture, Pixel, Scene, Start, ViewRay, picture};
pub use projective::{Drift, Failure, Projective, light_in_view, projective_picture};
pub use shadow_map::{RectifiedTexel, ShadowMap, rectify};
pub use slice::{GUARD, Rectification, Slice};
pub use stretch::{Stretch, stretch_visibility};
pub use truth::shadow_map_picture;
pub use views::{LitRun, ShadowViews};
pub use visibility::{RowEnd, Visibility, row_visibility, row_visibility_direct};
