// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is impossible with iso-surfaces.

use super::MOST_CLIP_PLANES;
use crate::core::{TransferError, VolumeTextureError};
use crate::gpu::GpuError;
use crate::out_of_range::OutOfRange;
use crate::pass::PassError;

/// Why a surface cannot be seen.
#[derive(Debug, thiserror::Error)]
pub enum PainterlyError {
    /// A number out of its range.
    #[error(transparent)]
    Setting(#[from] OutOfRange),
    /// More clip planes than a pass takes.
    #[error("{0} clip planes are too many: at most {MOST_CLIP_PLANES} are taken")]
    ClipPlanes(usize),
    /// A volume that is flat or nowhere.
    #[error("the volume's place is impossible: its matrix must be finite and have an inverse")]
    Space,
    /// A range of values that is empty.
    #[error("values from {0} to {1} are no range: the second must be greater, both finite")]
    Range(f32, f32),
    /// A colour or opacity.
    #[error("entry {entry} of a table is {value:?}: colours must be from 0 to 65504, opacities from 0 to 1")]
    Entry {
        /// Its number.
        entry: usize,
        /// Linear RGB and opacity.
        value: [f32; 4],
    },
    /// A table over two curvatures that is none.
    #[error(
        "a table of {given} colours is impossible: give {side} rows of {side}, with from 2 to {limit} in a row, the width of a texture"
    )]
    Table {
        /// How many there are.
        given: usize,
        /// Colours in a row.
        side: usize,
        /// The device's limit.
        limit: u32,
    },
    /// Rays that were cast without what is asked for.
    #[error("the rays were cast without curvature: ask for it by `IsoForm::curvature`")]
    NoCurvature,
    /// The transfer function.
    #[error(transparent)]
    Function(#[from] TransferError),
    /// A picture without pixels, or too large.
    #[error("pictures of {size:?} are impossible: every side must lie between 1 and {limit} on this device")]
    Size {
        /// Columns and rows.
        size: [u32; 2],
        /// The device's limit.
        limit: u32,
    },
    /// The volume cannot be uploaded.
    #[error(transparent)]
    Volume(#[from] VolumeTextureError),
    /// A pass failed.
    #[error(transparent)]
    Pass(#[from] PassError),
}

impl From<GpuError> for PainterlyError {
    fn from(error: GpuError) -> Self {
        Self::Pass(error.into())
    }
}
