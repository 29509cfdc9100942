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
    /// Stored pictures of lights that the device does not hold in one piece.
    #[error(
        "the pictures of every light in one view need {bytes} bytes in one piece and the device takes {limit}: take light volumes in place of stored pictures, fewer lights or smaller views"
    )]
    LightColumns {
        /// What is needed.
        bytes: u64,
        /// What the device takes.
        limit: u64,
    },
    /// A projector that is no use for lights.
    #[error("light is solved for with a projector that solves for albedo")]
    LightProjector,
    /// A pass cannot be made or run.
    #[error(transparent)]
    Pass(#[from] PassError),
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Refuses another number of numbers than is needed.
pub(super) fn exact(name: &'static str, needed: usize, given: usize) -> Result<(), InverseError> {
    if needed == given { Ok(()) } else { Err(InverseError::Count { name, needed, given }) }
}
