// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes from pictures: the host's side of `wgsl/inverse`.
//!
//! Rendering a volume is linear in its emission and albedo, and so is its optical depth in its extinction: pictures are `W a`.
//! [`Projector`] renders (`W`) and projects pictures back into the volume (the transpose of `W`), with the same weights and without
//! storing a matrix. [`Solver`] finds the volumes whose pictures are nearest to those that are wanted.

mod descent;
mod error;
mod hull;
mod light;
mod light_solver;
mod log_targets;
mod meets;
mod problem;
mod projector;
mod radiance_targets;
mod solver;
mod touched;
mod view;

pub use descent::{SolverPart, SolverScalars, SolverSums};
pub use error::InverseError;
pub use hull::{Silhouette, visual_hull};
pub use light::{LightLayers, LightMaps, LightPasses, ShadowCasters};
pub use light_solver::{LightNumber, LightSolver, LightStrategy, LightUnknown};
pub use log_targets::{LogCounts, LogTargets, log_targets};
pub use meets::meets_volume;
pub use problem::{Regulariser, Target, Unknown};
pub use projector::{
    Basis, Channels, Collected, Fields, Medium, Projector, ProjectorForm, Solved, Transpose, ViewImages,
};
pub use radiance_targets::radiance_targets;
pub use solver::Solver;
pub use touched::touched;
pub use view::{PictureRows, RaySteps, SliceView, VoxelGrid};
