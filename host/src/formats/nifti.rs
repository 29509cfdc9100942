// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes as NIfTI-1 files.

use super::whole::{WriteError, write_whole};
use crate::data::Volume;
use flate2::Compression;
use flate2::write::GzEncoder;
use glam::{DMat4, DVec3, DVec4};
use std::io::{self, Write};
use std::path::Path;

/// Where voxels begin: after the header and four bytes that say that nothing else follows it.
const BEGIN: usize = 352;
/// Number of float32 as the type of voxels.
const FLOAT32: i16 = 16;
/// Lengths in millimetres, which readers take where they do not look.
const MILLIMETRES: u8 = 2;

/// Writes volumes of the same size and place as one NIfTI-1 file of 32-bit floats, whole or not at all, compressed where the name ends in
/// `.gz`: values bit by bit as they are, and the place as a matrix (`sform`), rounded to f32. One volume makes a file of three axes; more,
/// such as the red, green and blue of a colour, one of four, volume after volume, which viewers step through or show as colour.
///
/// # Errors
/// [`WriteError`]; [`WriteError::Data`] where a side is too long for the format. There must be a volume, and all must be alike.
pub(super) fn write_nifti(path: &Path, volumes: &[Volume]) -> Result<(), WriteError> {
    let wrong = |reason: &str| WriteError::Data { path: path.to_owned(), reason: reason.to_owned() };
    let first = volumes.first().ok_or_else(|| wrong("there is no volume to write"))?;
    let [x, y, z] = first.size.map(i16::try_from);
    let (Ok(x), Ok(y), Ok(z), Ok(count)) = (x, y, z, i16::try_from(volumes.len())) else {
        return Err(wrong(&format!(
            "{:?} voxels are too many for NIfTI-1, whose sides hold {} at most; write .npy instead",
            first.size,
            i16::MAX
        )));
    };
    let axes = if count > 1 { 4 } else { 3 };
    let header = header([axes, x, y, z, count, 1, 1, 1], patient_from_voxel(first));
    let write = |writer: &mut dyn Write| -> io::Result<()> {
        writer.write_all(&header)?;
        for values in volumes.iter().flat_map(|volume| volume.values.chunks(1 << 14)) {
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            writer.write_all(&bytes)?;
        }
        Ok(())
    };
    let compressed = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    write_whole(path, |writer| {
        if !compressed {
            return write(writer);
        }
        let mut encoder = GzEncoder::new(writer, Compression::default());
        write(&mut encoder)?;
        encoder.finish().map(|_| ())
    })
}

/// From the numbers of voxels to right, front, up in millimetres; the world is left, up, front in metres, as the loader has it.
fn patient_from_voxel(volume: &Volume) -> DMat4 {
    let patient_from_world =
        DMat4::from_cols(DVec4::NEG_X, DVec4::Z, DVec4::Y, DVec4::W) * DMat4::from_scale(DVec3::splat(1e3));
    let sides = DVec3::from(volume.size.map(f64::from));
    let unit_from_voxel = DMat4::from_scale(1.0 / sides) * DMat4::from_translation(DVec3::splat(0.5));
    patient_from_world * volume.world_from_unit.as_dmat4() * unit_from_voxel
}

