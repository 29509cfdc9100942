// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is impossible with views and volumes, in the words of the flags.

use super::views::ViewsError;
use crate::OutOfRange;
use crate::command::CommandError;
use crate::inverse::{InverseError, LogCounts};
use std::path::PathBuf;

/// Why views and a volume do not go together. Each message says what to do.
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    /// A view that does not see the volume.
    #[error(
        "--views: view `{view}` misses the volume: no ray of it meets the box {low} to {high} m before a surface; \
         move its camera, or leave it out"
    )]
    Misses {
        /// The view.
        view: String,
        /// Least corner of the box around the volume.
        low: glam::Vec3,
        /// Greatest corner.
        high: glam::Vec3,
    },
    /// No pixel has an optical depth.
    #[error(
        "--for extinction: no pixel of any view has an optical depth: {} are beyond the background, {} beyond the medium, {} show nothing since \
         the medium looks like the background; give views another background, or another --medium-radiance",
        .0.beyond_background, .0.beyond_medium, .0.dropped
    )]
    NoDepths(LogCounts),
    /// A hull of no masks.
    #[error("--hull: no view of {0} has a mask; give mask = \"FILE\" to a view, or leave it out")]
    NoMasks(PathBuf),
    /// No voxel is solved for.
    #[error(
        "--for {0}: no voxel matters: none with extinction lies inside the masks; give other masks or another --volume"
    )]
    NoVoxels(&'static str),
    /// Nothing that light could change.
    #[error(
        "--for light: nothing scatters light: extinction or albedo is 0 everywhere; give another --volume or --albedo"
    )]
    NoScattering,
    /// A view with a light of its own where one light is solved for.
    #[error(
        "--for light: view `{0}` has an `environment` of its own, and one light is solved for: leave it out"
    )]
    OwnLight(String),
    /// A picture, a volume or what is between them is more than the device holds.
    #[error("{flag}: {what} need {needed} {unit} and the device takes {limit}: {remedy}")]
    TooLarge {
        /// What to change.
        flag: &'static str,
        /// Which.
        what: String,
        /// How many of the unit.
        needed: u64,
        /// `bytes in one piece`, or `texels along a side`.
        unit: &'static str,
        /// How many at most.
        limit: u64,
        /// What to do.
        remedy: &'static str,
    },
    /// A file that is read would be replaced.
    #[error("--out: {0} is read by this command and would be replaced; give another folder")]
    Replaces(PathBuf),
    /// Interrupted before there was anything to keep.
    #[error("interrupted before the first iteration was done: nothing was written")]
    Interrupted,
}

impl From<SolveError> for CommandError {
    fn from(error: SolveError) -> Self {
        match error {
            SolveError::NoMasks(_) | SolveError::OwnLight(_) => Self::Misuse(error.to_string()),
            _ => Self::failure(error),
        }
    }
}

impl From<ViewsError> for CommandError {
    fn from(error: ViewsError) -> Self {
        match error {
            ViewsError::Write(_) => Self::failure(format!("--out: {error}")),
            _ => Self::failure(format!("--views: {error}")),
        }
    }
}

impl From<InverseError> for CommandError {
    fn from(error: InverseError) -> Self {
        match &error {
            InverseError::Setting(OutOfRange { name: "number of slices", .. }) => {
                Self::misuse("--steps", error)
            }
            InverseError::Setting(OutOfRange { name: "number of iterations", .. }) => {
                Self::misuse("--iterations", error)
            }
            InverseError::Setting(OutOfRange { name: "greatest optical depth", .. }) => {
                Self::misuse("--most-depth", error)
            }
            InverseError::Setting(OutOfRange {
                name: "step of bent rays" | "number of steps of bent rays",
                ..
            }) => Self::misuse("--refraction-step", error),
            InverseError::Light(_) => Self::misuse("--light", error),
            InverseError::LightColumns { .. } => Self::failure(format!("--light-strategy: {error}")),
            InverseError::Memory {
                name: "light volumes" | "sums of light volumes" | "volumes of scattered light",
                ..
            } => Self::failure(format!("--light-resolution: {error}")),
            InverseError::Camera => Self::failure(format!("--views: {error}")),
            InverseError::Memory { .. } => Self::failure(format!("--resolution: {error}")),
            _ => Self::failure(error),
        }
    }
}
