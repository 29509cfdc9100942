// SPDX-License-Identifier: MIT OR Apache-2.0
//! Painterly rendering of volumes: the host's side of `wgsl/painterly`.
//!
//! [`IsoRaycast`] casts view rays at the surface of an [`IsoVolume`] that a [`crate::core::Transfer`] function classifies, and writes colour,
//! normal, flow and distance of what they hit into [`IsoTargets`], passing over the bricks that [`SolidBricks`] finds empty. [`Shade`] lights colours that were left unlit.
//! Of the curvatures that may be written too, [`Advect`] makes streaks, and [`Ridges`] colours ridges and valleys.
//! [`Strokes`] keeps brush strokes on such a surface: they follow it, fade in and out, are born where they
//! lie too thinly and deleted where they lie too densely, and are drawn with [`Brushes`] in a [`PainterlyStyle`].
//! [`Painting`] does all of it, frame by frame.

mod advect;
mod brushes;
mod error;
mod iso_raycast;
mod painting;
mod ridges;
mod settings;
mod shade;
mod solid_bricks;
mod stroke_data;
mod stroke_error;
mod stroke_passes;
mod strokes;
mod style;
#[cfg(feature = "command")]
mod style_file;
mod volume;

pub use advect::{Advect, AdvectBound, StreakParameters};
pub use brushes::{BRUSH_SIZE, BrushImage, Brushes, procedural_brushes};
pub use error::PainterlyError;
pub use iso_raycast::{IsoBound, IsoForm, IsoRaycast, IsoTargets};
pub use painting::{Canvas, Painting, PaintingError, PaintingFrame, PaintingSettings};
pub use ridges::{CurvatureTable, RidgeParameters, Ridges, RidgesBound};
pub use settings::{IsoFrame, IsoSettings, IsoSurface, MOST_CLIP_PLANES, SurfaceLighting};
pub use shade::{Shade, ShadeBound};
pub use solid_bricks::{BrickRanges, SolidBricks};
pub use stroke_data::{Stroke, StrokeCounts, StrokeFrame, StrokeState, StrokeStyle};
pub use stroke_error::StrokeError;
pub use strokes::{StrokeSettings, StrokeStep, StrokeTargets, Strokes};
pub use style::{DensityBounds, LayerStyle, Orientation, PainterlyStyle, Rates};
#[cfg(feature = "command")]
pub use style_file::{STYLES, parse_style, read_style};
pub use volume::IsoVolume;
