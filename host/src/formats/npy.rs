// SPDX-License-Identifier: MIT OR Apache-2.0
//! Arrays in NumPy's .npy format.

use std::io::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use npyz::{NpyHeader, Order, TypeChar, WriterBuilder};

use super::array::{Array, ArrayData, for_each_type};
use super::whole::{WriteError, write_whole};

/// Why an array file could not be read. Each message names the file.
#[derive(Debug, thiserror::Error)]
pub enum ArrayError {
    /// There is no such file.
    #[error("{path}: there is no such array file; check the path")]
    Missing {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be read.
    #[error("{path}: the array file cannot be read: {source}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// The file does not begin like an array file.
    #[error("{path}: the file is no .npy array: {reason}; write it with numpy.save")]
    NotAnArray {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Numbers of a type that is not read.
    #[error(
        "{path}: arrays of type {found} are not read; convert it to float32, float16, float64, uint8, uint16, uint32 or int32"
    )]
    UnsupportedType {
        /// The file.
        path: PathBuf,
        /// NumPy's description of the type.
        found: String,
    },
    /// Fewer bytes than the shape asks for.
    #[error(
        "{path}: the array is cut off: its shape {shape:?} needs {needed} bytes but only {found} follow; save it again with numpy.save"
    )]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Length of each axis.
        shape: Vec<usize>,
        /// Bytes that the shape asks for.
        needed: usize,
        /// Bytes that are there.
        found: usize,
    },
    /// More elements than can be counted.
    #[error("{path}: the shape {shape:?} of the array is too large")]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Length of each axis.
        shape: Vec<u64>,
    },
}

/// Longest header and deepest nesting of brackets that are parsed: `npyz` parses recursively.
const MAX_HEADER: usize = 1 << 16;
const MAX_NESTING: usize = 16;

/// Reads an array, in C or Fortran order and of either byte order, into C order.
///
/// # Errors
/// [`ArrayError`].
pub fn read_npy(path: impl AsRef<Path>) -> Result<Array, ArrayError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| match source.kind() {
        io::ErrorKind::NotFound => ArrayError::Missing { path: path.to_owned() },
        _ => ArrayError::Unreadable { path: path.to_owned(), source },
    })?;
    let wrong = |reason: &str| ArrayError::NotAnArray { path: path.to_owned(), reason: reason.to_owned() };
    let text = check_header(&bytes).map_err(wrong)?;
    // `npyz` multiplies the lengths unchecked, so an overflow has to be found before.
    if let Some(shape) = shape_in_text(text)
        && !can_be_counted(&shape)
    {
        return Err(ArrayError::TooLarge { path: path.to_owned(), shape });
    }
    let mut rest = bytes.as_slice();
    let header = catch_unwind(AssertUnwindSafe(|| NpyHeader::from_reader(&mut rest)))
        .map_err(|_| wrong("its header cannot be parsed"))?
        .map_err(|error| wrong(&error.to_string()))?;
    let unsupported = || ArrayError::UnsupportedType { path: path.to_owned(), found: header.dtype().descr() };
    let npyz::DType::Plain(kind) = header.dtype() else {
        return Err(unsupported());
    };

    let too_large = || ArrayError::TooLarge { path: path.to_owned(), shape: header.shape().to_vec() };
    let shape: Option<Vec<usize>> = header.shape().iter().map(|n| usize::try_from(*n).ok()).collect();
    let shape = shape.ok_or_else(too_large)?;
    if !can_be_counted(header.shape()) {
        return Err(too_large());
    }
    let count: usize = shape.iter().product();
    let needed = kind.num_bytes().unwrap_or(1).checked_mul(count).ok_or_else(too_large)?;
    if rest.len() < needed {
        return Err(ArrayError::Truncated { path: path.to_owned(), shape, needed, found: rest.len() });
    }

    let order = header.order();
    let (letter, width) = (kind.type_char(), kind.size_field());
    macro_rules! read {
        ($variant:ident) => {{
            let file = npyz::NpyFile::with_header(header.clone(), rest);
            let values = file.into_vec().map_err(|error| wrong(&error.to_string()))?;
            ArrayData::$variant(in_c_order(values, &shape, order))
        }};
    }
    let data = match (letter, width) {
        (TypeChar::Float, 4) => read!(F32),
        (TypeChar::Float, 2) => read!(F16),
        (TypeChar::Float, 8) => read!(F64),
        (TypeChar::Uint, 1) => read!(U8),
        (TypeChar::Uint, 2) => read!(U16),
        (TypeChar::Uint, 4) => read!(U32),
        (TypeChar::Int, 4) => read!(I32),
        _ => return Err(unsupported()),
    };
    Ok(Array { shape, data })
}

