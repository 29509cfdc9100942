// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes as sheets of splats: the host's side of `wgsl/splatting`.
//!
//! [`Splats`] are the voxels of a volume above a threshold; several volumes act as one. [`Sheets`] lie one behind the other along the half-way vector between
//! eye and light. [`SheetPicture`] sorts splats by sheet, and draws sheet after sheet into a picture and into a shadow buffer.

mod error;
mod frame;
mod inputs;
mod kernel;
mod light_path;
mod lights;
mod means;
mod order;
mod passes;
mod picture;
mod scattered_light;
mod sheets;
mod soft_light;
mod soft_plane;
mod soft_schedule;
mod splats;
mod surfaces;

pub use error::SplattingError;
pub use frame::{
    LightTransport, ScatteringSettings, Shading, SheetFrame, SheetLighting, SheetSettings, SoftShadows,
};
pub use inputs::SheetInputs;
pub use kernel::Kernel;
pub use lights::light_around;
pub use picture::SheetPicture;
pub use scattered_light::Scattering;
pub use sheets::{SheetNumber, SheetTargets, Sheets};
pub use soft_plane::{SoftLight, SoftPlane};
pub use soft_schedule::{LayerBlur, LayerMerge, SOFT_LAYERS, SOFT_SPREAD, SoftSchedule};
pub use splats::{SplatBatch, SplatVolume, Splats};
pub use surfaces::Surfaces;
