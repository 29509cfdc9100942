// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bent normals and cones in screen space: the host's side of `wgsl/ambient`.
//!
//! [`BentPasses`] finds from depth and normals how open each pixel is and in which direction; [`ConeLight`] prepares an environment map;
//! [`ShadePass`] lights surfaces with both.

mod error;
mod light;
mod occlusion;
mod settings;
mod shade;

pub use error::AmbientError;
pub use light::{CONE_LAYERS, ConeLight, ConeLightBound, ConeLightError, ConeLightForm, environment_texture};
pub use occlusion::{BentForm, BentPasses, Blurring, Sampling, SurfaceImages};
pub use settings::{BentBlur, OcclusionSettings};
pub use shade::{Method, ShadePass};