/// Whether the product of the lengths, in bytes of the widest type, fits. Axes of length zero do not excuse
/// others that overflow.
fn can_be_counted(shape: &[u64]) -> bool {
    let bytes = shape.iter().try_fold(8u64, |product, n| product.checked_mul((*n).max(1)));
    bytes.is_some_and(|bytes| isize::try_from(bytes).is_ok())
}

/// The numbers in the brackets after the word `shape`.
fn shape_in_text(header: &[u8]) -> Option<Vec<u64>> {
    let (_, after) = std::str::from_utf8(header).ok()?.split_once("shape")?;
    let (_, inside) = after.split_once(['(', '['])?;
    let (inside, _) = inside.split_once([')', ']'])?;
    // A length that does not fit in 64 bits counts as the largest.
    let length =
        |text: &str| text.bytes().all(|b| b.is_ascii_digit()).then(|| text.parse().unwrap_or(u64::MAX));
    inside.split(',').map(str::trim).filter(|text| !text.is_empty()).map(length).collect()
}

/// The text of the header, if it is that of an array and safe to parse.
fn check_header(bytes: &[u8]) -> Result<&[u8], &'static str> {
    let prefix =
        bytes.get(..8).filter(|prefix| prefix.starts_with(b"\x93NUMPY")).ok_or("it lacks the mark")?;
    let cut = "its header is cut off";
    let byte = |i: usize| bytes.get(i).map(|b| usize::from(*b)).ok_or(cut);
    let (start, length) = match prefix[6] {
        1 => (10, byte(8)? | byte(9)? << 8),
        2 | 3 => (12, byte(8)? | byte(9)? << 8 | byte(10)? << 16 | byte(11)? << 24),
        _ => return Err("it has an unknown version"),
    };
    if length > MAX_HEADER {
        return Err("its header is too long");
    }
    let text = bytes.get(start..start + length).ok_or(cut)?;
    let mut depth = 0usize;
    for byte in text {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > MAX_NESTING {
            return Err("its header is nested too deeply");
        }
    }
    Ok(text)
}

fn in_c_order<T: Copy>(values: Vec<T>, shape: &[usize], order: Order) -> Vec<T> {
    if order == Order::C || shape.len() < 2 || values.is_empty() {
        return values;
    }
    let mut strides = Vec::with_capacity(shape.len());
    let mut stride = 1;
    for length in shape {
        strides.push(stride);
        stride *= length;
    }
    let mut index = vec![0; shape.len()];
    let mut at = 0;
    let mut out = Vec::with_capacity(values.len());
    for _ in 0..values.len() {
        out.push(values[at]);
        for axis in (0..shape.len()).rev() {
            index[axis] += 1;
            at += strides[axis];
            if index[axis] < shape[axis] {
                break;
            }
            at -= strides[axis] * shape[axis];
            index[axis] = 0;
        }
    }
    out
}

