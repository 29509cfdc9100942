// SPDX-License-Identifier: MIT OR Apache-2.0
//! Styles of strokes as TOML files.

use super::{PainterlyStyle, StrokeError};
use crate::formats::{parse_toml, read_toml};
use std::path::Path;

/// The styles that come with Airlight: names and texts.
pub const STYLES: [(&str, &str); 4] = [
    ("a", include_str!("../../styles/painterly/a.toml")),
    ("b", include_str!("../../styles/painterly/b.toml")),
    ("c", include_str!("../../styles/painterly/c.toml")),
    ("dense", include_str!("../../styles/painterly/dense.toml")),
];

/// Reads a style.
///
/// # Errors
/// [`StrokeError::File`], with line and column, also for a key that is unknown;
/// [`StrokeError::Style`] for a number that is impossible.
pub fn read_style(path: impl AsRef<Path>) -> Result<PainterlyStyle, StrokeError> {
    let path = path.as_ref();
    parse_style(path, &read_toml(path)?)
}

/// Like [`read_style`] for a text. `path`: where it lies, for errors.
///
/// # Errors
/// As [`read_style`].
pub fn parse_style(path: impl AsRef<Path>, text: &str) -> Result<PainterlyStyle, StrokeError> {
    let style: PainterlyStyle = parse_toml(path.as_ref(), text)?;
    style.check()?;
    Ok(style)
}
