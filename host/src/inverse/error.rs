// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is impossible when a volume is solved for.

use crate::core::LightError;
use crate::gpu::GpuError;
use crate::out_of_range::OutOfRange;
use crate::pass::PassError;

/// Why a volume cannot be rendered or solved for as asked.
#[derive(Debug, thiserror::Error)]
pub enum InverseError {
    /// A number out of its range.
    #[error(transparent)]
    Setting(#[from] OutOfRange),
    /// A view or a volume whose matrix has no inverse.
    #[error("the view has no rays: its camera's and its volume's matrices must be finite and have inverses")]
    Camera,
    /// A light that is impossible.
    #[error(transparent)]
    Light(#[from] LightError),
    /// Not as many numbers as something holds.
    #[error("{name} need {needed} numbers and were given {given}")]
    Count {
        /// Which.
        name: &'static str,
        /// What is needed.
        needed: usize,
        /// What was given.
        given: usize,
    },
    /// More than the device holds in one piece.
    #[error(
        "{name} need {bytes} bytes in one piece and the device takes {limit}: take a coarser volume or smaller views"
    )]
    Memory {
        /// Which.
        name: &'static str,
        /// What is needed.
        bytes: u64,
        /// What the device takes.
        limit: u64,
    },
    /// Rays that are to be bent, and a medium that has no index.
    #[error("bent rays need an index of refraction and the medium has none: give its `index`")]
    Index,
    /// A pass cannot be made or run.
    #[error(transparent)]
    Pass(#[from] PassError),
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}
