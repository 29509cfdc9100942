// SPDX-License-Identifier: MIT OR Apache-2.0
//! Arrays in NumPy's format, written and read without the host's code.
#![allow(dead_code, clippy::unwrap_used)]

use std::path::Path;

/// The bytes of a file. `descr`: NumPy's name of the type, such as `<f4`.
pub fn encoded(descr: &str, shape: &[usize], data: &[u8]) -> Vec<u8> {
    let sides: String = shape.iter().map(|side| format!("{side},")).collect();
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({sides}), }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

/// Writes 32-bit floats.
pub fn write_f32(path: &Path, shape: &[usize], values: &[f32]) {
    assert_eq!(shape.iter().product::<usize>(), values.len());
    let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    std::fs::write(path, encoded("<f4", shape, &data)).unwrap();
}

/// Writes 64-bit floats.
pub fn write_f64(path: &Path, shape: &[usize], values: &[f64]) {
    assert_eq!(shape.iter().product::<usize>(), values.len());
    let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    std::fs::write(path, encoded("<f8", shape, &data)).unwrap();
}

/// Writes 32-bit unsigned integers.
pub fn write_u32(path: &Path, shape: &[usize], values: &[u32]) {
    assert_eq!(shape.iter().product::<usize>(), values.len());
    let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    std::fs::write(path, encoded("<u4", shape, &data)).unwrap();
}

/// Writes bytes.
pub fn write_u8(path: &Path, shape: &[usize], values: &[u8]) {
    assert_eq!(shape.iter().product::<usize>(), values.len());
    std::fs::write(path, encoded("|u1", shape, values)).unwrap();
}

/// An array that was read.
#[derive(Debug)]
pub struct Array {
    pub descr: String,
    pub shape: Vec<usize>,
    pub data: Vec<u8>,
}

/// Reads an array in C order.
#[track_caller]
pub fn read(path: &Path) -> Array {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert_eq!(bytes[..6], *b"\x93NUMPY", "{}", path.display());
    let (start, length) = match bytes[6] {
        1 => (10, usize::from(u16::from_le_bytes([bytes[8], bytes[9]]))),
        _ => (12, u32::from_le_bytes(bytes[8..12].try_into().unwrap()) as usize),
    };
    let header = std::str::from_utf8(&bytes[start..start + length]).unwrap();
    assert!(header.contains("'fortran_order': False"), "{header}");
    let between = |from: &str, to: char| {
        let rest = &header[header.find(from).unwrap() + from.len()..];
        rest[..rest.find(to).unwrap()].to_owned()
    };
    let sides = between("'shape': (", ')');
    let sides = sides.split(',').map(str::trim).filter(|side| !side.is_empty());
    let array = Array {
        descr: between("'descr': '", '\''),
        shape: sides.map(|side| side.parse().unwrap()).collect(),
        data: bytes[start + length..].to_vec(),
    };
    let size: usize = array.descr[2..].parse().unwrap();
    assert_eq!(array.data.len(), size * array.shape.iter().product::<usize>(), "{}", path.display());
    array
}

fn words<T>(array: &Array, descr: &str, from: fn([u8; 4]) -> T) -> Vec<T> {
    assert_eq!(array.descr, descr);
    array.data.chunks_exact(4).map(|word| from(word.try_into().unwrap())).collect()
}

/// Shape and values of an array of 32-bit floats.
#[track_caller]
pub fn read_f32(path: &Path) -> (Vec<usize>, Vec<f32>) {
    let array = read(path);
    let values = words(&array, "<f4", f32::from_le_bytes);
    (array.shape, values)
}

/// Shape and values of an array of 32-bit unsigned integers.
#[track_caller]
pub fn read_u32(path: &Path) -> (Vec<usize>, Vec<u32>) {
    let array = read(path);
    let values = words(&array, "<u4", u32::from_le_bytes);
    (array.shape, values)
}

/// Shape and values of an array of 32-bit signed integers.
#[track_caller]
pub fn read_i32(path: &Path) -> (Vec<usize>, Vec<i32>) {
    let array = read(path);
    let values = words(&array, "<i4", i32::from_le_bytes);
    (array.shape, values)
}

/// Shape and values of an array of bytes.
#[track_caller]
pub fn read_u8(path: &Path) -> (Vec<usize>, Vec<u8>) {
    let array = read(path);
    assert_eq!(array.descr, "|u1");
    (array.shape, array.data)
}
