// SPDX-License-Identifier: MIT OR Apache-2.0
//! Ray casting of iso-surfaces where something is odd: cameras inside, clip planes, wild voxels, thin volumes, nothing solid;
//! lighting and occlusion.
#![allow(clippy::unwrap_used)]

#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/probing.rs"]
mod probing;
#[path = "../support/surfaces.rs"]
mod surfaces;

mod cameras;
mod cuts;
mod odd_volumes;
mod shading;
