// SPDX-License-Identifier: MIT OR Apache-2.0
//! Ray casting of iso-surfaces where something is odd: cameras inside, clip planes, wild voxels, thin volumes, nothing solid;
//! lighting and occlusion.

mod cameras;
mod cuts;
mod odd_volumes;
mod shading;
