// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is impossible in a transfer function.

use crate::gpu::GpuError;
use crate::pass::PassError;
use glam::Vec3;
use std::path::PathBuf;

/// Why a transfer function cannot be read, made or applied.
#[derive(Debug, thiserror::Error)]
pub enum TransferError {
    /// Something in a file; lines and columns count from 1, columns in characters.
    #[error("{}:{line}:{column}: {key}: {reason}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Line.
        line: usize,
        /// Column.
        column: usize,
        /// The key, from the top of the file: `layer[1].constraint[0].color`.
        key: String,
        /// What is wrong, and what is right.
        reason: String,
    },
    /// The file itself.
    #[error("{}: the transfer function cannot be read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// Something in a description made in code.
    #[error("{key}: {reason}")]
    Description {
        /// Which part, as in a file.
        key: String,
        /// What is wrong, and what is right.
        reason: String,
    },
    /// A constraint refers to a picture, and there is none.
    #[error("{key} names a pixel or a point of a scene: a rendered scene is needed to find its place")]
    NeedsScene {
        /// The constraint.
        key: String,
    },
    /// A pixel that the picture does not have.
    #[error("{key}: pixel {x}, {y} lies outside the picture of {width}x{height}")]
    PixelOutside {
        /// The constraint.
        key: String,
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// Width of the picture.
        width: u32,
        /// Height of the picture.
        height: u32,
    },
    /// A point that the camera does not see.
    #[error("{key}: the point {point} lies outside the picture")]
    PointOutside {
        /// The constraint.
        key: String,
        /// Where it is, metres.
        point: Vec3,
    },
    /// An object that the scene does not have.
    #[error("{key}: the scene has no object `{name}` to follow; it has {known}")]
    UnknownObject {
        /// The constraint.
        key: String,
        /// The unknown name.
        name: String,
        /// Those it has.
        known: String,
    },
    /// Key frames that are not in order.
    #[error("key frames must be finite and ascend: {after} follows {before}")]
    Order {
        /// A frame.
        before: f32,
        /// The next one.
        after: f32,
    },
    /// No key frames.
    #[error("at least one key frame is needed")]
    NoKeys,
    /// Text that is no list of key frames.
    #[error("`{0}` is neither a number nor a list of key frames FRAME:VALUE,FRAME:VALUE as 0:5,48:31")]
    KeyText(String),
    /// A map of another size.
    #[error("{what} of {given:?} was given where {expected:?} is needed")]
    OtherSize {
        /// What has the size.
        what: &'static str,
        /// Its width and height.
        given: [u32; 2],
        /// Those needed.
        expected: [u32; 2],
    },
    /// A property that is marched, where nothing is.
    #[error(
        "an evaluation does not find the mean distance of lit points: apply this function by `Restyle`, which marches"
    )]
    VisibleDepth,
    /// A size.
    #[error(transparent)]
    Stylize(#[from] crate::stylize::StylizeError),
    /// A pass failed.
    #[error(transparent)]
    Pass(#[from] PassError),
}

impl From<GpuError> for TransferError {
    fn from(error: GpuError) -> Self {
        Self::Pass(error.into())
    }
}
