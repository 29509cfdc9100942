// SPDX-License-Identifier: MIT OR Apache-2.0
//! Volumes of both formats, sound and broken.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::data::Random;
use crate::formats::{Array, ArrayData, write_npy};
use std::io::Write;

const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets");

fn load(name: &str, bytes: &[u8]) -> Result<Volume, MediumFileError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    load_volume(&path, 0.5)
}

/// A header of a volume of 2 x 3 x 4 voxels of 16 bits, with what changes it, and the voxels 0..24.
fn nifti(big: bool, changes: &[(usize, &[u8])]) -> Vec<u8> {
    let mut file = vec![0; 352];
    let mut put = |at: usize, bytes: &[u8]| {
        let mut bytes = bytes.to_vec();
        if big {
            bytes.reverse();
        }
        file[at..at + bytes.len()].copy_from_slice(&bytes);
    };
    put(0, &348_i32.to_le_bytes());
    for (i, side) in [3_i16, 2, 3, 4, 1, 1, 1, 1].into_iter().enumerate() {
        put(40 + 2 * i, &side.to_le_bytes());
    }
    put(70, &4_i16.to_le_bytes());
    put(72, &16_i16.to_le_bytes());
    for (i, spacing) in [1.0_f32, 10.0, 20.0, 30.0].into_iter().enumerate() {
        put(76 + 4 * i, &spacing.to_le_bytes());
    }
    put(108, &352_f32.to_le_bytes());
    for (at, bytes) in changes {
        put(*at, bytes);
    }
    file[344..348].copy_from_slice(b"n+1\0");
    for value in 0..24_i16 {
        file.extend(if big { value.to_be_bytes() } else { value.to_le_bytes() });
    }
    file
}

fn places(volume: &Volume) -> [Vec3; 2] {
    [Vec3::ZERO, Vec3::ONE].map(|unit| volume.world_from_unit.transform_point3(unit))
}

#[test]
fn values_and_places_of_nifti_volumes() {
    let counted: Vec<f32> = (0..24_u8).map(f32::from).collect();
    for big in [false, true] {
        let plain = load("a.nii", &nifti(big, &[])).unwrap();
        assert_eq!((plain.size, &plain.values), ([2, 3, 4], &counted));
        // Right, front, up in millimetres becomes left, up, front in metres.
        let [min, max] = places(&plain);
        assert!(min.distance(Vec3::new(0.005, -0.015, -0.01)) < 1e-6, "{min}");
        assert!(max.distance(Vec3::new(-0.015, 0.105, 0.05)) < 1e-6, "{max}");
        assert!(plain.world_from_unit.determinant() > 0.0);
    }
    let scaled = load("a.NII", &nifti(true, &[(112, &2_f32.to_le_bytes()), (116, &1_f32.to_le_bytes())]));
    assert_eq!(scaled.unwrap().values[23], 47.0);
    // Metres.
    let metres = load("a.nii", &nifti(false, &[(123, &[1])])).unwrap();
    assert!((metres.voxel() - 10.0).abs() < 1e-4);
    // A quarter turn about the upward axis, by the quaternion: along x becomes along the front.
    let half = 0.5_f32.sqrt().to_le_bytes();
    let turned = nifti(false, &[(252, &1_i16.to_le_bytes()), (264, &half), (268, &1000_f32.to_le_bytes())]);
    let turned = load("a.nii", &turned).unwrap().world_from_unit;
    assert!(turned.x_axis.truncate().distance(Vec3::new(0.0, 0.0, 0.02)) < 1e-6, "{turned}");
    assert!((turned.w_axis.x + 1.01).abs() < 1e-6, "{turned}");
    // The matrix goes before the quaternion.
    let mut rows = vec![(254, 2_i16.to_le_bytes().to_vec()), (252, 1_i16.to_le_bytes().to_vec())];
    for (at, value) in [(280, -5_f32), (300, 6.0), (320, 7.0), (324, 9.0)] {
        rows.push((at, value.to_le_bytes().to_vec()));
    }
    let rows: Vec<(usize, &[u8])> = rows.iter().map(|(at, bytes)| (*at, bytes.as_slice())).collect();
    let mirrored = load("a.nii", &nifti(false, &rows)).unwrap().world_from_unit;
    assert!(mirrored.x_axis.truncate().distance(Vec3::new(0.01, 0.0, 0.0)) < 1e-6, "{mirrored}");
    assert!(mirrored.y_axis.truncate().distance(Vec3::new(0.0, 0.0, 0.018)) < 1e-6, "{mirrored}");
    assert!((mirrored.w_axis.y - 0.0055).abs() < 1e-6, "{mirrored}");
}

