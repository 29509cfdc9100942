// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cameras, lights and the passes that every system shares: the host's side of `wgsl/core`.

mod camera;
mod light;
mod raster;
mod scan;
mod tonemap;

pub use camera::{Camera, CameraError, DepthRange, PerspectiveView};
pub use light::{DIRECTIONAL, Light, LightError, POINT, SPOT, direction_from_angles};
pub(crate) use raster::{MESH_VERTEX, begin};
pub use raster::{MeshBuffers, Pictures, Raster, Sky};
pub use scan::Scan;
pub use tonemap::{Tonemap, TonemapParameters};
