// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is impossible of ambient light.

use crate::gpu::GpuError;
use crate::out_of_range::OutOfRange;
use crate::pass::PassError;

/// Why there is no ambient light as asked.
#[derive(Debug, thiserror::Error)]
pub enum AmbientError {
    /// A number out of its range.
    #[error(transparent)]
    Setting(#[from] OutOfRange),
    /// A pass cannot be made or run.
    #[error(transparent)]
    Pass(#[from] PassError),
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}
