// SPDX-License-Identifier: MIT OR Apache-2.0
//! Values that change from key frame to key frame, linearly between them.

use super::{Transfer, TransferError, TransferFunction};
use crate::scattering::Medium;
use crate::stylize::Width;
use std::str::FromStr;

/// A value at each of one or more frames; constant before the first and after the last.
#[derive(Debug, Clone, PartialEq)]
pub struct Keyed<T> {
    keys: Vec<(f32, T)>,
}

impl<T> Keyed<T> {
    /// The same in every frame.
    pub fn constant(value: T) -> Self {
        Self { keys: vec![(0.0, value)] }
    }

    /// Values at frames, which ascend.
    ///
    /// # Errors
    /// [`TransferError::NoKeys`], [`TransferError::Order`].
    pub fn new(keys: Vec<(f32, T)>) -> Result<Self, TransferError> {
        let Some((first, _)) = keys.first() else { return Err(TransferError::NoKeys) };
        if !first.is_finite() {
            return Err(TransferError::Order { before: *first, after: *first });
        }
        for pair in keys.windows(2) {
            let (before, after) = (pair[0].0, pair[1].0);
            if !(after > before && after.is_finite()) {
                return Err(TransferError::Order { before, after });
            }
        }
        Ok(Self { keys })
    }

    /// Frames and values.
    pub fn keys(&self) -> &[(f32, T)] {
        &self.keys
    }

    /// The values before and behind a frame, and the share 0..1 of the second.
    pub fn around(&self, frame: f32) -> (&T, &T, f32) {
        let behind = self.keys.partition_point(|(at, _)| *at <= frame);
        let (before, after) = (&self.keys[behind.max(1) - 1], &self.keys[behind.min(self.keys.len() - 1)]);
        let span = after.0 - before.0;
        let share = if span > 0.0 { ((frame - before.0) / span).clamp(0.0, 1.0) } else { 0.0 };
        (&before.1, &after.1, share)
    }

    /// Other values at the same frames.
    ///
    /// # Errors
    /// Those of `change`.
    pub fn try_map<U, E>(&self, mut change: impl FnMut(&T) -> Result<U, E>) -> Result<Keyed<U>, E> {
        let keys = self.keys.iter().map(|(at, value)| Ok((*at, change(value)?))).collect::<Result<_, E>>()?;
        Ok(Keyed { keys })
    }
}

impl Keyed<f32> {
    /// The value at a frame.
    pub fn value(&self, frame: f32) -> f32 {
        let (before, after, share) = self.around(frame);
        before + (after - before) * share
    }

    /// The value at a frame as the width of a kernel: the nearest odd number, at least 1.
    pub fn width(&self, frame: f32) -> Width {
        Width::nearest(self.value(frame))
    }
}

/// A number, or `FRAME:VALUE,FRAME:VALUE`.
impl FromStr for Keyed<f32> {
    type Err = TransferError;

    fn from_str(text: &str) -> Result<Self, TransferError> {
        let number = |part: &str| {
            let value = part.trim().parse::<f32>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| TransferError::KeyText(text.to_owned()))
        };
        if !text.contains(':') {
            return Ok(Self::constant(number(text)?));
        }
        let key = |part: &str| match part.split_once(':') {
            Some((frame, value)) => Ok((number(frame)?, number(value)?)),
            None => Err(TransferError::KeyText(text.to_owned())),
        };
        Self::new(text.split(',').map(key).collect::<Result<_, _>>()?)
    }
}

impl Keyed<Transfer> {
    /// The uniform at a frame, for a scene with `medium`.
    pub fn function(&self, frame: f32, medium: &Medium) -> TransferFunction {
        let (before, after, share) = self.around(frame);
        before.settings.function(medium).between(&after.settings.function(medium), share)
    }
}
