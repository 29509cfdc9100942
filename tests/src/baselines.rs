// SPDX-License-Identifier: MIT OR Apache-2.0
//! Competitors that are not product: passes over the same rectified map, with the same bindings as
//! the march along its rows, for the benchmarks and the tests to compare with.
//!
//! Each is a pass that builds a texture from the rectified map and one that evaluates a picture,
//! average visibility over the nearest row. Their sources import Airlight's modules. One more copies
//! a shadow map, texel by texel: the floor under all that morphology does. And one draws quads whose
//! corners are known: the floor under all that drawing strokes does. Two gather an environment's light in
//! screen space, direction by direction, and blur it: what bent cones compete with.

pub mod minmax;
pub mod variance;

/// The system under which the passes are added to a library.
pub const SYSTEM: &str = "baselines";

/// A pass of a competitor.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// Its name in the system [`SYSTEM`].
    pub name: &'static str,
    /// WGSL text with naga_oil directives.
    pub text: &'static str,
}

/// What all pictures have in common, followed by what one competitor adds.
macro_rules! picture {
    ($file:literal) => {
        concat!(include_str!("baselines/picture.wgsl"), "\n", include_str!($file))
    };
}

/// Every pass.
pub const PASSES: [Source; 10] = [
    Source { name: "minmax_build", text: include_str!("baselines/minmax_build.wgsl") },
    Source { name: "minmax", text: picture!("baselines/minmax.wgsl") },
    Source { name: "minmax_binary_build", text: include_str!("baselines/minmax_binary_build.wgsl") },
    Source { name: "minmax_binary", text: picture!("baselines/minmax_binary.wgsl") },
    Source { name: "variance_filter", text: include_str!("baselines/variance_filter.wgsl") },
    Source { name: "variance", text: picture!("baselines/variance.wgsl") },
    Source { name: "copy", text: include_str!("baselines/copy.wgsl") },
    Source { name: "plain_quads", text: include_str!("baselines/plain_quads.wgsl") },
    Source { name: "ssdo", text: include_str!("baselines/ssdo.wgsl") },
    Source { name: "ssdo_blur", text: include_str!("baselines/ssdo_blur.wgsl") },
];
