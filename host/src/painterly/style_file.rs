// SPDX-License-Identifier: MIT OR Apache-2.0
//! Styles of strokes as TOML files.

use super::{PainterlyStyle, StrokeError};
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
/// [`StrokeError::Unreadable`]; [`StrokeError::File`] with line and column, also for a key that is unknown;
/// [`StrokeError::Style`] for a number that is impossible.
pub fn read_style(path: impl AsRef<Path>) -> Result<PainterlyStyle, StrokeError> {
    let path = path.as_ref();
    let unreadable = |source| StrokeError::Unreadable { path: path.to_owned(), source };
    parse_style(path, &std::fs::read_to_string(path).map_err(unreadable)?)
}

/// Like [`read_style`] for a text. `path`: where it lies, for errors.
///
/// # Errors
/// As [`read_style`].
pub fn parse_style(path: impl AsRef<Path>, text: &str) -> Result<PainterlyStyle, StrokeError> {
    let style: PainterlyStyle = toml::from_str(text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        let before = text.get(..at).unwrap_or(text);
        StrokeError::File {
            path: path.as_ref().to_owned(),
            line: before.matches('\n').count() + 1,
            column: before.rsplit('\n').next().unwrap_or_default().chars().count() + 1,
            reason: error.message().trim().replace('\n', ", "),
        }
    })?;
    style.check()?;
    Ok(style)
}
