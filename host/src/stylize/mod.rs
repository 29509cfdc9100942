// SPDX-License-Identifier: MIT OR Apache-2.0
//! Light shafts in the hands of an artist: the host's side of `wgsl/stylize`.
//!
//! [`PunchHoles`] makes random holes in the shadow of an object.

mod hole_statistics;
mod holes;
mod holes_passes;

pub use holes::{HoleError, HoleMotion, HoleParameters, HolePattern, Holes, shadow_map_extent};
pub use holes_passes::{HoleMask, HolePicture, PunchHoles, PunchHolesBound};