/// Writes an array in C order, whole or not at all.
///
/// # Errors
/// [`WriteError`]; [`WriteError::Data`] where the shape and the number of elements disagree.
pub fn write_npy(path: impl AsRef<Path>, array: &Array) -> Result<(), WriteError> {
    fn write<T: npyz::AutoSerialize + Copy>(
        writer: &mut dyn Write,
        shape: &[u64],
        values: &[T],
    ) -> io::Result<()> {
        let mut npy = npyz::WriteOptions::new().default_dtype().shape(shape).writer(writer).begin_nd()?;
        npy.extend(values.iter().copied())?;
        npy.finish()
    }
    let path = path.as_ref();
    if array.expected_len() != Some(array.data.len()) {
        let reason = format!("{} numbers do not make an array of shape {:?}", array.data.len(), array.shape);
        return Err(WriteError::Data { path: path.to_owned(), reason });
    }
    let shape: Vec<u64> = array.shape.iter().map(|n| *n as u64).collect();
    write_whole(path, |writer| for_each_type!(&array.data, values => write(writer, &shape, values)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use half::f16;

    fn folder() -> tempfile::TempDir {
        tempfile::tempdir().expect("a temporary folder")
    }

    fn raw(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let text = format!("{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend(u16::try_from(text.len()).expect("short").to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Array, ArrayError> {
        let folder = folder();
        let path = folder.path().join("a.npy");
        std::fs::write(&path, bytes).expect("a file");
        read_npy(&path)
    }

    #[test]
    fn every_type_comes_back() {
        let folder = folder();
        let path = folder.path().join("a.npy");
        let cases = [
            ArrayData::F32(vec![1.5, -2.0, f32::INFINITY, 0.0, 1e-40, 6.0]),
            ArrayData::F16([1.5, -2.0, 65504.0, 0.0, 5.0, 6.0].map(f16::from_f32).to_vec()),
            ArrayData::F64(vec![1.5, -2.0, 1e300, 0.0, 5.0, 6.0]),
            ArrayData::U8(vec![0, 1, 2, 3, 4, 255]),
            ArrayData::U16(vec![0, 1, 2, 3, 4, 65535]),
            ArrayData::U32(vec![0, 1, 2, 3, 4, u32::MAX]),
            ArrayData::I32(vec![0, -1, 2, i32::MIN, 4, i32::MAX]),
        ];
        for data in cases {
            for shape in [vec![6], vec![2, 3], vec![1, 3, 2, 1]] {
                let array = Array { shape, data: data.clone() };
                write_npy(&path, &array).expect("written");
                assert_eq!(read_npy(&path).expect("read"), array);
            }
        }
        for array in [
            Array { shape: vec![], data: ArrayData::F32(vec![7.0]) },
            Array { shape: vec![0, 4], data: ArrayData::U8(vec![]) },
        ] {
            write_npy(&path, &array).expect("written");
            assert_eq!(read_npy(&path).expect("read"), array);
        }
    }

    #[test]
    fn fortran_and_big_endian_arrays_come_in_c_order() {
        let array = read(&raw("'|u1'", "True", "(2, 3)", &[0, 3, 1, 4, 2, 5])).expect("an array");
        assert_eq!(array, Array { shape: vec![2, 3], data: ArrayData::U8(vec![0, 1, 2, 3, 4, 5]) });
        let array = read(&raw("'|u1'", "True", "(2, 2, 2)", &[0, 4, 2, 6, 1, 5, 3, 7])).expect("an array");
        assert_eq!(array.data, ArrayData::U8((0..8).collect()));
        let array = read(&raw("'>u2'", "False", "(2,)", &[1, 0, 0, 2])).expect("an array");
        assert_eq!(array.data, ArrayData::U16(vec![256, 2]));
    }

    #[test]
    fn errors_are_told_apart_and_name_the_file() {
        assert!(matches!(read_npy("nowhere.npy"), Err(ArrayError::Missing { .. })));
        assert!(matches!(read(b"P6 1 1"), Err(ArrayError::NotAnArray { .. })));
        assert!(matches!(read(b"\x93NUMPY\x01\x00\xff"), Err(ArrayError::NotAnArray { .. })));
        assert!(matches!(read(&raw("'<f4'", "maybe", "(1,)", &[0; 4])), Err(ArrayError::NotAnArray { .. })));
        let deep = "(".repeat(5000);
        assert!(matches!(read(&raw("'<f4'", "False", &deep, &[])), Err(ArrayError::NotAnArray { .. })));
        for descr in ["'<i8'", "'<c8'", "'|O'", "'|b1'", "[('a', '<f4')]", "'<U3'"] {
            let error = read(&raw(descr, "False", "(1,)", &[0; 32])).expect_err(descr);
            assert!(matches!(error, ArrayError::UnsupportedType { .. }), "{descr}: {error}");
        }
        let cut = read(&raw("'<f4'", "False", "(2, 3)", &[0; 23])).expect_err("23 bytes of 24");
        assert!(cut.to_string().contains("a.npy") && cut.to_string().contains("needs 24 bytes"), "{cut}");
        for shape in [
            "(4294967296, 4294967296)",
            "(9223372036854775807, 9)",
            "(0, 4294967296, 4294967296)",
            "(99999999999999999999,)",
        ] {
            let error = read(&raw("'<f4'", "False", shape, &[])).expect_err(shape);
            assert!(matches!(error, ArrayError::TooLarge { .. }), "{shape}: {error}");
        }
        let array = Array { shape: vec![2, 2], data: ArrayData::U8(vec![1]) };
        let folder = folder();
        let error = write_npy(folder.path().join("a.npy"), &array).expect_err("one number of four");
        assert!(error.to_string().contains("shape [2, 2]"), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 0);
    }

    #[test]
    fn garbage_never_panics() {
        let mut random = crate::data::Random::new(5);
        let good = raw("'<f4'", "False", "(2, 3)", &[0; 24]);
        for _ in 0..1000 {
            let mut bytes = good.clone();
            for _ in 0..=random.below(4) {
                let place = random.below(bytes.len());
                bytes[place] = if random.below(2) == 0 {
                    random.next_u32() as u8
                } else {
                    b"(){}',0<>"[random.below(9)]
                };
            }
            bytes.truncate(random.below(bytes.len() + 1));
            let _ = read(&bytes);
        }
    }
}
