// SPDX-License-Identifier: MIT OR Apache-2.0
//! Transfer functions: two properties of a view ray say what its light looks like.
//!
//! A [`Transfer`] is described by layers, read from a file by [`read_transfer`] (feature `command`) or built in code.
//! [`Baker`] turns it into a texture, [`Restyle`] applies that to the light that any scattering method wrote:
//!
//! ```no_run
//! # use airlight::{Buffer, Gpu, Shaders, Stage, Texture, stylize::*};
//! # fn shown(gpu: &Gpu, shaders: &Shaders, stage: &Stage, scattered: &Texture) -> Result<(), TransferError> {
//! let style = read_transfer("sunset.toml")?;
//! let (frame, movements) = (12.0, Default::default());
//! let (camera, medium, inputs) = (&stage.camera, &stage.medium, stage.inputs());
//! let scene = PickScene { camera, medium, inputs, scattered, movements: &movements };
//! let map = Baker::new(gpu, shaders)?.bake_frame(gpu, &style, frame, Some(&scene))?;
//! let function = style.function(frame, &stage.medium);
//! let restyle = Restyle::new(gpu, shaders, &function, &stage.inputs(), [640, 480])?;
//! let bound = restyle.bind(gpu, &stage.inputs(), scattered, &map, &Buffer::uniform(gpu, &function))?;
//! let mut encoder = gpu.encoder();
//! restyle.record(&mut encoder, &bound);
//! gpu.submit(encoder)?;
//! // `restyle.restyled` goes where `scattered` went: into `scattering::Composite`.
//! # Ok(())
//! # }
//! ```

mod baker;
mod description;
mod diffusion;
mod error;
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
#[cfg(feature = "command")]
pub use file::{parse_transfer, read_transfer};
pub use function::{Mode, Phase, RayProperty, TransferFunction, TransferSettings};
pub use keyed::Keyed;
pub use pick::PickScene;
pub use restyle::Restyle;
