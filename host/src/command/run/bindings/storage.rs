// SPDX-License-Identifier: MIT OR Apache-2.0
//! Storage buffers.

use super::place::{Place, output_flag, shape_text};
use super::{Recipe, Written};
use crate::command::CommandError;
use crate::command::run::fields::Type;
use crate::command::run::plan::Plan;
use crate::command::run::spelling::Scalar;

impl Place<'_> {
    /// A storage buffer, and what is kept of it.
    pub(super) fn storage(
        &self,
        ty: &str,
        min_size: u64,
        plan: &Plan,
    ) -> Result<(Recipe, Option<Written>), CommandError> {
        let spelled = Type::new(ty, &plan.structs);
        let scalar = spelled.scalar(&plan.structs);
        let open_end = spelled.open_end(&plan.structs);
        let fits = |bytes: u64| match open_end {
            Some((before, stride)) => bytes >= min_size && (bytes - before).is_multiple_of(stride.max(1)),
            None => bytes == min_size,
        };
        let wanted = || match open_end {
            Some((0, stride)) => format!("{ty} takes a multiple of {}", stride / 4),
            Some((before, stride)) => format!("{ty} takes {} and a multiple of {}", before / 4, stride / 4),
            None => format!("{ty} takes {}", min_size / 4),
        };
        let limit = self.limits.max_storage_buffer_binding_size;
        let too_large = |bytes: u128| {
            (bytes > u128::from(limit))
                .then(|| format!("{bytes} bytes; a device binds at most {limit} bytes as a storage buffer"))
        };

        let given = self.given()?;
        let mut contents = None;
        if let Some(given) = &given {
            let (found, bytes) = self.words(given, ty, scalar)?;
            if !fits(bytes.len() as u64) {
                return Err(given.wrong(format!(
                    "{} numbers in {}; {}",
                    bytes.len() / 4,
                    shape_text(&given.shape),
                    wanted()
                )));
            }
            if let Some(problem) = too_large(bytes.len() as u128) {
                return Err(given.wrong(problem));
            }
            contents = Some((found, bytes));
        }
        let Some(output) = self.output else {
            let bytes = contents.map(|(_, bytes)| bytes).unwrap_or_default();
            return Ok((Recipe::Storage(bytes), None));
        };
        let flag = output_flag(output);
        let count = output
            .shape
            .as_ref()
            .map(|shape| shape.iter().map(|side| u128::from(*side)).fold(1, u128::saturating_mul));
        let shape_given =
            || output.shape.as_deref().unwrap_or_default().iter().map(|side| *side as usize).collect();
        let (shape, default_scalar, bytes): (Vec<usize>, _, _) = match (contents, count) {
            (Some((found, bytes)), None) => {
                (given.map(|given| given.shape).unwrap_or_default(), found, bytes)
            }
            (Some((found, bytes)), Some(count)) if count == bytes.len() as u128 / 4 => {
                (shape_given(), found, bytes)
            }
            (Some((_, bytes)), Some(count)) => {
                let problem =
                    format!("the shape holds {count} numbers; the array of --in has {}", bytes.len() / 4);
                return Err(CommandError::misuse(&flag, problem));
            }
            (None, None) if open_end.is_none() => {
                (vec![min_size as usize / 4], Scalar::F32, vec![0; min_size as usize])
            }
            (None, None) => {
                let problem = format!("say how many numbers, {}=FILE.npy:COUNT; {}", self.name, wanted());
                return Err(CommandError::misuse(&flag, problem));
            }
            (None, Some(count)) => {
                let size = count.saturating_mul(4);
                if let Some(problem) = too_large(size) {
                    return Err(CommandError::misuse(&flag, problem));
                }
                if !fits(size as u64) {
                    return Err(CommandError::misuse(
                        &flag,
                        format!("the shape holds {count} numbers; {}", wanted()),
                    ));
                }
                (shape_given(), Scalar::F32, vec![0; size as usize])
            }
        };
        let scalar = output.scalar.or(scalar).unwrap_or(default_scalar);
        let written = Written { flag, file: output.file.clone(), shape, scalar };
        Ok((Recipe::Storage(bytes), Some(written)))
    }
}
