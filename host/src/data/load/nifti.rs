// SPDX-License-Identifier: MIT OR Apache-2.0
//! NIfTI-1 volumes in one file, plain or compressed.

use super::medium::MediumFileError;
use crate::data::Volume;
use flate2::bufread::MultiGzDecoder;
use glam::{DMat4, DQuat, DVec3, DVec4, Mat4};
use nifti::{DataElement, InMemNiftiVolume, NiftiHeader, NiftiType};
use std::io::{BufRead, Read};
use std::path::Path;

/// Bytes of the header.
const HEADER: u64 = 348;
/// The header of the second version begins with this length.
const SECOND_HEADER: i32 = 540;
/// Most voxels that are read.
const MAX_VOXELS: u64 = 1 << 30;

/// Types of voxels that are read.
const READ: [NiftiType; 10] = [
    NiftiType::Uint8,
    NiftiType::Int8,
    NiftiType::Uint16,
    NiftiType::Int16,
    NiftiType::Uint32,
    NiftiType::Int32,
    NiftiType::Uint64,
    NiftiType::Int64,
    NiftiType::Float32,
    NiftiType::Float64,
];

/// From right, front, up in millimetres, as the format has it, to left, up, front in metres: a patient faces +z.
fn world_from_patient(millimetres: f64) -> DMat4 {
    let (x, y, z) = (DVec4::NEG_X, DVec4::Z, DVec4::Y);
    DMat4::from_cols(x, y, z, DVec4::W) * DMat4::from_scale(DVec3::splat(1e-3 * millimetres))
}

/// Reads volumes, as many as `allowed` has; their values as they are, times the slope of the file.
pub(super) fn load(
    path: &Path,
    mut bytes: impl BufRead,
    allowed: &[u64],
) -> Result<Vec<Volume>, MediumFileError> {
    let begin = bytes.fill_buf().map_err(|error| MediumFileError::io(path, error))?;
    if begin.starts_with(&[0x1f, 0x8b]) {
        return read(path, MultiGzDecoder::new(bytes), allowed);
    }
    read(path, bytes, allowed)
}

fn read(path: &Path, mut bytes: impl Read, allowed: &[u64]) -> Result<Vec<Volume>, MediumFileError> {
    let broken = |reason: &str| MediumFileError::broken(path, reason);
    let mut begin = Vec::new();
    let read = bytes.by_ref().take(HEADER).read_to_end(&mut begin);
    read.map_err(|error| broken(&format!("it cannot be read: {error}")))?;
    if begin.len() as u64 != HEADER {
        return Err(broken(&format!("its header has {} bytes of {HEADER}", begin.len())));
    }
    let length = [begin[0], begin[1], begin[2], begin[3]];
    if [i32::from_le_bytes(length), i32::from_be_bytes(length)].contains(&SECOND_HEADER) {
        let reason = "NIfTI-2 is not read; convert it to NIfTI-1";
        return Err(MediumFileError::unsupported(path, reason));
    }
    let mut header = NiftiHeader::from_reader(begin.as_slice())
        .map_err(|error| MediumFileError::broken(path, error.to_string().to_lowercase()))?;
    if !header.magic.starts_with(b"n+1") {
        let reason = "its voxels lie in another file (.hdr and .img); convert the pair to one .nii file";
        return Err(MediumFileError::unsupported(path, reason));
    }
    let kind = header.data_type().map_err(|error| MediumFileError::broken(path, error))?;
    let size = size(path, &header, allowed)?;
    if !READ.contains(&kind) {
        let reason = format!("voxels of type {kind:?} are not read; convert them to float32 or int16");
        return Err(MediumFileError::unsupported(path, reason));
    }
    // What the type takes, whatever the header says besides.
    header.bitpix = i16::try_from(8 * kind.size_of()).unwrap_or(0);
    let skipped = header.vox_offset;
    if !(skipped.is_finite() && (HEADER as f32..1e8).contains(&skipped)) {
        return Err(broken(&format!("its voxels are said to begin at byte {skipped}")));
    }
    std::io::copy(&mut bytes.by_ref().take(skipped as u64 - HEADER), &mut std::io::sink())
        .map_err(|error| broken(&format!("it cannot be read: {error}")))?;
    let voxels = InMemNiftiVolume::from_reader(bytes, &header)
        .map_err(|error| broken(&format!("its voxels cannot be read: {error}")))?;
    let mut values = values(path, voxels, kind)?;
    let (slope, offset) = (header.scl_slope, header.scl_inter);
    if slope != 0.0 && slope.is_finite() && offset.is_finite() && (slope, offset) != (1.0, 0.0) {
        values.iter_mut().for_each(|value| *value = *value * slope + offset);
    }
    let voxels = size.iter().map(|side| *side as usize).product();
    let world_from_unit = world_from_unit(&header, size).as_mat4();
    if values.len() == voxels {
        return Ok(vec![volume(path, size, values, world_from_unit)?]);
    }
    values.chunks(voxels).map(|values| volume(path, size, values.to_vec(), world_from_unit)).collect()
}

