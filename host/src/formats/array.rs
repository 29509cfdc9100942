// SPDX-License-Identifier: MIT OR Apache-2.0
//! Arrays of numbers, whatever file they come from.

use half::f16;

/// Numbers of one type, in C order (the last index runs fastest).
#[derive(Clone, Debug, PartialEq)]
pub enum ArrayData {
    /// 32-bit floats.
    F32(Vec<f32>),
    /// 16-bit floats.
    F16(Vec<f16>),
    /// 64-bit floats.
    F64(Vec<f64>),
    /// 8-bit unsigned integers.
    U8(Vec<u8>),
    /// 16-bit unsigned integers.
    U16(Vec<u16>),
    /// 32-bit unsigned integers.
    U32(Vec<u32>),
    /// 32-bit signed integers.
    I32(Vec<i32>),
}

/// Calls `$body` with `$values` bound to the vector of whatever type is in `$data`.
macro_rules! for_each_type {
    ($data:expr, $values:ident => $body:expr) => {
        match $data {
            ArrayData::F32($values) => $body,
            ArrayData::F16($values) => $body,
            ArrayData::F64($values) => $body,
            ArrayData::U8($values) => $body,
            ArrayData::U16($values) => $body,
            ArrayData::U32($values) => $body,
            ArrayData::I32($values) => $body,
        }
    };
}
pub(super) use for_each_type;

impl ArrayData {
    /// Number of elements.
    pub fn len(&self) -> usize {
        for_each_type!(self, values => values.len())
    }

    /// Whether there is no element.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Name of the type: `f32`, `f16`, `f64`, `u8`, `u16`, `u32` or `i32`.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::F32(_) => "f32",
            Self::F16(_) => "f16",
            Self::F64(_) => "f64",
            Self::U8(_) => "u8",
            Self::U16(_) => "u16",
            Self::U32(_) => "u32",
            Self::I32(_) => "i32",
        }
    }

    /// All elements as `f32`: integers by value, rounded to the nearest number that there is.
    pub fn to_f32(&self) -> Vec<f32> {
        match self {
            Self::F32(values) => values.clone(),
            Self::F16(values) => values.iter().map(|v| v.to_f32()).collect(),
            Self::F64(values) => values.iter().map(|v| *v as f32).collect(),
            Self::U8(values) => values.iter().map(|v| f32::from(*v)).collect(),
            Self::U16(values) => values.iter().map(|v| f32::from(*v)).collect(),
            Self::U32(values) => values.iter().map(|v| *v as f32).collect(),
            Self::I32(values) => values.iter().map(|v| *v as f32).collect(),
        }
    }

    /// The same numbers in a type that WGSL has: `f16` and `f64` become `f32`, `u16` becomes `u32`.
    #[must_use]
    pub fn to_shader_types(self) -> Self {
        match self {
            Self::F16(_) | Self::F64(_) => Self::F32(self.to_f32()),
            Self::U16(values) => Self::U32(values.into_iter().map(u32::from).collect()),
            other => other,
        }
    }
}

/// An array of numbers; no axes make a single number.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Length of each axis, the slowest first.
    pub shape: Vec<usize>,
    /// The numbers, as many as the product of the shape.
    pub data: ArrayData,
}

impl Array {
    /// All elements as `f32`, see [`ArrayData::to_f32`].
    pub fn to_f32(&self) -> Vec<f32> {
        self.data.to_f32()
    }

    /// Number of elements that the shape asks for; `None` where it overflows.
    pub fn expected_len(&self) -> Option<usize> {
        self.shape.iter().try_fold(1usize, |product, length| product.checked_mul(*length))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversions() {
        let array = Array { shape: vec![2], data: ArrayData::U16(vec![1, 65535]) };
        assert_eq!(array.to_f32(), [1.0, 65535.0]);
        assert_eq!(array.data.to_shader_types(), ArrayData::U32(vec![1, 65535]));
        assert_eq!(ArrayData::F64(vec![0.5]).to_shader_types(), ArrayData::F32(vec![0.5]));
    }
}
