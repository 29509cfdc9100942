// SPDX-License-Identifier: MIT OR Apache-2.0
//! What the solver's passes are told, and what they say.

use encase::ShaderType;
use glam::{UVec3, Vec4};

/// The uniform `SolverPart` of `inverse/solver_steps`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SolverPart {
    /// Voxels along x, y and z.
    pub size: UVec3,
    /// Where its sums begin, groups.
    pub first_group: u32,
    /// Weight of the squared Laplacian.
    pub laplacian: f32,
    /// Weight of the squared value.
    pub smallness: f32,
    /// Weight of the squared difference from 1.
    pub oneness: f32,
    /// Least value.
    pub low: f32,
    /// Greatest value.
    pub high: f32,
    /// Groups of all volumes that are solved for.
    pub groups: u32,
    /// Least of what a pace is one over.
    pub steepest: f32,
    /// Padding.
    pub reserved_a: u32,
}

/// The uniform `SolverSums` of `inverse/solver_steps`.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SolverSums {
    /// Groups of all volumes that are solved for.
    pub groups: u32,
    /// First sum of a picture.
    pub first_picture: u32,
    /// Sums of pictures.
    pub pictures: u32,
    /// From 0.
    pub iteration: u32,
}

/// The uniform `SolverScalars` of `inverse/solver_steps`, by channel.
#[derive(Debug, Clone, Copy, PartialEq, ShaderType)]
pub struct SolverScalars {
    /// What is kept of the direction before.
    pub kept: Vec4,
    /// Length of the step along the direction.
    pub step: Vec4,
    /// Square of the way downhill, times the pace.
    pub square: Vec4,
}