#[test]
fn what_is_shipped_is_read() {
    let head = load_volume(format!("{ASSETS}/head_mri.nii.gz"), 1.0).unwrap();
    assert_eq!(head.size, [161, 191, 151]);
    assert_eq!(
        volume_from_bytes("head", &std::fs::read(format!("{ASSETS}/head_mri.nii.gz")).unwrap()).unwrap(),
        head
    );
    let broken = volume_from_bytes("head.nii", &[7; 400]).unwrap_err().to_string();
    assert!(broken.contains("head.nii"), "{broken}");
    assert!(head.values.iter().all(|value| (0.0..=255.0).contains(value)));
    assert!(head.values.iter().filter(|value| **value > 50.0).count() > 500_000);
    let stent = load_volume(format!("{ASSETS}/stent_ct.nii.gz"), 1.0).unwrap();
    assert_eq!(stent.size, [256, 128, 128]);
    assert_eq!(stent.values.iter().copied().fold(0.0, f32::max), 32.0);
    for volume in [head, stent] {
        let extent = volume.bounds().max - volume.bounds().min;
        assert!(extent.min_element() > 0.1 && extent.max_element() < 0.5, "{extent}");
    }
}

#[test]
fn arrays_are_cubes_about_the_origin() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("v.npy");
    let write = |shape: &[usize]| {
        let values = (0..shape.iter().product::<usize>() as u32).collect();
        write_npy(&path, &Array { shape: shape.to_vec(), data: ArrayData::U32(values) }).unwrap();
        load_volume(&path, 0.5)
    };
    let volume = write(&[2, 3, 4]).unwrap();
    assert_eq!((volume.size, volume.values[5]), ([4, 3, 2], 5.0));
    assert_eq!(places(&volume), [Vec3::new(-1.0, -0.75, -0.5), Vec3::new(1.0, 0.75, 0.5)]);
    for shape in [&[6][..], &[2, 3], &[2, 3, 4, 5], &[2, 0, 4], &[]] {
        let error = write(shape).unwrap_err().to_string();
        assert!(error.contains("v.npy") && error.contains("[z, y, x]"), "{error}");
    }
    write(&[1, 1, 1]).unwrap();
    for voxel in [0.0, f32::NAN] {
        let error = load_volume(&path, voxel).unwrap_err().to_string();
        assert!(error.contains("flat"), "{error}");
    }
}

#[test]
fn errors_name_the_file_and_the_fault() {
    assert!(load_volume("none.nii", 1.0).unwrap_err().to_string().contains("no such file"));
    assert!(load_volume("none.npy", 1.0).unwrap_err().to_string().contains("no such"));
    let (size, kind) = (40, 70);
    let short = |value: i16| value.to_le_bytes().to_vec();
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("a.dcm", vec![], ".nii.gz or .npy"),
        ("a.nii", vec![], "0 bytes of 348"),
        ("a.nii", vec![7; 400], "no valid NIfTI"),
        ("a.nii.gz", vec![0x1f, 0x8b, 8, 0, 1, 2], "no valid NIfTI"),
        ("a.nii", nifti(false, &[])[..399].to_vec(), "voxels cannot be read"),
        ("a.nii", nifti(false, &[(0, &540_i32.to_le_bytes())]), "NIfTI-2"),
        ("a.nii", nifti(false, &[(size, &short(9))]), "no valid NIfTI"),
        ("a.nii", nifti(false, &[(size + 2, &short(0))]), "no valid NIfTI"),
        ("a.nii", nifti(false, &[(size, &short(4)), (size + 8, &short(3))]), "3 volumes"),
        ("a.nii", nifti(false, &[(size + 2, &short(32000)), (size + 4, &short(32000))]), "resample"),
        ("a.nii", nifti(false, &[(kind, &short(3))]), "no valid NIfTI"),
        ("a.nii", nifti(false, &[(kind, &short(128))]), "Rgb24"),
        ("a.nii", nifti(false, &[(108, &f32::NAN.to_le_bytes())]), "begin at byte NaN"),
        ("a.nii", nifti(false, &[(108, &(-1_f32).to_le_bytes())]), "begin at byte -1"),
        ("a.nii", nifti(false, &[(80, &0_f32.to_le_bytes())]), "flat"),
        ("a.npy", vec![1, 2, 3], "numpy.save"),
    ];
    for (name, bytes, part) in cases {
        let error = load(name, &bytes).unwrap_err().to_string();
        assert!(error.contains(part) && error.contains(name), "{error:?} lacks {part:?}");
        assert_eq!(error.lines().count(), 1, "{error}");
    }
    // The mark of a pair of files.
    let mut pair = nifti(false, &[]);
    pair[344..348].copy_from_slice(b"ni1\0");
    assert!(load("a.nii", &pair).unwrap_err().to_string().contains("one .nii file"));
}

#[test]
fn garbage_never_panics() {
    let mut random = Random::new(3);
    let good = nifti(false, &[]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nii.gz");
    let mut read = 0;
    for round in 0..600 {
        let mut bytes = good.clone();
        for _ in 0..random.below(6) {
            let place = random.below(bytes.len());
            bytes[place] = random.next_u32() as u8;
        }
        if round % 3 == 0 {
            bytes.truncate(random.below(bytes.len() + 1));
        }
        if round % 2 == 0 {
            let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
            packed.write_all(&bytes).unwrap();
            bytes = packed.finish().unwrap();
            let place = random.below(bytes.len());
            bytes[place] ^= if round % 4 == 0 { random.next_u32() as u8 } else { 0 };
        }
        std::fs::write(&path, &bytes).unwrap();
        read += u32::from(load_volume(&path, 1.0).is_ok());
    }
    assert!(read > 100, "only {read} could be read");
}
