// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions: two properties of a view ray say what its light looks like.
//!
//! A [`Transfer`] is described by layers, read from a file by [`read_transfer`] (feature `command`) or built in code.
//! [`Baker`] turns it into a texture, [`Restyle`] applies that to the light that any scattering method wrote;
//! [`StylizedEvaluation`] is the last pass of a prefiltered method that does so itself.

mod baker;
mod description;
mod diffusion;
mod error;
mod evaluate;
#[cfg(feature = "command")]
mod file;
mod function;
mod keyed;
mod pick;
mod restyle;

pub use baker::{Baker, TransferLayer, TransferShare};
pub use description::{Blend, Color, Constraint, Layer, Place, Source, Transfer, TransferImage};
pub use diffusion::DiffusionLevel;
pub use error::TransferError;
pub use evaluate::StylizedEvaluation;
#[cfg(feature = "command")]
pub use file::{parse_transfer, read_transfer};
pub use function::{Mode, Phase, RayProperty, TransferFunction, TransferSettings};
pub use keyed::Keyed;
pub use pick::PickScene;
pub use restyle::Restyle;
