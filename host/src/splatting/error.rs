// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is impossible with sheets of splats.

use crate::core::{LightError, VolumeTextureError};
use crate::gpu::GpuError;
use crate::pass::PassError;
use glam::Vec3;

/// Why sheets cannot be drawn as asked.
#[derive(Debug, thiserror::Error)]
pub enum SplattingError {
    /// A number out of its range.
    #[error("{name} of {value} is impossible: it must be {range}")]
    Setting {
        /// Which.
        name: &'static str,
        /// What was given.
        value: f32,
        /// What is possible.
        range: &'static str,
    },
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

pub(super) fn in_range(
    name: &'static str,
    value: f32,
    possible: std::ops::RangeInclusive<f32>,
    range: &'static str,
) -> Result<(), SplattingError> {
    if possible.contains(&value) { Ok(()) } else { Err(SplattingError::Setting { name, value, range }) }
}
