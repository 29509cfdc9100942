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
mod sheets;
mod splats;

pub use error::SplattingError;
pub use frame::{LightTransport, Shading, SheetFrame, SheetLighting, SheetSettings};
pub use inputs::SheetInputs;
pub use kernel::Kernel;
pub use lights::light_around;
pub use picture::SheetPicture;
pub use sheets::{SheetNumber, SheetTargets, Sheets};
pub use splats::{SplatBatch, SplatVolume, Splats};
