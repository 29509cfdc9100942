// SPDX-License-Identifier: MIT OR Apache-2.0
//! Numbers that have to lie in a range.

/// A number out of its range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{name} of {value} is impossible: it must be {range}")]
pub struct OutOfRange {
    /// Which.
    pub name: &'static str,
    /// What was given.
    pub value: f32,
    /// What is possible.
    pub range: &'static str,
}

/// Refuses a number out of its range, and one that is none.
pub(crate) fn in_range(
    name: &'static str,
    value: f32,
    possible: std::ops::RangeInclusive<f32>,
    range: &'static str,
) -> Result<(), OutOfRange> {
    if possible.contains(&value) { Ok(()) } else { Err(OutOfRange { name, value, range }) }
}
