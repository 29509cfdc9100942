// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bent normals and cones in screen space: the host's side of `wgsl/ambient`.
//!
//! [`BentPasses`] finds from depth and normals how open each pixel is and in which direction; [`ShadePass`] lights surfaces with that.

mod error;
mod occlusion;
mod settings;

pub use error::AmbientError;
pub use occlusion::{BentForm, BentPasses, Blurring, Sampling, SurfaceImages};
pub use settings::{BentBlur, OcclusionSettings};
