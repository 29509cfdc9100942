// SPDX-License-Identifier: MIT OR Apache-2.0
//! Runs Airlight's WGSL shader modules for stylized light in volumes.
//!
//! [`Gpu`] opens a device on WebGPU's default limits. [`Shaders`] composes modules and passes.
//! [`Pass`] turns a pass into pipelines whose resources are bound by name. Each system is a module
//! of plain functions that record passes into an encoder: [`ambient`], [`inverse`], [`painterly`], [`scattering`],
//! [`splatting`], [`stylize`], [`transmittance`].

pub mod ambient;
#[cfg(feature = "capture")]
pub mod capture;
#[cfg(feature = "command")]
pub mod command;
pub mod core;
pub mod data;
#[cfg(feature = "command")]
pub mod formats;
mod gpu;
pub mod inverse;
pub mod layout;
mod out_of_range;
pub mod painterly;
mod pass;
mod resource;
pub mod scattering;
#[cfg(feature = "command")]
pub mod scenes;
mod shaders;
pub mod splatting;
mod stage;
pub mod stylize;
pub mod transmittance;

pub use airlight_validate as validate;
pub use gpu::{Gpu, GpuError};
pub use out_of_range::OutOfRange;
pub use pass::{
    Bound, ColorTarget, DepthTarget, Draw, DrawExtent, Pass, PassError, RenderStages, Resource, watch,
};
pub use resource::{Buffer, Part, Sampler, Texture};
pub use shaders::Shaders;
pub use stage::{Lighting, PartShadows, Setting, Stage, StageError, light_texture};
