// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transmittance maps of a directional light: the host's side of `wgsl/transmittance`.
//!
//! A [`TransmittanceMap`] holds what a light ray a texel meets, in one of the [`Form`]s. [`Voxels`] builds it from a volume,
//! [`Splat`] and [`SplatFixed`] from particles in any order, and [`Query`] asks it for transmittance at points.
//! [`VolumePicture`] and [`ParticlePicture`] are pictures of media that are lit through it.

mod error;
mod lighting;
mod map;
mod particle_picture;
mod particles;
mod query;
mod settings;
mod splat;
mod splat_fixed;
mod volume_picture;
mod voxels;

pub use error::TransmittanceError;
pub use lighting::{Composite, MediumLighting, MediumView};
pub use map::TransmittanceMap;
pub use particle_picture::{ParticlePicture, ParticlePictureBound};
pub use particles::{CheckParticles, ParticleBuffer, ParticleCounts, SplatTarget};
pub use query::{Query, QueryBound};
pub use settings::{Form, MapSettings, Precision};
pub use splat::Splat;
pub use splat_fixed::{SplatFixed, SplatFixedBound};
pub use volume_picture::{VolumePicture, VolumePictureBound};
pub use voxels::Voxels;
