// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cameras, lights and the passes that every system shares: the host's side of `wgsl/core`.

mod camera;
mod jitter;
mod light;
mod raster;
mod resolve_depth;
mod scan;
mod tonemap;

pub use camera::{Camera, CameraError, DepthRange, PerspectiveView};
pub use jitter::{Jitter, blue_noise_texture};
pub use light::{DIRECTIONAL, Light, LightError, POINT, SPOT, direction_from_angles};
pub use raster::{MeshBuffers, Pictures, Raster, Sky};
pub use resolve_depth::{ResolveDepth, ResolveDepthParameters, SampleChoice};
pub use scan::Scan;
pub use tonemap::{Tonemap, TonemapParameters};
