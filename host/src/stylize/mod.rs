// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light shafts in the hands of an artist: the host's side of `wgsl/stylize`.
//!
//! [`Morphology`] closes holes of a shadow map with a box or a disc; [`EpipolarMorphology`] extrudes its blockers
//! along view rays, where the camera cannot see it; [`PunchHoles`] makes random holes in the shadow of an object.
//! [`StylizedShadows`] does all of that to every map of a light. [`Transfer`] functions restyle what a scattering method wrote.

mod epipolar;
mod epipole;
mod error;
mod hole_error;
mod hole_statistics;
mod holes;
mod holes_passes;
mod kernel;
mod morphology;
mod shadows;
mod transfer;

pub use epipolar::{EpipolarBound, EpipolarKernel, EpipolarMorphology, EpipolarSettings, Form};
pub use epipole::Epipole;
pub use error::StylizeError;
pub use hole_error::HoleError;
pub use holes::{HoleMotion, HoleParameters, HolePattern, Holes, shadow_map_extent};
pub use holes_passes::{HoleMask, HolePicture, PunchHoles, PunchHolesBound};
pub use kernel::{Element, Operator, Width};
pub use morphology::{Disc, Morphology, MorphologyBound, MorphologySettings, Window};
pub use shadows::{ShadowMaps, ShadowOperator, ShadowStyle, StylizedShadows};
pub use transfer::{
    Baker, Blend, Color, Constraint, DiffusionLevel, Keyed, Layer, Mode, Phase, PickScene, Place,
    RayProperty, Restyle, Source, Transfer, TransferError, TransferFunction, TransferImage, TransferLayer,
    TransferSettings, TransferShare,
};
#[cfg(feature = "command")]
pub use transfer::{parse_transfer, read_transfer};

use crate::gpu::Gpu;
use crate::pass::{Bound, Pass};
use crate::resource::Texture;
use wgpu::TextureFormat::R32Float;

/// A dispatch: which pass, what it is given, over how many invocations.
struct Step {
    pass: usize,
    bound: Bound,
    size: [u32; 3],
}

fn record(passes: &[Pass], steps: &[Step], encoder: &mut wgpu::CommandEncoder) {
    for step in steps {
        passes[step.pass].dispatch(encoder, &step.bound, step.size);
    }
}

/// A map of values that a pass writes and the next reads.
fn values(gpu: &Gpu, size: [u32; 2]) -> Texture {
    Texture::storage(gpu, size, R32Float)
}
