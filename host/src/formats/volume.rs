// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes as files, NIfTI-1 or .npy as their names say.

use super::array::{Array, ArrayData};
use super::nifti::write_nifti;
use super::npy::write_npy;
use super::whole::WriteError;
use crate::data::Volume;
use std::path::Path;

/// Writes volumes of the same size and place, one, or several for the channels of a colour, into one file, whole or not at all.
///
/// `.nii` and `.nii.gz`: NIfTI-1 with their place, of four axes where there are several. `.npy`: float32 of the shape z, y, x, and channel where there are
/// several; the place is not in it. [`crate::data::load_channels`] reads both, with values bit by bit as they were.
///
/// # Errors
/// [`WriteError`]; [`WriteError::Data`] where the name ends otherwise, where there is no volume, where volumes differ in size or place, or a
/// side is too long for the format.
pub fn write_volumes(path: impl AsRef<Path>, volumes: &[Volume]) -> Result<(), WriteError> {
    let path = path.as_ref();
    let wrong = |reason: &str| Err(WriteError::Data { path: path.to_owned(), reason: reason.to_owned() });
    let Some(first) = volumes.first() else {
        return wrong("there is no volume to write");
    };
    let voxels = first.size.iter().map(|side| *side as usize).product::<usize>();
    let alike = |volume: &Volume| {
        volume.size == first.size
            && volume.world_from_unit == first.world_from_unit
            && volume.values.len() == voxels
    };
    if !volumes.iter().all(alike) {
        return wrong("the volumes of a file must have the same size and place, and a value a voxel");
    }
    let name = path.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
    if name.ends_with(".nii") || name.ends_with(".nii.gz") {
        return write_nifti(path, volumes);
    }
    if !name.ends_with(".npy") {
        return wrong("a volume is written as .nii, .nii.gz or .npy; let the name end so");
    }
    let [x, y, z] = first.size.map(|side| side as usize);
    let mut shape = vec![z, y, x];
    let values = if let [only] = volumes {
        only.values.clone()
    } else {
        shape.push(volumes.len());
        (0..voxels).flat_map(|voxel| volumes.iter().map(move |volume| volume.values[voxel])).collect()
    };
    write_npy(path, &Array { shape, data: ArrayData::F32(values) })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::data::{load_channels, load_volume};
    use crate::formats::read_npy;
    use glam::Mat4;

    #[test]
    fn arrays_come_back_with_channels_last() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npy");
        // Cubes of 0.5 m about the origin, which is what the loader takes arrays for.
        let place = Mat4::from_translation(glam::Vec3::new(-0.5, -0.75, -0.25))
            * Mat4::from_scale(glam::Vec3::new(1.0, 1.5, 0.5));
        let volume = |first: f32| {
            Volume::new([2, 3, 1], (0..6).map(|i| first + i as f32 / 3.0).collect(), place).unwrap()
        };
        let one = [volume(0.1)];
        write_volumes(&path, &one).unwrap();
        assert_eq!(load_volume(&path, 0.5).unwrap(), one[0]);
        let three = [volume(0.1), volume(100.0), volume(-7.0)];
        write_volumes(&path, &three).unwrap();
        assert_eq!(load_channels(&path, 0.5).unwrap(), three);
        let array = read_npy(&path).unwrap();
        assert_eq!((array.shape.as_slice(), array.to_f32()[4]), (&[1, 3, 2, 3][..], three[1].values[1]));
        assert!(load_volume(&path, 0.5).unwrap_err().to_string().contains("[1, 3, 2, 3]"));
    }

    #[test]
    fn what_does_not_fit_is_refused_and_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let volume = Volume::new([2, 1, 1], vec![0.0; 2], Mat4::IDENTITY).unwrap();
        let moved = Volume { world_from_unit: Mat4::from_translation(glam::Vec3::X), ..volume.clone() };
        let short = Volume { values: vec![1.0], ..volume.clone() };
        for (name, wrong, said) in [
            ("a.npy", vec![], "no volume"),
            ("a.nii", vec![volume.clone(), moved], "same size and place"),
            ("a.nii.gz", vec![short], "a value a voxel"),
            ("a.vdb", vec![volume], ".nii.gz or .npy"),
        ] {
            let error = write_volumes(folder.path().join(name), &wrong).unwrap_err().to_string();
            assert!(error.contains(said) && error.contains(name), "{error}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
