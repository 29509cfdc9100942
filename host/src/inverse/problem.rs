// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is to be solved: volumes that are unknown, and the pictures that are wanted of them.

use super::{Medium, ViewImages};
use std::sync::Arc;

/// What is known of a volume beforehand, as multiples of the mean of W'C W 1 over all voxels that are solved for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Regulariser {
    /// Weight of the squared Laplacian: how smooth it is.
    pub laplacian: f32,
    /// Weight of the squared values: how small they are.
    pub smallness: f32,
    /// Weight of the squared differences from 1.
    pub oneness: f32,
}

/// A volume that is to be solved for.
#[derive(Debug, Clone)]
pub struct Unknown {
    /// Voxels along x, y and z.
    pub size: [u32; 3],
    /// Which are solved for, x fastest; the others are 0.
    pub solved: Vec<bool>,
    /// Values to begin with: the projector's numbers a voxel.
    pub start: Vec<f32>,
    /// Greatest value; the least is 0.
    pub high: f32,
    /// What is known beforehand.
    pub regulariser: Regulariser,
}

/// A view and the picture that is wanted of it.
pub struct Target {
    /// The view.
    pub view: ViewImages,
    /// What is known of the medium; views in other light or of another time have others.
    pub medium: Arc<Medium>,
    /// Less what does not depend on what is solved for: the projector's numbers a pixel.
    pub wanted: Vec<f32>,
    /// How much each pixel counts, from 0 up.
    pub weights: Vec<f32>,
}
