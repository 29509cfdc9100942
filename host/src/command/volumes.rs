// SPDX-License-Identifier: MIT OR Apache-2.0
//! `--volume`: files of volumes, and the number of voxels of those that are made.

use super::CommandError;
use super::error::medium_error;
use crate::data::{Volume, load_volume};
use glam::{Mat4, Vec3};
use std::path::Path;

/// Metres of the longest side of a .npy volume for whose voxels no side is said.
const LONGEST: f32 = 4.0;

/// Whether a path is that of an array.
pub fn is_array(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("npy"))
}

/// Reads a file. `voxel`: side of a voxel of an array, metres; `known`: what else may be given.
///
/// # Errors
/// Misuse: an unknown name. A failure: a file that cannot be read.
pub fn load(path: &Path, voxel: Option<f32>, known: &str) -> Result<Volume, CommandError> {
    let volume = load_volume(path, voxel.unwrap_or(1.0));
    let mut volume = volume.map_err(|error| medium_error("--volume", error, known))?;
    if is_array(path) && voxel.is_none() {
        let longest = volume.bounds().size().max_element();
        volume.world_from_unit = Mat4::from_scale(Vec3::splat(LONGEST / longest)) * volume.world_from_unit;
    }
    Ok(volume)
}

/// Voxels of a box with such sides, `count` along the longest, at least one.
pub fn voxels(count: u32, sides: [f32; 3]) -> [u32; 3] {
    let longest = sides.into_iter().fold(0.0, f32::max);
    sides.map(|side| (count as f32 * side / longest).round().max(1.0) as u32)
}
