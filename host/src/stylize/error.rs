// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is impossible in stylization.

use super::HoleError;
use crate::gpu::Gpu;
use crate::pass::PassError;
use glam::DVec4;

/// Why an occluder cannot be changed as asked.
#[derive(Debug, thiserror::Error)]
pub enum StylizeError {
    /// A kernel width without a middle.
    #[error("a kernel of {0} texels is impossible: the width must be an odd whole number from 1 on, as 11")]
    Width(f64),
    /// A kernel width that is no number.
    #[error("a kernel of `{0}` texels is impossible: the width must be an odd whole number from 1 on, as 11")]
    WidthText(String),
    /// Size of a map.
    #[error("{what} of {width}x{height} is impossible: both must lie between 1 and {limit} on this device")]
    Size {
        /// What has the size.
        what: &'static str,
        /// Width.
        width: u32,
        /// Height.
        height: u32,
        /// The device's limit.
        limit: u32,
    },
    /// Another map than the passes were built for.
    #[error("a shadow map of {given:?} texels was bound to passes for {expected:?}: build them for its size")]
    OtherSize {
        /// Width and height of what was bound.
        given: [u32; 2],
        /// Width and height of what was announced.
        expected: [u32; 2],
    },
    /// Not one matrix, and one set of holes, for each shadow map.
    #[error(
        "{expected} shadow maps were given {matrices} matrices and {holes} sets of holes: one each is wanted"
    )]
    Maps {
        /// Matrices given.
        matrices: usize,
        /// Sets of holes given, if any.
        holes: usize,
        /// Maps.
        expected: usize,
    },
    /// The eye has no place in the map.
    #[error("the eye at {0} has no place in the shadow map: its coordinates must be finite and not all zero")]
    Epipole(DVec4),
    /// The light has six maps.
    #[error("a point light has a shadow map for each face: give the matrix of one face to `Epipole::in_map`")]
    PointLight,
    /// Holes.
    #[error(transparent)]
    Holes(#[from] HoleError),
    /// A pass failed.
    #[error(transparent)]
    Pass(#[from] PassError),
}

/// Checks a size against the device's limit.
pub(super) fn check_size(gpu: &Gpu, what: &'static str, size: [u32; 2]) -> Result<(), StylizeError> {
    let limit = gpu.limits.max_texture_dimension_2d;
    let [width, height] = size;
    if size.iter().any(|side| *side == 0 || *side > limit) {
        return Err(StylizeError::Size { what, width, height, limit });
    }
    Ok(())
}
