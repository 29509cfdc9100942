// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes from NIfTI and .npy files.

use super::medium::MediumFileError;
use super::nifti;
use crate::data::Volume;
use crate::formats::read_npy;
use glam::{Mat4, Vec3};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// Loads a volume from a NIfTI-1 file (.nii, .nii.gz) or a .npy array of three axes: z, y, x with x fastest, y up.
///
/// Values come as they are in the file, times its slope; they may be negative or NaN, which maps read as 0. A NIfTI volume lies
/// in the world as the file says, in metres, its upward axis y and its front z; an array is centred on the origin, its voxels cubes of a side of
/// `voxel` metres.
///
/// # Errors
/// [`MediumFileError`].
pub fn load_volume(path: impl AsRef<Path>, voxel: f32) -> Result<Volume, MediumFileError> {
    let path = path.as_ref();
    let name = path.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
    if name.ends_with(".nii") || name.ends_with(".nii.gz") {
        let file = File::open(path).map_err(|error| MediumFileError::io(path, error))?;
        return image(path, BufReader::new(file));
    }
    if name.ends_with(".npy") {
        return array(path, voxel);
    }
    Err(MediumFileError::UnknownExtension { path: path.to_owned(), wanted: ".nii, .nii.gz or .npy" })
}

/// A volume from the bytes of a NIfTI-1 file that is part of the program. `name` stands for its path in errors.
///
/// # Errors
/// As [`load_volume`].
pub fn volume_from_bytes(name: &str, bytes: &[u8]) -> Result<Volume, MediumFileError> {
    image(Path::new(name), bytes)
}

fn image(path: &Path, bytes: impl BufRead) -> Result<Volume, MediumFileError> {
    // The parser is not ours; a panic in it is a broken file like any other.
    catch_unwind(AssertUnwindSafe(|| nifti::load(path, bytes)))
        .unwrap_or_else(|_| Err(MediumFileError::broken(path, "its parser gave up")))
}

fn array(path: &Path, voxel: f32) -> Result<Volume, MediumFileError> {
    let array = read_npy(path)?;
    let sides: Option<Vec<u32>> = array.shape.iter().map(|side| u32::try_from(*side).ok()).collect();
    let (Some([z, y, x]), false) = (sides.as_deref(), array.data.is_empty()) else {
        let wanted = "a volume wants three axes, [z, y, x], of at least one voxel each";
        return Err(MediumFileError::Shape { path: path.to_owned(), shape: array.shape, wanted });
    };
    let size = [*x, *y, *z];
    let extent = Vec3::from(size.map(|side| side as f32)) * voxel;
    let world_from_unit = Mat4::from_translation(-0.5 * extent) * Mat4::from_scale(extent);
    Volume::new(size, array.to_f32(), world_from_unit)
        .map_err(|error| MediumFileError::unsupported(path, format!("voxels of {voxel} m: {error}")))
}

#[cfg(test)]
mod tests;