fn volume(
    path: &Path,
    size: [u32; 3],
    values: Vec<f32>,
    world_from_unit: Mat4,
) -> Result<Volume, MediumFileError> {
    Volume::new(size, values, world_from_unit).map_err(|error| MediumFileError::broken(path, error))
}

fn size(path: &Path, header: &NiftiHeader, allowed: &[u64]) -> Result<[u32; 3], MediumFileError> {
    let sides = header.dim().map_err(|error| MediumFileError::broken(path, error))?;
    let size = [0, 1, 2].map(|axis| sides.get(axis).map_or(1, |side| u32::from(*side)));
    let several: u64 = sides.iter().skip(3).map(|side| u64::from(*side)).product();
    if !allowed.contains(&several) {
        let reason = format!("it holds {several} volumes; extract the one that is meant");
        return Err(MediumFileError::unsupported(path, reason));
    }
    let voxels = size.iter().fold(several, |product, side| product.saturating_mul(u64::from(*side)));
    if voxels > MAX_VOXELS {
        let reason = format!("{size:?} are more than {MAX_VOXELS} voxels; crop or resample the volume");
        return Err(MediumFileError::unsupported(path, reason));
    }
    Ok(size)
}

fn values(path: &Path, voxels: InMemNiftiVolume, kind: NiftiType) -> Result<Vec<f32>, MediumFileError> {
    fn typed<T: DataElement>(voxels: InMemNiftiVolume, value: fn(T) -> f32) -> nifti::Result<Vec<f32>> {
        Ok(voxels.into_nifti_typed_data::<T>()?.into_iter().map(value).collect())
    }
    let values = match kind {
        NiftiType::Uint8 => typed(voxels, |value: u8| value.into()),
        NiftiType::Int8 => typed(voxels, |value: i8| value.into()),
        NiftiType::Uint16 => typed(voxels, |value: u16| value.into()),
        NiftiType::Int16 => typed(voxels, |value: i16| value.into()),
        NiftiType::Uint32 => typed(voxels, |value: u32| value as f32),
        NiftiType::Int32 => typed(voxels, |value: i32| value as f32),
        NiftiType::Uint64 => typed(voxels, |value: u64| value as f32),
        NiftiType::Int64 => typed(voxels, |value: i64| value as f32),
        NiftiType::Float32 => typed(voxels, |value: f32| value),
        NiftiType::Float64 => typed(voxels, |value: f64| value as f32),
        _ => Err(nifti::NiftiError::UnsupportedDataType(kind)),
    };
    values.map_err(|error| MediumFileError::broken(path, error))
}

/// Where the box lies: by the matrix of the file, else by its quaternion, else by the sizes of voxels alone.
fn world_from_unit(header: &NiftiHeader, size: [u32; 3]) -> DMat4 {
    let row = |row: [f32; 4]| DVec4::from(row.map(f64::from));
    let spacing = DVec3::from([1, 2, 3].map(|axis| f64::from(header.pixdim[axis].abs())));
    let patient_from_voxel = if header.sform_code > 0 {
        let rows = [row(header.srow_x), row(header.srow_y), row(header.srow_z), DVec4::W];
        DMat4::from_cols_array_2d(&rows.map(|row| row.to_array())).transpose()
    } else if header.qform_code > 0 {
        let [b, c, d] = [header.quatern_b, header.quatern_c, header.quatern_d].map(f64::from);
        let a = (1.0 - b * b - c * c - d * d).max(0.0).sqrt();
        let shift = [header.quatern_x, header.quatern_y, header.quatern_z].map(f64::from);
        // The third axis is mirrored by the first number of `pixdim`.
        let mirror = if header.pixdim[0] < 0.0 { -1.0 } else { 1.0 };
        DMat4::from_scale_rotation_translation(
            spacing * DVec3::new(1.0, 1.0, mirror),
            DQuat::from_xyzw(b, c, d, a).normalize(),
            DVec3::from(shift),
        )
    } else {
        DMat4::from_scale(spacing)
    };
    // Metres, millimetres, micrometres; without a word millimetres.
    let unit = match header.xyzt_units & 7 {
        1 => 1e3,
        3 => 1e-3,
        _ => 1.0,
    };
    let sides = DVec3::from(size.map(f64::from));
    let voxel_from_unit = DMat4::from_translation(DVec3::splat(-0.5)) * DMat4::from_scale(sides);
    world_from_patient(unit) * patient_from_voxel * voxel_from_unit
}
