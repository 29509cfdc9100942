// SPDX-License-Identifier: MIT OR Apache-2.0
//! What is impossible with strokes.

use crate::gpu::GpuError;
use crate::pass::PassError;

/// Why strokes cannot be kept or drawn as asked.
#[derive(Debug, thiserror::Error)]
pub enum StrokeError {
    /// A number of a style.
    #[error("{name} of {value} is impossible: it must be {range}")]
    Style {
        /// Which number, as in a file.
        name: String,
        /// What was given.
        value: f32,
        /// What is possible.
        range: &'static str,
    },
    /// A style file.
    #[cfg(feature = "command")]
    #[error("the style {0}")]
    File(#[from] crate::formats::TomlFileError),
    /// Number of strokes.
    #[error("a buffer of {given} strokes is impossible: it must hold between 1 and {limit} on this device")]
    Capacity {
        /// What was asked for.
        given: u32,
        /// The device's limit.
        limit: u32,
    },
    /// A size.
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
    /// Other sources than announced.
    #[error(
        "{what} of {given:?} pixels was given to strokes that expect {expected:?}: build them for its size"
    )]
    OtherSize {
        /// Which source.
        what: &'static str,
        /// Width and height of what was given.
        given: [u32; 2],
        /// Width and height of what was announced.
        expected: [u32; 2],
    },
    /// Curvature is wanted and missing.
    #[error("the style's strokes follow curvature: give a curvature target, or take another orientation")]
    Curvature,
    /// A transform that has no inverse.
    #[error("the volume's transform has no inverse: its scale must be finite and not 0 along any axis")]
    Transform,
    /// A brush image.
    #[error("a brush of {width}x{height} with {values} values is impossible: {reason}")]
    Brush {
        /// Width.
        width: u32,
        /// Height.
        height: u32,
        /// Numbers given.
        values: usize,
        /// Why.
        reason: &'static str,
    },
    /// No brush at all.
    #[error("there is no brush: strokes need at least one")]
    NoBrush,
    /// A style names a brush that is not there.
    #[error("layer {layer} takes brush {brush}, but there are only {count}: brushes count from 0")]
    MissingBrush {
        /// Name of the layer.
        layer: &'static str,
        /// The brush.
        brush: u32,
        /// How many there are.
        count: u32,
    },
    /// A pass failed.
    #[error(transparent)]
    Pass(#[from] PassError),
}

impl From<GpuError> for StrokeError {
    fn from(error: GpuError) -> Self {
        Self::Pass(error.into())
    }
}