fn header(sides: [i16; 8], patient_from_voxel: DMat4) -> [u8; BEGIN] {
    let mut header = [0; BEGIN];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &348_i32.to_le_bytes());
    // What Analyze 7.5 wants, and some readers still do.
    put(38, b"r");
    for (axis, side) in sides.into_iter().enumerate() {
        put(40 + 2 * axis, &side.to_le_bytes());
    }
    put(70, &FLOAT32.to_le_bytes());
    put(72, &32_i16.to_le_bytes());
    let spacing = |axis: usize| patient_from_voxel.col(axis).truncate().length() as f32;
    for (axis, size) in [1.0, spacing(0), spacing(1), spacing(2), 1.0].into_iter().enumerate() {
        put(76 + 4 * axis, &size.to_le_bytes());
    }
    put(108, &(BEGIN as f32).to_le_bytes());
    put(112, &1_f32.to_le_bytes());
    put(123, &[MILLIMETRES]);
    // The matrix leads to a place of the scanner's kind, whatever was scanned.
    put(254, &1_i16.to_le_bytes());
    for row in 0..3 {
        for (column, value) in patient_from_voxel.row(row).to_array().into_iter().enumerate() {
            put(280 + 16 * row + 4 * column, &(value as f32).to_le_bytes());
        }
    }
    put(344, b"n+1\0");
    header
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::data::{Random, load_channels, load_volume};
    use crate::formats::write_volumes;
    use glam::{Mat4, Vec3};

    fn volumes(count: u64) -> Vec<Volume> {
        let turned = Mat4::from_rotation_x(0.3) * Mat4::from_rotation_y(-1.1);
        // Sheared and mirrored besides.
        let sheared = Mat4::from_cols_array(&[
            0.5, 0.1, 0.0, 0.0, 0.0, -2.0, 0.3, 0.0, 0.0, 0.0, 3.0, 0.0, 1.0, -2.0, 7.0, 1.0,
        ]);
        (0..count)
            .map(|seed| {
                let mut random = Random::new(seed);
                let mut values: Vec<f32> = (0..5 * 7 * 3).map(|_| random.range(-1.0, 9.0)).collect();
                values[..4].copy_from_slice(&[-0.0, 1e-42, f32::INFINITY, f32::MAX]);
                Volume::new([5, 7, 3], values, turned * sheared).unwrap()
            })
            .collect()
    }

    fn same(read: &Volume, written: &Volume) {
        let bits = |volume: &Volume| volume.values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!((read.size, bits(read)), (written.size, bits(written)));
        for corner in [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE] {
            let [read, written] =
                [read, written].map(|volume| volume.world_from_unit.transform_point3(corner));
            assert!(read.distance(written) < 5e-6, "{corner}: {read} {written}");
        }
    }

    #[test]
    fn volumes_come_back_bit_by_bit_where_they_were() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.nii", "a.nii.gz"] {
            let path = folder.path().join(name);
            let one = volumes(1);
            write_volumes(&path, &one).unwrap();
            same(&load_volume(&path, 1.0).unwrap(), &one[0]);
            let three = volumes(3);
            write_volumes(&path, &three).unwrap();
            let read = load_channels(&path, 1.0).unwrap();
            assert_eq!(read.len(), 3);
            for (read, written) in read.iter().zip(&three) {
                same(read, written);
            }
            // A reader that wants one volume says so.
            assert!(load_volume(&path, 1.0).unwrap_err().to_string().contains("3 volumes"));
        }
        let [plain, compressed] =
            ["a.nii", "a.nii.gz"].map(|name| std::fs::read(folder.path().join(name)).unwrap());
        assert_eq!(plain.len(), BEGIN + 4 * 3 * 105);
        assert_eq!(compressed[..2], [0x1f, 0x8b]);
    }

    /// By another hand: the crate's own reader of headers.
    #[test]
    fn the_header_says_size_type_and_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.nii.gz");
        let placed =
            Mat4::from_translation(Vec3::new(-1.0, 0.0, -2.0)) * Mat4::from_scale(Vec3::new(2.0, 5.0, 4.0));
        let volume = Volume::new([4, 10, 2], vec![0.25; 80], placed).unwrap();
        write_volumes(&path, &[volume]).unwrap();
        let header = nifti::NiftiHeader::from_file(&path).unwrap();
        assert_eq!(header.dim().unwrap(), [4, 10, 2]);
        assert_eq!(header.data_type().unwrap(), nifti::NiftiType::Float32);
        assert_eq!(header.pixdim[1..4], [500.0, 500.0, 2000.0]);
        // The first voxel lies at (-0.75, 0.25, -1) m: 750 mm right, 1000 mm behind, 250 mm up.
        assert_eq!(header.srow_x, [-500.0, 0.0, 0.0, 750.0]);
        assert_eq!(header.srow_y, [0.0, 0.0, 2000.0, -1000.0]);
        assert_eq!(header.srow_z, [0.0, 500.0, 0.0, 250.0]);
        assert_eq!((header.scl_slope, header.scl_inter, header.vox_offset), (1.0, 0.0, 352.0));
    }

    #[test]
    fn what_does_not_fit_is_refused_and_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.nii.gz");
        let long = Volume::new([40_000, 1, 1], vec![0.0; 40_000], Mat4::IDENTITY).unwrap();
        let error = write_volumes(&path, &[long]).unwrap_err().to_string();
        assert!(error.contains("[40000, 1, 1] voxels are too many") && error.contains("a.nii.gz"), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
