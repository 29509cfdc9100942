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
    load(path.as_ref(), voxel, &[1]).map(one)
}

/// Loads a volume, or the red, green and blue of one: like [`load_volume`], also from a NIfTI-1 file of four axes that holds three
/// volumes, or from a .npy array z, y, x, channel with three channels; what [`crate::formats::write_volumes`] writes. One volume or three, of the same size and place.
///
/// # Errors
/// [`MediumFileError`].
pub fn load_channels(path: impl AsRef<Path>, voxel: f32) -> Result<Vec<Volume>, MediumFileError> {
    load(path.as_ref(), voxel, &[1, 3])
}

/// A volume from the bytes of a NIfTI-1 file that is part of the program. `name` stands for its path in errors.
///
/// # Errors
/// As [`load_volume`].
pub fn volume_from_bytes(name: &str, bytes: &[u8]) -> Result<Volume, MediumFileError> {
    image(Path::new(name), bytes, &[1]).map(one)
}

/// As many volumes as `allowed` has.
fn load(path: &Path, voxel: f32, allowed: &[u64]) -> Result<Vec<Volume>, MediumFileError> {
    let name = path.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
    if name.ends_with(".nii") || name.ends_with(".nii.gz") {
        let file = File::open(path).map_err(|error| MediumFileError::io(path, error))?;
        return image(path, BufReader::new(file), allowed);
    }
    if name.ends_with(".npy") {
        return array(path, voxel, allowed);
    }
    Err(MediumFileError::UnknownExtension { path: path.to_owned(), wanted: ".nii, .nii.gz or .npy" })
}

/// The only one of volumes, which are never none.
fn one(mut volumes: Vec<Volume>) -> Volume {
    volumes.swap_remove(0)
}

fn image(path: &Path, bytes: impl BufRead, allowed: &[u64]) -> Result<Vec<Volume>, MediumFileError> {
    // The parser is not ours; a panic in it is a broken file like any other.
    catch_unwind(AssertUnwindSafe(|| nifti::load(path, bytes, allowed)))
        .unwrap_or_else(|_| Err(MediumFileError::broken(path, "its parser gave up")))
}

fn array(path: &Path, voxel: f32, allowed: &[u64]) -> Result<Vec<Volume>, MediumFileError> {
    let array = read_npy(path)?;
    let sides: Option<Vec<u32>> = array.shape.iter().map(|side| u32::try_from(*side).ok()).collect();
    let sides = sides.filter(|_| !array.data.is_empty()).unwrap_or_default();
    let (size, channels) = match sides[..] {
        [z, y, x] => ([x, y, z], 1),
        [z, y, x, 3] if allowed.contains(&3) => ([x, y, z], 3),
        _ => {
            let wanted = if allowed.contains(&3) {
                "a volume wants three axes, [z, y, x], of at least one voxel each, or a fourth of three channels"
            } else {
                "a volume wants three axes, [z, y, x], of at least one voxel each"
            };
            return Err(MediumFileError::Shape { path: path.to_owned(), shape: array.shape, wanted });
        }
    };
    let extent = Vec3::from(size.map(|side| side as f32)) * voxel;
    let world_from_unit = Mat4::from_translation(-0.5 * extent) * Mat4::from_scale(extent);
    let values = array.to_f32();
    let volume = |channel: usize| {
        let values = values.iter().skip(channel).step_by(channels).copied().collect();
        Volume::new(size, values, world_from_unit)
            .map_err(|error| MediumFileError::unsupported(path, format!("voxels of {voxel} m: {error}")))
    };
    (0..channels).map(volume).collect()
}

#[cfg(test)]
mod tests;
