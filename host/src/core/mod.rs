// SPDX-License-Identifier: MIT OR Apache-2.0
//! Cameras, lights and the passes that every system shares: the host's side of `wgsl/core`.

mod bricks;
mod camera;
mod geometry;
mod jitter;
mod light;
mod light_fit;
mod raster;
mod resolve_depth;
mod scan;
mod shadow_views;
mod sort;
mod tonemap;
mod transfer;
#[cfg(feature = "command")]
mod transfer_file;
mod volume;

pub use bricks::{BrickThreshold, Bricks, brick_count};
pub use camera::{Camera, CameraError, DepthRange, OrthographicView, PerspectiveView, View};
pub use geometry::{Geometry, GeometryPass};
pub use jitter::{Jitter, blue_noise_texture};
pub use light::{DIRECTIONAL, Light, LightError, POINT, SPOT, direction_from_angles};
pub use raster::{Drawing, MeshBuffers, Pictures, Raster, Sky};
pub(crate) use raster::{MESH_VERTEX, begin};
pub use resolve_depth::{ResolveDepth, ResolveDepthParameters, SampleChoice};
pub use scan::Scan;
pub use shadow_views::{Cascades, MAX_VIEWS, ShadowViews};
pub use sort::{Sort, SortParameters};
pub use tonemap::{Tonemap, TonemapParameters};
#[cfg(feature = "command")]
pub(crate) use transfer::entry;
pub use transfer::{Transfer, TransferError, TransferPoint};
#[cfg(feature = "command")]
pub use transfer_file::{TRANSFERS, TransferFileError, TransferFunction, parse_transfer, read_transfer};
pub use volume::{Reading, VolumeSpace, VolumeTexture, VolumeTextureError};
