// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is impossible with sheets of splats.

use crate::core::{LightError, VolumeTextureError};
use crate::gpu::GpuError;
use crate::out_of_range::OutOfRange;
use crate::pass::PassError;
use glam::Vec3;

/// Why sheets cannot be drawn as asked.
#[derive(Debug, thiserror::Error)]
pub enum SplattingError {
    /// A number out of its range.
    #[error(transparent)]
    Setting(#[from] OutOfRange),
    /// The volume cannot be uploaded.
    #[error(transparent)]
    Volume(#[from] VolumeTextureError),
    /// More voxels than numbers of 32 bits.
    #[error(
        "a volume of {0:?} voxels is impossible: it has more than 4294967295 of them; take a coarser one"
    )]
    Voxels([u32; 3]),
    /// Two pictures that should be of one size.
    #[error("the camera is for pictures of {camera:?} pixels, and the picture has {picture:?}")]
    Viewport {
        /// Width and height of the camera's viewport.
        camera: [u32; 2],
        /// Width and height of the picture.
        picture: [u32; 2],
    },
    /// Meshes without a triangle.
    #[error("the meshes have no triangle: leave them out, or give one that has")]
    NoPolygons,
    /// A light buffer in which scattered light finds no room.
    #[error(
        "light scattered through {sheets} sheets of {size:?} texels needs a buffer of {bytes} bytes, and the device binds {limit}: take a smaller light buffer"
    )]
    LightBuffer {
        /// Columns and rows of the light buffer.
        size: [u32; 2],
        /// How many sheets there are.
        sheets: usize,
        /// What one pass needs.
        bytes: u64,
        /// What the device binds.
        limit: u64,
    },
    /// A light in a plane parallel to the sheets has to be before the whole scene.
    #[error(
        "soft shadows are impossible here: along the sheets' normal the scene lies from {nearest} to {farthest} m before \
         the light, and all of it has to lie before the light, the nearest at least a thousandth as far as the farthest, \
         and none 1e12 m away"
    )]
    LightBehind {
        /// Distance of the nearest point along the normal, metres; negative behind the light. Of a directional light the cosine
        /// between its way and the normal.
        nearest: f32,
        /// Distance of the farthest point.
        farthest: f32,
    },
    /// A light in the midst of what it shines on.
    #[error(
        "the light at {0} is inside the volumes' box: light has to meet the first sheet first; move it out"
    )]
    LightInside(Vec3),
    /// A light that would have to shine into more than a frustum.
    #[error(
        "the light at {0} is too near to the volumes: it sees them over more than 160 degrees; move it away"
    )]
    LightTooNear(Vec3),
    /// The light.
    #[error(transparent)]
    Light(#[from] LightError),
    /// A pass failed.
    #[error(transparent)]
    Pass(#[from] PassError),
}

impl From<GpuError> for SplattingError {
    fn from(error: GpuError) -> Self {
        Self::Pass(error.into())
    }
}
