// SPDX-License-Identifier: MIT OR Apache-2.0
//! A binding of a pass, and the array that it is given.

use crate::command::CommandError;
use crate::command::error::{named, one_line};
use crate::command::run::spelling::{Input, Output, Scalar};
use crate::formats::{Array, ArrayData, read_npy};

/// The text of an `--in` up to its end.
pub(super) fn input_flag(input: &Input) -> String {
    format!("--in {}={}", input.name, input.file.display())
}

/// The text of an `--out` up to the file.
pub(super) fn output_flag(output: &Output) -> String {
    format!("--out {}={}", output.name, output.file.display())
}

/// A binding with what was said about it.
pub(super) struct Place<'a> {
    pub(super) name: &'a str,
    pub(super) input: Option<&'a Input>,
    pub(super) output: Option<&'a Output>,
    pub(super) pass: String,
    pub(super) size: Option<[u32; 2]>,
    pub(super) limits: &'a wgpu::Limits,
}

/// An array with the flag that named it.
pub(super) struct Given {
    pub(super) flag: String,
    pub(super) shape: Vec<usize>,
    /// As a shader takes it.
    pub(super) data: ArrayData,
    /// As it is in the file.
    pub(super) type_name: &'static str,
}

impl Given {
    /// A failure, described.
    pub(super) fn wrong(&self, problem: impl std::fmt::Display) -> CommandError {
        CommandError::failure(format!("{}: {problem}", self.flag))
    }

    /// Its words, where they are numbers of 32 bits.
    fn bytes(&self) -> Option<(Scalar, Vec<u8>)> {
        match &self.data {
            ArrayData::F32(values) => {
                Some((Scalar::F32, values.iter().flat_map(|v| v.to_le_bytes()).collect()))
            }
            ArrayData::U32(values) => {
                Some((Scalar::U32, values.iter().flat_map(|v| v.to_le_bytes()).collect()))
            }
            ArrayData::I32(values) => {
                Some((Scalar::I32, values.iter().flat_map(|v| v.to_le_bytes()).collect()))
            }
            _ => None,
        }
    }
}

/// A shape as NumPy writes it.
pub(super) fn shape_text(shape: &[usize]) -> String {
    let sides: Vec<_> = shape.iter().map(usize::to_string).collect();
    format!("({})", sides.join(", "))
}

impl Place<'_> {
    /// Misuse, described.
    pub(super) fn impossible(&self, problem: &str) -> CommandError {
        CommandError::Misuse(format!("{}: `{}`: {problem}", self.pass, self.name))
    }

    /// The array of `--in`.
    pub(super) fn given(&self) -> Result<Option<Given>, CommandError> {
        let Some(input) = self.input else { return Ok(None) };
        let flag = input_flag(input);
        let array = read_npy(&input.file).map_err(|error| {
            CommandError::failure(format!("--in {}: {}", input.name, named(&input.file, one_line(error))))
        })?;
        let Array { shape, data } = array;
        let type_name = data.type_name();
        Ok(Some(Given { flag, shape, data: data.to_shader_types(), type_name }))
    }

    /// The bytes of an array of words whose type must be `scalar`, where that is known.
    pub(super) fn words(
        &self,
        given: &Given,
        ty: &str,
        scalar: Option<Scalar>,
    ) -> Result<(Scalar, Vec<u8>), CommandError> {
        let (found, bytes) = given.bytes().ok_or_else(|| {
            given.wrong(format!("`{}` is {ty} and takes f32, u32 or i32, not {}", self.name, given.type_name))
        })?;
        match scalar {
            Some(wanted) if wanted != found => Err(given.wrong(format!(
                "`{}` is {ty} and takes {}, not {}",
                self.name,
                wanted.name(),
                found.name()
            ))),
            _ => Ok((found, bytes)),
        }
    }
}
