// SPDX-License-Identifier: MIT OR Apache-2.0
//! `--refraction`: the index of refraction that bends rays.

use super::field::Field;
use super::options::MediumFlags;
use super::volumes::{Matter, edges, placed};
use crate::command::CommandError;
use std::ops::RangeInclusive;

/// Indices that there are.
const POSSIBLE: RangeInclusive<f32> = 0.01..=100.0;

/// What bends rays.
pub struct Refraction {
    /// All three numbers of a voxel are the same.
    pub index: Field,
    /// Metres of a step of a ray.
    pub step: f32,
}

impl Refraction {
    /// Reads it; none where none is asked for.
    ///
    /// # Errors
    /// A failure: a file, or numbers that are no indices.
    pub fn new(flags: &MediumFlags, matter: &Matter) -> Result<Option<Self>, CommandError> {
        let Some(path) = &flags.refraction else { return Ok(None) };
        let index = placed("--refraction", path, matter.place)?;
        let failed = |problem: String| {
            Err(CommandError::failure(format!("--refraction: {}: {problem}", path.display())))
        };
        let wrong = index.values.iter().filter(|value| !POSSIBLE.contains(&value.x)).count();
        if wrong > 0 {
            let (least, most) = (POSSIBLE.start(), POSSIBLE.end());
            return failed(format!(
                "{wrong} voxels are not from {least} to {most}: give 1 where there is nothing"
            ));
        }
        if index.values.iter().any(|value| value.y != value.x || value.z != value.x) {
            return failed("it differs between channels: give one number a voxel".to_owned());
        }
        let side = |axis: usize| {
            edges(matter.place)[axis] / matter.extinction.size[axis].max(index.size[axis]) as f32
        };
        let least = side(0).min(side(1)).min(side(2));
        Ok(Some(Self { index, step: flags.refraction_step.unwrap_or(0.5 * least) }))
    }
}
