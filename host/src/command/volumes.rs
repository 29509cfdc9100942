// SPDX-License-Identifier: MIT OR Apache-2.0
//! `--volume`: files of volumes, those that are made, and the flags of both.

mod flags;
mod made;

pub use flags::VolumeFlags;
pub use made::{KNOWN, Made, SEED_OF_FILES};

use super::CommandError;
use super::error::medium_error;
use crate::data::{Volume, load_channels, load_volume};
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
    let mut volume =
        load_volume(path, voxel.unwrap_or(1.0)).map_err(|error| medium_error("--volume", error, known))?;
    scale_array(path, voxel, std::slice::from_mut(&mut volume));
    Ok(volume)
}

/// Like [`load`], of a file that holds one volume or the three channels of one.
///
/// # Errors
/// As [`load`].
pub fn load_all(path: &Path, voxel: Option<f32>, known: &str) -> Result<Vec<Volume>, CommandError> {
    let mut volumes =
        load_channels(path, voxel.unwrap_or(1.0)).map_err(|error| medium_error("--volume", error, known))?;
    scale_array(path, voxel, &mut volumes);
    Ok(volumes)
}

/// Gives an array for whose voxels no side was said its longest side.
fn scale_array(path: &Path, voxel: Option<f32>, volumes: &mut [Volume]) {
    if !is_array(path) || voxel.is_some() {
        return;
    }
    for volume in volumes {
        let longest = volume.bounds().size().max_element();
        volume.world_from_unit = Mat4::from_scale(Vec3::splat(LONGEST / longest)) * volume.world_from_unit;
    }
}

/// Voxels of a box with such sides, `count` along the longest, at least one.
pub fn voxels(count: u32, sides: [f32; 3]) -> [u32; 3] {
    let longest = sides.into_iter().fold(0.0, f32::max);
    sides.map(|side| (count as f32 * side / longest).round().max(1.0) as u32)
}
