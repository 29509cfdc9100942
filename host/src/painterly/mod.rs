// SPDX-License-Identifier: MIT OR Apache-2.0
//! Painterly rendering of volumes: the host's side of `wgsl/painterly`.
//!
//! [`Strokes`] keeps brush strokes on a surface that a ray caster shows: they follow it, fade in and out, are born where they
//! lie too thinly and deleted where they lie too densely, and are drawn with [`Brushes`] in a [`PainterlyStyle`].

mod brushes;
mod stroke_data;
mod stroke_error;
mod stroke_passes;
mod strokes;
mod style;
#[cfg(feature = "command")]
mod style_file;

pub use brushes::{BRUSH_SIZE, BrushImage, Brushes, procedural_brushes};
pub use stroke_data::{Stroke, StrokeCounts, StrokeFrame, StrokeState, StrokeStyle};
pub use stroke_error::StrokeError;
pub use strokes::{StrokeSettings, StrokeStep, StrokeTargets, Strokes};
pub use style::{DensityBounds, LayerStyle, Orientation, PainterlyStyle, Rates};
#[cfg(feature = "command")]
pub use style_file::{STYLES, parse_style, read_style};
