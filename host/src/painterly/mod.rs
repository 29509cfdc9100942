// SPDX-License-Identifier: MIT OR Apache-2.0
//! Iso-surfaces of volumes: the host's side of `wgsl/painterly`.
//!
//! [`IsoRaycast`] casts view rays at the surface of an [`IsoVolume`] that a [`Transfer`] function classifies, and writes colour,
//! normal, flow and distance of what they hit into [`IsoTargets`], passing over the bricks that [`SolidBricks`] finds empty. [`Shade`] lights colours that were left unlit.
//! Of the curvatures that may be written too, [`Advect`] makes streaks, and [`Ridges`] colours ridges and valleys.

mod advect;
mod error;
mod iso_raycast;
mod ridges;
mod settings;
mod shade;
mod solid_bricks;
mod transfer;
mod volume;

pub use advect::{Advect, AdvectBound, StreakParameters};
pub use error::PainterlyError;
pub use iso_raycast::{IsoBound, IsoForm, IsoRaycast, IsoTargets};
pub use ridges::{CurvatureTable, RidgeParameters, Ridges, RidgesBound};
pub use settings::{IsoFrame, IsoSettings, IsoSurface, MOST_CLIP_PLANES, SurfaceLighting};
pub use shade::{Shade, ShadeBound};
pub use solid_bricks::{BrickRanges, SolidBricks};
pub use transfer::{Transfer, TransferPoint};
pub use volume::IsoVolume;
